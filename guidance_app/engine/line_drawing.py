"""A guidance line that the driver draws by driving: from A to B, along a curve, around a pivot, or through one point.

The points are those of the guided point, so that the passes lie where they were driven.
"""

import copy
import math

import numpy as np

from guidance_app.guidance.family import GuidanceLineError, PassFamily
from guidance_app.guidance.patterns import LINES
from guidance_app.guidance.patterns.a_plus import points_of
from guidance_app.guidance.patterns.pivot import points_of_arc
from guidance_app.language import sentence
from guidance_app.model import FloatArray, LineBegun, LineKind

__all__ = ["AT_ONCE", "LineDrawing", "line_at_once"]

AT_ONCE = frozenset({LineKind.A_PLUS, LineKind.FOLLOW})
"""Lines that need no second point."""
POINT_EVERY = 0.5
MOST_POINTS = 20_000
SHORTEST = 5.0
"""Metres from A to B; less tells no direction."""


class LineDrawing:
    """The points of one line while it is driven. ``kind`` is its name in ``LINES``."""

    def __init__(self, kind: LineKind, start: tuple[float, float]) -> None:
        self.kind = kind
        self._points = [start]
        self._metres = 0.0

    def fork(self) -> "LineDrawing":
        """An independent copy."""
        other = copy.copy(self)
        other._points = list(self._points)  # noqa: SLF001 - its own class
        return other

    def step(self, point: tuple[float, float]) -> None:
        """One guided point further; kept are points half a metre apart."""
        step = math.dist(self._points[-1], point)
        if step >= POINT_EVERY and len(self._points) < MOST_POINTS:
            self._points.append(point)
            self._metres += step

    @property
    def begun(self) -> LineBegun:
        """The line as far as it has come: from A as the crow flies, a curve as it was driven."""
        start, here = self._points[0], self._points[-1]
        return LineBegun(self.kind, start, math.dist(start, here) if self.kind is LineKind.AB else self._metres)

    def family(self, end: tuple[float, float], spacing: float) -> PassFamily:
        """The passes beside the line that ends here. Raises ``GuidanceLineError``."""
        points: FloatArray = np.array([*self._points, end])
        if self.kind is LineKind.AB and math.dist(points[0], points[-1]) < SHORTEST:
            msg = sentence("A and B are less than {metres:g} m apart: drive on", metres=SHORTEST)
            raise GuidanceLineError(msg)
        if self.kind is LineKind.PIVOT:
            points = points_of_arc(points)
        return LINES[self.kind].family(points, spacing)


def line_at_once(kind: LineKind, point: tuple[float, float], heading: float, spacing: float) -> PassFamily:
    """Passes that need no driving first: through ``point`` in ``heading``, or beside whatever is driven next."""
    points = points_of(point, heading) if kind is LineKind.A_PLUS else np.zeros((0, 2))
    return LINES[kind].family(points, spacing)
