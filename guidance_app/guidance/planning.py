"""A whole field's plan: headland laps, passes in driving order, and what joins them."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import MultiPolygon, Polygon

from guidance_app.guidance.cells import Piece, Strips, cells_of, cut, strips_over
from guidance_app.guidance.costs import costs_of
from guidance_app.guidance.direction import pass_heading
from guidance_app.guidance.headland import Headland, Lap, headland_of, parts_of
from guidance_app.guidance.patterns import METHODS
from guidance_app.guidance.request import PlanError, PlanRequest, request_from_documents
from guidance_app.guidance.room import Room
from guidance_app.guidance.turns import Turn, Turner
from guidance_app.model import FloatArray, Plan, Segment, SegmentKind

__all__ = ["PlanError", "PlanRequest", "plan_operation", "request_from_documents"]

SMALLEST_FIELD = 10.0
"""Square metres; less is not a field."""

VERTEX_TOLERANCE = 0.02
"""Metres by which a boundary may be smoothed before planning: below what a driver can hold."""


@dataclass(frozen=True, slots=True, eq=False)
class _Work:
    """Something to work, in the direction it will be driven. ``points`` in driving order."""

    kind: SegmentKind
    number: int
    points: FloatArray
    closed: bool

    @property
    def first_pose(self) -> tuple[float, float, float]:
        return _pose(self.points[0], self.points[1] - self.points[0])

    @property
    def last_pose(self) -> tuple[float, float, float]:
        if self.closed:
            return _pose(self.points[0], self.points[0] - self.points[-1])
        return _pose(self.points[-1], self.points[-1] - self.points[-2])


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
    works: list[_Work] = []
    strips = None
    if headland.mainland:
        strips = strips_over(headland.mainland, heading, request.spacing, request.last_pass, None)
        pieces = cut(headland.mainland, strips, 0.0)
        for cell in cells_of(pieces):
            order = method.pass_order(len(cell), options)
            works.extend(_driven(cell, order.sequence, strips, len(works)))
    else:
        warnings.append("the turning space leaves no mainland: the field is worked in laps only")
    laps = [
        _Work(SegmentKind.LAP, len(works) + 1 + place, _started_near(lap.points, None), closed=True)
        for place, lap in enumerate(headland.laps)
    ]
    works = laps + works if request.laps_first else works + laps[::-1]
    if not works:
        msg = f"a field of {ground.area / 1e4:.2f} ha has no room for a working width of {request.width:g} m"
        raise PlanError(msg)
    segments = tuple(_segments(works, turner))
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
    return Polygon(ground.exterior, holes)


def _driven(cell: Sequence[Piece], sequence: Sequence[int], strips: Strips, done: int) -> Iterator[_Work]:
    forward = True
    for place in sequence:
        piece = cell[place]
        middle = strips.middle(piece.row)
        ends = [(piece.low, middle), (piece.high, middle)]
        points = strips.east_north(np.array(ends if forward else ends[::-1]))
        forward = not forward
        yield _Work(SegmentKind.PASS, done + place + 1, points, closed=False)


def _started_near(points: FloatArray, near: FloatArray | None) -> FloatArray:
    return points


def _segments(works: Sequence[_Work], turner: Turner) -> Iterator[Segment]:
    starts = np.array([work.last_pose for work in works[:-1]]).reshape(-1, 3)
    ends = np.array([work.first_pose for work in works[1:]]).reshape(-1, 3)
    turns = turner.turns(starts, ends) if len(works) > 1 else []
    for place, work in enumerate(works):
        length = shapely.length(shapely.linestrings(work.points))
        if work.closed:
            length += math.dist(work.points[0], work.points[-1])
        yield Segment(work.kind, work.number, work.points, True, float(length), closed=work.closed)
        if place < len(turns):
            yield from _turn_segments(turns[place], works[place + 1].number)


def _turn_segments(turn: Turn, number: int) -> Iterator[Segment]:
    for leg in turn.legs:
        length = float(shapely.length(shapely.linestrings(leg.points)))
        yield Segment(
            SegmentKind.TURN,
            number,
            leg.points,
            implement_down=False,
            length=length,
            fits=turn.missing == 0,
            missing=turn.missing,
            reverse=leg.reverse,
        )


def _pose(point: FloatArray, direction: FloatArray) -> tuple[float, float, float]:
    return float(point[0]), float(point[1]), math.atan2(direction[1], direction[0])


def _rings(part: Polygon) -> tuple[FloatArray, ...]:
    return tuple(shapely.get_coordinates(ring) for ring in (part.exterior, *part.interiors))
