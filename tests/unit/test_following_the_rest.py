"""A tracker that goes on along a plan made again: no jump while working, nothing worked is forgotten."""

import math

import numpy as np
import pytest
import shapely
from support.passes import a_pose, poses_along

from guidance_app.guidance.planning import PlanRequest, plan_operation
from guidance_app.guidance.replanning import First, replan
from guidance_app.guidance.tracking import Tracker
from guidance_app.model import Guidance, OffsetKind, Plan, Pose, Segment, SegmentKind

MILLIMETRE = 1e-3
FIELD = shapely.box(0.0, 0.0, 150.0, 100.0)
REQUEST = PlanRequest(width=9.0)
PLAN = plan_operation(FIELD, REQUEST)
WORKS = [each for each in PLAN.segments if each.implement_down]


def driven(tracker: Tracker, works: list[Segment], part: float = 1.0) -> tuple[Pose, Guidance]:
    """Works these passes with the implement down on them, the last one only in part."""
    t, last = 0.0, None
    for place, segment in enumerate(works):
        points = np.vstack([segment.points, segment.points[:1]]) if segment.closed else segment.points
        poses = list(poses_along(points, start=t))
        for pose in poses[: round(part * len(poses))] if place == len(works) - 1 else poses:
            guidance = tracker.step(pose, (pose.east, pose.north), working=True)
            assert guidance is not None
            last, t = (pose, guidance), pose.t + 0.1
    assert last is not None
    return last


def rest_of(tracker: Tracker, pose: Pose, plan: Plan = PLAN) -> Plan:
    return replan(plan, tracker.done, tracker.standing(pose, (pose.east, pose.north)), FIELD, REQUEST)


def test_in_the_middle_of_a_pass_the_guidance_goes_on_without_a_jump() -> None:
    tracker = Tracker(PLAN, PLAN.spacing)
    pose, before = driven(tracker, WORKS[:3], 0.5)
    assert tracker.shift(0.4)
    before = tracker.step(pose, (pose.east, pose.north), working=True)
    assert before is not None
    rest = rest_of(tracker, pose)
    tracker.follow(rest)
    after = tracker.step(pose, (pose.east, pose.north), working=True)
    assert after is not None
    assert after.target.number == before.target.number == WORKS[2].number
    assert after.cross_track == pytest.approx(before.cross_track, abs=MILLIMETRE)
    assert after.heading_error == pytest.approx(before.heading_error, abs=MILLIMETRE)
    assert after.remaining == pytest.approx(before.remaining, abs=MILLIMETRE)
    assert after.on_pass
    assert after.done == before.done == {WORKS[0].number, WORKS[1].number}
    assert after.count == before.count
    assert [record.kind for record in tracker.offsets] == [OffsetKind.NUDGE]


def test_driven_against_its_plan_a_pass_is_finished_that_way() -> None:
    tracker = Tracker(PLAN, PLAN.spacing)
    back = [Segment(WORKS[0].kind, 1, WORKS[0].points[::-1], implement_down=True, length=WORKS[0].length)]
    pose, before = driven(tracker, back, 0.6)
    assert before.against
    tracker.follow(rest_of(tracker, pose))
    after = tracker.step(pose, (pose.east, pose.north), working=True)
    assert after is not None
    assert not after.against
    assert after.cross_track == pytest.approx(before.cross_track, abs=MILLIMETRE)
    assert after.remaining == pytest.approx(before.remaining, abs=MILLIMETRE)


def test_the_rest_of_the_rest_gets_done() -> None:
    tracker = Tracker(PLAN, PLAN.spacing)
    pose, _ = driven(tracker, WORKS[:2], 0.5)
    rest = rest_of(tracker, pose)
    tracker.follow(rest)
    _, guidance = driven(tracker, [each for each in rest.segments if each.kind is SegmentKind.PASS])
    assert guidance.done == {each.number for each in WORKS if each.kind is SegmentKind.PASS}


def test_a_pass_taken_is_the_target_and_the_plan_leads_there() -> None:
    tracker = Tracker(PLAN, PLAN.spacing)
    pose, _ = driven(tracker, WORKS[:2])
    assert tracker.take(WORKS[6].number)
    standing = tracker.standing(pose, (pose.east, pose.north))
    assert standing.first == First(WORKS[6].number)
    rest = replan(PLAN, tracker.done, standing, FIELD, REQUEST)
    tracker.follow(rest)
    after = tracker.step(pose, (pose.east, pose.north), working=False)
    assert after is not None
    assert after.target.number == WORKS[6].number
    assert rest.segments[0].number == WORKS[6].number
    assert not rest.segments[0].implement_down


def test_turned_round_by_the_driver_a_pass_is_planned_that_way() -> None:
    tracker = Tracker(PLAN, PLAN.spacing)
    first = WORKS[0].points
    pose = a_pose(0.0, float(first[-1, 0]), float(first[-1, 1]))
    tracker.step(pose, (pose.east, pose.north), working=False)
    assert tracker.reverse()
    rest = rest_of(tracker, pose)
    begun = next(each for each in rest.segments if each.implement_down)
    assert begun.number == WORKS[0].number
    assert math.dist(begun.points[0], first[-1]) < MILLIMETRE


@pytest.mark.parametrize("times", [1, 2])
def test_turned_round_on_a_half_worked_pass_its_rest_is_worked_from_the_other_end(times: int) -> None:
    tracker = Tracker(PLAN, PLAN.spacing)
    pose, before = driven(tracker, WORKS[:1], 0.4)
    assert before.remaining is not None
    rest = PLAN
    for _ in range(times):
        assert tracker.reverse()
        rest = rest_of(tracker, pose, rest)
        tracker.follow(rest)
    begun = next(each for each in rest.segments if each.implement_down)
    assert begun.number == WORKS[0].number
    assert begun.length == pytest.approx(before.remaining, abs=MILLIMETRE)
    end, here = WORKS[0].points[-1], (pose.east, pose.north)
    first, last = (begun.points[0], begun.points[-1])[:: 1 if times == 1 else -1]
    assert math.dist(first, end) < MILLIMETRE
    assert math.dist(last, here) < MILLIMETRE
    if times == 1:
        guidance = tracker.step(pose, (pose.east, pose.north), working=False)
        assert guidance is not None
        assert not guidance.on_pass
        assert guidance.turn is not None
        assert guidance.turn.driven


def test_after_a_crash_a_new_tracker_knows_what_is_done() -> None:
    tracker = Tracker(PLAN, PLAN.spacing)
    pose, guidance = driven(tracker, WORKS[:4])
    rest = rest_of(tracker, pose)
    again = Tracker(rest, rest.spacing)
    after = again.step(pose, (pose.east, pose.north), working=False)
    assert after is not None
    assert after.done == guidance.done
    assert after.target.number not in guidance.done
    assert after.count == guidance.count


def test_a_lap_half_worked_is_gone_on_with() -> None:
    plan = plan_operation(FIELD, PlanRequest(width=9.0, square_corners=False, laps_first=True))
    lap = next(each for each in plan.segments if each.closed)
    tracker = Tracker(plan, plan.spacing)
    pose, before = driven(tracker, [lap], 0.4)
    rest = replan(plan, (), tracker.standing(pose, (pose.east, pose.north)), FIELD, REQUEST)
    tracker.follow(rest)
    after = tracker.step(pose, (pose.east, pose.north), working=True)
    assert after is not None
    assert after.target.number == before.target.number
    assert not after.target.closed
    assert after.remaining == pytest.approx(before.remaining, abs=0.05)
