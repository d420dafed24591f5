"""The counter equals the exact union of what was swept, for every width, direction, spacing and wobble."""

import math
from dataclasses import astuple

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given, settings
from hypothesis import strategies as st
from support.worked import Place, bend, straight, swept, twice, union, work

from guidance_app.guidance.coverage import Coverage, cell_size

THOUSANDTH = 1e-3
"""Of the worked area: what the counter may be wrong by."""


def wobbling_passes(width: float, spacing: float, heading: float, count: int, seed: int) -> list[list[Place]]:
    """Passes to and fro beside each other, as a person steers them."""
    rng = np.random.default_rng(seed)
    length = 8.0 * width
    right = (math.cos(heading), -math.sin(heading))
    passes = []
    for i in range(count):
        places = straight((i * spacing * right[0], i * spacing * right[1]), heading, length, step=0.05 * width)
        phase, size = rng.uniform(0, math.tau), 0.02 * width
        wobbled = []
        for j, (east, north, _) in enumerate(places):
            side = size * math.sin(phase + 0.1 * j)
            turned = heading + 0.04 * math.cos(phase + 0.1 * j)
            wobbled.append((east + side * right[0], north + side * right[1], turned))
        if i % 2:
            wobbled = [(east, north, turned + math.pi) for east, north, turned in wobbled[::-1]]
        passes.append(wobbled)
    return passes


@settings(max_examples=10)
@given(
    width=st.floats(1.0, 36.0),
    part=st.floats(0.85, 1.1),
    heading=st.floats(-math.pi, math.pi),
    seed=st.integers(0, 2**32 - 1),
)
def test_worked_and_overlap_equal_the_exact_union(width: float, part: float, heading: float, seed: int) -> None:
    passes = wobbling_passes(width, part * width, heading, 4, seed)
    coverage = Coverage(width)
    t = 0.0
    for number, places in enumerate(passes):
        t = work(coverage, places, t, number)
    strips = [swept(places, width) for places in passes]
    exact = union(strips).area
    assert coverage.totals.worked == pytest.approx(exact, rel=THOUSANDTH)
    assert abs(coverage.totals.overlap - twice(strips).area) < THOUSANDTH * exact
    of_passes = [coverage.of_pass(number) for number in range(4)]
    assert sum(one.worked for one in of_passes) == pytest.approx(coverage.totals.worked)
    assert sum(one.overlap for one in of_passes) == pytest.approx(coverage.totals.overlap)
    assert of_passes[0].overlap == 0.0


@settings(max_examples=25)
@given(first=st.floats(0.0, math.pi), turned=st.floats(0.3, math.pi - 0.3), overlap=st.floats(0.05, 0.95))
def test_dead_straight_work_along_either_edge_of_a_field_is_counted_right(
    first: float, turned: float, overlap: float
) -> None:
    """The hardest case for a grid: strips that would all lie along it. The lap comes first, then passes."""
    width, length = 6.0, 60.0
    one, other = (np.array([math.sin(h), math.cos(h)]) for h in (first, first + turned))
    start = 20.0 * one
    field = shapely.Polygon([0 * one, 120 * one, 120 * one + 90 * other, 90 * other])
    coverage = Coverage(width, field)
    t = work(coverage, straight((-500.0, -500.0), first, 20.0), 0.0, 0)
    before = coverage.totals
    right = np.array([math.cos(first + turned), -math.sin(first + turned)])
    for number in range(1, 4):
        place = start + number * (width - overlap) * right
        t = work(coverage, straight((float(place[0]), float(place[1])), first + turned, length), t, number)
    exact = (3 * width - 2 * overlap) * length
    assert coverage.totals.worked - before.worked == pytest.approx(exact, rel=THOUSANDTH)
    assert abs(coverage.totals.overlap - 2 * overlap * length) < THOUSANDTH * exact


@settings(max_examples=10)
@given(
    width=st.floats(2.0, 24.0),
    heading=st.floats(-math.pi, math.pi),
    turns=st.lists(st.floats(-1.5, 1.5), min_size=1, max_size=3),
    radius=st.floats(0.6, 3.0),
)
def test_on_bends_too(width: float, heading: float, turns: list[float], radius: float) -> None:
    """Radii between 0.6 and 3 widths: the implement's inner end never goes backwards."""
    places = straight((0.0, 0.0), heading, 3.0 * width)
    for turn in turns:
        places += bend(places[-1], radius * width, turn)
        places += straight(places[-1][:2], places[-1][2], width)[1:]
    coverage = Coverage(width)
    work(coverage, places, 0.0)
    assert coverage.totals.worked == pytest.approx(swept(places, width).area, rel=2 * THOUSANDTH)


@settings(max_examples=10)
@given(width=st.floats(3.0, 24.0), part=st.floats(0.05, 0.45), heading=st.floats(-math.pi, math.pi))
def test_the_inner_fold_of_a_square_turn_is_not_worked_twice(width: float, part: float, heading: float) -> None:
    places = straight((0.0, 0.0), heading, 2.0 * width)
    places += bend(places[-1], part * width, math.pi / 2, step=0.02 * width)
    places += straight(places[-1][:2], places[-1][2], 2.0 * width)[1:]
    coverage = Coverage(width)
    work(coverage, places, 0.0)
    exact = swept(places, width).area
    assert coverage.totals.worked == pytest.approx(exact, rel=2 * THOUSANDTH)
    assert coverage.totals.overlap < THOUSANDTH * exact


@settings(max_examples=10)
@given(width=st.floats(2.0, 12.0), heading=st.floats(-math.pi, math.pi))
def test_a_later_crossing_in_one_strip_is_worked_twice(width: float, heading: float) -> None:
    """Straight on, three quarters round, and square over the first stretch: the crossing is a square."""
    radius = 2.0 * width
    places = straight((0.0, 0.0), heading, 5.0 * width)
    places += bend(places[-1], radius, 1.5 * math.pi)
    places += straight(places[-1][:2], places[-1][2], 5.0 * width)[1:]
    coverage = Coverage(width)
    work(coverage, places, 0.0)
    assert coverage.totals.overlap == pytest.approx(width**2, rel=0.02)


@settings(max_examples=6)
@given(
    heading=st.floats(-math.pi, math.pi),
    offset=st.floats(-20.0, 20.0),
    sides=st.integers(3, 9),
    seed=st.integers(0, 2**32 - 1),
)
def test_area_left_and_headland_equal_the_exact_ones(heading: float, offset: float, sides: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0, math.tau, sides)) + np.arange(sides) * 0.01
    outline = shapely.Polygon(np.column_stack([60 * np.sin(angles), 60 * np.cos(angles)])).buffer(10.0, quad_segs=4)
    field = outline.difference(shapely.Point(offset, 5.0).buffer(8.0, quad_segs=6))
    mainland = field.buffer(-12.0)
    coverage = Coverage(6.0, field, mainland)
    passes = wobbling_passes(6.0, 6.1, heading, 5, seed)
    t = 0.0
    for number, places in enumerate(passes):
        t = work(coverage, [(east + offset, north - 20.0, turned) for east, north, turned in places], t, number)
    ground = shapely.affinity.translate(union(swept(places, 6.0) for places in passes), offset, -20.0)
    assert coverage.totals.left is not None
    assert abs(coverage.totals.left - field.difference(ground).area) < THOUSANDTH * ground.area
    assert abs(coverage.totals.headland - ground.difference(mainland).area) < THOUSANDTH * ground.area


anything = st.floats(allow_nan=True, allow_infinity=True)
near = st.floats(-50.0, 50.0)


@settings(max_examples=60)
@given(
    st.lists(
        st.tuples(st.one_of(anything, near), st.one_of(anything, near), anything, anything, st.booleans()), max_size=12
    )
)
def test_totals_are_finite_for_any_place(steps: list[tuple[float, float, float, float, bool]]) -> None:
    coverage = Coverage(3.0, shapely.box(-40, -40, 40, 40))
    for east, north, heading, t, down in steps:
        coverage.step((east, north, heading), t, down, 1)
    totals = coverage.totals
    assert all(math.isfinite(value) for value in astuple(totals) if value is not None)
    assert totals.left is not None
    assert 0.0 <= totals.left <= 6400.0


@settings(max_examples=10)
@given(st.integers(0, 200), st.integers(0, 2**32 - 1))
def test_a_fork_goes_on_like_the_coverage_and_leaves_it_alone(cut: int, seed: int) -> None:
    places = [place for one in wobbling_passes(3.0, 2.8, 0.4, 3, seed) for place in one]
    steps = [(place, 0.2 * i, i % 40 < 36, i // 160) for i, place in enumerate(places)]

    def go_on(coverage: Coverage, behind: int) -> Coverage:
        for step in steps[behind:]:
            coverage.step(*step)
        return coverage

    coverage = Coverage(3.0)
    for step in steps[:cut]:
        coverage.step(*step)
    fork, stray = coverage.fork(), coverage.fork()
    work(stray, straight((0.0, 0.0), 1.2, 40.0), 1000.0)
    expected = go_on(Coverage(3.0), 0)
    for one in (go_on(coverage, cut), go_on(fork, cut)):
        assert one.totals == expected.totals
        assert [one.of_pass(number) for number in range(3)] == [expected.of_pass(number) for number in range(3)]
        assert one.worked.count == expected.worked.count


@given(st.floats(0.3, 60.0))
def test_a_whole_number_of_cells_lies_across_the_implement(width: float) -> None:
    cell = cell_size(width)
    assert 0.01 < cell <= 0.2 + 1e-9
    assert abs(width / cell - round(width / cell)) < 1e-6
