"""The readings of attitude of the last moments, so that each fix gets those that are nearest to it in time.

A sensor on a link of its own is not in step with the fixes, and a fix is known only when its last sentence has come:
the newest reading may be a tenth of a second younger than the fix. Sensors also say one thing a sentence (heading in
one, roll and pitch in the next), so each quantity is taken from the nearest reading that holds it.
"""

from collections import deque
from collections.abc import Callable

from guidance_app.model import Attitude

__all__ = ["Attitudes"]

KEPT_S = 2.0
NEAR_S = 1.0
"""A reading farther than this from a fix says nothing about it."""

MOST_KEPT = 1000
"""Readings of two seconds at five times the highest rate that sensors speak text at."""


class Attitudes:
    """Remembers two seconds of readings."""

    def __init__(self) -> None:
        self._kept: deque[Attitude] = deque(maxlen=MOST_KEPT)

    def fork(self) -> "Attitudes":
        """An independent copy."""
        other = Attitudes()
        other._kept = self._kept.copy()
        return other

    def take(self, reading: Attitude) -> None:
        """Remembers one more."""
        self._kept.append(reading)
        while self._kept[0].arrival < reading.arrival - KEPT_S:
            self._kept.popleft()

    def at(self, arrival: float) -> Attitude | None:
        """What was read nearest to this session time, quantity by quantity; None when nothing was read near it."""
        near = (one for one in self._kept if abs(one.arrival - arrival) <= NEAR_S)
        readings = sorted(near, key=lambda one: abs(one.arrival - arrival))
        if not readings:
            return None

        def nearest(member: Callable[[Attitude], float | None]) -> float | None:
            return next((value for one in readings if (value := member(one)) is not None), None)

        return Attitude(
            arrival=readings[0].arrival,
            t=readings[0].t,
            heading=nearest(lambda one: one.heading),
            roll=nearest(lambda one: one.roll),
            pitch=nearest(lambda one: one.pitch),
            roll_rate=nearest(lambda one: one.roll_rate),
            pitch_rate=nearest(lambda one: one.pitch_rate),
            yaw_rate=nearest(lambda one: one.yaw_rate),
            link=readings[0].link,
        )
