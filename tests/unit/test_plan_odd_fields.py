"""Whatever field and machine are given, there is a plan inside the field or one sentence, never a crash."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from support.star_fields import stars

from guidance_app.bench.plan_searches import ODD_FIELDS
from guidance_app.documents import Direction, Method
from guidance_app.guidance.planning import PlanError, PlanRequest, plan_operation
from guidance_app.guidance.room import Room
from guidance_app.guidance.turns import Turner
from guidance_app.guidance.ways import Ways
from guidance_app.model import Plan, SegmentKind

CENTIMETRE = 0.01


def outcome(polygon: shapely.Polygon, request: PlanRequest) -> tuple[Plan | None, str]:
    try:
        return plan_operation(polygon, request), ""
    except PlanError as error:
        return None, str(error)


def planned(polygon: shapely.Polygon, request: PlanRequest) -> Plan | None:
    """The plan, checked; None where a sentence says why there is none."""
    plan, sentence = outcome(polygon, request)
    if plan is None:
        assert len(sentence) > 10
        assert "\n" not in sentence
        return None
    room = shapely.make_valid(polygon).buffer(CENTIMETRE)
    for each in plan.segments:
        assert np.isfinite(each.points).all()
        assert len(each.points) >= 2
        assert not each.fits or shapely.contains_xy(room, *each.points.T).all()
        assert each.fits is (each.missing == 0)
    numbers = [each.number for each in plan.segments if each.implement_down]
    assert len(numbers) == len(set(numbers))
    return plan


@pytest.mark.parametrize("name", ODD_FIELDS)
def test_an_odd_field_gets_a_plan_or_a_sentence(name: str) -> None:
    planned(*ODD_FIELDS[name])


def test_a_turning_space_that_leaves_nothing_gives_laps_and_says_so() -> None:
    plan = planned(shapely.box(0, 0, 90, 70), PlanRequest(width=6.0, turning_space=60.0))
    assert plan is not None
    assert "laps" in plan.warnings[0]
    assert sum(each.length for each in plan.segments if each.kind is SegmentKind.LAP) > 0.8 * plan.costs.work_m


def test_a_start_outside_is_said_and_planned() -> None:
    plan = planned(shapely.box(0, 0, 90, 70), PlanRequest(width=6.0, start=(-80.0, 30.0)))
    assert plan is not None
    assert any("outside" in warning for warning in plan.warnings)


@pytest.mark.parametrize(
    ("polygon", "words"),
    [
        (shapely.Polygon(), "no boundary"),
        (shapely.Polygon([(0, 0), (1e9, 0), (1e9, 1e9)]), "not a place"),
        (shapely.box(0, 0, 2, 2), "too small"),
        (shapely.Polygon([(0, 0), (100, 100), (100, 0), (0, 100)]), "parts"),
    ],
)
def test_what_is_no_field_is_refused_in_a_sentence(polygon: shapely.Polygon, words: str) -> None:
    with pytest.raises(PlanError, match=words):
        plan_operation(polygon, PlanRequest(width=6.0))


@settings(max_examples=12, deadline=None)
@given(
    stars(),
    st.sampled_from([3.0, 6.0, 12.0, 30.0]),
    st.sampled_from([2.0, 5.0, 9.0]),
    st.sampled_from([method for method in Method if method is not Method.LINE]),
    st.sampled_from([Direction.BEST, Direction.LONGEST_EDGE]),
    st.booleans(),
)
def test_any_field_and_any_machine(
    polygon: shapely.Polygon, width: float, radius: float, method: Method, direction: Direction, reverse: bool
) -> None:
    request = PlanRequest(
        width=width, radius=radius, method=method, direction=direction, reverse_allowed=reverse, offset_right=0.4
    )
    planned(polygon, request)


def test_a_way_that_turns_back_on_the_spot_is_flagged() -> None:
    yard, request = shapely.box(0, 0, 8, 8), PlanRequest(width=3.0, reverse_allowed=False)
    turner = Turner(Room(yard, request.body), request)
    way = Ways(turner, [], [yard]).way(np.array([4.0, 4.0, 0.0]), np.array([4.0, 4.0, np.pi]))
    assert not way.fits
    assert way.length == 0.0
