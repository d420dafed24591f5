"""Whether body and implement stay inside the field along a path, and by how many metres they do not."""

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import Polygon

from guidance_app.guidance.manoeuvres import Manoeuvres, poses_along
from guidance_app.guidance.request import Body
from guidance_app.model import FloatArray

__all__ = ["TOUCH", "Room"]

TOUCH = 0.05
"""Metres that body or implement may stick out: a lap along the boundary touches it with the implement's end."""

SPACING, FEWEST, MOST = 1.2, 16, 150
"""Metres between the poses at which a candidate is checked, and how many there are at least and at most."""

TRACTOR_REAR = -0.6
"""Metres from the axle to the tractor's rear end."""

BoolArray = NDArray[np.bool_]


class Room:
    """The ground that a machine may cover: the field without its obstacles, and ``touch`` metres beyond."""

    def __init__(self, polygon: Polygon, body: Body, touch: float = TOUCH) -> None:
        self.ground: Polygon = polygon.buffer(touch, quad_segs=2)
        self.polygon = polygon
        self._outline = _outline(body)
        self.half_width = float(np.abs(self._outline[:, 1]).max())
        shapely.prepare(self.ground)
        shapely.prepare(self.polygon)

    def fits(self, moves: Manoeuvres) -> BoolArray:
        """For each existing candidate whether the whole machine stays inside all along."""
        if not len(moves.start):
            return np.zeros(0, dtype=bool)
        return self.fits_poses(self.poses(moves))

    def poses(self, moves: Manoeuvres) -> FloatArray:
        """Poses (C, K, 3) along candidates, close enough to each other for a check."""
        total = moves.total
        count = int(np.clip(total.max() / SPACING, FEWEST, MOST))
        return poses_along(moves, total[:, None] * np.linspace(0.0, 1.0, count))

    def fits_poses(self, poses: FloatArray) -> BoolArray:
        """The same for poses (C, K, 3); corners' traces between neighbouring poses are checked too."""
        on_ground = np.asarray(shapely.contains_xy(self.ground, poses[..., 0], poses[..., 1]))
        inside: BoolArray = np.all(on_ground, axis=1)
        corners = self._corners(poses[inside])
        inside[inside] = traces = self._covered(np.swapaxes(corners, 1, 2))
        inside[inside] = self._covered(corners[traces])
        return inside

    def _covered(self, lines: FloatArray) -> BoolArray:
        """For lines (C, L, N, 2) whether all L of each lie in the ground."""
        covered = np.asarray(shapely.covers(self.ground, shapely.linestrings(lines)))
        inside: BoolArray = np.all(covered, axis=1)
        return inside

    def fits_each(self, poses: FloatArray) -> BoolArray:
        """For single poses (M, 3) whether the machine stays inside there."""
        inside: BoolArray = np.asarray(shapely.covers(self.ground, shapely.linestrings(self._corners(poses))))
        return inside

    def missing(self, poses: FloatArray) -> FloatArray:
        """Metres by which the machine sticks out at its worst along poses (C, K, 3); 0 where it fits."""
        corners = self._corners(poses)
        apart: FloatArray = shapely.distance(self.polygon, shapely.points(corners)).max(axis=(1, 2))
        return apart

    def _corners(self, poses: FloatArray) -> FloatArray:
        """Shape (C, K, B, 2): the outline's corners at each pose, the first one repeated at the end."""
        cosine, sine = np.cos(poses[..., 2])[..., None], np.sin(poses[..., 2])[..., None]
        forward, left = self._outline[:, 0], self._outline[:, 1]
        east = poses[..., 0, None] + forward * cosine - left * sine
        north = poses[..., 1, None] + forward * sine + left * cosine
        return np.stack([east, north], axis=-1)


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
