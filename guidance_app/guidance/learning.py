"""What was driven while working, pass by pass: for guidance along the last pass.

A pass begins when the implement is lowered. It ends when the tractor turns away with the implement lifted, or turns
round with the implement down; lifting it for a moment on the way does not end it.
"""

import copy
import math

import numpy as np

from guidance_app.angles import wrap_pi
from guidance_app.guidance.reading import Seen
from guidance_app.model import FloatArray

__all__ = ["DrivenPass"]

POINT_EVERY = 0.5
"""Metres between the points that are kept."""

SHORTEST = 10.0
"""Metres; less is not a pass."""

MOST_POINTS = 20_000
"""A pass of more is cut there: bounded memory."""

TURNED_AWAY = math.radians(60)
"""Turned so far from the end of the work, the tractor has left the pass."""

TURNED_ROUND = math.radians(110)
"""Turned so far within ``REACH`` metres, with the implement down, the pass ended before the turn."""

REACH = 20.0
STRAIGHT = math.radians(45)
"""Of a turn, all that points farther than this from the pass is cut off."""


class DrivenPass:
    """Collects the pass being driven. ``key`` is that of the pass it was driven on, None for the first."""

    def __init__(self) -> None:
        self.key: int | None = None
        self._points: list[tuple[float, float, float]] = []

    def fork(self) -> "DrivenPass":
        """An independent copy."""
        other = copy.copy(self)
        other._points = list(self._points)  # noqa: SLF001 - its own class
        return other

    def step(self, seen: Seen, key: int | None) -> FloatArray | None:
        """The pass, shape (N, 2) in the direction driven, at the epoch at which it has ended; else None."""
        if seen.working and seen.heading_known:
            self._append(seen, key)
        if not self._points:
            return None
        if not seen.working and abs(wrap_pi(seen.heading - self._points[-1][2])) > TURNED_AWAY:
            return self._ended()
        if seen.working and self._turned_round():
            return self._ended()
        return None

    def _append(self, seen: Seen, key: int | None) -> None:
        if not self._points:
            self.key = key
        elif math.dist(self._points[-1][:2], (seen.east, seen.north)) < POINT_EVERY:
            return
        if len(self._points) < MOST_POINTS:
            self._points.append((seen.east, seen.north, seen.heading))

    def _turned_round(self) -> bool:
        back = self._points[-1 - min(int(REACH / POINT_EVERY), len(self._points) - 1)]
        return abs(wrap_pi(self._points[-1][2] - back[2])) > TURNED_ROUND

    def _ended(self) -> FloatArray | None:
        points = np.array(self._points)
        self._points = []
        points = points[_without_turns(points[:, 2])]
        if len(points) < 2 or np.hypot(*np.diff(points[:, :2], axis=0).T).sum() < SHORTEST:
            return None
        return np.ascontiguousarray(points[:, :2])


def _without_turns(headings: FloatArray) -> slice:
    """Cuts off, at both ends, what points away from the pass as it is a little farther in."""
    reach = min(int(REACH / POINT_EVERY), len(headings) // 2)
    first, last = 0, len(headings)
    while last > reach and abs(wrap_pi(headings[last - 1] - headings[-1 - reach])) > STRAIGHT:
        last -= 1
    while first < last - 1 and abs(wrap_pi(headings[first] - headings[reach])) > STRAIGHT:
        first += 1
    return slice(first, last)
