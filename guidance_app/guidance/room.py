"""Whether body and implement stay inside the field along a path, and by how many metres they do not.

A machine whose outline begins inside and never touches the boundary on its way stays inside. The outline is tried at
places on the path; between them its corners are taken to run straight.
"""

import math

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import Polygon

from guidance_app.guidance.manoeuvres import Manoeuvres, poses_along
from guidance_app.guidance.request import Body
from guidance_app.guidance.room_kernels import Cells, cells_away, edges_by_cell, moves_clear, poses_clear
from guidance_app.model import FloatArray

__all__ = ["TOUCH", "Room"]

TOUCH = 0.05
"""Metres that body or implement may stick out: a lap along the boundary touches it with the implement's end."""

STEP = 0.6
"""Metres between the places at which a candidate is checked; a smaller obstacle could slip through between them."""

SPACING, FEWEST, MOST = 1.2, 16, 150
"""Metres between the poses at which what is missing is measured, and how many there are at least and at most."""

TRACTOR_REAR = -0.6
"""Metres from the axle to the tractor's rear end."""

CELLS = 16_384
"""Cells of the grid in which the boundary's edges are looked up, about."""

BoolArray = NDArray[np.bool_]


class Room:
    """The ground that a machine may cover: the field without its obstacles, and ``touch`` metres beyond."""

    def __init__(self, polygon: Polygon, body: Body, touch: float = TOUCH) -> None:
        self.ground: Polygon = polygon.buffer(touch, quad_segs=2)
        self.polygon = polygon
        self._outline = _outline(body)
        self._edges, self._grid, self._cells = _gridded(self.ground)
        self.half_width = float(np.abs(self._outline[:, 1]).max())
        shapely.prepare(self.ground)
        shapely.prepare(self.polygon)

    def fits(self, moves: Manoeuvres) -> BoolArray:
        """For each existing candidate whether the whole machine stays inside all along."""
        inside: BoolArray = np.asarray(shapely.contains_xy(self.ground, moves.start[:, 0], moves.start[:, 1]))
        pieces = (moves.turns[inside], moves.lengths[inside], moves.radius, STEP)
        inside[inside] = moves_clear(moves.start[inside], pieces, self._outline, self._edges, self._grid, self._cells)
        return inside

    def fits_each(self, poses: FloatArray) -> BoolArray:
        """For single poses (M, 3) whether the machine stays inside there."""
        inside: BoolArray = np.asarray(shapely.contains_xy(self.ground, poses[:, 0], poses[:, 1]))
        inside[inside] = poses_clear(poses[inside], self._outline, self._edges, self._grid, self._cells)
        return inside

    def poses(self, moves: Manoeuvres) -> FloatArray:
        """Poses (C, K, 3) along candidates, close enough to each other to measure what is missing."""
        total = moves.total
        count = int(np.clip(total.max() / SPACING, FEWEST, MOST))
        return poses_along(moves, total[:, None] * np.linspace(0.0, 1.0, count))

    def missing(self, poses: FloatArray) -> FloatArray:
        """Metres by which the machine sticks out at its worst along poses (C, K, 3); 0 where it fits."""
        corners = self._corners(poses)
        outside = ~np.asarray(shapely.contains_xy(self.polygon, corners[..., 0], corners[..., 1]))
        apart = np.zeros(outside.shape)
        apart[outside] = shapely.distance(self.polygon, shapely.points(corners[outside]))
        worst: FloatArray = apart.max(axis=(1, 2))
        return worst

    def _corners(self, poses: FloatArray) -> FloatArray:
        """Shape (C, K, B, 2): the outline's corners at each pose, the first one repeated at the end."""
        cosine, sine = np.cos(poses[..., 2])[..., None], np.sin(poses[..., 2])[..., None]
        forward, left = self._outline[:, 0], self._outline[:, 1]
        east = poses[..., 0, None] + forward * cosine - left * sine
        north = poses[..., 1, None] + forward * sine + left * cosine
        return np.stack([east, north], axis=-1)


def _gridded(ground: Polygon) -> tuple[FloatArray, FloatArray, Cells]:
    """The boundary's edges (E, 4), and the grid by whose cells they are found."""
    rings = [shapely.get_coordinates(ring) for ring in (ground.exterior, *ground.interiors)]
    edges = np.concatenate([np.column_stack([ring[:-1], ring[1:]]) for ring in rings])
    west, south, east, north = ground.bounds
    size = math.sqrt((east - west) * (north - south) / CELLS)
    columns, rows = math.ceil((east - west) / size), math.ceil((north - south) / size)
    grid = np.array([west, south, size])
    begins, listed = edges_by_cell(edges, grid, columns, rows)
    return edges, grid, (columns, rows, begins, listed, cells_away(begins, columns, rows))


def _outline(body: Body) -> FloatArray:
    """Corners (B, 2): forward and left of the working centre; closed."""
    middle, half = body.offset_right, body.half_width
    wide = body.implement_half_width
    corners = [
        (body.front, middle + half),
        (body.front, middle - half),
        (TRACTOR_REAR, middle - half),
        (body.implement_front, -wide),
        (body.implement_rear, -wide),
        (body.implement_rear, wide),
        (body.implement_front, wide),
        (TRACTOR_REAR, middle + half),
        (body.front, middle + half),
    ]
    return np.array(corners)
