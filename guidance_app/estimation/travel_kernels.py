"""The numeric part of ``travel``: the way's memory as one array, and what a fix does to it. Compiled by numba."""

import math

import numba
import numpy as np

from guidance_app import angles
from guidance_app.estimation.observation_kernels import NO_COURSE
from guidance_app.model import FloatArray

__all__ = ["KEPT", "REVERSE", "TRAVEL", "WAY_HEADING", "nothing_driven", "travelled", "wrap_2pi", "wrap_pi"]

BASELINE = 1.0
"""A heading is read over at least this many metres."""
SPACING = 0.1
"""Fixes nearer to the last kept one than this tell nothing new about the direction."""
REVERSAL = math.radians(110)
LONGEST_BACKING = 30.0
MOST_POINTS = 64

WAY_HEADING, REVERSE, BACKED, SEEN, BEFORE_LAST, LAST, KEPT, POINTS = 0, 1, 2, 3, 4, 6, 8, 9
"""The body's heading or ``NO_COURSE``; 1 when it backs up; the metres backed; how many fixes there were (2 at most);
the last two (east, north); how many medians are kept; and those, east and north in turn."""
TRAVEL = POINTS + 2 * MOST_POINTS

wrap_pi = numba.njit(cache=True)(angles.wrap_pi)
wrap_2pi = numba.njit(cache=True)(angles.wrap_2pi)


@numba.njit(cache=True)
def nothing_driven() -> FloatArray:
    """The memory before the first fix, shape (137,)."""
    memory = np.zeros(TRAVEL)
    memory[WAY_HEADING] = NO_COURSE
    return memory


@numba.njit(cache=True)
def _middle(a: float, b: float, c: float) -> float:
    return max(min(a, b), min(max(a, b), c))


@numba.njit(cache=True)
def travelled(memory: FloatArray, east: float, north: float, compass: float) -> None:
    """Takes one more fix, in place; ``compass`` is a measured heading of the body or ``NO_COURSE``."""
    seen = memory[SEEN]
    here_east = _middle(memory[BEFORE_LAST], memory[LAST], east)
    here_north = _middle(memory[BEFORE_LAST + 1], memory[LAST + 1], north)
    memory[BEFORE_LAST], memory[BEFORE_LAST + 1] = memory[LAST], memory[LAST + 1]
    memory[LAST], memory[LAST + 1] = east, north
    memory[SEEN] = min(seen + 1.0, 2.0)
    if compass != NO_COURSE:
        memory[WAY_HEADING] = compass
    kept = int(memory[KEPT])
    step = 0.0
    if kept > 0:
        newest = POINTS + 2 * (kept - 1)
        step = math.hypot(here_east - memory[newest], here_north - memory[newest + 1])
    if seen < 2.0 or (kept > 0 and step < SPACING):
        return
    memory[BACKED] = memory[BACKED] + step if memory[REVERSE] == 1.0 else 0.0
    far = _baseline(memory, here_east, here_north)
    if far >= 0:
        start = POINTS + 2 * far
        _turn(memory, wrap_2pi(math.atan2(here_east - memory[start], here_north - memory[start + 1])), compass)
    _keep(memory, max(far, kept + 1 - MOST_POINTS, 0), here_east, here_north)


@numba.njit(cache=True)
def _baseline(memory: FloatArray, east: float, north: float) -> int:
    """The newest kept point that is a baseline away; -1 for none."""
    for k in range(int(memory[KEPT]) - 1, -1, -1):
        at = POINTS + 2 * k
        if math.hypot(east - memory[at], north - memory[at + 1]) >= BASELINE:
            return k
    return -1


@numba.njit(cache=True)
def _keep(memory: FloatArray, first: int, east: float, north: float) -> None:
    """Adds a point and forgets those before ``first``, in place."""
    left = int(memory[KEPT]) - first
    for k in range(2 * left):
        memory[POINTS + k] = memory[POINTS + 2 * first + k]
    memory[POINTS + 2 * left], memory[POINTS + 2 * left + 1] = east, north
    memory[KEPT] = left + 1


@numba.njit(cache=True)
def _turn(memory: FloatArray, course: float, compass: float) -> None:
    """Heading, reverse and metres backed with a new baseline's direction, in place."""
    if compass != NO_COURSE:
        memory[REVERSE], memory[BACKED] = abs(wrap_pi(course - compass)) > math.pi / 2, 0.0
        return
    if memory[BACKED] > LONGEST_BACKING:
        memory[WAY_HEADING], memory[REVERSE], memory[BACKED] = course, 0.0, 0.0
        return
    reverse = memory[REVERSE] == 1.0
    body = wrap_2pi(course + math.pi) if reverse else course
    if memory[WAY_HEADING] != NO_COURSE and abs(wrap_pi(body - memory[WAY_HEADING])) > REVERSAL:
        reverse = not reverse
        body = wrap_2pi(body + math.pi)
    memory[WAY_HEADING], memory[REVERSE] = body, reverse
    if not reverse:
        memory[BACKED] = 0.0
