"""The way through a turn that is being driven: how far beside its path the guided point is, and how much is left.

A turn in which the tractor backs up runs over itself. The foot point is therefore searched from the last one forward;
whoever leaves the path by more than two metres is looked for anew.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from guidance_app.angles import wrap_pi
from guidance_app.guidance.polyline import Foot, Polyline
from guidance_app.model import FloatArray, Guidance, Pose, TurnGuide
from guidance_app.model.making import made_quickly

__all__ = ["Turning", "turning_of"]

WINDOW = 3.0
"""The foot point is searched so far ahead, and twice the distance moved; never behind the last one."""

FINE = 0.25

LOST = 2.0
"""Farther from the path than this the tractor is somewhere else along it."""

Point = tuple[float, float]


@made_quickly
@dataclass(frozen=True, slots=True, eq=False)
class Turning:
    """Where along a turn's path the guided point is. A value: each epoch gives the next one."""

    points: FloatArray
    path: Polyline
    foot: Foot
    at: Point

    def errors_at(self, point: Point, heading: float, moved: float = 0.0) -> tuple[float, float] | None:
        """Cross-track and heading error there, seen the way the tractor points; None beyond the turn's end."""
        foot = self._foot(point, moved)
        return None if foot.along >= self.path.length else _errors(foot, heading)

    def on(self, point: Point) -> "Turning":
        """One epoch further."""
        return replace(self, foot=self._foot(point, math.dist(point, self.at)), at=point)

    def shown(self, turn: TurnGuide, heading: float) -> TurnGuide:
        """The turn with how far beside it the tractor is, and what is left of it."""
        cross_track, heading_error = _errors(self.foot, heading)
        to_go = max(self.path.length - self.foot.along, 0.0)
        return replace(turn, cross_track=cross_track, heading_error=heading_error, to_go=to_go)

    def _foot(self, point: Point, moved: float) -> Foot:
        reach = 0.5 * WINDOW + moved
        foot = self.path.foot(*point, self.foot.along + reach, reach)
        return foot if foot.distance <= LOST else self.path.foot(*point)


def turning_of(before: Turning | None, guidance: Guidance | None, pose: Pose, point: Point) -> Turning | None:
    """Where along the turn that is being driven; None while none is."""
    turn = None if guidance is None else guidance.turn
    if turn is None or not turn.driven or not pose.heading_known:
        return None
    if before is not None and _same(before.points, turn.points):
        return before.on(point)
    path = Polyline.through(_fine(turn.points))
    return Turning(turn.points, path, path.foot(*point), point)


def _same(before: FloatArray, now: FloatArray) -> bool:
    """Nearly always the same memory; an engine that was kept in a file has a copy of it."""
    return np.may_share_memory(before, now) or np.array_equal(before, now)


def _fine(points: FloatArray) -> FloatArray:
    """The same way with a vertex every quarter of a metre, as the search goes by whole stretches between vertices."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    places = np.union1d(along, np.arange(0.0, along[-1], FINE))
    return np.column_stack([np.interp(places, along, points[:, axis]) for axis in range(2)])


def _errors(foot: Foot, heading: float) -> tuple[float, float]:
    """Backing up, the tractor points against the path: right of it is then left."""
    error = wrap_pi(heading - foot.direction)
    if abs(error) <= math.pi / 2:
        return foot.cross, error
    return -foot.cross, wrap_pi(error + math.pi)
