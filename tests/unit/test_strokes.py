"""Strokes over what laps and strips leave: worth their while, drivable, and in a dead end outward."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from support.star_fields import stars

from guidance_app.boundary import frame_of, polygon_in
from guidance_app.documents import Direction
from guidance_app.guidance.ground import ground_of
from guidance_app.guidance.leftover import leftovers
from guidance_app.guidance.planning import PlanError, PlanRequest, plan_operation
from guidance_app.guidance.room import Room
from guidance_app.guidance.strokes import GRID, PART, SMALLEST, WORTH, strokes
from guidance_app.guidance.swaths import unworked
from guidance_app.store import field_from_file

FIELD = shapely.box(0.0, 0.0, 60.0, 60.0)
HALF_STEP = 0.25
"""Metres along a stroke between the places at which it is driven again here."""


GAINED = 0.99
"""Of what a stroke has to gain; the rest is rounding."""


def driven(line: np.ndarray) -> np.ndarray:
    """Poses along a line (2, 2)."""
    east, north = line[1] - line[0]
    count = int(np.hypot(east, north) / HALF_STEP) + 2
    points = line[0] + np.linspace(0.0, 1.0, count)[:, None] * (line[1] - line[0])
    return np.column_stack([points, np.full(count, np.arctan2(north, east))])


def test_a_corner_is_worked_outward_only() -> None:
    request = PlanRequest(width=6.0, radius=5.0)
    corner = shapely.box(0.0, 0.0, 6.0, 6.0)
    (bundle,) = strokes(FIELD, corner, Room(FIELD, request.body), request)
    ((line, back),) = bundle.lines
    assert line is back
    assert bundle.spare
    behind = request.offset_back + request.length / 2
    assert line.min() < behind + 2 * HALF_STEP
    away = line[1] - line[0]
    assert away.max() > 3.0


def test_what_is_open_at_both_ends_is_worked_either_way() -> None:
    request = PlanRequest(width=6.0, radius=5.0)
    gap = shapely.box(20.0, 27.0, 40.0, 33.0)
    (bundle,) = strokes(FIELD, gap, Room(FIELD, request.body), request)
    ((line, back),) = bundle.lines
    assert np.allclose(line, back[::-1], atol=0.6)


def test_crumbs_and_slivers_are_left() -> None:
    request = PlanRequest(width=6.0, radius=5.0)
    crumbs = shapely.union_all([shapely.box(0.0, 0.0, 3.0, 3.0), shapely.box(0.0, 20.0, 0.6, 60.0)])
    assert strokes(FIELD, crumbs, Room(FIELD, request.body), request) == []


@settings(max_examples=15, deadline=None)
@given(stars(), st.sampled_from([3.0, 6.0, 12.0]))
def test_every_stroke_is_drivable_and_works_enough(polygon: shapely.Polygon, width: float) -> None:
    request = PlanRequest(width=width, radius=5.0)
    try:
        ground = ground_of(polygon, request)
    except PlanError:
        return
    worked = ground.buffer(-width)
    room = Room(ground, request.body)
    least = max(SMALLEST, WORTH * width**2, min(PART * ground.area, width**2))
    for bundle in strokes(ground, unworked(ground, worked), room, request):
        ((line, back),) = bundle.lines
        assert room.fits_each(driven(line)).all()
        assert room.fits_each(driven(back)).all()
        swath = shapely.LineString(line).buffer(width / 2, cap_style="flat")
        gained = swath.intersection(ground).difference(worked, grid_size=GRID)
        assert gained.area > GAINED * least
        worked = worked.union(swath, grid_size=GRID)


@pytest.mark.parametrize(
    ("name", "width", "least"), [("at_070", 6.0, 0.985), ("it_040", 6.0, 0.975), ("nz_024", 24.0, 0.88)]
)
def test_real_fields_with_corners_and_tongues(real_data: Path, name: str, width: float, least: float) -> None:
    boundary = field_from_file(real_data / "fields" / f"{name}.geojson").boundary
    polygon = polygon_in(frame_of(boundary), boundary)
    request = PlanRequest(width=width, radius=5.0 if width < 12 else 6.0, direction=Direction.BEST)
    assert plan_operation(polygon, request).costs.worked_fraction > least


def test_a_tongue_is_still_worked_in_strips(real_data: Path) -> None:
    boundary = field_from_file(real_data / "fields" / "it_040.geojson").boundary
    polygon = polygon_in(frame_of(boundary), boundary)
    request = PlanRequest(width=6.0, radius=5.0)
    ground = ground_of(polygon, request)
    found = leftovers(ground, unworked(ground, ground.buffer(-12.0).buffer(12.0)), Room(ground, request.body), request)
    assert max(len(bundle.lines) for bundle in found) > 1
