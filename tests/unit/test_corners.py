"""Corners of laps: backed up into as far as the boundary lets, inside, on circles that can be driven."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from support.star_fields import stars

from guidance_app.boundary import frame_of, polygon_in
from guidance_app.guidance.ground import ground_of
from guidance_app.guidance.headland import headland_of
from guidance_app.guidance.lap import Lap
from guidance_app.guidance.planning import PlanError, PlanRequest
from guidance_app.guidance.swaths import swath, united
from guidance_app.guidance.task import side_tasks
from guidance_app.store import field_from_file

IMPLEMENT_END = 0.03
"""Metres by which the implement's end may touch the boundary, rounding included."""

CORNER_STRIP = 2.5
"""Metres of a corner that may stay unworked: half the implement's length, a step, and the wedge of a bent way back."""

CORNER_CELL = 12.0
"""Metres: a square of the working width in each corner of a field."""


def laps_of(polygon: shapely.Polygon, request: PlanRequest) -> tuple[Lap, ...]:
    return headland_of(ground_of(polygon, request), request).laps


def bulged(bulge: float) -> shapely.Polygon:
    """A square whose sides bend in by so many metres just before each corner."""
    side = np.array([(0.0, 0.0), (9.0, -bulge), (71.0, -bulge)]) - 40.0
    turned = [side @ np.array([[c, s], [-s, c]]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    return shapely.Polygon(np.concatenate(turned))


@pytest.mark.parametrize("bulge", [0.0, 0.1, 0.3, 0.6])
@pytest.mark.parametrize("clockwise", [True, False])
def test_a_boundary_that_bends_a_little_costs_no_corner(bulge: float, clockwise: bool) -> None:
    field, request = bulged(bulge), PlanRequest(width=12.0, radius=6.0, laps=1, laps_clockwise=clockwise)
    (lap,) = laps_of(field, request)
    assert len(lap.corners) == 4
    worked = united([swath(task, request.width) for task in side_tasks(lap, 5.0, 1, None)])
    for east, north in ((-40, -40), (40, -40), (40, 40), (-40, 40)):
        cell = shapely.Point(east, north).buffer(CORNER_CELL, cap_style="square").intersection(field)
        assert cell.difference(worked).area < CORNER_STRIP * request.width


@pytest.mark.parametrize(("name", "least"), [("at_064", 0.93), ("dk_093", 0.93), ("ie_090", 0.93)])
def test_a_lap_works_the_rim_of_real_fields(real_data: Path, name: str, least: float) -> None:
    """What lies within the working width of the boundary, as far as a bar of that width gets there."""
    boundary = field_from_file(real_data / "fields" / f"{name}.geojson").boundary
    polygon, request = polygon_in(frame_of(boundary), boundary), PlanRequest(width=12.0, radius=6.0, laps=1)
    laps = laps_of(polygon, request)
    rim = polygon.difference(polygon.buffer(-request.width))
    worked = united([swath(task, request.width) for lap in laps for task in side_tasks(lap, 0.0, 1, None)])
    assert rim.intersection(worked).area > least * rim.area


@settings(max_examples=25, deadline=None)
@given(stars(), st.sampled_from([3.0, 6.0, 12.0]), st.booleans())
def test_the_way_back_stays_inside_and_bends_gently(polygon: shapely.Polygon, width: float, clockwise: bool) -> None:
    request = PlanRequest(width=width, radius=5.0, laps_clockwise=clockwise)
    try:
        laps = laps_of(polygon, request)
    except PlanError:
        return
    room = polygon.buffer(IMPLEMENT_END)
    for corner in (corner for lap in laps for corner in lap.corners):
        steps = np.diff(corner.back, axis=0)
        yaw = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
        assert np.ptp(yaw) * request.path_radius <= 0.2 * np.hypot(*steps.T).sum()
        toward = steps[-1] / np.hypot(*steps[-1])
        across = np.array([-toward[1], toward[0]]) * width / 2
        bar = shapely.LineString([corner.back[-1] - across, corner.back[-1] + across])
        assert room.covers(bar)
