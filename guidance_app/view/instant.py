"""From the newest fix to the instant of a redraw: how far the guided point has moved across its line since then.

Fixes come one to twenty-five times a second, pictures more often. Only the movement since the fix is computed here; the
cross-track error at the fix itself is the engine's, so at the fix both agree to the bit.
"""

import numpy as np

from guidance_app.estimation.prediction import pose_after
from guidance_app.estimation.reference_point import carried
from guidance_app.model import FloatArray, Guidance, Pose

__all__ = ["moved_right"]

Point = tuple[float, float]


def moved_right(guidance: Guidance, pose: Pose, point: Point, seconds: float) -> float:
    """Metres that ``point``, carried by the tractor at ``pose``, moves to the right of the target pass in ``seconds``.

    A trailed implement follows late; here it is taken as fixed to the tractor.
    Right as seen in the present direction of travel. Zero when nothing moves.
    """
    later = pose_after(pose, seconds)
    if (later.east, later.north, later.heading) == (pose.east, pose.north, pose.heading):
        return 0.0
    after = carried(point, pose, later)
    points, closed = guidance.target.points, guidance.target.closed
    moved = _right_of(points, after, closed=closed) - _right_of(points, point, closed=closed)
    return -moved if guidance.against else moved


def _right_of(points: FloatArray, place: Point, *, closed: bool) -> float:
    """Metres right of the nearest stretch of the line, which is thought to go on straight beyond its ends."""
    starts = points if closed else points[:-1]
    ends = np.roll(points, -1, axis=0) if closed else points[1:]
    along = ends - starts
    lengths = np.hypot(along[:, 0], along[:, 1])
    real = lengths > 0.0
    starts, along, lengths = starts[real], along[real], lengths[real]
    if len(starts) == 0:
        return 0.0
    units = along / lengths[:, np.newaxis]
    seen = np.asarray(place) - starts
    reached = np.clip(np.einsum("ij,ij->i", seen, units), 0.0, lengths)
    missed = seen - reached[:, np.newaxis] * units
    nearest = int(np.argmin(np.einsum("ij,ij->i", missed, missed)))
    return float(seen[nearest, 0] * units[nearest, 1] - seen[nearest, 1] * units[nearest, 0])
