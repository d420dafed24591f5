"""A path between any two places of a field that never leaves it, however it bends: the last resort, always flagged.

From a place straight to the nearest boundary, along that boundary, over to another ring where the two come closest,
and from the boundary straight to the other place: none of these pieces can cross a ring.
"""

import itertools

import numpy as np
import shapely
import shapely.ops
from shapely import LineString, Polygon

from guidance_app.model import FloatArray

__all__ = ["Detour"]

INSIDE = 0.1
"""Metres from the boundary at which a detour runs."""


class Detour:
    """Detours in one field."""

    def __init__(self, polygon: Polygon) -> None:
        self._polygon = polygon
        self._rings: list[LineString] | None = None
        self._bridges: dict[int, list[tuple[int, FloatArray]]] = {}

    def path(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """Points (N, 2) from ``start`` to ``end``, both inside."""
        straight = np.array([start, end])
        if self._polygon.covers(LineString(straight)):
            return straight
        rings = self._prepared()
        first, last = (self._nearest(place) for place in (start, end))
        stops = [np.array(start), first[1]]
        here = first
        for bridge in self._route(first[0], last[0]):
            stops.append(_along(rings[here[0]], here[1], bridge[1][0]))
            here = (bridge[0], bridge[1][1])
            stops.append(here[1])
        stops.append(_along(rings[here[0]], here[1], last[1]))
        stops.append(np.array(end))
        points = np.vstack([np.atleast_2d(stop) for stop in stops])
        apart = np.hypot(*np.diff(points, axis=0).T)
        return points[np.concatenate([[True], apart > 1e-6])]

    def _prepared(self) -> list[LineString]:
        if self._rings is None:
            inner = self._polygon.buffer(-INSIDE)
            parts = shapely.get_parts(inner)
            largest = parts[int(np.argmax(shapely.area(parts)))] if len(parts) else self._polygon
            self._rings = [LineString(ring) for ring in (largest.exterior, *largest.interiors)]
            self._bridges = _bridges(self._rings)
        return self._rings

    def _nearest(self, place: FloatArray) -> tuple[int, FloatArray]:
        rings = self._prepared()
        point = shapely.Point(place)
        ring = int(np.argmin([line.distance(point) for line in rings]))
        on_ring = shapely.ops.nearest_points(rings[ring], point)[0]
        return ring, np.array(on_ring.coords[0])

    def _route(self, first: int, last: int) -> list[tuple[int, FloatArray]]:
        """Bridges from ring to ring: the ring reached, and the two ends (2, 2)."""
        paths: list[tuple[int, list[tuple[int, FloatArray]]]] = [(first, [])]
        seen = {first}
        while paths:
            ring, path = paths.pop(0)
            if ring == last:
                return path
            for other, ends in self._bridges.get(ring, []):
                if other not in seen:
                    seen.add(other)
                    paths.append((other, [*path, (other, ends)]))
        return []


def _bridges(rings: list[LineString]) -> dict[int, list[tuple[int, FloatArray]]]:
    """The shortest lines that join all rings (a minimum spanning tree); no other ring lies between their ends."""
    apart = sorted((rings[a].distance(rings[b]), a, b) for a, b in itertools.combinations(range(len(rings)), 2))
    group = list(range(len(rings)))
    bridges: dict[int, list[tuple[int, FloatArray]]] = {}
    for _, a, b in apart:
        if group[a] == group[b]:
            continue
        ends = np.array([point.coords[0] for point in shapely.ops.nearest_points(rings[a], rings[b])])
        bridges.setdefault(a, []).append((b, ends))
        bridges.setdefault(b, []).append((a, ends[::-1]))
        old, new = group[b], group[a]
        group = [new if each == old else each for each in group]
    return bridges


def _along(ring: LineString, start: FloatArray, end: FloatArray) -> FloatArray:
    """Points of a ring from one place on it to another, the shorter way round."""
    low, high = (ring.project(shapely.Point(place)) for place in (start, end))
    inner = shapely.get_coordinates(shapely.ops.substring(ring, min(low, high), max(low, high)))
    if abs(high - low) > ring.length / 2:
        outer = [
            shapely.get_coordinates(shapely.ops.substring(ring, max(low, high), ring.length)),
            shapely.get_coordinates(shapely.ops.substring(ring, 0.0, min(low, high))),
        ]
        way = np.vstack(outer)
        return way if high < low else way[::-1]
    return inner if high >= low else inner[::-1]
