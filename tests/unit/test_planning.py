"""Plans: the methods' exact orders, every segment inside the field, and a sentence where there is no plan."""

import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from guidance_app.boundary import frame_of, polygon_in
from guidance_app.documents import Direction, Method
from guidance_app.guidance.ground import ground_of
from guidance_app.guidance.headland import headland_of
from guidance_app.guidance.orders import lands, neighbours, racetrack, skipping
from guidance_app.guidance.planning import PlanError, PlanRequest, plan_operation
from guidance_app.guidance.swaths import united
from guidance_app.model import Plan, SegmentKind
from guidance_app.store import field_from_file

CENTIMETRE = 0.01
RECTANGLE = shapely.box(0.0, 0.0, 200.0, 120.0)
METHODS = [method for method in Method if method is not Method.LINE]

ORDERS_OF_TWELVE = {
    "neighbouring": (neighbours(12), "1 2 3 4 5 6 7 8 9 10 11 12"),
    "skip 1": (skipping(12, 1), "1 3 5 7 9 11 12 10 8 6 4 2"),
    "skip 2": (skipping(12, 2), "1 4 7 10 11 8 5 2 3 6 9 12"),
    "lands of 6": (lands(12, 6), "3 4 2 5 1 6 9 10 8 11 7 12"),
    "racetrack of 2x4": (racetrack(12, 4), "5 1 6 2 7 3 8 4 9 11 10 12"),
}


@pytest.mark.parametrize("name", ORDERS_OF_TWELVE)
def test_twelve_passes_are_driven_in_the_order_of_the_books(name: str) -> None:
    order, wanted = ORDERS_OF_TWELVE[name]
    assert [place + 1 for place in order] == [int(number) for number in wanted.split()]


def test_every_order_is_a_permutation() -> None:
    for count in range(1, 201):
        for order in (
            neighbours(count),
            *(skipping(count, skip) for skip in range(4)),
            *(lands(count, land) for land in (1, 2, 5, 6, 9)),
            *(racetrack(count, half) for half in (1, 2, 4, 7)),
        ):
            assert sorted(order) == list(range(count))


def inside(plan: Plan, polygon: shapely.Polygon) -> bool:
    """Whether all that claims to fit lies in the field."""
    room = polygon.buffer(CENTIMETRE)
    return all(bool(np.all(shapely.contains_xy(room, *one.points.T))) for one in plan.segments if one.fits)


@pytest.mark.parametrize("method", METHODS)
def test_a_rectangle_is_worked_whole_by_every_method(method: Method) -> None:
    plan = plan_operation(RECTANGLE, PlanRequest(width=6.0, radius=5.0, method=method))
    assert inside(plan, RECTANGLE)
    assert plan.costs.worked_fraction > 0.985
    assert all(one.fits for one in plan.segments)
    numbers = [one.number for one in plan.segments if one.kind in {SegmentKind.PASS, SegmentKind.LAP}]
    assert len(numbers) == len(set(numbers))


@pytest.mark.parametrize("method", METHODS)
def test_turns_bend_no_tighter_than_the_radius(method: Method) -> None:
    radius = 5.0
    plan = plan_operation(RECTANGLE, PlanRequest(width=6.0, radius=radius, method=method))
    for one in plan.segments:
        if one.kind is not SegmentKind.TURN or len(one.points) < 3:
            continue
        steps = np.diff(one.points, axis=0)
        lengths = np.hypot(*steps.T)
        turned = np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
        bend = np.abs(turned) / (0.5 * (lengths[1:] + lengths[:-1]))
        assert np.median(bend) <= 1.02 / radius


@pytest.mark.parametrize("name", ["at_081", "it_058", "jp_041", "nz_062", "dk_093"])
def test_real_fields_are_worked_and_never_left(real_data: Path, name: str) -> None:
    boundary = field_from_file(real_data / "fields" / f"{name}.geojson").boundary
    polygon = polygon_in(frame_of(boundary), boundary)
    plan = plan_operation(polygon, PlanRequest(width=6.0, radius=5.0))
    assert inside(plan, polygon)
    assert plan.costs.worked_fraction > 0.96


def test_worked_strips_lose_no_ground_in_their_union(real_data: Path) -> None:
    text = (real_data / "union_all_case.wkt").read_text(encoding="utf-8")
    strips = [shapely.from_wkt(line) for line in text.splitlines() if line.startswith("POLYGON")]
    assert len(strips) == 6
    assert united(strips).area == pytest.approx(6256.14, abs=0.5)


def test_a_typed_direction_is_the_passes_direction() -> None:
    request = PlanRequest(width=6.0, radius=5.0, direction=Direction.TYPED, heading=math.radians(30))
    plan = plan_operation(RECTANGLE, request)
    for one in plan.segments:
        if one.kind is SegmentKind.PASS:
            east, north = one.points[-1] - one.points[0]
            assert abs(math.sin(math.atan2(east, north) - math.radians(30))) < 1e-6


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"width": 0.0}, "working width"),
        ({"width": math.nan}, "working width"),
        ({"radius": -1.0}, "turning radius"),
        ({"overlap": 7.0}, "overlap"),
        ({"heading": math.nan, "direction": Direction.TYPED}, "direction"),
    ],
)
def test_a_wish_that_cannot_be_is_refused_in_one_sentence(change: dict[str, object], word: str) -> None:
    with pytest.raises(PlanError, match=word):
        PlanRequest(**({"width": 6.0, "radius": 5.0} | change))


def test_a_field_in_two_parts_is_refused() -> None:
    bow_tie = shapely.Polygon([(0, 0), (100, 100), (100, 0), (0, 100)])
    with pytest.raises(PlanError, match="parts"):
        plan_operation(bow_tie, PlanRequest(width=6.0, radius=5.0))


def outcome(polygon: shapely.Polygon) -> Plan | PlanError:
    try:
        return plan_operation(polygon, PlanRequest(width=6.0, radius=5.0))
    except PlanError as error:
        return error


@pytest.mark.parametrize("side", [8.0, 14.0, 25.0])
def test_a_field_without_room_for_passes_is_a_plan_with_a_warning_or_a_sentence(side: float) -> None:
    small = shapely.box(0.0, 0.0, side, side)
    planned = outcome(small)
    if isinstance(planned, Plan):
        assert inside(planned, small)
        assert planned.warnings
    else:
        assert str(planned)


def test_every_sharp_corner_of_a_lap_is_worked_by_backing_up(real_data: Path) -> None:
    """Evened by means, this lap runs centimetres off the circles that cut its corners."""
    boundary = field_from_file(real_data / "fields" / "dk_093.geojson").boundary
    request = PlanRequest(width=12.0, radius=6.0)
    (lap,) = headland_of(ground_of(polygon_in(frame_of(boundary), boundary), request), request).laps
    assert len(lap.corners) == 5


@pytest.mark.parametrize("inside_out", [False, True])
@pytest.mark.parametrize("start", [None, (0.0, 0.0), (68.0, 67.0), (34.0, 0.0)])
def test_laps_follow_each_other_without_backing_up_wherever_they_begin(
    start: tuple[float, float] | None, inside_out: bool
) -> None:
    request = PlanRequest(
        width=6.0,
        offset_back=1.8,
        length=1.6,
        method=Method.SURROUNDING,
        options={"inside_out": inside_out},
        reverse_allowed=False,
        start=start,
    )
    plan = plan_operation(shapely.box(0.0, 0.0, 68.0, 67.0), request)
    assert all(each.fits for each in plan.segments)


@pytest.mark.parametrize("length", [40.0, 80.0])
def test_a_dead_end_is_left_backward(length: float) -> None:
    tongue = shapely.box(99.0, 40.0, 100.0 + length, 47.0)
    field = shapely.Polygon(shapely.union_all([shapely.box(0.0, 0.0, 100.0, 90.0), tongue]).exterior)
    plan = plan_operation(field, PlanRequest(width=6.0, radius=5.0))
    assert all(each.fits for each in plan.segments)
    assert max(each.length for each in plan.segments if each.reverse) > length
    assert plan.costs.worked_fraction > 0.985
    forward = plan_operation(field, PlanRequest(width=6.0, radius=5.0, reverse_allowed=False))
    assert not all(each.fits for each in forward.segments) or forward.costs.worked_fraction < plan.costs.worked_fraction
