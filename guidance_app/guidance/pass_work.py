"""What of a pass has been driven by, and what of that was left out: metres along it, by its implement.

A stretch that is worked when the tractor comes again is no longer left out, whichever way it is driven. Each section
of the implement counts for itself, by the strip of the pass that it runs on.
"""

import copy

import numpy as np

from guidance_app.guidance.progress import Progress, driven_stretches
from guidance_app.model import Guidance, Pass

__all__ = ["PassWork"]

EVERY = 0.5
"""Metres that are awaited before they are counted, unless the implement is lowered or lifted."""


class PassWork:
    """Remembers unions of stretches a pass: driven along, and worked by strip. ``behind`` is as the tracker's."""

    def __init__(self, behind: float = 0.0, sections: int = 1) -> None:
        self._behind = behind
        self._sections = sections
        self._driven = Progress()
        self._worked = Progress()
        self._keys: dict[tuple[int, float], int] = {}
        self._target: Pass | None = None
        self._key = 0
        self._length = 0.0
        self._last: float | None = None
        self._were_on = 0

    def fork(self) -> "PassWork":
        """An independent copy."""
        other = copy.copy(self)
        vars(other).update(_driven=self._driven.fork(), _worked=self._worked.fork(), _keys=dict(self._keys))
        return other

    def step(self, guidance: Guidance | None, sections_on: int) -> None:
        """One epoch further. A jump, a turn and a way beside the pass leave nothing out.

        Bit 0 of ``sections_on`` is the leftmost section; 0 when the implement is lifted.
        """
        if guidance is None or not guidance.on_pass:
            self._last = None
            return
        if guidance.target is not self._target:
            self._begin(guidance.target)
        place = self._place(guidance)
        if self._last is not None:
            if abs(place - self._last) < EVERY and sections_on == self._were_on:
                return
            strips = self._strips(against=guidance.against)
            for start, end in driven_stretches(self._last, place, self._length, closed=guidance.target.closed):
                self._driven.add(self._key, start, end)
                for strip in strips:
                    self._worked.add(strip, start, end)
        self._last, self._were_on = place, sections_on

    def _strips(self, *, against: bool) -> list[int]:
        """Keys of the strips that were worked until now; on the way back the leftmost section runs on the last one."""
        first, last = self._key * self._sections, self._sections - 1
        on = (place for place in range(self._sections) if self._were_on >> place & 1)
        return [first + (last - place if against else place) for place in on]

    @property
    def missed(self) -> float:
        """Metres of the present pass that were driven along and not worked; a strip's count for its share."""
        driven, first = self._driven.worked(self._key), self._key * self._sections
        lacking = (driven - self._worked.worked(first + strip) for strip in range(self._sections))
        return sum(max(metres, 0.0) for metres in lacking) / self._sections

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
