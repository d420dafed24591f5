"""Short passes for what laps and strips leave: corners that their lap cuts, tips, the rooms between.

A piece of ground gets one stroke after another, each the one that works most of it, along one of its edges. A stroke
runs as far as the whole machine stays inside. In a corner it is driven outward only: driving in, the tractor's front
would reach the boundary long before the implement does.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from guidance_app.guidance.bundle import Bundle
from guidance_app.guidance.clearance import parts_of
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.room import BoolArray, Room
from guidance_app.guidance.swaths import without_slivers
from guidance_app.model import FloatArray

__all__ = ["strokes"]

Swaths = NDArray[np.object_]

GRID = 1e-3
"""Metres to which corners of what is left are snapped, so that no difference of differences fails."""

SLIVER = 0.06
"""Working widths; what is narrower than twice this is not worth a stroke."""

WORTH = 0.15
"""Square working widths that a stroke works at least."""

SMALLEST = 15.0
"""Square metres that a stroke works at least."""

PART = 0.002
"""Part of the field that a stroke works at least, unless it works a whole square working width."""

EDGES = 6
"""Directions in which strokes over one piece are tried, those of its longest edges."""

ALIKE = math.radians(8.0)
"""Directions nearer to each other are one."""

INTO = (0.0, 0.1, 0.2, 0.35)
"""Working widths by which a stroke is moved away from the edge beside it to find room."""

STEP = 0.5
"""Metres between the places at which the machine is tried."""

SHORTEST = 3.0
"""Metres; a shorter stroke is lengthened over ground that is worked already."""

LENGTH_COSTS = 0.1
"""Part of a stroke's swath that weighs against what it gains."""

EITHER_WAY = 0.9
"""A stroke that gains so much of the best when driven the other way may be driven both ways."""


def strokes(ground: Polygon, rest: BaseGeometry, room: Room, request: PlanRequest) -> list[Bundle]:
    """Strokes for all that is worth one of ``rest``, which nothing works yet; each is a bundle of its own."""
    wide = without_slivers(rest, SLIVER * request.width)
    worth = _worth(ground, request)
    found: list[Bundle] = []
    swaths: list[BaseGeometry] = []
    for part in parts_of(shapely.set_precision(wide, GRID), worth):
        piece: BaseGeometry = part
        for swath in swaths:
            piece = _less(piece, swath)
        for bundle, swath in _strokes_over(piece, worth, room, request):
            found.append(bundle)
            swaths.append(swath)
    return found


def _worth(ground: Polygon, request: PlanRequest) -> float:
    """Square metres that make a stroke worth the way there."""
    square = request.width**2
    return max(SMALLEST, WORTH * square, min(PART * ground.area, square))


def _less(piece: BaseGeometry, swath: BaseGeometry) -> BaseGeometry:
    """What is left of a piece."""
    return MultiPolygon(parts_of(shapely.difference(piece, swath, grid_size=GRID)))


def _strokes_over(
    piece: BaseGeometry, worth: float, room: Room, request: PlanRequest
) -> Iterator[tuple[Bundle, BaseGeometry]]:
    """One after another with its swath, the one that gains most first, until none is worth it."""
    while piece.area > worth:
        tried = _tried(piece, room, request)
        if tried is None:
            return
        gains = shapely.area(shapely.intersection(tried.swaths, piece, grid_size=GRID))
        best = int(np.argmax(gains - LENGTH_COSTS * shapely.area(tried.swaths)))
        if gains[best] < worth:
            return
        line = tried.lines[best]
        back = tried.back[best]
        other = tried.lines[back] if back >= 0 and gains[back] >= EITHER_WAY * gains[best] else line
        yield Bundle(((line, other),), spare=True), tried.swaths[best]
        piece = _less(piece, tried.swaths[best])


@dataclass(frozen=True, slots=True, eq=False)
class _Tried:
    """Strokes that the machine can drive: lines (S, 2, 2), swaths (S,), and which is the same driven back, or -1."""

    lines: FloatArray
    swaths: Swaths
    back: NDArray[np.intp]


def _tried(piece: BaseGeometry, room: Room, request: PlanRequest) -> _Tried | None:
    """Along each of the piece's edges, beside them and moved inward, both ways."""
    strips = list(_strips(piece, request))
    poses = np.concatenate([strip.poses for strip in strips])
    fits = np.split(room.fits_each(poses), np.cumsum([len(strip.poses) for strip in strips])[:-1])
    found = [strip.worked(each, max(request.offset_back, 0.0)) for strip, each in zip(strips, fits, strict=True)]
    kept = [place for place, line in enumerate(found) if line is not None]
    if not kept:
        return None
    lines = np.array([found[place] for place in kept])
    rows = {place: row for row, place in enumerate(kept)}
    back = np.array([rows.get(place ^ 1, -1) for place in kept])
    return _Tried(lines, _swaths(lines, request.width), back)


@dataclass(frozen=True, slots=True, eq=False)
class _Strip:
    """Places along a line in the driving direction; the piece lies between ``low`` and ``high`` metres along it."""

    origin: FloatArray
    along: FloatArray
    low: float
    high: float
    places: FloatArray

    @property
    def poses(self) -> FloatArray:
        """Shape (P, 3), one at each place."""
        points = self.origin + self.places[:, None] * self.along
        return np.column_stack([points, np.full(len(points), math.atan2(self.along[1], self.along[0]))])

    def worked(self, fits: BoolArray, ahead: float) -> FloatArray | None:
        """The line (2, 2) that is worked: where the machine fits for longest; ``ahead`` stays free beyond its end."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], fits, [False]]).astype(int))).reshape(-1, 2)
        if not len(edges):
            return None
        first, last = edges[int(np.argmax(edges[:, 1] - edges[:, 0]))]
        free = float(self.places[first]), float(self.places[last - 1]) - ahead
        begin, end = max(free[0], self.low), min(free[1], self.high)
        if end - begin < SHORTEST:
            end = min(free[1], max(end, begin + SHORTEST))
            begin = max(free[0], end - SHORTEST)
        if end - begin < SHORTEST:
            return None
        return self.origin + np.array([[begin], [end]]) * self.along


def _strips(piece: BaseGeometry, request: PlanRequest) -> Iterator[_Strip]:
    """For each direction and place beside the piece a strip along it and one against it, in this order."""
    corners = shapely.get_coordinates(piece)
    half, ahead = request.width / 2, max(request.offset_back, 0.0) + SHORTEST
    moved = np.array(INTO) * request.width
    for along in _directions(piece, SLIVER * request.width):
        across = np.array([-along[1], along[0]])
        (left, low), (right, high) = _ends(corners @ np.column_stack([along, across]))
        for aside in np.concatenate([low + half + moved, high - half - moved, [(low + high) / 2]]):
            origin = aside * across
            places = np.arange(left - ahead, right + ahead + STEP, STEP)
            yield _Strip(origin, along, left, right, places)
            yield _Strip(origin, -along, -right, -left, -places[::-1])


def _ends(points: FloatArray) -> FloatArray:
    """The least and the greatest of each coordinate."""
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _directions(piece: BaseGeometry, smooth: float) -> Iterator[FloatArray]:
    """Unit vectors along the piece's longest edges."""
    yaws: list[float] = []
    for yaw, _ in sorted(_edges(piece, smooth), key=lambda edge: -edge[1]):
        if all(abs(math.remainder(yaw - other, math.pi)) > ALIKE for other in yaws):
            yaws.append(yaw)
            yield np.array([math.cos(yaw), math.sin(yaw)])
        if len(yaws) == EDGES:
            return


def _edges(piece: BaseGeometry, smooth: float) -> Iterator[tuple[float, float]]:
    """Yaw and length of each edge."""
    for part in parts_of(piece):
        steps = np.diff(shapely.get_coordinates(shapely.simplify(part.exterior, smooth)), axis=0)
        yield from zip(np.arctan2(steps[:, 1], steps[:, 0]).tolist(), np.hypot(*steps.T).tolist(), strict=True)


def _swaths(lines: FloatArray, width: float) -> Swaths:
    """What the lines (S, 2, 2) work, with square ends."""
    along = lines[:, 1] - lines[:, 0]
    side = np.stack([-along[:, 1], along[:, 0]], axis=1) * (width / 2 / np.hypot(*along.T))[:, None]
    rims = np.stack([lines[:, 0] - side, lines[:, 1] - side, lines[:, 1] + side, lines[:, 0] + side], axis=1)
    return np.array(shapely.polygons(rims))
