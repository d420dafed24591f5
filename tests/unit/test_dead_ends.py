"""A tractor backs out of a dead end, or into one, when no way that is driven forward fits."""

from pathlib import Path

import numpy as np
import pytest
import shapely

from guidance_app.boundary import frame_of, polygon_in
from guidance_app.documents import Direction
from guidance_app.guidance.ground import ground_of
from guidance_app.guidance.planning import PlanRequest, plan_operation
from guidance_app.guidance.ring import Ring
from guidance_app.guidance.room import Room
from guidance_app.guidance.turns import Turner
from guidance_app.guidance.ways import Ways
from guidance_app.store import field_from_file

MILLIMETRE = 0.001
YARD = shapely.box(0.0, 0.0, 80.0, 60.0)
BLIND = YARD.union(shapely.box(80.0, 25.0, 110.0, 35.0))
"""A yard with a blind alley to the east, wider than the machine and too narrow for a turn."""


def ways_of(request: PlanRequest) -> Ways:
    ground = ground_of(BLIND, request)
    lap = shapely.get_coordinates(YARD.buffer(-12.0).buffer(8.0).exterior)[:-1]
    return Ways(Turner(Room(ground, request.body), request), [Ring(lap)], ())


@pytest.mark.parametrize("inward", [True, False])
def test_a_blind_alley_is_left_and_entered_backward(inward: bool) -> None:
    request = PlanRequest(width=6.0, radius=5.0)
    in_the_alley = np.array([104.0, 30.0, 0.0 if inward else np.pi])
    in_the_yard = np.array([30.0, 20.0, np.pi])
    turn = (
        ways_of(request).way(in_the_alley, in_the_yard) if inward else ways_of(request).way(in_the_yard, in_the_alley)
    )
    assert turn.fits
    assert any(leg.reverse for leg in turn.legs)
    for before, after in zip(turn.legs, turn.legs[1:], strict=False):
        assert np.hypot(*(after.points[0] - before.points[-1])) < MILLIMETRE
    first, last = (in_the_alley, in_the_yard) if inward else (in_the_yard, in_the_alley)
    assert np.hypot(*(turn.legs[0].points[0] - first[:2])) < MILLIMETRE
    assert np.hypot(*(turn.legs[-1].points[-1] - last[:2])) < MILLIMETRE
    assert turn.length == pytest.approx(sum(leg.length for leg in turn.legs))


def test_nobody_backs_out_who_may_not() -> None:
    ways = ways_of(PlanRequest(width=6.0, radius=5.0, reverse_allowed=False))
    turn = ways.way(np.array([104.0, 30.0, 0.0]), np.array([30.0, 20.0, np.pi]))
    assert not turn.fits
    assert not any(leg.reverse for leg in turn.legs)


@pytest.mark.parametrize(("name", "width"), [("dk_061", 6.0), ("bg_086", 6.0), ("cz_061", 12.0)])
def test_real_fields_have_no_turn_that_does_not_fit(real_data: Path, name: str, width: float) -> None:
    boundary = field_from_file(real_data / "fields" / f"{name}.geojson").boundary
    request = PlanRequest(width=width, radius=5.0 if width < 12.0 else 6.0, direction=Direction.BEST)
    plan = plan_operation(polygon_in(frame_of(boundary), boundary), request)
    assert all(each.fits for each in plan.segments)
    for before, after in zip(plan.segments, plan.segments[1:], strict=False):
        end = before.points[0] if before.closed else before.points[-1]
        assert np.hypot(*(after.points[0] - end)) < MILLIMETRE
