"""A whole field's plan: headland laps, passes in driving order, and what joins them."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import shapely
from shapely import Polygon

from guidance_app.documents import Method
from guidance_app.guidance.costs import costs_of, joins_of
from guidance_app.guidance.driving_order import tasks_in_order
from guidance_app.guidance.ground import ground_of
from guidance_app.guidance.joining import Joiner
from guidance_app.guidance.layout import Layout, layout_of
from guidance_app.guidance.pattern import OperationMethod, PatternOptions
from guidance_app.guidance.patterns import METHODS
from guidance_app.guidance.request import PlanError, PlanRequest
from guidance_app.guidance.room import Room
from guidance_app.guidance.task import Task
from guidance_app.guidance.turn import Turn
from guidance_app.guidance.turns import Turner
from guidance_app.guidance.ways import Ways
from guidance_app.language import sentence
from guidance_app.model import FloatArray, Plan, Segment

__all__ = [
    "Groundwork",
    "PlanError",
    "PlanRequest",
    "groundwork_of",
    "plan_on",
    "plan_operation",
]

ROUNDS = 4
"""Times that small passes are left out because there is no way to them."""

SMALL_WIDTHS, SMALL_PART = 2.0, 0.01
"""A pass is small when it is shorter than so many working widths, or would work less than this part of the field."""

HOPELESS = 1.0
"""Metres; a turn that lacks less may be worth the driver's own judgement."""

UNWORKED = 0.02
"""Part of the field that may stay unworked without a warning."""


def plan_operation(polygon: Polygon, request: PlanRequest) -> Plan:
    """The passes of one operation on one field (east, north in metres). Raises ``PlanError`` with the reason."""
    return plan_on(groundwork_of(polygon, request), request)


@dataclass(frozen=True, slots=True, eq=False)
class Groundwork:
    """What of a plan does not depend on the order of passes or where the work begins."""

    layout: Layout
    joiner: Joiner


def groundwork_of(polygon: Polygon, request: PlanRequest) -> Groundwork:
    """Where the field is worked, and who finds the ways. Raises ``PlanError`` with the reason."""
    ground = ground_of(polygon, request)
    room = Room(ground, request.body)
    layout = layout_of(ground, room, request)
    turner = Turner(room, request)
    ways = Ways(turner, [lap.line for lap in layout.headland.laps], layout.headland.mainland)
    return Groundwork(layout, Joiner(turner, ways, request))


def plan_on(groundwork: Groundwork, request: PlanRequest) -> Plan:
    """The plan on ground that was laid out for this request but for method, options, corner and order."""
    layout, joiner = groundwork.layout, groundwork.joiner
    method, options = _method(request)
    for _ in range(ROUNDS):
        tasks = tasks_in_order(layout, joiner, (method, options), request)
        gone = _not_worth_it(tasks, joiner.turns(tasks), layout)
        if not gone:
            break
        layout = layout.without(gone)
    if not tasks:
        raise PlanError(_nothing(layout, request))
    segments = tuple(joiner.segments(tasks))
    return Plan(
        method=method.name,
        direction=layout.heading,
        spacing=layout.spacing,
        segments=segments,
        mainland=tuple(_rings(part) for part in layout.headland.mainland if layout.headland.laps),
        costs=costs_of(segments, layout, request),
        warnings=tuple(_warnings(segments, layout, request)),
    )


def _nothing(layout: Layout, request: PlanRequest) -> str:
    """Why neither a lap nor a pass is left: the tractor's circle is wider than the field, or the swath is."""
    west, south, east, north = layout.ground.bounds
    area = layout.ground.area / 1e4
    if 2 * request.radius > max(east - west, north - south):
        return sentence(
            "a turning radius of {radius:g} m is too large for this field of {area:.2f} ha",
            radius=request.radius,
            area=area,
        )
    return sentence(
        "a working width of {width:g} m is too wide for this field of {area:.2f} ha", width=request.width, area=area
    )


def _method(request: PlanRequest) -> tuple[OperationMethod, PatternOptions]:
    method = METHODS.get(request.method.value)
    if method is None:
        msg = sentence(
            "the method '{method}' is for driving without a plan; choose {names}",
            method=request.method.value,
            names=", ".join(METHODS),
        )
        raise PlanError(msg)
    return method, method.options_from(request.options)


def _not_worth_it(tasks: Sequence[Task], turns: Sequence[Turn], layout: Layout) -> list[FloatArray]:
    """The lines of small spare passes that cannot be reached or left: they stay unworked, and nobody is sent there."""
    gone = []
    for (before, after), turn in zip(itertools.pairwise(tasks), turns, strict=True):
        if turn.missing < HOPELESS:
            continue
        small = [task for task in (before, after) if task.spare and _small(task, layout)]
        if small:
            gone.append(min(small, key=lambda task: math.dist(*task.points)).points)
    return gone


def _small(task: Task, layout: Layout) -> bool:
    length = math.dist(*task.points)
    return length < SMALL_WIDTHS * layout.width or length * layout.width < SMALL_PART * layout.ground.area


def _warnings(segments: Sequence[Segment], layout: Layout, request: PlanRequest) -> list[str]:
    """What the driver should know before he begins, a sentence each."""
    warnings: list[str] = []
    if not layout.headland.mainland and request.method is not Method.SURROUNDING:
        warnings.append(sentence("The turning space leaves no mainland: the field is worked in laps."))
    if layout.headland.undrivable:
        warnings.append(
            sentence(
                "{count} laps bend too tightly for a turning radius of {radius:g} m and are left out.",
                count=layout.headland.undrivable,
                radius=request.radius,
            )
        )
    if request.start is not None and not layout.ground.covers(shapely.Point(request.start)):
        warnings.append(sentence("The start lies outside the field: the plan begins at the nearest place inside."))
    unfit = [join for join in joins_of(segments) if not all(each.fits for each in join)]
    if unfit:
        worst = max(each.missing for join in unfit for each in join)
        many = sentence("{count} turns do not fit; the worst lacks {worst:.1f} m.", count=len(unfit), worst=worst)
        warnings.append(
            many if len(unfit) > 1 else sentence("One turn does not fit; it lacks {worst:.1f} m.", worst=worst)
        )
    missed = layout.rest.area / layout.ground.area
    if missed > UNWORKED:
        warnings.append(
            sentence(
                "{percent:.1f} % of the field cannot be worked with this machine inside the boundary.",
                percent=100 * missed,
            )
        )
    return warnings


def _rings(part: Polygon) -> tuple[FloatArray, ...]:
    return tuple(shapely.get_coordinates(ring) for ring in (part.exterior, *part.interiors))
