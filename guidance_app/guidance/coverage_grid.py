"""Worked ground as bits of a turned grid, in tiles that exist only where work was done.

Counting the cells whose centres were covered is right on average wherever an edge cuts the cells in all ways alike, but
wrong by up to half a cell all the way where it runs along them or along their diagonals (0.5 % of a 12 m strip in the
worst case). So the grid lies as far as it can from the first direction of work and from the field's longer edges, along
which work is done: at 22.5 degrees if there is but one. Work in random other directions is wrong by 0.009 % (rms, 100 m
strips of 12 m); one in three hundred of them hits an axis within its 0.1 degree.
Copies share their tiles until one of them writes.
"""

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from guidance_app.guidance.coverage_kernels import (
    FIELD,
    GROUND_PLANES,
    MAINLAND,
    TILE,
    WORDS,
    WORK_PLANES,
    Bits,
    inside_of,
    paint,
    settle,
)
from guidance_app.model import FloatArray

__all__ = ["CellCounts", "CoverageGrid", "Ends", "Ground", "Patch"]

LONG_EDGE = 0.05
"""Of the field's outline: along shorter edges little is worked."""

TRIED = np.radians(np.arange(0.0, 45.0, 0.25))
"""Directions of the grid's axis that are compared; 45 degrees on, axes and diagonals repeat."""

TilePlace = tuple[int, int]
"""Column and row of a tile."""

Ends = tuple[float, float, float, float]
"""Column and row of the left end of what works, then of its right end."""

Patch = tuple[FloatArray, tuple[TilePlace, ...]]
"""A quadrilateral of shape (4, 2), in cells, and the tiles that it may touch."""

CellCounts = tuple[int, int, int, int]
"""New cells, newly twice, new in the field, new outside the mainland."""

Area = shapely.Polygon | shapely.MultiPolygon


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """The areas that worked ground is told apart by; each may be unknown."""

    field: Area | None
    mainland: Area | None


@dataclass(frozen=True, slots=True, eq=False)
class _Axes:
    """From east and north to cells, and the areas' edges in cells."""

    east: float
    north: float
    per_metre_along: float
    per_metre_across: float
    field: FloatArray | None
    mainland: FloatArray | None

    @staticmethod
    def along(east: float, north: float, heading: float, cell: float, ground: Ground) -> "_Axes":
        turned = _apart_from([heading, *_edge_headings(ground.field)])
        bare = _Axes(east, north, math.sin(turned) / cell, math.cos(turned) / cell, None, None)
        field, mainland = bare._edges(ground.field), bare._edges(ground.mainland)
        return _Axes(east, north, bare.per_metre_along, bare.per_metre_across, field, mainland)

    def cells(self, east: float, north: float) -> tuple[float, float]:
        """Column and row, with fractions."""
        away_east, away_north = east - self.east, north - self.north
        return (
            away_east * self.per_metre_along + away_north * self.per_metre_across,
            away_east * self.per_metre_across - away_north * self.per_metre_along,
        )

    def _edges(self, area: Area | None) -> FloatArray | None:
        """Shape (N, 4) of all rings, as ``inside_of`` takes them."""
        if area is None:
            return None
        rings = [shapely.get_coordinates(ring) for part in shapely.get_parts(area) for ring in _rings(part)]
        edges = []
        for ring in rings:
            corners = np.array([self.cells(east, north) for east, north in ring.tolist()])
            edges.append(np.hstack([corners[:-1], corners[1:]]))
        return np.ascontiguousarray(np.vstack(edges)) if edges else np.empty((0, 4))


def _apart_from(headings: Sequence[float]) -> float:
    """The direction whose axes and diagonals lie farthest from all headings."""
    eighth = math.pi / 4
    gaps = np.abs((TRIED[:, None] - np.array(headings) + 0.5 * eighth) % eighth - 0.5 * eighth)
    return float(TRIED[np.argmax(gaps.min(axis=1))])


def _edge_headings(field: Area | None) -> list[float]:
    if field is None or field.is_empty:
        return []
    headings: list[float] = []
    for part in shapely.get_parts(field):
        east, north = np.diff(shapely.get_coordinates(part.exterior), axis=0).T
        length = np.hypot(east, north)
        headings += np.arctan2(east, north)[length > LONG_EDGE * length.sum()].tolist()
    return headings


def _rings(part: shapely.Polygon) -> list[shapely.LinearRing]:
    return [] if part.is_empty else [part.exterior, *part.interiors]


@dataclass(slots=True, eq=False)
class _Tile:
    work: Bits
    ground: Bits
    x: int
    y: int


EVERYWHERE = np.full((GROUND_PLANES, TILE, WORDS), ~np.uint64(0), dtype=np.uint64)
EVERYWHERE.setflags(write=False)


class CoverageGrid:
    """Marks quadrilaterals and counts. Work is given in the cells of the grid, which ``ends`` finds."""

    def __init__(self, cell: float, ground: Ground) -> None:
        self.cell = cell
        self._ground = ground
        self._axes: _Axes | None = None
        self._tiles: dict[TilePlace, _Tile] = {}
        self._own: set[TilePlace] = set()

    def fork(self) -> "CoverageGrid":
        """An independent copy that costs one copy of the table of tiles; from now on both copy a tile to write it."""
        other = copy.copy(self)
        other._tiles = dict(self._tiles)  # noqa: SLF001 - its own class, as in the line below
        other._own = set()  # noqa: SLF001
        self._own = set()
        return other

    def lay(self, east: float, north: float, heading: float) -> None:
        """Lays the grid if it does not lie yet: origin and direction of work."""
        if self._axes is None:
            self._axes = _Axes.along(east, north, heading, self.cell, self._ground)

    @property
    def tiles(self) -> int:
        """How many tiles exist: 24 kB each, 40 kB where a boundary crosses."""
        return len(self._tiles)

    def ends(self, run: Ends) -> Ends:
        """In cells, from east and north of the left and of the right end; only after ``lay``."""
        assert self._axes is not None
        return (*self._axes.cells(run[0], run[1]), *self._axes.cells(run[2], run[3]))

    def patch(self, start: Ends, end: Ends) -> Patch:
        """The quadrilateral between two places of what works, ready to be painted and later settled."""
        (x0, y0, x1, y1), (x3, y3, x2, y2) = start, end
        corners = np.array((x0, y0, x1, y1, x2, y2, x3, y3)).reshape(4, 2)
        west, east = int(min(x0, x1, x2, x3) // TILE), int(max(x0, x1, x2, x3) // TILE)
        south, north = int(min(y0, y1, y2, y3) // TILE), int(max(y0, y1, y2, y3) // TILE)
        if west == east and south == north:
            return corners, ((west, south),)
        return corners, tuple((x, y) for x in range(west, east + 1) for y in range(south, north + 1))

    def paint(self, patch: Patch) -> CellCounts:
        """Marks it as worked."""
        corners, places = patch
        fresh = twice = field = headland = 0
        for place in places:
            tile = self._tiles[place] if place in self._own else self._own_tile(place)
            counts = paint(tile.work, tile.ground, tile.x, tile.y, corners)
            fresh += counts[0]
            twice += counts[1]
            field += counts[2]
            headland += counts[3]
        return fresh, twice, field, headland

    def settle(self, patch: Patch) -> None:
        """From now on, work on it is a second time."""
        corners, places = patch
        for place in places:
            tile = self._tiles[place] if place in self._own else self._own_tile(place)
            settle(tile.work, tile.x, tile.y, corners)

    def _own_tile(self, place: TilePlace) -> _Tile:
        shared = self._tiles.get(place)
        x, y = place[0] * TILE, place[1] * TILE
        if shared is None:
            work = np.zeros((WORK_PLANES, TILE, WORDS), dtype=np.uint64)
            tile = _Tile(work, self._what_lies(x, y), x, y)
        else:
            tile = _Tile(shared.work.copy(), shared.ground, x, y)
        self._tiles[place] = tile
        self._own.add(place)
        return tile

    def _what_lies(self, x: int, y: int) -> Bits:
        """Where field and mainland are not known, all is inside."""
        assert self._axes is not None
        ground = EVERYWHERE.copy()
        for plane, edges in ((FIELD, self._axes.field), (MAINLAND, self._axes.mainland)):
            if edges is not None:
                ground[plane] = 0
                inside_of(edges, x, y, ground[plane])
        return EVERYWHERE if np.array_equal(ground, EVERYWHERE) else ground
