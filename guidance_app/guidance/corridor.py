"""The shortest path between two places of a polygon with holes: a taut string.

The polygon is cut into triangles once; a path crosses them from neighbour to neighbour (A*), and the string pulled
tight through the crossed edges bends only at corners that stick into the ground. Where those corners are arcs of the
turning radius, the whole string can be driven.
"""

import heapq
import itertools
import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely import Polygon

from guidance_app.model import FloatArray

__all__ = ["Corridor"]

KEY = 1e-6
"""Metres to which corners are rounded when triangles are matched."""

_Point = tuple[float, float]


class Corridor:
    """Shortest paths in one polygon."""

    def __init__(self, ground: Polygon) -> None:
        triangles = list(shapely.get_parts(shapely.constrained_delaunay_triangles(ground)))
        self._tree = shapely.STRtree(triangles)
        self._corners = [_corners(part) for part in triangles]
        self._middles = [(float(part.centroid.x), float(part.centroid.y)) for part in triangles]
        self._beside = _neighbours(self._corners)

    def path(self, start: FloatArray, end: FloatArray) -> FloatArray | None:
        """Points (N, 2) from ``start`` to ``end``; None where the ground does not connect them.

        A place outside is taken into the nearest triangle.
        """
        if not len(self._corners):
            return None
        first, last = (int(self._tree.nearest(shapely.Point(place))) for place in (start, end))
        crossed = self._crossed(first, last, _point(start), _point(end))
        if crossed is None:
            return None
        gates = [self._gate(here, there) for here, there in itertools.pairwise(crossed)]
        return np.array(_pulled(_point(start), gates, _point(end)))

    def _crossed(self, first: int, last: int, start: _Point, end: _Point) -> list[int] | None:
        """Triangles from the first to the last; the way is measured over the middles of the edges crossed."""
        best = {first: 0.0}
        came: dict[int, int] = {}
        at = {first: start}
        waiting = [(math.dist(start, end), first)]
        closed: set[int] = set()
        while waiting:
            _, here = heapq.heappop(waiting)
            if here == last:
                way = [here]
                while way[-1] in came:
                    way.append(came[way[-1]])
                return way[::-1]
            if here in closed:
                continue
            closed.add(here)
            for there, (one, other) in self._beside[here].items():
                middle = ((one[0] + other[0]) / 2, (one[1] + other[1]) / 2)
                cost = best[here] + math.dist(at[here], middle)
                if cost < best.get(there, math.inf):
                    best[there], came[there], at[there] = cost, here, middle
                    heapq.heappush(waiting, (cost + math.dist(middle, end), there))
        return None

    def _gate(self, here: int, there: int) -> tuple[_Point, _Point]:
        """The edge between two triangles: its left end and its right end, seen by who crosses it."""
        one, other = self._beside[here][there]
        return (other, one) if _area(self._middles[here], one, other) > 0 else (one, other)


def _corners(triangle: Polygon) -> tuple[_Point, _Point, _Point]:
    first, second, third = (_point(corner) for corner in shapely.get_coordinates(triangle)[:3])
    return first, second, third


def _point(place: FloatArray) -> _Point:
    return float(place[0]), float(place[1])


def _neighbours(triangles: Sequence[tuple[_Point, _Point, _Point]]) -> list[dict[int, tuple[_Point, _Point]]]:
    """For each triangle those that share an edge with it, and the edge."""
    beside: list[dict[int, tuple[_Point, _Point]]] = [{} for _ in triangles]
    edges: dict[frozenset[tuple[int, int]], int] = {}
    for place, corners in enumerate(triangles):
        for one, other in ((0, 1), (1, 2), (2, 0)):
            edge = frozenset((round(x / KEY), round(y / KEY)) for x, y in (corners[one], corners[other]))
            partner = edges.setdefault(edge, place)
            if partner != place:
                beside[place][partner] = beside[partner][place] = (corners[one], corners[other])
    return beside


def _pulled(start: _Point, gates: Sequence[tuple[_Point, _Point]], end: _Point) -> list[_Point]:
    """The string from start to end pulled tight through the gates (funnel algorithm, Lee and Preparata 1984)."""
    doors = [*gates, (end, end)]
    path = [start]
    apex, left, right = start, start, start
    left_at = right_at = -1
    place = 0
    while place < len(doors):
        new_left, new_right = doors[place]
        if _area(apex, right, new_right) >= 0:
            if apex == right or _area(apex, left, new_right) < 0:
                right, right_at = new_right, place
            else:
                path.append(left)
                apex, place = left, left_at
                left = right = apex
                right_at = left_at
                place += 1
                continue
        if _area(apex, left, new_left) <= 0:
            if apex == left or _area(apex, right, new_left) > 0:
                left, left_at = new_left, place
            else:
                path.append(right)
                apex, place = right, right_at
                left = right = apex
                left_at = right_at
                place += 1
                continue
        place += 1
    path.append(end)
    return [point for number, point in enumerate(path) if number == 0 or math.dist(point, path[number - 1]) > KEY]


def _area(origin: _Point, one: _Point, other: _Point) -> float:
    """Twice the signed area; positive when ``other`` lies left of the line from ``origin`` to ``one``."""
    return (one[0] - origin[0]) * (other[1] - origin[1]) - (one[1] - origin[1]) * (other[0] - origin[0])
