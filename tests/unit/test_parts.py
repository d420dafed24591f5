"""The parts of a field: each is worked to its end before the next one is begun, and planned again in that order."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
import shapely

from guidance_app.documents import Direction, Method
from guidance_app.guidance.planning import PlanRequest, plan_operation
from guidance_app.guidance.replanning import Standing, replan
from guidance_app.model import Plan, SegmentKind

GAP = 10.0
"""Metres; a machine of 6 m passes through it, a lap does not run through it and back."""

WEST, EAST = 138.0, 162.0
"""Where the parts end; a pass between them works the gap."""


def hourglass() -> shapely.Polygon:
    """Two squares joined by a short gap."""
    west, east = shapely.box(0, 0, 140, 100), shapely.box(160, 0, 300, 100)
    return shapely.Polygon(shapely.union_all([west, east, shapely.box(139, 45, 161, 45 + GAP)]).exterior)


def works(plan: Plan) -> list[tuple[bool, SegmentKind]]:
    """Whether each pass or lap lies in the eastern part, and its kind, in driving order; not those in the gap."""
    down = [each for each in plan.segments if each.implement_down]
    middles = [float(np.ptp(each.points, axis=0)[0] / 2 + each.points[:, 0].min()) for each in down]
    return [(east > EAST, each.kind) for east, each in zip(middles, down, strict=True) if not WEST < east < EAST]


def sides(plan: Plan) -> list[tuple[bool, SegmentKind]]:
    """The same without repetitions."""
    return [side for side, _ in itertools.groupby(works(plan))]


def crossings(plan: Plan) -> int:
    """How often the plan goes from one part to the other."""
    return sum(one[0] != other[0] for one, other in itertools.pairwise(works(plan)))


@pytest.mark.parametrize("laps_first", [False, True])
def test_a_part_is_finished_before_the_next_is_begun(laps_first: bool) -> None:
    request = PlanRequest(width=6.0, start=(0.0, 0.0), laps_first=laps_first)
    kinds = [SegmentKind.LAP, SegmentKind.PASS] if laps_first else [SegmentKind.PASS, SegmentKind.LAP]
    assert sides(plan_operation(hourglass(), request)) == [(east, kind) for east in (False, True) for kind in kinds]


@pytest.mark.parametrize("method", [method for method in Method if method is not Method.LINE])
def test_the_gap_is_passed_once_and_numbers_are_those_of_the_whole_field(method: Method) -> None:
    plan = plan_operation(hourglass(), PlanRequest(width=6.0, method=method))
    numbers = sorted(each.number for each in plan.segments if each.implement_down)
    assert crossings(plan) == 1
    assert numbers == list(range(1, len(numbers) + 1))
    passes = [each.number for each in plan.segments if each.kind is SegmentKind.PASS]
    assert sorted(passes) == list(range(1, len(passes) + 1))


def test_the_work_begins_in_the_part_of_the_wished_start_or_corner() -> None:
    upright = shapely.affinity.rotate(hourglass(), 90, origin=(150, 50))
    southern, northern = (
        plan_operation(upright, PlanRequest(width=6.0, heading=0.0, direction=Direction.TYPED, start=(150.0, north)))
        for north in (-100.0, 200.0)
    )
    assert southern.segments[0].points[0, 1] < 50 < northern.segments[0].points[0, 1]
    across = PlanRequest(width=6.0, heading=np.pi / 2, direction=Direction.TYPED)
    corners = [plan_operation(upright, replace(across, start_corner=one)) for one in ("first-left", "last-left")]
    assert {bool(plan.segments[0].points[0, 1] > 50) for plan in corners} == {True, False}


def test_the_rest_is_planned_part_by_part() -> None:
    request = PlanRequest(width=6.0, start=(0.0, 0.0))
    plan = plan_operation(hourglass(), request)
    driven = [each for each in plan.segments if each.implement_down]
    done = {each.number for each in driven[:3]}
    east, north = np.asarray(driven[2].points[-1]).tolist()
    rest = replan(plan, done, Standing(east, north), hourglass(), request)
    assert crossings(rest) == 1
    assert {each.number for each in rest.segments if each.implement_down} == {each.number for each in driven[3:]}
