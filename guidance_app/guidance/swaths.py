"""The ground that tasks work: one polygon for each, and their union.

``shapely.union_all`` loses ground between adjacent strips (GEOS 3.11 to 3.14), unless a grid is given, and then takes
two to four times as long. A buffer of nothing round all of them together loses none.
"""

from collections.abc import Sequence

import shapely
from shapely.geometry.base import BaseGeometry

from guidance_app.guidance.task import Task

__all__ = ["swath", "united", "unworked", "without_slivers"]

GRID = 1e-4
"""Metres to which corners are snapped where ground is taken from ground; without it GEOS fails on some swaths."""

FLAT = 0.01
"""Metres to which a lap's line is smoothed before its swath is made: a union takes the longer the more points."""

ARC = 8
"""Chords in a quarter circle where a swath bends."""


def swath(task: Task, width: float) -> BaseGeometry:
    """What one task works, with square ends."""
    line = shapely.linearrings(task.points) if task.closed else shapely.linestrings(task.points)
    worked = shapely.buffer(shapely.simplify(line, FLAT), width / 2, cap_style="flat", quad_segs=ARC)
    assert isinstance(worked, BaseGeometry)
    return worked


def united(swaths: Sequence[BaseGeometry]) -> BaseGeometry:
    """The ground worked once or more often."""
    together = shapely.buffer(shapely.multipolygons(shapely.get_parts(list(swaths))), 0.0)
    assert isinstance(together, BaseGeometry)
    return together


def unworked(ground: BaseGeometry, worked: BaseGeometry) -> BaseGeometry:
    """The ground that is left."""
    left = shapely.difference(ground, worked, grid_size=GRID)
    assert isinstance(left, BaseGeometry)
    return left


def without_slivers(ground: BaseGeometry, sliver: float) -> BaseGeometry:
    """The ground without what is narrower than twice ``sliver`` metres."""
    wide = shapely.buffer(ground, -sliver, join_style="mitre")
    return wide.buffer(sliver, join_style="mitre")
