"""Whether the ground between two epochs was driven, or the position jumped.

More than 5 m between epochs is a jump when the fixes stayed away (2 s, or two and a half usual intervals) or when it
would have needed more than 15 m/s; a receiver of 1 Hz on a tractor at 25 km/h moves 7 m an epoch without a jump.
What is no number, or lies farther from the field than a field frame reaches, is no place at all.
"""

import math
from dataclasses import dataclass

from guidance_app.geodesy import MAX_REACH

__all__ = ["Continuity", "is_place"]

JUMP = 5.0
"""Shorter moves never count as a jump."""

FASTEST = 15.0
"""No field work is faster, in m/s."""

OUTAGE = 2.0
"""Seconds without a fix after which a long move is a jump, for a receiver of 1 Hz or more."""

OUTAGE_INTERVALS = 2.5
"""The same in usual intervals, for a slower receiver."""

LONGEST_INTERVAL = 10.0
"""Seconds; epochs farther apart are never usual."""


def is_place(east: float, north: float, *others: float) -> bool:
    """Whether this is a position of the field; whatever else comes with it has to be finite too."""
    return abs(east) <= MAX_REACH and abs(north) <= MAX_REACH and all(map(math.isfinite, others))


@dataclass(slots=True)
class Continuity:
    """Remembers the last epoch. A plain copy of it is independent."""

    t: float | None = None
    east: float = 0.0
    north: float = 0.0
    interval: float = 0.0

    def step(self, t: float, east: float, north: float) -> bool:
        """True when the way from the last epoch to this one was driven; False at a jump and at the first epoch."""
        before = self.t
        seconds = 0.0 if before is None else t - before
        distance = math.hypot(east - self.east, north - self.north)
        self.t, self.east, self.north = t, east, north
        if before is None or seconds < 0:
            return False
        outage = seconds > (max(OUTAGE, OUTAGE_INTERVALS * self.interval) if self.interval else LONGEST_INTERVAL)
        if seconds > 0:
            usual = min(seconds, LONGEST_INTERVAL)
            self.interval += (usual - self.interval) * (0.1 if self.interval else 1.0)
        if distance <= JUMP:
            return True
        return not outage and distance <= FASTEST * seconds
