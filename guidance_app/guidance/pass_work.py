"""What of a pass has been driven by, and what of that was left out: metres along it, by its implement.

A stretch that is worked when the tractor comes again is no longer left out, whichever way it is driven.
"""

import copy

import numpy as np

from guidance_app.guidance.progress import Progress, driven_stretches
from guidance_app.model import Guidance, Pass

__all__ = ["PassWork"]

EVERY = 0.5
"""Metres that are awaited before they are counted, unless the implement is lowered or lifted."""


class PassWork:
    """Remembers two unions of stretches a pass: driven along, and worked. ``behind`` is as the tracker's."""

    def __init__(self, behind: float = 0.0) -> None:
        self._behind = behind
        self._driven = Progress()
        self._worked = Progress()
        self._keys: dict[tuple[int, float], int] = {}
        self._target: Pass | None = None
        self._key = 0
        self._length = 0.0
        self._last: float | None = None
        self._was_working = False

    def fork(self) -> "PassWork":
        """An independent copy."""
        other = copy.copy(self)
        vars(other).update(_driven=self._driven.fork(), _worked=self._worked.fork(), _keys=dict(self._keys))
        return other

    def step(self, guidance: Guidance | None, *, working: bool) -> None:
        """One epoch further. A jump, a turn and a way beside the pass leave nothing out."""
        if guidance is None or not guidance.on_pass:
            self._last = None
            return
        if guidance.target is not self._target:
            self._begin(guidance.target)
        place = self._place(guidance)
        if self._last is not None:
            if abs(place - self._last) < EVERY and working == self._was_working:
                return
            for start, end in driven_stretches(self._last, place, self._length, closed=guidance.target.closed):
                self._driven.add(self._key, start, end)
                if self._was_working:
                    self._worked.add(self._key, start, end)
        self._last, self._was_working = place, working

    @property
    def missed(self) -> float:
        """Metres of the present pass that were driven along and not worked."""
        return max(self._driven.worked(self._key) - self._worked.worked(self._key), 0.0)

    def _begin(self, target: Pass) -> None:
        """A pass that was cut short when the rest was planned again counts as another one."""
        points = np.vstack([target.points, target.points[:1]]) if target.closed else target.points
        self._length = float(np.hypot(*np.diff(points, axis=0).T).sum())
        self._key = self._keys.setdefault((target.number, round(self._length, 2)), len(self._keys))
        self._target, self._last = target, None

    def _place(self, guidance: Guidance) -> float:
        """Metres along the pass as planned, of the implement."""
        along = guidance.along_track - self._behind
        if guidance.target.closed:
            along %= self._length
        elif not guidance.target.endless:
            along = min(max(along, 0.0), self._length)
        return self._length - along if guidance.against else along
