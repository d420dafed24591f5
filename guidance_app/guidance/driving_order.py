"""The order in which a field's laps and passes are driven: one part of the field after the other."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from guidance_app.documents import Method
from guidance_app.guidance.bundle import runs_of
from guidance_app.guidance.joining import Joiner
from guidance_app.guidance.layout import Layout
from guidance_app.guidance.parts import Part, parts_in
from guidance_app.guidance.pattern import OperationMethod, PatternOptions
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.route import preferred, route
from guidance_app.guidance.task import Task
from guidance_app.model import FloatArray

__all__ = ["tasks_in_order"]


def tasks_in_order(
    layout: Layout, joiner: Joiner, way: tuple[OperationMethod, PatternOptions], request: PlanRequest
) -> list[Task]:
    """Laps and passes in driving order; passes have the lower numbers whichever comes first."""
    method, options = way
    choices = [runs_of(bundle, method.pass_order(len(bundle.lines), options)) for bundle in layout.bundles]
    laps_first = method.laps_inward(options) if request.method is Method.SURROUNDING else request.laps_first
    order = _Order(layout, joiner, laps_first=laps_first)
    parts = parts_in(layout.headland.laps, choices)
    while parts:
        part = _next_part(parts, order.last, request) if len(parts) > 1 else parts[0]
        parts.remove(part)
        order.add(part, _wishes(request, first=not order.tasks, last=not parts))
    return order.tasks


def _next_part(parts: Sequence[Part], last: FloatArray | None, request: PlanRequest) -> Part:
    """The nearest; at first the one with the wished corner, or with the wished start."""
    if last is not None:
        return min(parts, key=lambda part: part.away(last))
    choices = [runs for part in parts for runs in part.choices]
    firsts = {id(choices[cell]) for cell, _ in preferred(choices, request)}
    able = [part for part in parts if any(id(runs) in firsts for runs in part.choices)] or list(parts)
    return able[0] if request.start is None else min(able, key=lambda part: part.away(np.array(request.start)))


def _wishes(request: PlanRequest, *, first: bool, last: bool) -> PlanRequest:
    """What is wished of one part: the start of the first, the exit of the last."""
    corner = request.start_corner if first else "nearest"
    return replace(request, start_corner=corner, exit=request.exit if last else None)


class _Order:
    """Tasks so far, numbered as they come."""

    def __init__(self, layout: Layout, joiner: Joiner, *, laps_first: bool) -> None:
        self.tasks: list[Task] = []
        self._layout = layout
        self._joiner = joiner
        self._laps_first = laps_first
        self._passes = 0
        self._laps = sum(len(bundle.lines) for bundle in layout.bundles)

    @property
    def last(self) -> FloatArray | None:
        """The pose (3,) in which the last task ends."""
        return self.tasks[-1].last if self.tasks else None

    def add(self, part: Part, request: PlanRequest) -> None:
        """All tasks of one part."""
        for adding in (self._add_laps, self._add_passes) if self._laps_first else (self._add_passes, self._add_laps):
            adding(part, request)

    def _add_laps(self, part: Part, request: PlanRequest) -> None:
        last = self.last
        if last is None:
            last = np.array(self._corner() if request.start is None else request.start)
        sides = self._joiner.round_tasks(part.laps, last, self._laps + 1, inward=self._laps_first)
        self._laps += len(sides)
        self.tasks.extend(sides)

    def _add_passes(self, part: Part, request: PlanRequest) -> None:
        start = request.start if self.last is None else (float(self.last[0]), float(self.last[1]))
        for run in route(part.choices, request, start):
            passes = run.tasks(self._passes)
            self._passes += len(passes)
            self.tasks.extend(passes)

    def _corner(self) -> tuple[float, float]:
        """The first corner of the boundary, where work begins when nobody says where."""
        east, north = self._layout.ground.exterior.coords[0][:2]
        return east, north
