"""Boundaries: what is repaired keeps its corners, what is refused names the place."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.documents import rectangle, ring_of

from guidance_app.boundary import BoundaryError, FieldDraft, checked_boundary, checked_field, frame_of, polygon_in
from guidance_app.documents import Position

MILLIMETRE = 1e-3
SQUARE_CENTIMETRES_10 = 1e-3

FIELD = ring_of(rectangle(200, 100))


def area_of(rings: list[list[Position]]) -> float:
    return checked_boundary(rings).area


def remarks_of(rings: list[list[Position]]) -> str:
    return "; ".join(checked_boundary(rings).remarks)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 20), st.booleans(), st.integers(0, 3))
def test_start_orientation_and_repeats_do_not_change_the_ground(start: int, turned: bool, repeats: int) -> None:
    corners = [(90 * math.cos(a), 60 * math.sin(a)) for a in (2 * math.pi * k / 21 for k in range(21))]
    wanted = area_of([ring_of(corners)])
    moved = corners[start:] + corners[:start]
    ring = ring_of(moved[::-1] if turned else moved)
    ring[3:3] = [ring[3]] * repeats
    checked = checked_boundary([ring])
    assert checked.area == pytest.approx(wanted, abs=SQUARE_CENTIMETRES_10)
    assert len(checked.geometry.coordinates[0]) == 22
    assert bool(checked.remarks) == bool(repeats)


def test_the_outer_ring_runs_counter_clockwise_and_exclusions_clockwise() -> None:
    hole = ring_of(rectangle(10, 10, (50, 50)))
    for outer in (FIELD, FIELD[::-1]):
        for inner in (hole, hole[::-1]):
            checked = checked_boundary([outer, inner])
            frame = frame_of(checked.geometry)
            rings = [frame.array_from_lonlat(ring) for ring in checked.geometry.coordinates]
            signs = [float((r[:-1, 0] * r[1:, 1] - r[1:, 0] * r[:-1, 1]).sum()) for r in rings]
            assert signs[0] > 0 > signs[1]
            assert checked.area == pytest.approx(19_900, rel=1e-6)


def test_an_open_ring_is_closed_with_a_remark() -> None:
    assert area_of([FIELD[:-1]]) == pytest.approx(area_of([FIELD]), abs=SQUARE_CENTIMETRES_10)
    assert "was open" in remarks_of([FIELD[:-1]])


def test_spikes_are_dropped_down_to_the_last_one() -> None:
    spiked = ring_of([(0, 0), (200, 0), (260, 0), (320, 0), (200, 0), (200, 100), (200, 170), (200, 100), (0, 100)])
    checked = checked_boundary([spiked])
    assert checked.area == pytest.approx(20_000, rel=1e-6)
    assert len(checked.geometry.coordinates[0]) == 5
    assert "spikes" in "; ".join(checked.remarks)


def test_a_spike_at_the_first_corner_is_seen_too() -> None:
    spiked = ring_of([(-50, 0), (0, 0), (200, 0), (200, 100), (0, 100), (0, 0)])
    assert checked_boundary([spiked]).area == pytest.approx(20_000, rel=1e-6)


def test_a_sharp_corner_is_no_spike() -> None:
    wedge = ring_of([(0, 0), (400, 0.0), (0, 2.0)])
    assert area_of([wedge]) == pytest.approx(400, rel=1e-4)  # a tenth of a millimetre in 2 m


def test_repairs_never_move_a_corner() -> None:
    ring = ring_of([(0, 0), (200, 0), (200, 0.0001), (260, 0), (200, 0), (200, 100), (0, 100)])
    kept = checked_boundary([ring]).geometry.coordinates[0]
    frame = frame_of(checked_boundary([ring]).geometry)
    given_corners = frame.array_from_lonlat(ring)
    for corner in frame.array_from_lonlat(kept):
        assert min(math.dist(corner, other) for other in given_corners) < MILLIMETRE


def test_a_ring_that_crosses_itself_is_refused_with_the_place_and_the_edges() -> None:
    with pytest.raises(BoundaryError) as caught:
        checked_boundary([ring_of([(0, 0), (200, 0), (0, 100), (200, 100)])])
    assert "crosses itself at latitude 41.930450, longitude -4.868794" in str(caught.value)
    assert "between corners 2-3 and 4-1" in str(caught.value)


def test_a_ring_that_touches_itself_is_refused() -> None:
    with pytest.raises(BoundaryError, match="crosses itself"):
        checked_boundary([ring_of([(0, 0), (100, 50), (200, 0), (200, 100), (100, 50), (0, 100)])])


def test_exclusions_outside_across_and_over_each_other_are_refused_with_the_place() -> None:
    outside = ring_of(rectangle(20, 20, (190, 40)))
    with pytest.raises(BoundaryError, match="exclusion 1 reaches outside the boundary at latitude"):
        checked_boundary([FIELD, outside])
    one, two = ring_of(rectangle(30, 30, (20, 20))), ring_of(rectangle(30, 30, (40, 40)))
    with pytest.raises(BoundaryError, match="exclusions 1 and 2 lie on each other at latitude"):
        checked_boundary([FIELD, one, two])
    wall = ring_of([(0, 0), (105, 48), (200, 100), (95, 52)])
    with pytest.raises(BoundaryError, match="cut the field apart"):
        checked_boundary([FIELD, wall])


def test_an_exclusion_of_nothing_is_dropped_with_a_remark() -> None:
    nothing = ring_of([(50, 50), (60, 50), (70, 50)])
    checked = checked_boundary([FIELD, nothing])
    assert len(checked.geometry.coordinates) == 1
    assert "exclusion 1 encloses nothing" in "; ".join(checked.remarks)


@pytest.mark.parametrize(
    ("corner", "sentence"),
    [
        ((float("nan"), 41.9), "not a number"),
        ((-4.87, float("inf")), "not a number"),
        ((41.93, 139.7), "latitude and longitude look swapped"),
        ((512_000.0, 4_640_000.0), "look like metres"),
        ((10.0, 89.9), "less than a degree from a pole"),
        ((-4.0, 41.93), "km apart"),
    ],
)
def test_a_corner_that_cannot_be_is_refused_with_a_hint(corner: Position, sentence: str) -> None:
    ring = [FIELD[0], FIELD[1], corner, FIELD[3]]
    with pytest.raises(BoundaryError, match=sentence):
        checked_boundary([ring])


@pytest.mark.parametrize(
    ("side", "sentence"),
    [(1.0, "too small"), (9.9, "too small"), (10_100.0, "too large"), (90_000.0, "km apart")],
)
def test_fields_of_no_sensible_size_are_refused(side: float, sentence: str) -> None:
    with pytest.raises(BoundaryError, match=sentence):
        checked_boundary([ring_of(rectangle(side, side))])


def test_too_few_corners_are_refused() -> None:
    for ring in ([], [FIELD[0]], FIELD[:2], [FIELD[0]] * 5, ring_of([(0, 0), (50, 0), (100, 0)])):
        with pytest.raises(BoundaryError):
            checked_boundary([ring])
    with pytest.raises(BoundaryError):
        checked_boundary([])


def test_too_many_corners_and_exclusions_are_refused() -> None:
    with pytest.raises(BoundaryError, match="corners; 99999 are possible"):
        checked_boundary([FIELD * 25_000])
    with pytest.raises(BoundaryError, match="exclusions; 999 are possible"):
        checked_boundary([FIELD] * 1001)


def test_a_field_across_the_180th_meridian_is_like_any_other() -> None:
    ring = ring_of(rectangle(200, 100, (-100, 0)), (-16.8, 180.0))
    assert min(corner[0] for corner in ring) < 0 < max(corner[0] for corner in ring)
    checked = checked_boundary([ring])
    assert checked.area == pytest.approx(20_000, rel=1e-6)
    assert polygon_in(frame_of(checked.geometry), checked.geometry).is_valid


@settings(max_examples=20, deadline=None)
@given(st.floats(-75, 75), st.floats(-180, 180), st.floats(20, 2000))
def test_the_area_is_true_anywhere_on_earth(latitude: float, longitude: float, side: float) -> None:
    ring = ring_of(rectangle(side, side), (latitude, longitude))
    assert area_of([ring]) == pytest.approx(side * side, rel=1e-5)


def test_of_several_parts_the_largest_is_taken_and_said() -> None:
    small, large = ring_of(rectangle(50, 50)), ring_of(rectangle(80, 80, (100, 0)))
    field = checked_field(FieldDraft(name=None, parts=([small], [large])), "Two")
    assert field.area == pytest.approx(6400, rel=1e-6)
    assert field.document.name == "Two"
    assert any("2 parts; only the largest, 0.64 ha" in remark for remark in field.remarks)
    with pytest.raises(BoundaryError, match="no polygon"):
        checked_field(FieldDraft(name="x", parts=()), "x")
    with pytest.raises(BoundaryError, match="cannot be stored"):
        checked_field(FieldDraft(name="x" * 500, parts=([large],)), "x")
