"""The headland: laps along the boundary and round the obstacles, and the mainland that they enclose."""

import math
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import MultiPolygon, Polygon

from guidance_app.guidance.request import PlanRequest
from guidance_app.model import FloatArray

__all__ = ["Headland", "Lap", "default_depth", "headland_of", "parts_of", "rounded"]

ARC = 16
"""Chords in a quarter circle of a rounded corner: 7 mm from the circle at a radius of 6 m."""

SMALLEST = 1.0
"""Square metres; smaller leftovers of an offset are not ground."""

SHORTEST = 0.05
"""Metres between neighbouring points of a lap."""


@dataclass(frozen=True, slots=True, eq=False)
class Lap:
    """One ring to drive, closed, its first point not repeated. ``place`` counts from the boundary, from 0."""

    place: int
    points: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Headland:
    """Laps outermost first, the mainland's parts (none when the laps take all), and the depth between."""

    depth: float
    laps: tuple[Lap, ...]
    mainland: tuple[Polygon, ...]


def parts_of(geometry: shapely.Geometry, smallest: float = SMALLEST) -> tuple[Polygon, ...]:
    """The polygons in a geometry, without slivers."""
    return tuple(part for part in shapely.get_parts(geometry) if isinstance(part, Polygon) and part.area > smallest)


def rounded(ground: Polygon | MultiPolygon, radius: float) -> shapely.Geometry:
    """``ground`` without what a circle of ``radius`` inside it cannot reach: its corners become arcs."""
    return ground.buffer(-radius, quad_segs=ARC).buffer(radius, quad_segs=ARC)


def default_depth(request: PlanRequest) -> float:
    """Metres that a square turn needs: radius, half the implement, and what the tractor overruns the pass's end."""
    overrun = max(request.offset_back, 0.0)
    half = max(request.width / 2, request.body.half_width + abs(request.offset_right))
    swing = math.hypot(request.path_radius + half, request.offset_back + request.length / 2)
    return overrun + swing


def headland_of(ground: Polygon, request: PlanRequest) -> Headland:
    """Laps and mainland for the wished turning space, or the space that a turn needs."""
    rest = (request.width - request.spacing) / 2
    count, depth = _count_and_depth(request, rest)
    step = (depth - rest) / count if count else request.spacing
    laps: list[Lap] = []
    for place in range(count):
        laps.extend(_laps_at(ground, place, request.width / 2 + place * step, request.path_radius))
    mainland = parts_of(ground.buffer(-depth, quad_segs=ARC)) if count else (ground,)
    return Headland(depth if count else 0.0, tuple(laps), mainland)


def _count_and_depth(request: PlanRequest, rest: float) -> tuple[int, float]:
    if request.laps is not None:
        return request.laps, request.laps * request.spacing + rest
    if request.turning_space is not None:
        count = math.ceil(max(0.0, request.turning_space - rest) / request.spacing - 1e-6)
        return count, max(request.turning_space, rest)
    count = max(1, math.ceil((default_depth(request) - rest) / request.spacing))
    return count, count * request.spacing + rest


def _laps_at(ground: Polygon, place: int, inset: float, radius: float) -> list[Lap]:
    """The rings at one distance from the boundary, with corners that a circle of ``radius`` can follow."""
    free = rounded(ground.buffer(-inset, quad_segs=ARC), radius)
    return [Lap(place, _ring_points(ring)) for part in parts_of(free) for ring in (part.exterior, *part.interiors)]


def _ring_points(ring: shapely.LinearRing) -> FloatArray:
    points = shapely.get_coordinates(shapely.simplify(ring, 0.005))[:-1]
    apart = np.hypot(*(points - np.roll(points, 1, axis=0)).T)
    kept: FloatArray = points[apart > SHORTEST]
    return kept
