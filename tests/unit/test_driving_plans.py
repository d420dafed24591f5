"""Whole plans driven along their own path, the implement switching by itself: the order holds and all gets done."""

import math
from itertools import groupby

import numpy as np
import pytest
import shapely
from support.passes import INTERVAL, a_pose, poses_along

from guidance_app.documents import Method
from guidance_app.guidance.coverage import Coverage
from guidance_app.guidance.planning import plan_operation
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.tracking import Tracker
from guidance_app.guidance.work import WorkSwitch
from guidance_app.model import Plan, Pose, SegmentKind

WIDTH = 9.0
SPEED = 4.0
BENT = shapely.Polygon([(0, 0), (180, 0), (180, 80), (90, 80), (90, 160), (0, 160)])
WITH_POND = shapely.box(0, 0, 160, 120).difference(shapely.Point(80, 55).buffer(10))


def poses_of(plan: Plan, noise: float, rng: np.random.Generator) -> list[Pose]:
    """As a receiver would see the drive: at 4 m/s, backwards where the plan backs up."""
    poses: list[Pose] = []
    for segment in plan.segments:
        points = np.vstack([segment.points, segment.points[:1]]) if segment.closed else segment.points
        for pose in poses_along(points, start=INTERVAL * len(poses), speed=SPEED):
            east, north = rng.normal((pose.east, pose.north), noise)
            heading = pose.heading + rng.normal(0, 0.1 * noise) + (math.pi if segment.reverse else 0.0)
            poses.append(a_pose(pose.t, float(east), float(north), heading, -SPEED if segment.reverse else SPEED))
    return poses


@pytest.mark.parametrize(
    ("method", "field", "noise"),
    [
        (Method.ROUND_TRIP, BENT, 0.1),
        (Method.TRANSFER, WITH_POND, 0.0),
        (Method.INTERMEDIATE_DIVISION, BENT, 0.0),
        (Method.SURROUNDING, WITH_POND, 0.1),
    ],
    ids=["round trip", "transfer", "intermediate division", "surrounding"],
)
def test_driven_as_planned_the_order_holds_and_every_pass_gets_done(
    method: Method, field: shapely.Polygon, noise: float
) -> None:
    plan = plan_operation(field, PlanRequest(width=WIDTH, method=method))
    works = [one.number for one in plan.segments if one.kind in (SegmentKind.PASS, SegmentKind.LAP)]
    tracker, switch, coverage = Tracker(plan, plan.spacing), WorkSwitch(WIDTH), Coverage(WIDTH, field)
    targets = []
    for pose in poses_of(plan, noise, np.random.default_rng(3)):
        guidance = tracker.step(pose, (pose.east, pose.north), switch.down)
        switch = switch.after(pose, guidance, None)
        assert guidance is not None
        targets.append(guidance.target.number)
        coverage.step((pose.east, pose.north, pose.heading), pose.t, switch.down, guidance.target.number)
    assert [number for number, _ in groupby(targets)] == works
    assert tracker.done == set(works)
    worked_in_field = field.area - (coverage.totals.left or 0.0)
    assert worked_in_field / field.area > plan.costs.worked_fraction - 0.01
