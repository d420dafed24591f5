"""Angles: wrapping, and the two conventions of the project.

A **heading** turns clockwise from true north, as a compass does; everything but the scene speaks headings. A **yaw**
turns counter-clockwise from east, as a mathematician's angle does; only the scene needs it. Nothing else in the
package knows pi/2. All angles are radians.
"""

import math
from collections.abc import Iterable

__all__ = [
    "east_north",
    "heading_between",
    "heading_from_yaw",
    "mean_heading",
    "wrap_2pi",
    "wrap_pi",
    "yaw_from_heading",
]


def wrap_pi(angle: float) -> float:
    """The same direction in [-pi, pi): the form for differences and innovations."""
    return (angle + math.pi) % math.tau - math.pi


def wrap_2pi(angle: float) -> float:
    """The same direction in [0, 2 pi): the form for headings that a person reads."""
    wrapped = angle % math.tau
    return 0.0 if wrapped >= math.tau else wrapped


def yaw_from_heading(heading: float) -> float:
    """Counter-clockwise from east, from clockwise from north."""
    return wrap_pi(math.pi / 2 - heading)


def heading_from_yaw(yaw: float) -> float:
    """Clockwise from north in [0, 2 pi), from counter-clockwise from east."""
    return wrap_2pi(math.pi / 2 - yaw)


def east_north(heading: float) -> tuple[float, float]:
    """The unit vector (east, north) that points along ``heading``."""
    return math.sin(heading), math.cos(heading)


def heading_between(start: tuple[float, float], end: tuple[float, float]) -> float:
    """Heading in [0, 2 pi) from ``start`` to ``end``, both (east, north); 0 when they coincide."""
    return wrap_2pi(math.atan2(end[0] - start[0], end[1] - start[1]))


def mean_heading(headings: Iterable[float]) -> float | None:
    """Circular mean in [0, 2 pi); None for no headings or headings that cancel out."""
    east = north = 0.0
    for heading in headings:
        east += math.sin(heading)
        north += math.cos(heading)
    if math.hypot(east, north) < 1e-9:
        return None
    return wrap_2pi(math.atan2(east, north))
