"""A boundary that is driven: points of the antenna's track or of an implement's edge, gated, thinned, undoable.

A bad point in a boundary makes dangerous passes, so a fix is taken only with the wanted quality, with a known
heading, while the tractor moves, and where the way from the last point is one that a tractor can have driven. What
was not taken is counted, with the reason.
"""

import math
from collections import Counter
from collections.abc import Mapping
from enum import StrEnum
from types import MappingProxyType

import numpy as np
import shapely

from guidance_app.language import sentence
from guidance_app.model import FixQuality, FloatArray, Pose

__all__ = ["BoundaryDrive", "DrivenEdge", "QualityGate"]

LEAST_STEP = 0.4
"""Points lie at least so far apart, in metres."""
SPIKE_SLACK = 1.0
"""A point may lie this much farther from the last one than the speed explains, in metres."""
STANDING = 0.15
"""Below this speed, in m/s, the heading is no good and nothing is taken."""
TOLERANCE = 0.05
"""The finished ring lies within this many metres of what was driven."""
FEWEST = 3


class DrivenEdge(StrEnum):
    """Which line is the boundary."""

    TRACK = "tractor"
    LEFT = "left edge of the implement"
    RIGHT = "right edge of the implement"


class QualityGate(StrEnum):
    """The least fix quality that is taken."""

    ANY = "any fix"
    DGPS = "DGPS or better"
    RTK = "RTK only"


_GATES: Mapping[QualityGate, frozenset[FixQuality]] = MappingProxyType(
    {
        QualityGate.ANY: frozenset(FixQuality) - {FixQuality.NONE},
        QualityGate.DGPS: frozenset({FixQuality.DGPS, FixQuality.PPS, FixQuality.RTK_FIXED, FixQuality.RTK_FLOAT}),
        QualityGate.RTK: frozenset({FixQuality.RTK_FIXED, FixQuality.RTK_FLOAT}),
    }
)


class BoundaryDrive:
    """Remembers the points of one boundary. Not thread-safe.

    ``width`` is the implement's working width, ``offset_right`` how far its middle lies right of the tractor's line.
    """

    def __init__(
        self, edge: DrivenEdge, gate: QualityGate, width: float, points: list[tuple[float, float]] | None = None
    ) -> None:
        self._edge = edge
        self._gate = _GATES[gate]
        self._width = width
        self._points: list[tuple[float, float]] = list(points or [])
        self._last: tuple[Pose, tuple[float, float]] | None = None
        self._refused: Counter[str] = Counter()
        self.paused = False
        """While paused nothing is taken; the way on is a straight line."""

    def step(self, pose: Pose, implement: tuple[float, float, float], quality: FixQuality) -> bool:
        """Looks at one pose; True when it gave a point."""
        if self.paused:
            self._last = None
            return False
        if quality not in self._gate:
            return self._refuse("fix quality")
        if not pose.heading_known:
            return self._refuse("direction unknown")
        if abs(pose.speed) < STANDING:
            return False
        point = self._edge_point(pose, implement)
        if self._is_spike(pose, point):
            return self._refuse("jump")
        self._last = pose, point
        if self._points and math.dist(self._points[-1], point) < LEAST_STEP:
            return False
        self._points.append(point)
        return True

    def _refuse(self, reason: str) -> bool:
        self._refused[reason] += 1
        return False

    def _edge_point(self, pose: Pose, implement: tuple[float, float, float]) -> tuple[float, float]:
        if self._edge is DrivenEdge.TRACK:
            return pose.east, pose.north
        side = self._width / 2 if self._edge is DrivenEdge.RIGHT else -self._width / 2
        east, north, heading = implement
        return east + side * math.cos(heading), north - side * math.sin(heading)

    def _is_spike(self, pose: Pose, point: tuple[float, float]) -> bool:
        """Whether the way from the last point is longer than this speed, or a turn of the implement, explains."""
        if self._last is None:
            return False
        before, place = self._last
        seconds = max(pose.t - before.t, 0.0)
        turned = abs(math.remainder(pose.heading - before.heading, math.tau))
        possible = max(abs(pose.speed), abs(before.speed)) * seconds + self._width * turned + SPIKE_SLACK
        if math.dist(place, point) <= possible:
            return False
        if seconds > 3.0:  # after so long the last point says little: go on from here
            self._last = None
            return False
        return True

    def undo(self, metres: float) -> None:
        """Takes back the last ``metres`` of the way, at least the last point."""
        left = metres
        while self._points and left > 0:
            last = self._points.pop()
            left -= math.dist(last, self._points[-1]) if self._points else left
        self._last = None

    @property
    def points(self) -> FloatArray:
        """Shape (N, 2): east, north of what was taken."""
        return np.array(self._points, dtype=float).reshape(-1, 2)

    @property
    def length(self) -> float:
        """Metres along the points."""
        points = self.points
        return float(np.hypot(*np.diff(points, axis=0).T).sum()) if len(points) > 1 else 0.0

    @property
    def gap(self) -> float:
        """Metres from the last point back to the first: what closing the ring adds as a straight line."""
        return math.dist(self._points[0], self._points[-1]) if self._points else 0.0

    @property
    def area(self) -> float:
        """Square metres inside, were the ring closed now; 0 where it crosses itself."""
        if len(self._points) < FEWEST:
            return 0.0
        polygon = shapely.Polygon(self._points)
        return float(polygon.area) if polygon.is_valid else 0.0

    @property
    def refused(self) -> Mapping[str, int]:
        """How many fixes were not taken, by reason."""
        return MappingProxyType(self._refused)

    def ring(self) -> FloatArray:
        """The finished ring without its closing point, shape (N, 2), thinned to 5 cm. Raises ``ValueError``."""
        if len(self._points) < FEWEST:
            msg = sentence(
                "the drive has {count} points; a boundary needs at least {fewest}: drive on",
                count=len(self._points),
                fewest=FEWEST,
            )
            raise ValueError(msg)
        points = self._without_overlap()
        line = shapely.LineString([*points, points[0]])
        thin = shapely.get_coordinates(line.simplify(TOLERANCE))
        ring: FloatArray = thin[:-1]
        return ring

    def _without_overlap(self) -> list[tuple[float, float]]:
        """The points without an end that runs past the start: the ring closes where the way meets its beginning."""
        points = self._points
        head = shapely.LineString(points[: max(2, len(points) // 10)]) if len(points) > 20 else None
        if head is None:
            return points
        for index in range(len(points) - 1, max(len(points) * 9 // 10, 2), -1):
            step = shapely.LineString(points[index - 1 : index + 1])
            if step.crosses(head):
                meeting = step.intersection(head)
                first = next(iter(shapely.get_coordinates(meeting).tolist()), None)
                if first is None:
                    return points
                along = head.project(shapely.Point(first))
                begin = next(n for n in range(len(points)) if _length_to(points, n) >= along)
                return [(float(first[0]), float(first[1])), *points[begin:index]]
        return points


def _length_to(points: list[tuple[float, float]], index: int) -> float:
    return sum(math.dist(points[n], points[n + 1]) for n in range(index))
