"""What is worked in one go: a pass or a side of a lap, in the direction in which it is driven."""

import math
from dataclasses import dataclass

import numpy as np

from guidance_app.guidance.cells import Piece, Strips
from guidance_app.guidance.lap import Lap
from guidance_app.guidance.turn import Turn
from guidance_app.model import FloatArray, SegmentKind

__all__ = ["Task", "pass_line", "pose_at", "side_tasks"]


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """``points`` (N, 2) in driving order; ``approach`` is the turn that leads to it where that is already known.

    A ``spare`` one is left out of a plan when it cannot be reached and is not worth much.
    """

    kind: SegmentKind
    number: int
    points: FloatArray
    closed: bool = False
    approach: Turn | None = None
    spare: bool = False

    @classmethod
    def along(cls, line: FloatArray, number: int = 0, *, spare: bool = False) -> "Task":
        """A pass along a line (2, 2)."""
        return cls(SegmentKind.PASS, number, line, spare=spare)

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


def pass_line(piece: Piece, strips: Strips) -> FloatArray:
    """A pass as a line (2, 2) along its strips' heading."""
    across = strips.middle(piece.row)
    return strips.east_north(np.array([(piece.low, across), (piece.high, across)]))


def side_tasks(lap: Lap, begin: float, number: int, approach: Turn | None) -> list[Task]:
    """The sides of a lap begun at ``begin`` metres along its line, numbered from ``number``."""
    return [
        Task(SegmentKind.LAP, number + place, side.points, side.closed, approach if place == 0 else side.approach)
        for place, side in enumerate(lap.sides_from(begin))
    ]


def pose_at(point: FloatArray, direction: FloatArray) -> FloatArray:
    """Pose (3,) at a point, heading along ``direction``."""
    return np.array([point[0], point[1], math.atan2(direction[1], direction[0])])
