"""What is worked in one go: a pass or a side of a lap, in the direction in which it is driven."""

import math
from dataclasses import dataclass

import numpy as np

from guidance_app.guidance.turns import Turn
from guidance_app.model import FloatArray, SegmentKind

__all__ = ["Task", "pose_at"]


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """``points`` (N, 2) in driving order; ``approach`` is the turn that leads to it where that is already known."""

    kind: SegmentKind
    number: int
    points: FloatArray
    closed: bool = False
    approach: Turn | None = None

    @property
    def first(self) -> FloatArray:
        """Pose (3,) at its start: east, north, yaw."""
        return pose_at(self.points[0], self.points[1] - self.points[0])

    @property
    def last(self) -> FloatArray:
        """Pose (3,) at its end."""
        if self.closed:
            return pose_at(self.points[0], self.points[0] - self.points[-1])
        return pose_at(self.points[-1], self.points[-1] - self.points[-2])


def pose_at(point: FloatArray, direction: FloatArray) -> FloatArray:
    """Pose (3,) at a point, heading along ``direction``."""
    return np.array([point[0], point[1], math.atan2(direction[1], direction[0])])
