"""An AB line from the first straight stretch that is driven, for a log or a drive that comes without a line."""

import copy
import math
from collections import deque
from typing import NamedTuple

import numpy as np

from guidance_app.angles import wrap_pi
from guidance_app.guidance.continuity import Continuity, is_place
from guidance_app.model import FloatArray, Pose

__all__ = ["StraightStretch"]

SHORTEST = 30.0
"""Metres that have to be straight."""

WITHIN = math.radians(3.0)
"""All headings lie within this of the stretch's middle heading."""

SLOWEST = 0.5
"""Metres per second forward; slower, a heading from a receiver says little."""

POINT_EVERY = 0.25
"""Metres between the points that are kept."""


Corner = tuple[float, float]
"""East, north."""


class _Point(NamedTuple):
    east: float
    north: float
    heading: float
    """Turned on continuously, not wrapped."""
    along: float


class StraightStretch:
    """Watches poses until ``shortest`` metres were straight; cost and memory stay bounded however long that takes."""

    def __init__(self, shortest: float = SHORTEST) -> None:
        self._shortest = shortest
        self._points: deque[_Point] = deque()
        self._continuity = Continuity()

    def fork(self) -> "StraightStretch":
        """An independent copy."""
        other = copy.copy(self)
        other._points = self._points.copy()  # noqa: SLF001 - its own class, as in the line below
        other._continuity = copy.copy(self._continuity)  # noqa: SLF001
        return other

    def step(self, pose: Pose) -> tuple[Corner, Corner] | None:
        """A and B, each (east, north), when this pose completes the stretch; else None.

        Both lie on the line of least squared distances to the stretch, A where it began.
        """
        if not is_place(pose.east, pose.north, pose.t, pose.heading, pose.speed):
            return None
        continuous = self._continuity.step(pose.t, pose.east, pose.north)
        if not (continuous and pose.heading_known and pose.speed > SLOWEST):
            self._points.clear()
        if not pose.heading_known or pose.speed <= SLOWEST:
            return None
        if not self._append(pose):
            return None
        while not self._is_straight():
            self._points.popleft()
        if self._points[-1].along - self._points[0].along < self._shortest:
            return None
        return _fitted(np.array([point[:2] for point in self._points]))

    def _append(self, pose: Pose) -> bool:
        """Whether the pose lies far enough from the last one to be kept."""
        if not self._points:
            self._points.append(_Point(pose.east, pose.north, pose.heading, 0.0))
            return True
        last = self._points[-1]
        distance = math.hypot(pose.east - last.east, pose.north - last.north)
        if distance < POINT_EVERY:
            return False
        heading = last.heading + wrap_pi(pose.heading - last.heading)
        self._points.append(_Point(pose.east, pose.north, heading, last.along + distance))
        return True

    def _is_straight(self) -> bool:
        headings = [point.heading for point in self._points]
        return max(headings) - min(headings) <= 2.0 * WITHIN


def _fitted(points: FloatArray) -> tuple[Corner, Corner]:
    middle = points.mean(axis=0)
    away = points - middle
    across = 2.0 * float(away[:, 0] @ away[:, 1])
    angle = 0.5 * math.atan2(across, float(away[:, 0] @ away[:, 0] - away[:, 1] @ away[:, 1]))
    toward = np.array([math.cos(angle), math.sin(angle)])
    if float((points[-1] - points[0]) @ toward) < 0:
        toward = -toward
    along = away @ toward
    start, end = middle + along[0] * toward, middle + along[-1] * toward
    return (float(start[0]), float(start[1])), (float(end[0]), float(end[1]))
