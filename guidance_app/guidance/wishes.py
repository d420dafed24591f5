"""What a plan is asked for by documents: tractor, implement, operation, and the field's entrance and guidance lines."""

import math
from types import MappingProxyType
from typing import Any

from guidance_app.boundary import frame_of
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
from guidance_app.guidance.request import LastPass, PlanError, PlanRequest
from guidance_app.language import sentence

__all__ = ["request_from_documents", "request_of"]

STRAIGHT = ("ab", "a-plus")
"""Kinds of guidance lines that straight passes can lie beside."""

_Place = tuple[float, float]


def request_of(job: Job) -> PlanRequest:
    """The request of a job with a field, in the field's frame. Raises ``PlanError``."""
    assert job.field is not None, "a plan is made for a field"
    frame = frame_of(job.field.boundary)
    start = None if job.field.entrance is None else _place(job.field.entrance, frame)
    line = None
    if job.operation is not None and job.operation.direction is Direction.LINE:
        line = _line(job.field, job.operation.guidance_line, frame)
    return request_from_documents(job.tractor, job.implement, job.operation, start, line)


def request_from_documents(
    tractor: Tractor,
    implement: Implement,
    operation: Operation | None = None,
    start: _Place | None = None,
    line: tuple[_Place, _Place] | None = None,
) -> PlanRequest:
    """The request of a saved operation; without one, round trip along the longest edge. Raises ``PlanError``.

    ``line`` is the guidance line that an operation along one needs. A trailed implement is not backed up: the tractor
    then turns forwards only.
    """
    chosen = {} if operation is None else _chosen(operation, start)
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
        start=start,
        line=line,
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


def _line(field: FieldDocument, name: str, frame: FieldFrame) -> tuple[_Place, _Place]:
    """The straight guidance line of this name, or the field's first; a name that is not there is said so."""
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
