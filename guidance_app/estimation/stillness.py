"""Does the tractor stand? From the receiver's speed where there is one, else from fixes that stay where they are.

A speed below 0.12 m/s for half a second is standing (receivers creep by some centimetres a second at rest); one
reading above it does not end that, unless it is above 0.25 m/s. Fixes alone say less: those that stay within one cell
for a time bound the speed by cell over time, and that is what is passed on.
"""

import math
from dataclasses import dataclass

from guidance_app.estimation.receiver_noise import DEFAULT_CELL
from guidance_app.model import Measurement
from guidance_app.model.making import made_quickly

__all__ = ["Stillness"]

SLOW = 0.12
OFF = 0.25
SLOW_FOR = 0.5
HELD_FOR = 1.0
STANDING_SD = 0.01
"""How still, in m/s, a tractor is whose receiver says that it stands."""


@made_quickly
@dataclass(frozen=True, slots=True)
class Stillness:
    """Since when the fix has stayed where it is, and since when the receiver's speed has been low. Times are ``t``."""

    east: float
    north: float
    held_since: float
    slow_since: float | None
    quick: int = 0

    @staticmethod
    def of(z: Measurement) -> "Stillness":
        """At the first measurement."""
        return Stillness(z.east, z.north, z.t, z.t if z.speed is not None and z.speed < SLOW else None)

    def after(self, z: Measurement, white: float) -> "Stillness":
        """With one more measurement, whose white scatter is ``white`` metres."""
        slow_since, quick = self._slow_since(z)
        cell_east, cell_north = z.cell or (DEFAULT_CELL, DEFAULT_CELL)
        reach = 3.0 * white
        held = abs(z.east - self.east) < cell_east / 2 + reach and abs(z.north - self.north) < cell_north / 2 + reach
        if held:
            return Stillness(self.east, self.north, self.held_since, slow_since, quick)
        return Stillness(z.east, z.north, z.t, slow_since, quick)

    def repeats(self, z: Measurement) -> bool:
        """Whether this is the very fix that has been held: nothing new if the tractor stands."""
        return self.held_since < z.t and (self.east, self.north) == (z.east, z.north)

    def speed_bound(self, z: Measurement, white: float) -> float | None:
        """Standard deviation of the speed about zero, in m/s; None while the tractor is not known to stand."""
        if z.speed is not None:
            stands = self.slow_since is not None and z.t - self.slow_since >= SLOW_FOR
            return STANDING_SD if stands else None
        held = z.t - self.held_since
        if held < HELD_FOR:
            return None
        return (max(z.cell or (DEFAULT_CELL,)) + 6.0 * white) / (held * math.sqrt(3.0))

    def _slow_since(self, z: Measurement) -> tuple[float | None, int]:
        """Since when the speed is low, and how many readings in a row were not."""
        if z.speed is None or z.speed >= OFF:
            return None, 0
        if z.speed < SLOW:
            return (z.t if self.slow_since is None else self.slow_since), 0
        quick = self.quick + 1
        return (self.slow_since if quick < 2 else None), quick
