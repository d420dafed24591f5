"""Fixes that the gate refused: single outliers, a step of the receiver's, or a filter that has lost its way.

An outlier is dead-reckoned over, five in a row at most. Four that agree within 15 cm on how far off they are, are a
step of the receiver's. And three that follow each other as a tractor moves, ever farther from what was expected, say
that it is the filter that is wrong: the tractor braked, turned or was stamped with a wrong time.
"""

import math
from dataclasses import dataclass

from guidance_app.estimation.receiver_noise import DEFAULT_CELL
from guidance_app.model import Measurement

__all__ = ["SHARPEST", "Refused", "is_lost", "step_of"]

SHARPEST = 1.0
"""What a driver may do between two fixes, in m/s2, beyond what the motion models foresee."""
DEAD_RECKONED = 5
LOST_FIXES = 3
STEP_FIXES = 4
STEP_SCATTER = 0.15
FASTEST = 20.0


@dataclass(frozen=True, slots=True)
class Refused:
    """A fix that the gate refused, and how far east and north of the expected place it was."""

    z: Measurement
    east: float
    north: float


def is_lost(refused: tuple[Refused, ...]) -> bool:
    """Whether it is the filter that is wrong, by the fixes refused in a row until now."""
    if len(refused) > DEAD_RECKONED:
        return True
    if len(refused) < LOST_FIXES:
        return False
    one, two, three = refused[-LOST_FIXES:]
    first, second = two.z.t - one.z.t, three.z.t - two.z.t
    bend = math.hypot(
        (three.z.east - two.z.east) / second - (two.z.east - one.z.east) / first,
        (three.z.north - two.z.north) / second - (two.z.north - one.z.north) / first,
    )
    speed = math.hypot(three.z.east - one.z.east, three.z.north - one.z.north) / (first + second)
    drawn_away = math.hypot(three.east - one.east, three.north - one.north)
    cell = max(three.z.cell or (DEFAULT_CELL,))
    even = bend * min(first, second) < STEP_SCATTER + 2.0 * cell + 0.5 * SHARPEST * (first + second) ** 2
    return even and speed < FASTEST and drawn_away > STEP_SCATTER + cell


def step_of(refused: tuple[Refused, ...]) -> tuple[float, float] | None:
    """The receiver's step (east, north), if the last four refused fixes agree on one."""
    last = refused[-STEP_FIXES:]
    if len(last) < STEP_FIXES:
        return None
    east = sum(fix.east for fix in last) / STEP_FIXES
    north = sum(fix.north for fix in last) / STEP_FIXES
    agree = all(math.hypot(fix.east - east, fix.north - north) < STEP_SCATTER for fix in last)
    return (east, north) if agree else None
