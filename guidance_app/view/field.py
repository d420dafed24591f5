"""The field's ground: its polygon and exclusions as triangles, its rings as strokes, the box around everything.

Triangles are shapely's constrained Delaunay triangulation, which keeps holes and concave corners.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from guidance_app.model import FloatArray, Snapshot
from guidance_app.view.camera import Extent, extent_of
from guidance_app.view.polyline import Segments, closed_ring, cut, segments, thinned

__all__ = ["Mesh", "everything", "exclusion_mesh", "ground_mesh", "mainland_strokes", "ring_strokes"]

Z_SOIL, Z_EXCLUSION, Z_MAINLAND, Z_BOUNDARY = 0.0, 0.01, 0.09, 0.10
RING_TOLERANCE = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Vertices of shape (N, 3), faces of shape (M, 3), counter-clockwise seen from above."""

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]


def ground_mesh(rings: Sequence[FloatArray]) -> Mesh | None:
    """The field's ground without its exclusions; None without a field."""
    if not rings:
        return None
    return _triangles([shapely.Polygon(rings[0], rings[1:])], Z_SOIL)


def exclusion_mesh(rings: Sequence[FloatArray]) -> Mesh | None:
    """What lies inside the exclusions; None when there are none."""
    return _triangles([shapely.Polygon(ring) for ring in rings[1:]], Z_EXCLUSION) if len(rings) > 1 else None


def _triangles(polygons: Iterable[shapely.Polygon], z: float) -> Mesh | None:
    pieces = [shapely.constrained_delaunay_triangles(polygon) for polygon in polygons if polygon.area > 0]
    corners = [
        shapely.get_coordinates(shapely.orient_polygons(shapely.get_parts(piece))).reshape(-1, 4, 2)[:, :3]
        for piece in pieces
        if not piece.is_empty
    ]
    if not corners:
        return None
    flat = np.concatenate(corners).reshape(-1, 2)
    places, index = np.unique(flat, axis=0, return_inverse=True)
    vertices = np.column_stack([places, np.full(len(places), z)]).astype(np.float32)
    return Mesh(vertices, index.reshape(-1, 3).astype(np.uint32))


def ring_strokes(rings: Sequence[FloatArray]) -> Segments:
    """The edges of these rings as strokes, thinned to 2 cm."""
    drawn = [segments(cut(thinned(closed_ring(ring), RING_TOLERANCE)), Z_BOUNDARY) for ring in rings]
    return np.concatenate(drawn) if drawn else np.empty((0, 2, 3), np.float32)


def mainland_strokes(snapshot: Snapshot) -> Segments:
    """The line between headland and mainland; empty without a plan or without a headland."""
    parts = snapshot.plan.mainland if snapshot.plan is not None else ()
    drawn = [segments(cut(thinned(closed_ring(ring), RING_TOLERANCE)), Z_MAINLAND) for part in parts for ring in part]
    return np.concatenate(drawn) if drawn else np.empty((0, 2, 3), np.float32)


def everything(snapshot: Snapshot) -> Extent:
    """The box that holds the field, or without one the passes and the track, and the tractor."""
    boxes = [extent_of(snapshot.field_rings[0])] if snapshot.field_rings else _without_field(snapshot)
    pose = snapshot.pose
    if pose is not None:
        boxes.append(Extent(pose.east, pose.north, pose.east, pose.north))
    if not boxes:
        return Extent(-50.0, -50.0, 50.0, 50.0)
    return Extent(
        min(box.west for box in boxes),
        min(box.south for box in boxes),
        max(box.east for box in boxes),
        max(box.north for box in boxes),
    )


def _without_field(snapshot: Snapshot) -> list[Extent]:
    boxes = [extent_of(line.points) for line in snapshot.passes if not line.endless and len(line.points)]
    track = snapshot.track
    if track is not None:
        pieces = [*track.pieces[: track.count], track.open_piece]
        boxes += [extent_of(piece) for piece in pieces if isinstance(piece, np.ndarray) and len(piece)]
    return boxes
