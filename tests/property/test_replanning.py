"""The rest planned again: nothing done comes again, nothing left is lost, all of it inside and joined."""

import itertools
import math
import time

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from guidance_app.documents import Direction, Method
from guidance_app.guidance.planning import PlanError, PlanRequest, plan_operation
from guidance_app.guidance.replanning import First, Standing, replan
from guidance_app.model import Plan, Segment, SegmentKind

CENTIMETRE = 0.01
MOST_S = 0.1
"""Twice what the bench asks for: tests share their machine with others."""
FIELD = shapely.Polygon([(0, 0), (200, 0), (230, 90), (120, 150), (0, 130)]).difference(
    shapely.Point(70, 60).buffer(11, quad_segs=4)
)
REQUESTS = {
    "round trip": PlanRequest(width=9.0),
    "skip one, laps first": PlanRequest(width=9.0, method=Method.TRANSFER, laps_first=True),
    "lands": PlanRequest(width=9.0, method=Method.INTERMEDIATE_DIVISION),
    "laps": PlanRequest(width=9.0, method=Method.SURROUNDING),
    "without backing": PlanRequest(width=9.0, reverse_allowed=False),
}
PLANS = {name: plan_operation(FIELD, request) for name, request in REQUESTS.items()}


def works(segments: tuple[Segment, ...]) -> list[Segment]:
    return [each for each in segments if each.implement_down]


def numbers(segments: tuple[Segment, ...]) -> list[int]:
    return [each.number for each in works(segments)]


def ends_of(segment: Segment) -> tuple[tuple[float, float], ...]:
    return tuple(sorted((round(float(east), 6), round(float(north), 6)) for east, north in segment.points[[0, -1]]))


def check_joined_and_inside(plan: Plan) -> None:
    room = FIELD.buffer(CENTIMETRE)
    for each in plan.segments:
        assert not each.fits or shapely.contains_xy(room, *each.points.T).all()
    for before, after in itertools.pairwise(plan.segments):
        end = before.points[0] if before.closed else before.points[-1]
        assert not (before.fits and after.fits) or math.dist(end, after.points[0]) < CENTIMETRE


@st.composite
def situations(draw: st.DrawFn) -> tuple[str, set[int], Standing]:
    name = draw(st.sampled_from(sorted(PLANS)))
    everything = numbers(PLANS[name].segments)
    count = draw(st.integers(0, len(everything) - 1))
    done = set(everything[:count]) | draw(st.sets(st.sampled_from(everything), max_size=4))
    left = [number for number in everything if number not in done]
    first = draw(st.none() | st.builds(First, st.sampled_from(left), st.none() | st.booleans())) if left else None
    later = draw(st.frozensets(st.sampled_from(left), max_size=3)) if left else frozenset()
    place = st.floats(15, 100)
    heading = draw(st.none() | st.floats(0, 6.28))
    return name, done, Standing(draw(place), draw(place), heading, first, later)


@settings(max_examples=60, deadline=None)
@given(situations())
def test_what_is_left_is_planned_once_and_what_is_done_never(situation: tuple[str, set[int], Standing]) -> None:
    name, done, standing = situation
    plan, request = PLANS[name], REQUESTS[name]
    everything = numbers(plan.segments)
    if done >= set(everything):
        with pytest.raises(PlanError, match="every pass"):
            replan(plan, done, standing, FIELD, request)
        return
    rest = replan(plan, done, standing, FIELD, request)
    assert sorted(numbers(rest.segments)) == sorted(set(everything) - done)
    assert sorted(numbers(rest.finished)) == sorted(done)
    before = {each.number: ends_of(each) for each in works(plan.segments)}
    assert all(ends_of(each) == before[each.number] for each in works(rest.segments) if not each.closed)
    check_joined_and_inside(rest)


@settings(max_examples=30, deadline=None)
@given(situations())
def test_the_drivers_choice_comes_first_and_what_he_leaves_comes_last(
    situation: tuple[str, set[int], Standing],
) -> None:
    name, done, standing = situation
    if done >= set(numbers(PLANS[name].segments)):
        return
    order = numbers(replan(PLANS[name], done, standing, FIELD, REQUESTS[name]).segments)
    if standing.first is not None:
        assert order[0] == standing.first.number
        order = order[1:]
    later = [number in standing.later for number in order]
    assert later == sorted(later)


@settings(max_examples=20, deadline=None)
@given(situations(), st.integers(1, 5))
def test_planned_again_and_again_it_ends(situation: tuple[str, set[int], Standing], step: int) -> None:
    name, done, standing = situation
    plan = PLANS[name]
    everything = set(numbers(plan.segments))
    while done < everything:
        plan = replan(plan, done, Standing(standing.east, standing.north), FIELD, REQUESTS[name])
        assert set(numbers(plan.segments)) == everything - done
        done = done | set(numbers(plan.segments)[:step])


@pytest.mark.parametrize("backward", [False, True])
def test_a_pass_left_in_its_middle_is_finished_from_there(backward: bool) -> None:
    plan = PLANS["round trip"]
    begun = works(plan.segments)[3]
    place = begun.points.mean(axis=0)
    standing = Standing(50.0, 40.0, 1.0, First(begun.number, backward, (float(place[0]), float(place[1]))))
    rest = works(replan(plan, numbers(plan.segments)[:3], standing, FIELD, REQUESTS["round trip"]).segments)[0]
    assert rest.number == begun.number
    assert math.dist(rest.points[0], place) < CENTIMETRE
    assert math.dist(rest.points[-1], begun.points[0 if backward else -1]) < CENTIMETRE


def test_in_work_there_is_no_way_to_where_the_tractor_is() -> None:
    plan = PLANS["round trip"]
    begun = works(plan.segments)[0]
    east, north = begun.points[-1] - begun.points[0]
    place = (float(begun.points.mean(axis=0)[0]), float(begun.points.mean(axis=0)[1]))
    standing = Standing(*place, math.atan2(east, north), First(begun.number, backward=False, worked_to=place))
    rest = replan(plan, (), standing, FIELD, REQUESTS["round trip"])
    assert rest.segments[0].kind is SegmentKind.PASS


def test_three_hundred_passes_are_planned_again_at_once() -> None:
    field = shapely.box(0, 0, 300, 306 * 3.0)
    request = PlanRequest(width=3.0, direction=Direction.TYPED, heading=math.pi / 2)
    plan = plan_operation(field, request)
    passes = [each.number for each in plan.segments if each.kind is SegmentKind.PASS]
    assert len(passes) >= 298
    seconds = []
    for _ in range(9):
        begin = time.process_time()
        replan(plan, passes[:2], Standing(150.0, 450.0, 0.0, First(passes[140])), field, request)
        seconds.append(time.process_time() - begin)
    assert min(seconds) <= MOST_S


def test_after_a_pass_taken_elsewhere_the_rest_costs_little_more_than_planned() -> None:
    plan, request = PLANS["round trip"], REQUESTS["round trip"]
    order = numbers(plan.segments)
    rest = replan(plan, order[:2], Standing(20.0, 20.0, 0.0, First(order[7])), FIELD, request)
    assert rest.costs.idle_m < plan.costs.idle_m + 3 * np.hypot(230, 150)
    assert rest.costs.worked_fraction == plan.costs.worked_fraction
