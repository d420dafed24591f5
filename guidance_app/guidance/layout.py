"""Where a field is worked, whatever the order: laps, cells of passes, leftovers, and the ground they work."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from guidance_app.documents import Direction, Method
from guidance_app.guidance.bundle import Bundle
from guidance_app.guidance.cells import Piece, Strips, cells_of, cut, cut_inside, strips_over
from guidance_app.guidance.direction import pass_heading
from guidance_app.guidance.headland import Headland, headland_of, laps_only
from guidance_app.guidance.leftover import leftovers
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.room import Room
from guidance_app.guidance.strokes import strokes
from guidance_app.guidance.swaths import swath, united, unworked
from guidance_app.guidance.task import Task, pass_line, side_tasks
from guidance_app.model import FloatArray

__all__ = ["Layout", "layout_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """All that is worked.

    ``worked`` is the union of the swaths, ``rest`` the ground that is left, ``swaths_area`` the sum of their areas.
    """

    width: float
    ground: Polygon
    headland: Headland
    heading: float
    spacing: float
    bundles: tuple[Bundle, ...]
    worked: BaseGeometry
    rest: BaseGeometry
    swaths_area: float

    def without(self, lines: Sequence[FloatArray]) -> "Layout":
        """The same with these lines (2, 2) of its bundles left out, whichever way they are driven."""
        gone = {id(line) for line in lines}
        kept = (_kept(bundle, gone) for bundle in self.bundles)
        bundles = tuple(bundle for bundle in kept if bundle.lines)
        swaths = _lap_swaths(self.headland, self.width) + _swaths(bundles, self.width)
        worked, area = united(swaths), sum(each.area for each in swaths)
        return replace(self, bundles=bundles, worked=worked, rest=unworked(self.ground, worked), swaths_area=area)


def layout_of(ground: Polygon, room: Room, request: PlanRequest) -> Layout:
    """Headland, passes over the mainland, and passes for what both leave.

    Leftovers are looked for twice: a bent one is worked by one straight pass after another. Strokes go on from laps and
    passes: where there are none, nothing leads to them.
    """
    headland = laps_only(ground, request) if request.method is Method.SURROUNDING else headland_of(ground, request)
    heading = pass_heading(ground, headland.mainland, request)
    mainland = headland.mainland if headland.laps else ()
    bundles, spacing = _bundles(mainland, heading, request)
    swaths = _lap_swaths(headland, request.width) + _swaths(bundles, request.width)
    worked = united(swaths)
    rest = unworked(ground, worked)
    area = sum(each.area for each in swaths)
    along = None if headland.laps else heading
    for search in (partial(leftovers, heading=along), leftovers, strokes) if request.leftovers else ():
        if search is strokes and not area:
            break
        more = search(ground, rest, room, request)
        if more:
            bundles.extend(more)
            swaths = _swaths(more, request.width)
            area += sum(each.area for each in swaths)
            worked = united([worked, *swaths])
            rest = unworked(ground, worked)
    return Layout(request.width, ground, headland, heading, spacing, tuple(bundles), worked, rest, area)


def _bundles(mainland: tuple[Polygon, ...], heading: float, request: PlanRequest) -> tuple[list[Bundle], float]:
    if not mainland:
        return [], request.spacing
    across = _line_across(heading, request)
    strips = strips_over(mainland, heading, request.spacing, request.last_pass, across)
    pieces = cut(mainland, strips) if request.lengthen else cut_inside(mainland, strips)
    return [_bundle(cell, strips) for cell in cells_of(pieces)], strips.spacing


def _bundle(cell: Sequence[Piece], strips: Strips) -> Bundle:
    lines = [pass_line(piece, strips) for piece in cell]
    return Bundle(tuple((line, line[::-1]) for line in lines), rows=(cell[0].row, cell[-1].row))


def _kept(bundle: Bundle, gone: set[int]) -> Bundle:
    lines = tuple(both for both in bundle.lines if not gone & {id(both[0]), id(both[1])})
    return bundle if len(lines) == len(bundle.lines) else replace(bundle, lines=lines)


def _lap_swaths(headland: Headland, width: float) -> list[BaseGeometry]:
    return [swath(task, width) for lap in headland.laps for task in side_tasks(lap, 0.0, 0, None)]


def _swaths(bundles: Sequence[Bundle], width: float) -> list[BaseGeometry]:
    return [swath(Task.along(line), width) for bundle in bundles for line, _ in bundle.lines]


def _line_across(heading: float, request: PlanRequest) -> float | None:
    """How far the AB line lies to the right of the origin, seen along the passes; None without one."""
    if request.direction is not Direction.LINE or request.line is None:
        return None
    east, north = request.line[0]
    return east * math.cos(heading) - north * math.sin(heading)
