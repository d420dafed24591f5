"""What a plan is asked for by documents: tractor, implement, operation, and the field's entrance and guidance lines."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely

from guidance_app.boundary import frame_of, polygon_in
from guidance_app.documents import (
    Direction,
    FieldDocument,
    HitchKind,
    Implement,
    Job,
    Operation,
    Position,
    Tractor,
)
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.request import LastPass, PlanError, PlanRequest, driven_over
from guidance_app.language import sentence

__all__ = ["Places", "edge_place", "exclusions_with", "line_places", "request_from_documents", "request_of"]

STRAIGHT = ("ab", "a-plus")
"""Kinds of guidance lines that straight passes can lie beside."""

MOVED = 10.0
"""Metres from a tapped place to the boundary, up to which its edge was only moved and is still there."""

_Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Places:
    """What an operation says of places on its field, in the field's frame.

    ``line`` is the guidance line, ``edge`` a place near the edge that the passes follow; ``passable`` numbers the
    exclusions that are driven over, from 0.
    """

    start: _Place | None = None
    line: tuple[_Place, _Place] | None = None
    edge: _Place | None = None
    passable: frozenset[int] = frozenset()


NO_PLACES = Places()


def request_of(job: Job) -> PlanRequest:
    """The request of a job with a field, in the field's frame. Raises ``PlanError``."""
    assert job.field is not None, "a plan is made for a field"
    frame = frame_of(job.field.boundary)
    start = None if job.field.entrance is None else _place(job.field.entrance, frame)
    places = Places(start) if job.operation is None else _places(job.field, job.operation, frame, start)
    return request_from_documents(job.tractor, job.implement, job.operation, places)


def request_from_documents(
    tractor: Tractor,
    implement: Implement,
    operation: Operation | None = None,
    places: Places = NO_PLACES,
) -> PlanRequest:
    """The request of a saved operation; without one, round trip along the longest edge. Raises ``PlanError``.

    An operation along a guidance line or an edge needs it among ``places``. A trailed implement is not backed up: the
    tractor then turns forwards only.
    """
    chosen = {} if operation is None else _chosen(operation, places.start)
    reverse_allowed = chosen.pop("reverse_allowed", True) and implement.hitch is HitchKind.MOUNTED
    behind = implement.offset_back
    if implement.hitch is HitchKind.TRAILED:
        behind = implement.hitch_back + implement.drawbar
    return PlanRequest(
        width=implement.working_width,
        overlap=implement.overlap,
        radius=tractor.turning_radius,
        offset_back=behind,
        offset_right=implement.offset_right,
        length=implement.length,
        wheelbase=tractor.wheelbase,
        track_width=tractor.track_width,
        start=places.start,
        line=places.line,
        edge_near=places.edge,
        passable=places.passable,
        reverse_allowed=reverse_allowed,
        **chosen,
    )


def _chosen(operation: Operation, start: _Place | None) -> dict[str, Any]:
    typed = operation.direction is Direction.TYPED
    return {
        "method": operation.method,
        "options": MappingProxyType(dict(operation.options)),
        "laps": operation.laps,
        "turning_space": operation.turning_space,
        "direction": operation.direction,
        "heading": math.radians(operation.direction_deg) if typed else None,
        "start_corner": operation.start_corner,
        "exit": start if operation.end_at_entrance else None,
        "laps_first": operation.laps_first,
        "laps_clockwise": operation.laps_clockwise,
        "last_pass": LastPass(operation.last_pass),
        "over_exclusions": operation.over_exclusions,
        "reverse_allowed": operation.reverse_allowed,
    }


def _places(field: FieldDocument, operation: Operation, frame: FieldFrame, start: _Place | None) -> Places:
    line = edge = None
    holes = len(field.boundary.coordinates) - 1
    over = driven_over(holes, exclusions_with(field, operation.passable), all_of_them=operation.over_exclusions)
    if operation.direction is Direction.LINE:
        line = line_places(field, operation.guidance_line, frame)
    if operation.direction is Direction.EDGE and operation.edge_at is not None:
        edge = edge_place(field, operation.edge_at, frame, over)
    return Places(start, line, edge, over)


def edge_place(field: FieldDocument, at: Position, frame: FieldFrame, over: frozenset[int]) -> _Place:
    """A place near an edge, in the frame; an edge that is gone is said so, for another one is another direction.

    Exclusions that are driven ``over`` have no edges. Raises ``PlanError``.
    """
    place = _place(at, frame)
    polygon = polygon_in(frame, field.boundary)
    left = [ring for number, ring in enumerate(polygon.interiors) if number not in over]
    away = shapely.Polygon(polygon.exterior, left).boundary.distance(shapely.Point(place))
    if away > MOVED:
        msg = sentence(
            "no edge of the field '{field}' is left at the chosen place: choose an edge again", field=field.name
        )
        raise PlanError(msg)
    return place


def exclusions_with(field: FieldDocument, places: Sequence[Position]) -> frozenset[int]:
    """The numbers, from 0, of the exclusions in which one of these places lies.

    An exclusion that was moved away from its place is one to drive around.
    """
    points = shapely.points(np.asarray(places, dtype=float).reshape(-1, 2))
    holes = [shapely.Polygon(ring) for ring in field.boundary.coordinates[1:]]
    return frozenset(number for number, hole in enumerate(holes) if bool(shapely.covers(hole, points).any()))


def line_places(field: FieldDocument, name: str, frame: FieldFrame) -> tuple[_Place, _Place]:
    """Both ends of the straight guidance line of this name, or of the field's first one; none is a ``PlanError``."""
    straight = [each for each in field.lines if each.type in STRAIGHT]
    found = next((each for each in straight if not name or each.name == name), None)
    if found is None:
        wanted = f"'{name}'" if name else sentence("AB or A+")
        msg = sentence("the field '{field}' has no guidance line {line} for the passes", field=field.name, line=wanted)
        raise PlanError(msg)
    first, last = found.geometry.coordinates[0], found.geometry.coordinates[-1]
    return _place(first, frame), _place(last, frame)


def _place(position: Position, frame: FieldFrame) -> _Place:
    longitude, latitude = position
    return frame.east_north_from_degrees(latitude, longitude)
