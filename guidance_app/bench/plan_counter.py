"""The counter of worked ground, driven along a plan, against the exact union of what the implement swept.

The union is made two polygons at a time: ``shapely.union_all`` loses ground between adjacent strips.
"""

import functools
import math
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from guidance_app.bench.plan_cases import line_of
from guidance_app.bench.rows import Row
from guidance_app.guidance.coverage import Coverage
from guidance_app.guidance.planning import PlanRequest, plan_operation
from guidance_app.model import FloatArray, Plan

__all__ = ["counter_row"]

STEP = 1.0
"""Metres between two fixes."""

SPEED = 2.0
GRID = 1e-6
REQUEST = PlanRequest(width=6.0)


def counter_row(name: str, polygon: shapely.Polygon) -> Row:
    """By how much the counter is wrong on one field's plan."""
    plan = plan_operation(polygon, REQUEST)
    coverage, t = Coverage(REQUEST.width), 0.0
    for number, places in enumerate(_drives(plan)):
        for place, (east, north, heading) in enumerate(places.tolist()):
            coverage.step((east, north, heading), t, place < len(places) - 1, number)
            t += STEP / SPEED
    exact = functools.reduce(_united, (_swept(places) for places in _drives(plan))).area
    counted = coverage.totals.worked
    return Row(
        "plan",
        "worked-area counter against the exact union",
        abs(counted - exact) / exact,
        "",
        "<= 0.001",
        f"{name}: {counted:.0f} of {exact:.0f} m2",
    )


def _drives(plan: Plan) -> Iterator[FloatArray]:
    """For each pass and lap the implement's places (N, 3): east, north, heading."""
    for each in plan.segments:
        if each.implement_down:
            points = shapely.get_coordinates(line_of(each).segmentize(STEP))
            ahead = np.diff(points, axis=0)
            heading = np.arctan2(ahead[:, 0], ahead[:, 1])
            yield np.column_stack([points, np.append(heading, heading[-1])])


def _swept(places: FloatArray) -> BaseGeometry:
    """The quadrilaterals between neighbouring places, both triangles where the implement's line crosses its last."""
    east, north, heading = places.T
    half = 0.5 * REQUEST.width
    aside = half * np.column_stack([np.cos(heading), -np.sin(heading)])
    middles = np.column_stack([east, north])
    left, right = middles - aside, middles + aside
    corners = np.stack([left[:-1], right[:-1], right[1:], left[1:]], axis=1)
    return _pairwise([shapely.make_valid(shapely.Polygon(quad)) for quad in corners])


def _pairwise(areas: Sequence[BaseGeometry]) -> BaseGeometry:
    """The union, neighbours first."""
    if len(areas) == 1:
        return areas[0]
    middle = math.ceil(len(areas) / 2)
    return _united(_pairwise(areas[:middle]), _pairwise(areas[middle:]))


def _united(one: BaseGeometry, other: BaseGeometry) -> BaseGeometry:
    joined = shapely.union(_areas(one), _areas(other), grid_size=GRID)
    assert isinstance(joined, BaseGeometry)
    return joined


def _areas(geometry: BaseGeometry) -> BaseGeometry:
    parts = [part for part in shapely.get_parts(geometry) if isinstance(part, shapely.Polygon)]
    return shapely.MultiPolygon(parts)
