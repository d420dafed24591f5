"""From the newest fix to the instant of a redraw: how far the guided point has moved across its line since then.

Fixes come one to twenty-five times a second, pictures more often. Only the movement since the fix is computed here; the
cross-track error at the fix itself is the engine's, so at the fix both agree to the bit.
"""

from guidance_app.estimation.prediction import pose_after
from guidance_app.estimation.reference_point import carried
from guidance_app.guidance.polyline import Polyline
from guidance_app.model import Guidance, Pose

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
    line = Polyline.of(guidance.target)
    moved = line.foot(*after).cross - line.foot(*point).cross
    return -moved if guidance.against else moved
