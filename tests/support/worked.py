"""Worked ground computed exactly and slowly: unions of what an implement sweeps, two polygons at a time."""

import functools
import itertools
import math
from collections.abc import Iterable, Sequence

import numpy as np
import shapely

from guidance_app.guidance.coverage import Coverage
from guidance_app.model import FloatArray

INTERVAL = 0.2
MICROMETRE = 1e-6

Place = tuple[float, float, float]
"""East, north, heading of the implement's middle."""


def union(areas: Iterable[shapely.Geometry]) -> shapely.Geometry:
    """By pairs and on a grid of a micrometre.

    ``shapely.union_all`` loses area on adjacent strips (GEOS 3.11 to 3.14), and without a grid so does ``union`` of
    two polygons that share an edge with rounded corners (a whole strip of 3.8 m2 in one case).
    """
    return functools.reduce(_united, areas, shapely.MultiPolygon())


def _united(one: shapely.Geometry, other: shapely.Geometry) -> shapely.Geometry:
    return _polygons(shapely.union(one, _polygons(other), grid_size=MICROMETRE))


def _polygons(area: shapely.Geometry) -> shapely.MultiPolygon:
    """Without the lines and points that are left where polygons collapse."""
    parts = shapely.get_parts(shapely.get_parts(area))
    return shapely.MultiPolygon([part for part in parts if isinstance(part, shapely.Polygon) and part.area > 0])


def implement_line(place: Place, width: float, low: float = 0.0, high: float = 1.0) -> FloatArray:
    """Shape (2, 2): left and right end of the part of the implement between two fractions of its width."""
    east, north, heading = place
    right = np.array([math.cos(heading), -math.sin(heading)])
    return np.array([(east, north) + (low - 0.5) * width * right, (east, north) + (high - 0.5) * width * right])


def swept(places: Sequence[Place], width: float, low: float = 0.0, high: float = 1.0) -> shapely.Geometry:
    """What the implement sweeps between the places; where its line crosses its last one, both triangles."""
    lines = [implement_line(place, width, low, high) for place in places]
    quads = (shapely.Polygon([one[0], one[1], after[1], after[0]]) for one, after in itertools.pairwise(lines))
    return union(shapely.make_valid(quad) for quad in quads)


def twice(strips: Sequence[shapely.Geometry]) -> shapely.Geometry:
    """Ground that lies in more than one strip."""
    return union(
        shapely.intersection(one, other, grid_size=MICROMETRE) for i, one in enumerate(strips) for other in strips[:i]
    )


def work(
    coverage: Coverage, places: Sequence[Place], start: float, number: int | None = 1, sections: int | None = None
) -> float:
    """Works along the places, one each 0.2 s, and lifts the implement at the last; answers the time after."""
    for i, place in enumerate(places):
        coverage.step(place, start + i * INTERVAL, i < len(places) - 1, number, sections)
    return start + (len(places) + 1) * INTERVAL


def straight(start: tuple[float, float], heading: float, length: float, step: float = 0.5) -> list[Place]:
    """Places every ``step`` metres, the last exactly at the end."""
    along = np.append(np.arange(0.0, length, step), length)
    return [(start[0] + float(s) * math.sin(heading), start[1] + float(s) * math.cos(heading), heading) for s in along]


def bend(start: Place, radius: float, turn: float, step: float = 0.2) -> list[Place]:
    """An arc from a place on, to the right for a positive turn."""
    east, north, heading = start
    side = math.copysign(1.0, turn)
    centre = (east + side * radius * math.cos(heading), north - side * radius * math.sin(heading))
    count = max(2, math.ceil(abs(turn) * radius / step))
    found = []
    for part in np.linspace(0.0, turn, count + 1)[1:]:
        now = heading + float(part)
        found.append((centre[0] - side * radius * math.cos(now), centre[1] + side * radius * math.sin(now), now))
    return found
