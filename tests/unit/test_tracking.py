"""A plan and free lines are followed as a driver expects it; each case is one drive."""

import math

import numpy as np
import pytest
import shapely
from support.passes import (
    INTERVAL,
    a_plan,
    a_pose,
    a_segment,
    drive,
    drive_plan,
    half_circle,
    poses_along,
    round_trip,
    rounded_ring,
)

from guidance_app.guidance.family import Circles, OffsetCurves, ParallelLines
from guidance_app.guidance.patterns.last_pass import following_last
from guidance_app.guidance.tracking import Tracker
from guidance_app.model import Guidance, OffsetKind, Plan, Pose, Segment, SegmentKind

SPACING = 4.0
CENTIMETRE = 0.01
NORTH, SOUTH = 0.0, math.pi


def ab_tracker(field: shapely.Polygon | None = None) -> Tracker:
    return Tracker(ParallelLines((0.0, 0.0), (0.0, 100.0), SPACING), SPACING, field=field)


def numbers(answers: list[Guidance]) -> list[int]:
    """The targets in the order in which they came, each once in a row."""
    found = [answer.target.number for answer in answers]
    return [number for i, number in enumerate(found) if i == 0 or number != found[i - 1]]


# --- along a plan -----------------------------------------------------------------------------------------------------


def test_a_plan_is_followed_in_its_order_and_every_pass_gets_done() -> None:
    plan = round_trip(5)
    driven = drive_plan(Tracker(plan, SPACING), plan)
    assert numbers([one for _, one in driven]) == [1, 2, 3, 4, 5]
    on_passes = [(segment, one) for segment, one in driven if segment.kind is SegmentKind.PASS]
    assert all(one.target.number == segment.number and not one.against for segment, one in on_passes)
    assert max(abs(one.cross_track) for _, one in on_passes) < CENTIMETRE
    assert driven[-1][1].done == {1, 2, 3, 4, 5}
    assert {one.count for _, one in driven} == {5}


def test_along_track_grows_and_remaining_shrinks_on_a_pass() -> None:
    plan = round_trip(3)
    for number in (1, 2, 3):
        on_it = [
            one
            for segment, one in drive_plan(Tracker(plan, SPACING), plan)
            if segment.kind is SegmentKind.PASS and segment.number == number
        ]
        assert np.diff([one.along_track for one in on_it]) == pytest.approx(2.0 * INTERVAL, abs=CENTIMETRE)
        assert {round(one.along_track + (one.remaining or 0.0), 6) for one in on_it} == {60.0}


def test_the_turn_is_told_before_and_drawn_while_it_is_driven() -> None:
    plan = round_trip(3)
    driven = drive_plan(Tracker(plan, SPACING), plan)
    for segment, one in driven:
        assert one.turn is None or one.turn.fits
        if segment.kind is SegmentKind.PASS and segment.number < 3:
            assert one.turn is not None
            assert one.turn.distance == one.remaining
            assert one.turn.seconds == pytest.approx(one.turn.distance / 2.0)
            assert one.turn.points[0] == pytest.approx(segment.points[-1])
        elif segment.kind is SegmentKind.TURN and one.target.number == segment.number:
            assert one.turn is not None
            assert one.turn.points == pytest.approx(segment.points)
            assert one.turn.distance == 0.0
        elif segment.number == 3:
            assert one.turn is None
    assert any(segment.kind is SegmentKind.TURN and one.target.number == segment.number for segment, one in driven)


def test_next_pass_is_the_next_of_the_order_that_is_not_done() -> None:
    tracker = Tracker(round_trip(4), SPACING, done=frozenset({1, 3}))
    answer = drive(tracker, [a_pose(0.0, SPACING, 70.0, SOUTH)], working=False)[0]
    assert answer.target.number == 2
    assert answer.next_number == 4


def test_work_may_start_anywhere_and_goes_on_from_there() -> None:
    plan = round_trip(5)
    tracker = Tracker(plan, SPACING)
    onto_third = list(poses_along(np.array([[2 * SPACING, -20.0], [2 * SPACING, 60.0]])))
    before = drive(tracker, onto_third[:125], working=False)
    assert before[0].target.number == 1
    assert before[-1].target.number == 3
    after = drive(tracker, onto_third[125:], working=True)
    assert {one.target.number for one in after} == {3}
    away = half_circle((2 * SPACING, 60.0), (3 * SPACING, 60.0), clockwise=True)
    turned = drive(tracker, list(poses_along(away, start=60.0)), working=False)
    assert turned[-1].target.number == 4
    assert turned[-1].next_number == 5


def test_the_last_pass_left_out_is_offered_again() -> None:
    plan = round_trip(3)
    tracker = Tracker(plan, SPACING)
    drive(tracker, [a_pose(0.0, 0.0, 0.0)], working=False)
    assert tracker.skip()
    for number, east in ((2, SPACING), (3, 2 * SPACING)):
        line = np.array([[east, 0.0], [east, 60.0]])
        answers = drive(tracker, list(poses_along(line, start=100.0 * number)), working=True)
        assert {one.target.number for one in answers} == {number}
        off = np.array([[east, 60.0], [east + 4.0, 66.0], [east + 9.0, 66.0]])
        answers = drive(tracker, list(poses_along(off, start=100.0 * number + 50)), working=False)
    assert answers[-1].target.number == 1
    assert answers[-1].done == {2, 3}
    assert answers[-1].next_number is None


def test_a_pass_cut_by_an_obstacle_is_done_when_all_its_pieces_are() -> None:
    low, high = np.array([[0.0, 0.0], [0.0, 40.0]]), np.array([[0.0, 60.0], [0.0, 100.0]])
    plan = a_plan([a_segment(SegmentKind.PASS, 1, low), a_segment(SegmentKind.PASS, 1, high)], SPACING)
    tracker = Tracker(plan, SPACING)
    first = drive(tracker, list(poses_along(low)), working=True)
    assert first[-1].done == frozenset()
    between = np.array([[0.0, 40.0], [3.0, 50.0], [0.0, 60.0]])
    drive(tracker, list(poses_along(between, start=50.0)), working=False)
    assert drive(tracker, list(poses_along(high, start=80.0)), working=True)[-1].done == {1}


def test_the_implement_behind_is_on_the_pass_until_it_has_come_to_the_end() -> None:
    tracker = Tracker(round_trip(1), SPACING, behind=3.0)
    answers = drive(tracker, list(poses_along(np.array([[0.0, -10.0], [0.0, 75.0]]))), working=False)
    on_it = [one.along_track for one in answers if one.on_pass]
    assert on_it[0] == pytest.approx(3.0, abs=2.0 * INTERVAL)
    assert on_it[-1] == pytest.approx(63.0, abs=2.0 * INTERVAL)


def test_on_the_planned_way_back_along_the_target_the_target_is_not_worked() -> None:
    first, second = np.array([[0.0, 0.0], [0.0, 60.0]]), np.array([[SPACING, 0.0], [SPACING, 60.0]])
    way = np.array([[0.0, 60.0], [2.0, 64.0], [SPACING, 60.0], [SPACING, 0.0], [3.0, -3.0], [SPACING, 0.0]])
    segments = [
        a_segment(SegmentKind.PASS, 1, first),
        a_segment(SegmentKind.TURN, 2, way),
        a_segment(SegmentKind.PASS, 2, second),
    ]
    tracker = Tracker(a_plan(segments, SPACING), SPACING)
    drive(tracker, list(poses_along(first)), working=True)
    coming = drive(tracker, list(poses_along(way, start=50.0)), working=False)
    assert coming[-1].target.number == 2
    assert not any(one.on_pass for one in coming)
    assert any(one.on_pass for one in drive(tracker, list(poses_along(second, start=150.0)), working=False))


# --- laps -------------------------------------------------------------------------------------------------------------


def two_laps() -> Plan:
    outer, inner = rounded_ring(80.0, 8.0), rounded_ring(80.0 - 2 * SPACING, 8.0)
    return a_plan(
        [
            a_segment(SegmentKind.LAP, 1, outer, closed=True),
            a_segment(SegmentKind.TRANSFER, 2, np.vstack([outer[0], inner[0]])),
            a_segment(SegmentKind.LAP, 2, inner, closed=True),
        ],
        SPACING,
    )


def test_a_lap_is_finished_once_around_with_the_implement_down_and_the_next_begins() -> None:
    plan = two_laps()
    outer = np.vstack([plan.segments[0].points, plan.segments[0].points[:3]])
    tracker = Tracker(plan, SPACING)
    answers = drive(tracker, list(poses_along(outer)), working=True)
    assert numbers(answers) == [1, 2]
    changed = next(i for i, one in enumerate(answers) if one.target.number == 2)
    assert changed * 2.0 * INTERVAL > plan.segments[0].length - 3.0
    assert answers[-1].done == {1}
    on_lap = answers[:changed]
    assert max(abs(one.cross_track) for one in on_lap) < CENTIMETRE
    assert max(abs(one.heading_error) for one in on_lap) < math.radians(3)


def test_a_lap_begun_before_its_first_point_is_not_at_its_end() -> None:
    plan = two_laps()
    ring = plan.segments[0].points
    tracker = Tracker(plan, SPACING)
    around = np.vstack([ring[-3:], ring[:40]])
    answers = drive(tracker, list(poses_along(around)), working=True)
    assert answers[0].remaining is not None
    assert answers[0].remaining > plan.segments[0].length
    assert np.diff([one.remaining for one in answers[:-1]]) == pytest.approx(-2.0 * INTERVAL, abs=0.02)


def test_a_lap_may_be_driven_the_other_way_round() -> None:
    plan = two_laps()
    ring = plan.segments[0].points[::-1]
    answers = drive(Tracker(plan, SPACING), list(poses_along(ring[5:60])), working=True)
    assert all(one.against for one in answers)
    assert max(abs(one.heading_error) for one in answers) < math.radians(3)
    assert np.all(np.diff([one.along_track for one in answers]) > 0)


# --- without a plan ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("field", [None, shapely.box(-60.0, 0.0, 60.0, 100.0)], ids=["endless", "in a field"])
def test_turning_to_one_side_leads_to_the_neighbour_there(side: int, field: shapely.Polygon | None) -> None:
    tracker = ab_tracker(field)
    up = list(poses_along(np.array([[0.0, 0.0], [0.0, 100.0]])))
    assert {one.target.number for one in drive(tracker, up, working=True)} == {0}
    round_end = half_circle((0.0, 100.0), (side * SPACING, 100.0), clockwise=side > 0)
    turned = drive(tracker, list(poses_along(round_end, start=60.0)), working=False)
    assert turned[-1].target.number == side
    assert turned[-1].done == {0}
    down = drive(
        tracker,
        list(poses_along(np.array([[side * SPACING, 100.0], [side * SPACING, 40.0]]), start=70.0)),
        working=True,
    )
    assert {one.target.number for one in down} == {side}
    assert all(one.against for one in down)
    assert {one.next_number for one in down} == {2 * side}


def test_lowered_on_another_pass_that_pass_is_meant() -> None:
    tracker = ab_tracker()
    drive(tracker, [a_pose(0.0, 0.0, 0.0)], working=False)
    tracker.take(0)
    answer = drive(tracker, [a_pose(1.0, 3 * SPACING + 0.3, 5.0)], working=True)[0]
    assert answer.target.number == 3
    assert answer.cross_track == pytest.approx(0.3)


def test_turning_with_the_implement_down_leads_to_the_next_pass() -> None:
    tracker = ab_tracker()
    path = np.vstack(
        [
            [[0.0, 0.0]],
            half_circle((0.0, 60.0), (SPACING, 60.0), clockwise=True),
            [[SPACING, 0.0]],
        ]
    )
    assert numbers(drive(tracker, list(poses_along(path)), working=True)) == [0, 1]


def test_driving_over_the_lines_with_the_implement_down_changes_nothing() -> None:
    tracker = ab_tracker()
    drive(tracker, list(poses_along(np.array([[0.0, 0.0], [0.0, 10.0]]))), working=True)
    over = drive(tracker, list(poses_along(np.array([[0.0, 10.0], [40.0, 10.0]]), start=20.0)), working=True)
    assert {one.target.number for one in over} == {0}


def test_backing_up_keeps_sides_and_direction() -> None:
    tracker = ab_tracker()
    forward = drive(tracker, [a_pose(0.1 * i, 0.5, 0.2 * i) for i in range(50)], working=True)
    back = drive(tracker, [a_pose(5.0 + 0.1 * i, 0.5, 9.8 - 0.2 * i, speed=-2.0) for i in range(40)], working=False)
    assert {round(one.cross_track, 9) for one in forward + back} == {0.5}
    assert {one.heading_error for one in back} == {0.0}
    assert np.all(np.diff([one.along_track for one in back]) < 0)


def test_direction_of_travel_has_hysteresis() -> None:
    tracker = ab_tracker()
    swing = [a_pose(0.1 * i, 0.5, 1.0, math.radians(90 + 15 * math.sin(i))) for i in range(60)]
    first = drive(tracker, [a_pose(-1.0, 0.5, 1.0, 0.0)], working=False)[0]
    assert not first.against
    assert not any(one.against for one in drive(tracker, swing, working=False))
    assert drive(tracker, [a_pose(9.0, 0.5, 1.0, math.radians(115))], working=False)[0].against
    assert all(one.against for one in drive(tracker, swing, working=False))


def test_offset_curves_are_tracked_to_the_centimetre_at_10_000_points() -> None:
    north = np.arange(0.0, 5000.0, 0.5)
    curve = np.column_stack([40.0 * np.sin(north / 90.0), north])
    family = OffsetCurves(curve, SPACING)
    tracker = Tracker(family, SPACING)
    line = family.pass_numbered(5)
    assert line is not None
    first = int(np.argmin(np.abs(line.points[:, 1] - 2000.0)))
    answers = drive(tracker, list(poses_along(line.points[first : first + 200])), working=False)
    assert {one.target.number for one in answers} == {5}
    assert max(abs(one.cross_track) for one in answers) < CENTIMETRE
    assert max(abs(one.heading_error) for one in answers) < math.radians(1)


# --- the driver's wishes ----------------------------------------------------------------------------------------------


def test_a_taken_pass_stays_until_the_tractor_has_been_there() -> None:
    tracker = ab_tracker()
    drive(tracker, [a_pose(0.0, 0.0, 0.0)], working=False)
    assert tracker.take(3)
    beside = drive(tracker, list(poses_along(np.array([[0.0, 0.0], [0.0, 40.0]]))), working=False)
    assert {one.target.number for one in beside} == {3}
    there = np.array([[3 * SPACING, 0.0], [3 * SPACING, 20.0]])
    drive(tracker, list(poses_along(there, start=50.0)), working=False)
    back = drive(tracker, list(poses_along(np.array([[SPACING, 0.0], [SPACING, 20.0]]), start=90.0)), working=False)
    assert back[-1].target.number == 1


def test_there_is_no_pass_of_an_unknown_number() -> None:
    assert not Tracker(round_trip(3), SPACING).take(4)
    assert not ab_tracker().take(10**9)


def test_nothing_can_be_asked_of_a_tracker_without_a_target() -> None:
    tracker = ab_tracker()
    assert not tracker.skip()
    assert not tracker.reverse()
    assert not tracker.line_here((0.0, 0.0))
    assert tracker.errors_at(0.0, 0.0, 0.0) is None


def test_reversed_the_pass_is_entered_at_its_other_end() -> None:
    tracker = Tracker(round_trip(3), SPACING)
    start = a_pose(0.0, 0.0, -10.0)
    before = drive(tracker, [start], working=False)[0]
    assert tracker.reverse()
    after = drive(tracker, [start], working=False)[0]
    assert (before.against, after.against) == (False, True)
    assert before.along_track == pytest.approx(-10.0)
    assert after.along_track == pytest.approx(70.0)
    assert abs(after.heading_error) == pytest.approx(math.pi)
    southward = drive(tracker, list(poses_along(np.array([[0.0, 70.0], [0.0, 30.0]]), start=90.0)), working=False)
    assert all(one.against for one in southward)
    assert abs(southward[-1].heading_error) < math.radians(1)
    assert southward[-1].turn is None


def test_offsets_add_up_by_kind_and_stay_on_their_side_of_the_ground() -> None:
    tracker = ab_tracker()
    drive(tracker, [a_pose(0.0, 0.0, 0.0)], working=False)
    assert tracker.shift(0.10, OffsetKind.NUDGE, arrival=1.0)
    assert tracker.shift(0.05, OffsetKind.NUDGE, arrival=2.0)
    assert tracker.shift(1.00, OffsetKind.SHIFT, arrival=3.0)
    assert [(one.kind, one.arrival, round(one.metres, 9)) for one in tracker.offsets] == [
        (OffsetKind.NUDGE, 2.0, 0.15),
        (OffsetKind.SHIFT, 3.0, 1.0),
    ]
    northward = drive(tracker, [a_pose(4.0, 0.0, 0.0)], working=False)[0]
    southward = drive(tracker, [a_pose(5.0, 0.0, 0.0, SOUTH)], working=False)[0]
    assert northward.cross_track == pytest.approx(-1.15)
    assert southward.cross_track == pytest.approx(1.15)
    assert tracker.shift(0.15, OffsetKind.NUDGE)
    assert tracker.offsets[0].metres == pytest.approx(0.0)


@pytest.mark.parametrize("metres", [math.nan, math.inf, 1001.0])
def test_lines_are_not_moved_out_of_bounds(metres: float) -> None:
    tracker = ab_tracker()
    assert not tracker.shift(metres)
    assert tracker.offsets == ()


def across(*, back: bool = False) -> list[Pose]:
    """Over thirty passes at a right angle, or back."""
    way = np.array([[0.0, 50.0], [30 * SPACING, 50.0]])
    return list(poses_along(way[::-1] if back else way, start=100.0 if back else 10.0))


def test_who_drives_across_the_passes_with_the_implement_up_is_shown_where_the_tractor_is() -> None:
    tracker = ab_tracker()
    answers = drive(tracker, across(), working=False)
    assert numbers(answers) == sorted(set(numbers(answers)))
    assert max(abs(one.cross_track) for one in answers) < 1.5 * SPACING
    assert answers[-1].target.number >= 28


def test_across_passes_that_are_done_nothing_flickers() -> None:
    tracker = ab_tracker()
    for number in (3, 5, 6):
        points = np.array([[number * SPACING, 0.0], [number * SPACING, 60.0]])
        drive(tracker, list(poses_along(points, start=100.0 * number)), working=True)
    answers = drive(tracker, across(back=True), working=False)[1:]
    assert numbers(answers) == sorted(set(numbers(answers)), reverse=True)


def test_across_the_passes_the_one_that_is_worked_or_taken_or_planned_stays() -> None:
    worked = ab_tracker()
    drive(worked, list(poses_along(np.array([[0.0, 0.0], [0.0, 50.0]]))), working=True)
    aslant = np.array([[0.0, 50.0], [20 * SPACING, 50.0 + 20 * SPACING]])
    assert numbers(drive(worked, list(poses_along(aslant, start=100.0)), working=True)) == [0]
    taken = ab_tracker()
    drive(taken, across()[:1], working=False)
    assert taken.take(7)
    assert numbers(drive(taken, across(), working=False)) == [7]
    plan = round_trip(12)
    planned = Tracker(plan, SPACING)
    assert numbers(drive(planned, across(), working=False)) == [1]


def test_a_nudge_moves_the_passes_of_a_plan_to_one_side_of_the_ground() -> None:
    plan = round_trip(3)
    tracker = Tracker(plan, SPACING)
    drive(tracker, [a_pose(0.0, 0.0, 5.0)], working=False)
    assert tracker.shift(0.3)
    driven = drive_plan(tracker, plan, start=10.0)
    errors = {segment.number: round(one.cross_track, 6) for segment, one in driven if segment.kind is SegmentKind.PASS}
    assert errors == {1: -0.3, 2: 0.3, 3: -0.3}
    sides = {segment.number: one.mirrored for segment, one in driven if segment.kind is SegmentKind.PASS}
    assert sides == {1: False, 2: True, 3: False}
    first = driven[0][1].target.points
    assert first[:, 0] == pytest.approx(0.3)


def test_a_target_is_not_moved_out_of_existence() -> None:
    tracker = Tracker(Circles((0.0, 0.0), 6.0, SPACING), SPACING)
    before = drive(tracker, [a_pose(0.0, 0.0, 6.2, math.pi / 2)], working=False)[0]
    assert not tracker.shift(10.0)
    assert tracker.offsets == ()
    assert drive(tracker, [a_pose(1.0, 0.0, 6.2, math.pi / 2)], working=False)[0].cross_track == before.cross_track


def test_a_lap_is_nudged_to_its_own_right() -> None:
    plan = two_laps()
    tracker = Tracker(plan, SPACING)
    poses = list(poses_along(plan.segments[0].points[:60]))
    drive(tracker, poses[:1], working=False)
    assert tracker.shift(0.2)
    answers = drive(tracker, poses, working=True)
    assert [one.cross_track for one in answers] == pytest.approx([-0.2] * len(answers), abs=CENTIMETRE)
    assert shapely.LinearRing(answers[0].target.points).length < shapely.LinearRing(plan.segments[0].points).length


@pytest.mark.parametrize(
    "segments",
    [
        [],
        [a_segment(SegmentKind.TURN, 1, np.array([[0.0, 0.0], [1.0, 0.0]]))],
        [a_segment(SegmentKind.PASS, 1, np.array([[1.0, 2.0], [1.0, 2.0]]))],
    ],
    ids=["nothing", "only a turn", "a pass without length"],
)
def test_a_plan_that_cannot_be_driven_is_refused_at_once(segments: list[Segment]) -> None:
    with pytest.raises(ValueError, match=r"plan|line"):
        Tracker(a_plan(segments, SPACING), SPACING)


def test_errors_at_a_predicted_pose_are_those_of_the_present_target() -> None:
    tracker = Tracker(round_trip(3), SPACING)
    drive(tracker, [a_pose(0.0, 0.2, 5.0)], working=True)
    assert tracker.errors_at(0.5, 8.0, 0.1) == pytest.approx((0.5, 0.1))


# --- along the last pass ----------------------------------------------------------------------------------------------


def test_each_pass_follows_the_one_driven_before() -> None:
    tracker = Tracker(following_last(np.empty((0, 2)), SPACING), SPACING)
    north = np.arange(0.0, 100.0, 1.0)
    first = np.column_stack([3.0 * np.sin(north / 30.0), north])
    poses = list(poses_along(first))
    assert all(tracker.step(pose, (pose.east, pose.north), working=True) is None for pose in poses)
    end = (float(first[-1, 0]), 99.0)
    round_end = half_circle(end, (end[0] + SPACING, end[1]), clockwise=True)
    turned = [tracker.step(pose, (pose.east, pose.north), working=False) for pose in poses_along(round_end, start=90.0)]
    assert turned[-1] is not None
    assert turned[-1].target.number == 1
    assert turned[-1].done == {0}
    line = shapely.LineString(first)
    inner = [point for point in turned[-1].target.points if 10.0 < point[1] < 90.0]
    assert inner
    assert [line.distance(shapely.Point(point)) for point in inner] == pytest.approx([SPACING] * len(inner), abs=0.1)
    wider = np.column_stack([first[::-1, 0] + SPACING + 0.5, north[::-1]])
    answers = drive(tracker, list(poses_along(wider, start=100.0)), working=True)
    assert {one.target.number for one in answers} == {1}
    assert all(one.against for one in answers)
    away = half_circle((float(wider[-1, 0]), 0.0), (float(wider[-1, 0]) + SPACING, 0.0), clockwise=False)
    third = drive(tracker, list(poses_along(away, start=200.0)), working=False)[-1]
    assert third.target.number == 2
    second_driven = shapely.LineString(wider)
    inner = [point for point in third.target.points if 10.0 < point[1] < 90.0]
    distances = [second_driven.distance(shapely.Point(point)) for point in inner]
    assert distances == pytest.approx([SPACING] * len(inner), abs=0.1)
