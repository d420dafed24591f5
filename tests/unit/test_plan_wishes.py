"""What an operation asks for is what the plan does: line, last pass, way round, exit, exclusions, one by one."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import shapely
from pydantic import ValidationError

from guidance_app.bench.plan_cases import tightest
from guidance_app.boundary import frame_of, polygon_in
from guidance_app.documents import (
    Direction,
    FieldDocument,
    Geometry,
    GuidanceLineDocument,
    HitchKind,
    Implement,
    Job,
    LineGeometry,
    Operation,
    Receiver,
    Tractor,
)
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.cells import cut, strips_over
from guidance_app.guidance.direction import best_heading
from guidance_app.guidance.planning import PlanError, PlanRequest, plan_operation
from guidance_app.guidance.request import LastPass
from guidance_app.guidance.wishes import request_of
from guidance_app.model import FloatArray, Plan, Segment, SegmentKind

MILLIMETRE = 1e-3
CENTIMETRE = 0.01
FRAME = FieldFrame(47.5, 8.5)
CORNERS = np.array([[-100.0, -60.0], [100.0, -60.0], [100.0, 65.0], [-100.0, 65.0], [-100.0, -60.0]])
POND = np.array([[-10.0, -5.0], [-10.0, 15.0], [12.0, 15.0], [12.0, -5.0], [-10.0, -5.0]])
LINE = np.array([[-50.0, -31.7], [61.0, -12.4]])


def degrees(points: FloatArray) -> list[tuple[float, float]]:
    found = [(float(lon), float(lat)) for lon, lat in FRAME.lonlat_from_array(points)]
    return [*found[:-1], found[0]] if len(points) > 1 and np.array_equal(points[0], points[-1]) else found


def a_job(**wishes: Any) -> Job:
    field = FieldDocument(
        name="F",
        boundary=Geometry(coordinates=[degrees(CORNERS), degrees(POND)]),
        entrance=degrees(CORNERS[:1] + 1.0)[0],
        lines=[
            GuidanceLineDocument(name="curved", type="curve", geometry=LineGeometry(coordinates=degrees(LINE))),
            GuidanceLineDocument(name="fence", type="ab", geometry=LineGeometry(coordinates=degrees(LINE))),
        ],
    )
    hitch = wishes.pop("hitch", HitchKind.MOUNTED)
    return Job(
        tractor=Tractor(name="T"),
        implement=Implement(name="I", working_width=9.0, hitch=hitch),
        receiver=Receiver(name="R"),
        field=field,
        operation=Operation(name="O", field="F", tractor="T", implement="I", **wishes),
    )


def plan_of(job: Job) -> tuple[Plan, shapely.Polygon]:
    assert job.field is not None
    polygon = polygon_in(frame_of(job.field.boundary), job.field.boundary)
    return plan_operation(polygon, request_of(job)), polygon


def passes(plan: Plan) -> list[Segment]:
    return [each for each in plan.segments if each.kind is SegmentKind.PASS]


@pytest.mark.parametrize("name", ["", "fence"])
def test_passes_beside_a_guidance_line_keep_its_distance_to_a_millimetre(name: str) -> None:
    job = a_job(direction=Direction.LINE, guidance_line=name)
    plan, _ = plan_of(job)
    assert job.field is not None
    frame = frame_of(job.field.boundary)
    first, last = (
        np.array(frame.east_north_from_degrees(latitude, longitude))
        for longitude, latitude in job.field.lines[1].geometry.coordinates
    )
    along = (last - first) / np.hypot(*(last - first))
    for each in passes(plan):
        across = (each.points - first) @ np.array([along[1], -along[0]])
        turned = abs(float(np.diff(across)[0]))
        if turned > CENTIMETRE:
            continue  # a leftover has its own direction
        spacings = across.mean() / plan.spacing
        assert abs(spacings - round(spacings)) * plan.spacing < MILLIMETRE
    beside = [abs(float(np.diff((each.points - first) @ np.array([along[1], -along[0]]))[0])) for each in passes(plan)]
    assert sum(one < CENTIMETRE for one in beside) >= 8


def test_a_guidance_line_that_is_not_there_is_named() -> None:
    with pytest.raises(PlanError, match="'F' has no guidance line 'hedge'"):
        request_of(a_job(direction=Direction.LINE, guidance_line="hedge"))


def test_exclusions_are_driven_round_or_over() -> None:
    around, polygon = plan_of(a_job())
    over, _ = plan_of(a_job(over_exclusions=True))
    pond = shapely.Polygon(polygon.interiors[0]).buffer(-CENTIMETRE)
    assert not any(shapely.LineString(each.points).intersects(pond) for each in around.segments if each.fits)
    assert any(shapely.LineString(each.points).intersects(pond) for each in passes(over))


def test_one_exclusion_is_driven_over_and_the_other_one_round() -> None:
    second = POND + np.array([60.0, 0.0])
    job = a_job(passable=degrees(np.array([[1.0, 5.0]])))
    assert job.field is not None
    geometry = Geometry(coordinates=[*job.field.boundary.coordinates, degrees(second)])
    job = job.model_copy(update={"field": job.field.model_copy(update={"boundary": geometry})})
    plan, polygon = plan_of(job)
    over, around = (shapely.Polygon(ring).buffer(-CENTIMETRE) for ring in polygon.interiors)
    assert any(shapely.LineString(each.points).intersects(over) for each in passes(plan))
    assert not any(shapely.LineString(each.points).intersects(around) for each in plan.segments if each.fits)


def test_a_passable_place_that_lies_in_no_exclusion_opens_none() -> None:
    request = request_of(a_job(passable=degrees(np.array([[-60.0, -30.0]]))))
    assert request.passable == frozenset()


def test_the_tapped_edge_of_an_operation_gives_the_direction_and_outlives_a_shift() -> None:
    for shift in (0.0, 3.0):
        at = degrees(np.array([[100.0 + shift, 10.0]]))[0]
        plan, _ = plan_of(a_job(direction=Direction.EDGE, edge_at=at))
        assert abs(math.sin(plan.direction)) < math.radians(0.1)


@pytest.mark.parametrize(
    ("at", "wishes"),
    [((40.0, 30.0), {}), ((-10.0, 5.0), {"over_exclusions": True})],
    ids=["in the middle", "of an exclusion that is driven over"],
)
def test_a_tapped_edge_that_is_gone_is_said(at: tuple[float, float], wishes: Mapping[str, Any]) -> None:
    with pytest.raises(PlanError, match="no edge of the field 'F' is left at the chosen place"):
        request_of(a_job(direction=Direction.EDGE, edge_at=degrees(np.array([at]))[0], **wishes))


def test_passes_along_an_edge_need_one() -> None:
    with pytest.raises(PlanError, match="none is tapped"):
        request_of(a_job(direction=Direction.EDGE))


@pytest.mark.parametrize("place", [(math.nan, 47.5), (500_000.0, 47.5), (8.5, -91.0)])
def test_an_operation_takes_no_place_that_is_not_on_earth(place: tuple[float, float]) -> None:
    for wrong in ({"edge_at": place}, {"passable": [place]}):
        with pytest.raises(ValidationError, match=r"corner|longitude"):
            a_job(**wrong)


def clockwise(lap: Segment) -> bool:
    return not shapely.is_ccw(shapely.linearrings(lap.points))


@pytest.mark.parametrize("wish", [True, False])
def test_laps_go_the_way_round_that_is_wished(wish: bool) -> None:
    request = PlanRequest(width=9.0, square_corners=False, laps_clockwise=wish)
    plan = plan_operation(shapely.box(0, 0, 200, 120), request)
    laps = [each for each in plan.segments if each.closed]
    assert laps
    assert all(clockwise(each) is wish for each in laps)
    assert request_of(a_job(laps_clockwise=wish)).laps_clockwise is wish


@pytest.mark.parametrize("first", [True, False])
def test_laps_come_first_or_last(first: bool) -> None:
    plan, _ = plan_of(a_job(laps_first=first))
    kinds = [each.kind for each in plan.segments if each.implement_down]
    assert kinds == sorted(kinds, key=lambda kind: (kind is SegmentKind.PASS) is first)


def test_the_last_pass_overlaps_is_left_out_or_all_are_closer() -> None:
    field = shapely.box(0, 0, 150, 120)
    made = {
        last: plan_operation(field, PlanRequest(width=9.0, laps=2, last_pass=last, leftovers=False))
        for last in LastPass
    }
    inner = 120 - 4 * 9.0
    assert len(passes(made[LastPass.OVERLAP])) == len(passes(made[LastPass.EVEN])) == math.ceil(inner / 9.0)
    assert len(passes(made[LastPass.GAP])) == math.floor(inner / 9.0)
    assert made[LastPass.OVERLAP].spacing == 9.0
    assert made[LastPass.EVEN].spacing == pytest.approx(inner / math.ceil(inner / 9.0))
    assert made[LastPass.GAP].costs.missed_m2 > made[LastPass.EVEN].costs.missed_m2
    assert request_of(a_job(last_pass="even")).last_pass is LastPass.EVEN


def test_a_plan_ends_where_the_driver_leaves() -> None:
    field = shapely.box(0, 0, 190, 120)
    ends = []
    for way_out in ((0.0, 0.0), (190.0, 120.0)):
        plan = plan_operation(field, PlanRequest(width=9.0, laps_first=True, exit=way_out, start_corner="nearest"))
        ends.append(math.dist(passes(plan)[-1].points[-1], way_out))
    assert max(ends) < 40.0
    assert request_of(a_job(end_at_entrance=True)).exit == request_of(a_job()).start
    assert request_of(a_job()).exit is None


@pytest.mark.parametrize("corner", ["first-left", "first-right", "last-left", "last-right"])
def test_work_begins_at_the_corner_that_is_wished(corner: str) -> None:
    request = PlanRequest(width=9.0, direction=Direction.TYPED, heading=0.0, start_corner=corner)  # type: ignore[arg-type]  # one of the literals
    first = passes(plan_operation(shapely.box(0, 0, 190, 120), request))[0]
    assert bool(first.points[0, 0] > 95) is corner.startswith("last")
    assert bool(first.points[0, 1] > 60) is corner.endswith("left")


def test_the_edge_that_is_tapped_gives_the_direction() -> None:
    field = shapely.Polygon([(0, 0), (200, 0), (200, 90), (0, 140)])
    plan = plan_operation(field, PlanRequest(width=9.0, direction=Direction.EDGE, edge_near=(100.0, 118.0)))
    wanted = math.atan2(200, -50)
    assert abs(math.sin(plan.direction - wanted)) < 1e-6


def test_a_trailed_implement_is_never_backed_up() -> None:
    plan, _ = plan_of(a_job(hitch=HitchKind.TRAILED))
    assert not any(each.reverse for each in plan.segments if each.fits)


@pytest.mark.parametrize("change", [{}, {"square_corners": False}, {"reverse_allowed": False}])
def test_nothing_that_fits_bends_tighter_than_the_turning_circle(change: Mapping[str, Any]) -> None:
    field = shapely.Polygon([(0, 0), (200, 0), (230, 90), (120, 150), (0, 130)])
    plan = plan_operation(field, PlanRequest(width=9.0, **change))
    assert all(each.fits for each in plan.segments)
    assert tightest(plan.segments, 5.0) <= 1.0


@pytest.mark.parametrize("narrow", [26.0, 60.0, 150.0])
def test_the_best_direction_takes_at_most_one_pass_more_than_the_fewest(narrow: float) -> None:
    field = shapely.Polygon([(0, 0), (1400, 300), (1400 - narrow / 5, 300 + narrow), (-narrow / 5, narrow)])
    request = PlanRequest(width=6.0, direction=Direction.BEST)

    def passes_at(heading: float) -> int:
        return len(cut([field], strips_over([field], heading, 6.0, LastPass.OVERLAP, None)))

    fewest = min(passes_at(math.radians(half / 2)) for half in range(360))
    assert passes_at(best_heading([field], request)) <= fewest + 1
