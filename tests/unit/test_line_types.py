"""Every guidance line type makes passes from the points that a field stores, or says in a sentence why not."""

import itertools
import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.documents import GuidanceLineDocument
from guidance_app.guidance.family import GuidanceLineError, PassFamily, offset_line, passes_within
from guidance_app.guidance.patterns import LINES, a_plus, pivot
from guidance_app.guidance.polyline import Polyline
from guidance_app.model import FloatArray

SPACING = 3.0
MILLIMETRE = 1e-3
POINTS = {
    "ab": np.array([[0.0, 0.0], [10.0, 90.0]]),
    "a-plus": a_plus.points_of((5.0, -3.0), math.radians(30)),
    "curve": np.column_stack([8.0 * np.sin(np.arange(0, 200) / 50.0), np.arange(0.0, 200.0)]),
    "pivot": np.array([[0.0, 0.0], [60.0, 0.0]]),
    "last-pass": np.array([[0.0, 0.0], [2.0, 50.0], [0.0, 100.0]]),
}


def test_every_type_that_a_field_can_store_has_its_family() -> None:
    stored = GuidanceLineDocument.model_fields["type"].annotation.__args__
    assert set(stored) <= set(LINES)
    assert set(POINTS) == set(LINES)


@pytest.mark.parametrize("name", LINES)
def test_pass_0_is_the_guidance_line_and_its_neighbours_lie_a_spacing_beside(name: str) -> None:
    family = LINES[name].family(POINTS[name], SPACING)
    guidance_line = family.pass_numbered(0)
    right = family.pass_numbered(1)
    assert guidance_line is not None
    assert right is not None
    base = Polyline.of(guidance_line)
    feet = [base.foot(*point) for point in right.points[1:-1]] or [base.foot(*point) for point in right.points]
    assert [foot.cross for foot in feet] == pytest.approx([SPACING] * len(feet), abs=0.02)
    assert family.nearest_number(*right.points[0]) == 1


@pytest.mark.parametrize("name", LINES)
def test_points_that_make_no_line_are_refused_in_a_sentence(name: str) -> None:
    same = np.zeros((2, 2))
    if name == "last-pass":
        assert LINES[name].family(np.empty((0, 2)), SPACING).pass_numbered(0) is None
        return
    for points in (same, np.array([[0.0, 0.0]]), np.empty((0, 2)), np.full((2, 2), math.nan)):
        with pytest.raises(GuidanceLineError, match=r"\w+ \w+"):
            LINES[name].family(points, SPACING)


@pytest.mark.parametrize("name", [name for name in LINES if name != "last-pass"])
@pytest.mark.parametrize("spacing", [0.0, -1.0, math.nan, math.inf])
def test_a_spacing_that_cannot_be_driven_is_refused(name: str, spacing: float) -> None:
    with pytest.raises(GuidanceLineError, match="spacing"):
        LINES[name].family(POINTS[name], spacing)


def test_a_curve_of_less_than_five_metres_says_how_short_it_is() -> None:
    with pytest.raises(GuidanceLineError, match=r"3\.0 m long"):
        LINES["curve"].family(np.array([[0.0, 0.0], [3.0, 0.0]]), SPACING)


@pytest.mark.parametrize("name", LINES)
def test_numbers_beyond_every_field_have_no_pass(name: str) -> None:
    family = LINES[name].family(POINTS[name], SPACING)
    assert family.pass_numbered(10**7) is None
    assert family.pass_numbered(-(10**7)) is None
    assert family.count is None


def test_a_plus_runs_in_its_heading() -> None:
    line = LINES["a-plus"].family(POINTS["a-plus"], SPACING).pass_numbered(0)
    assert line is not None
    assert Polyline.of(line).first_heading == pytest.approx(math.radians(30))
    assert line.points[0] == pytest.approx([5.0, -3.0])


@given(
    st.floats(-300, 300),
    st.floats(-300, 300),
    st.floats(20.0, 400.0),
    st.floats(0.6, math.tau),
    st.integers(0, 2**32 - 1),
)
def test_a_part_of_the_circle_gives_the_pivot(east: float, north: float, radius: float, part: float, seed: int) -> None:
    angles = np.linspace(0.0, part, 100)
    noise = np.random.default_rng(seed).normal(0, MILLIMETRE, (100, 2))
    driven = np.column_stack([east + radius * np.cos(angles), north + radius * np.sin(angles)]) + noise
    centre, rim = pivot.points_of_arc(driven)
    assert math.dist(centre, (east, north)) < 0.001 * radius + 0.05
    assert math.dist(centre, rim) == pytest.approx(radius, abs=0.001 * radius + 0.05)


def test_a_straight_line_has_no_pivot() -> None:
    with pytest.raises(GuidanceLineError, match="straight"):
        pivot.points_of_arc(np.column_stack([np.arange(50.0), 2.0 * np.arange(50.0)]))


def within(family: PassFamily, area: shapely.Polygon) -> list[int]:
    return [one.number for one in passes_within(family, area)]


def test_drawn_passes_are_those_that_cross_the_field() -> None:
    assert within(LINES["ab"].family(np.array([[0.0, 0.0], [0.0, 10.0]]), SPACING), shapely.box(-4, 50, 7, 90)) == [
        -1,
        0,
        1,
        2,
    ]
    circles = LINES["pivot"].family(POINTS["pivot"], 20.0)
    assert within(circles, shapely.box(5, 5, 60, 60)) == [-1, 0, 1, 2]


def test_a_curve_that_is_driven_over_and_over_stays_apart() -> None:
    """Ten thousand points of a curve with noise: neighbours keep their distance and do not cross."""
    rng = np.random.default_rng(4)
    north = np.arange(0.0, 5000.0, 0.5)
    driven = np.column_stack([60.0 * np.sin(north / 150.0), north]) + rng.normal(0, 0.02, (len(north), 2))
    family = LINES["curve"].family(driven, SPACING)
    lines: list[FloatArray] = []
    for number in (-2, -1, 0, 1, 2):
        line = family.pass_numbered(number)
        assert line is not None
        lines.append(line.points)
    gaps = [shapely.LineString(low).distance(shapely.LineString(high)) for low, high in itertools.pairwise(lines)]
    assert min(gaps) > SPACING - 0.05


def test_a_line_moved_by_next_to_nothing_stays_where_it_is() -> None:
    """Nudges there and back leave a rest that GEOS cannot offset by."""
    line = np.array([[0.0, 0.0], [0.0, 100.0]])
    assert offset_line(line, 0.1 + 0.2 - 0.3) is line
