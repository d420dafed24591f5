"""A whole field's plan: headland laps, passes in driving order, and what joins them."""

import shapely
from shapely import Polygon

from guidance_app.guidance.cells import cells_of, cut, strips_over
from guidance_app.guidance.costs import costs_of
from guidance_app.guidance.direction import pass_heading
from guidance_app.guidance.headland import headland_of, parts_of
from guidance_app.guidance.joining import Joiner
from guidance_app.guidance.leftover import leftovers
from guidance_app.guidance.leftover import runs_of as leftover_runs
from guidance_app.guidance.patterns import METHODS
from guidance_app.guidance.request import PlanError, PlanRequest, request_from_documents
from guidance_app.guidance.room import Room
from guidance_app.guidance.route import Cell, Way, route, runs_of
from guidance_app.guidance.swaths import swath, united
from guidance_app.guidance.task import Task
from guidance_app.guidance.turns import Turner
from guidance_app.guidance.ways import Ways
from guidance_app.model import FloatArray, Plan

__all__ = ["PlanError", "PlanRequest", "plan_operation", "request_from_documents"]

ROUNDS = 3
"""Times that leftovers are looked for: a bent one is worked by one straight pass after another."""

SMALLEST_FIELD = 10.0
"""Square metres; less is not a field."""

VERTEX_TOLERANCE = 0.02
"""Metres by which a boundary may be smoothed before planning: below what a driver can hold."""


def plan_operation(polygon: Polygon, request: PlanRequest) -> Plan:
    """The passes of one operation on one field (east, north in metres). Raises ``PlanError`` with the reason."""
    ground = _ground(polygon, request)
    method = METHODS[request.method.value]
    options = method.options_from(request.options)
    headland = headland_of(ground, request)
    room = Room(ground, request.body)
    turner = Turner(room, request)
    heading = pass_heading(ground, headland.mainland, request)
    warnings: list[str] = []
    strips = None
    cells: list[Cell] = []
    if headland.mainland:
        strips = strips_over(headland.mainland, heading, request.spacing, request.last_pass, None)
        pieces = cut(headland.mainland, strips, 0.0)
        cells = [Cell(run, strips) for run in cells_of(pieces)]
    else:
        warnings.append("the turning space leaves no mainland: the field is worked in laps only")
    ways = Ways(turner, [lap.points for lap in headland.laps], headland.mainland)
    joiner = Joiner(turner, ways)
    choices: list[list[Way]] = [list(runs_of(cell, method.pass_order(len(cell.pieces), options))) for cell in cells]
    worked = united(
        [swath(task, request.width) for lap in headland.laps for task in joiner.sides(lap)]
        + [swath(task, request.width) for ways_in in choices for task in ways_in[0].tasks(0)]
    )
    for _ in range(ROUNDS):
        rest = leftovers(ground, worked, room, request)
        if not rest:
            break
        more = [list(leftover_runs(each)) for each in rest]
        choices.extend(more)
        worked = united([worked, *(swath(task, request.width) for way in more for task in way[0].tasks(0))])
    tasks: list[Task] = []
    for run in route(choices, request):
        tasks.extend(run.tasks(len(tasks)))
    last = tasks[-1].last if tasks else None
    tasks.extend(joiner.round_tasks(headland.laps, last, len(tasks) + 1, inward=request.laps_first))
    if not tasks:
        msg = f"a field of {ground.area / 1e4:.2f} ha has no room for a working width of {request.width:g} m"
        raise PlanError(msg)
    segments = tuple(joiner.segments(tasks))
    return Plan(
        method=method.name,
        direction=heading,
        spacing=strips.spacing if strips else request.spacing,
        segments=segments,
        mainland=tuple(_rings(part) for part in headland.mainland),
        costs=costs_of(segments, ground, request),
        warnings=tuple(warnings),
    )


def _ground(polygon: Polygon, request: PlanRequest) -> Polygon:
    if polygon.is_empty:
        msg = "the field's boundary is empty"
        raise PlanError(msg)
    valid = polygon if polygon.is_valid else shapely.make_valid(polygon)
    parts = sorted(parts_of(valid, 0.0), key=lambda part: part.area, reverse=True)
    if not parts or parts[0].area < SMALLEST_FIELD:
        msg = f"the field's area of {valid.area:.1f} m2 is too small to work"
        raise PlanError(msg)
    if len(parts) > 1 and parts[1].area > max(SMALLEST_FIELD, 1e-3 * parts[0].area):
        msg = f"the field is in {len(parts)} parts: plan each as a field of its own"
        raise PlanError(msg)
    ground = shapely.simplify(parts[0], VERTEX_TOLERANCE)
    holes = [ring for place, ring in enumerate(ground.interiors) if place not in request.passable]
    return shapely.orient_polygons(Polygon(ground.exterior, holes))


def _rings(part: Polygon) -> tuple[FloatArray, ...]:
    return tuple(shapely.get_coordinates(ring) for ring in (part.exterior, *part.interiors))
