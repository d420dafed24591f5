"""Fields changed later: what is cut adds up, what is shifted comes back, and nothing wrong passes the checks."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.boundary import BoundaryError, polygon_in
from guidance_app.documents import FieldDocument, Geometry
from guidance_app.field_editing import (
    moved_corner,
    nearest_corner,
    rings_in,
    shifted,
    split,
    unshifted,
    with_corner,
    with_exclusion,
    without_corner,
    without_exclusion,
)
from guidance_app.geodesy import FieldFrame

MILLIMETRE = 1e-3
SQUARE_METRE = 1.0
FRAME = FieldFrame(47.5, 8.5)
CORNERS = np.array([[0.0, 0.0], [200.0, 0.0], [200.0, 100.0], [0.0, 100.0]])


def field(corners: np.ndarray = CORNERS) -> FieldDocument:
    ring = [(float(lon), float(lat)) for lon, lat in FRAME.lonlat_from_array(corners)]
    return FieldDocument(name="Long Acre", boundary=Geometry(coordinates=[[*ring, ring[0]]]), entrance=ring[0])


def area(document: FieldDocument) -> float:
    return float(polygon_in(FRAME, document.boundary).area)


@given(at=st.floats(0.05, 0.95), tilt=st.floats(-30.0, 30.0))
def test_the_two_parts_of_a_split_field_add_up_to_it(at: float, tilt: float) -> None:
    whole = field()
    one, other = split(FRAME, whole, [(200 * at, 40.0), (200 * at + tilt / 10, 60.0)])
    assert area(one) + area(other) == pytest.approx(area(whole), abs=SQUARE_METRE)
    assert area(one) > area(other) - SQUARE_METRE
    assert (one.name, other.name) == ("Long Acre 1", "Long Acre 2")


def test_a_split_keeps_the_exclusions_where_they_are() -> None:
    trees = np.array([[20.0, 20.0], [40.0, 20.0], [40.0, 40.0], [20.0, 40.0]])
    one, other = split(FRAME, with_exclusion(FRAME, field(), trees), [(100.0, 0.0), (100.0, 100.0)])
    assert sorted(len(part.boundary.coordinates) for part in (one, other)) == [1, 2]


@given(east=st.floats(-100, 100), north=st.floats(-100, 100))
def test_a_shift_moves_everything_and_is_undone(east: float, north: float) -> None:
    moved = shifted(field(), east, north, "2026-05-01T08:00:00Z", "stood on corner 1")
    assert rings_in(FRAME, moved)[0] == pytest.approx(
        rings_in(FRAME, field())[0] + np.array([east, north]), abs=5 * MILLIMETRE
    )
    assert moved.shifts[0].east == east
    back = unshifted(moved)
    assert back.shifts == []
    assert rings_in(FRAME, back)[0] == pytest.approx(rings_in(FRAME, field())[0], abs=MILLIMETRE)


def test_a_shift_that_no_datum_explains_is_refused() -> None:
    with pytest.raises(BoundaryError, match="right corner"):
        shifted(field(), 400.0, 0.0, "2026-05-01T08:00:00Z", "")
    with pytest.raises(BoundaryError, match="not been shifted"):
        unshifted(field())


def test_the_corner_under_the_finger_is_moved_and_no_other() -> None:
    corner, away = nearest_corner(FRAME, field(), (198.0, 99.0))
    assert away == pytest.approx(np.hypot(2.0, 1.0), abs=MILLIMETRE)
    before = rings_in(FRAME, field())[0]
    after = rings_in(FRAME, moved_corner(FRAME, field(), corner, (210.0, 110.0)))[0]
    changed = np.hypot(*(after - before).T) > MILLIMETRE
    assert changed.sum() == 1


def test_a_corner_that_makes_the_boundary_cross_itself_is_refused() -> None:
    corner, _ = nearest_corner(FRAME, field(), (200.0, 100.0))
    with pytest.raises(BoundaryError, match="crosses itself"):
        moved_corner(FRAME, field(), corner, (100.0, -50.0))


def test_a_corner_goes_into_the_nearest_edge_and_away_again() -> None:
    more = with_corner(FRAME, field(), (100.0, -10.0))
    assert area(more) == pytest.approx(area(field()) + 1000.0, abs=SQUARE_METRE)
    corner, _ = nearest_corner(FRAME, more, (100.0, -10.0))
    assert area(without_corner(FRAME, more, corner)) == pytest.approx(area(field()), abs=SQUARE_METRE)


def test_a_triangle_keeps_its_corners() -> None:
    with pytest.raises(BoundaryError, match="three corners"):
        without_corner(FRAME, field(CORNERS[:3]), (0, 0))


def test_an_exclusion_comes_and_goes() -> None:
    pond = shapely.get_coordinates(shapely.Point(100.0, 50.0).buffer(10.0))[:-1]
    with_pond = with_exclusion(FRAME, field(), pond)
    assert area(with_pond) < area(field()) - 300.0
    assert area(without_exclusion(with_pond, 1)) == pytest.approx(area(field()), abs=SQUARE_METRE)
    with pytest.raises(BoundaryError, match="there is no exclusion 2"):
        without_exclusion(with_pond, 2)


def test_a_line_that_misses_cuts_nothing() -> None:
    with pytest.raises(BoundaryError, match="1 parts"):
        split(FRAME, field(), [(0.0, 200.0), (100.0, 200.0)])
    with pytest.raises(BoundaryError, match="1 m apart"):
        split(FRAME, field(), [(100.0, 50.0), (100.0, 50.0)])
