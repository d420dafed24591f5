"""Outlines of tractor and implement on the ground, seen from the tractor: now, and where the look-ahead takes them.

The body frame here is the scene's: x ahead, y to the left, yaw counter-clockwise, origin at the rear axle's centre.
What hangs on the tractor is described in it once for each fix, so that a redraw between fixes moves one frame only.
"""

import math
from dataclasses import dataclass

import numpy as np

from guidance_app.angles import wrap_pi
from guidance_app.documents import HitchKind, Implement, Tractor
from guidance_app.model import FloatArray, Pose, Prediction, Snapshot
from guidance_app.view.polyline import Segments, closed_ring, segments

__all__ = [
    "Place",
    "arc_strokes",
    "ghost_strokes",
    "hollow_strokes",
    "implement_place",
    "in_body",
    "ring_strokes",
    "tractor_outline",
    "working_edge",
]

Z_GHOST, Z_ARC, Z_HOLLOW, Z_EDGE = 0.14, 0.13, 0.14, 0.15

REAR_TYRE = 0.82
"""Radius of a rear tyre for a wheelbase of 2.45 m; it grows with the tractor."""


@dataclass(frozen=True, slots=True)
class Place:
    """Somewhere in the body frame."""

    x: float
    y: float
    yaw: float

    def of(self, points: FloatArray) -> FloatArray:
        """Points given from this place, shape (N, 2), in the body frame."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        turn = np.array([[cosine, sine], [-sine, cosine]])
        return np.asarray(points @ turn + (self.x, self.y))


def in_body(pose: Pose, east: float, north: float, heading: float) -> Place:
    """A position and heading of the field frame as a place seen from ``pose``."""
    sine, cosine = math.sin(pose.heading), math.cos(pose.heading)
    de, dn = east - pose.east, north - pose.north
    return Place(de * sine + dn * cosine, -de * cosine + dn * sine, wrap_pi(pose.heading - heading))


def _array_in_body(pose: Pose, points: FloatArray) -> FloatArray:
    sine, cosine = math.sin(pose.heading), math.cos(pose.heading)
    offset = points - (pose.east, pose.north)
    return np.column_stack([offset @ (sine, cosine), offset @ (-cosine, sine)])


def tractor_scale(tractor: Tractor) -> float:
    """How large the tractor is against one of 2.45 m wheelbase."""
    return tractor.wheelbase / 2.45


def tractor_outline(tractor: Tractor) -> FloatArray:
    """Corners of the tractor seen from above, bonnet narrower than the rear; shape (N, 2), closed."""
    size = tractor_scale(tractor)
    back, front = -REAR_TYRE * size, tractor.wheelbase + 0.75 * size
    wide, axle, narrow = tractor.track_width / 2 + 0.25 * size, 0.9 * size, 0.42 * size
    half = [(back, wide), (axle, wide), (axle + 0.25, narrow), (front, narrow)]
    mirrored = [(x, -y) for x, y in reversed(half)]
    return closed_ring(np.array(half + mirrored))


def implement_outline(implement: Implement) -> FloatArray:
    """Corners of the implement around its working point; shape (5, 2), closed."""
    half, depth = implement.working_width / 2, max(implement.length, 0.3) / 2
    return np.array([(depth, half), (depth, -half), (-depth, -half), (-depth, half), (depth, half)])


def implement_place(snapshot: Snapshot, implement: Implement) -> Place:
    """Where the implement's working point is; by its documents alone while its pose is not known."""
    if snapshot.implement is None or snapshot.pose is None:
        return Place(-implement.offset_back, -implement.offset_right, 0.0)
    return in_body(snapshot.pose, *snapshot.implement)


def working_edge(implement: Implement, place: Place) -> Segments:
    """The line along which ground is worked, one stroke a section with a gap between; shape (sections, 2, 3).

    The leftmost section comes first, as in ``Snapshot.sections``.
    """
    half = implement.working_width / 2
    cuts = np.linspace(half, -half, implement.sections + 1)
    gap = min(0.12, implement.working_width / implement.sections / 8) if implement.sections > 1 else 0.0
    ends = np.stack([cuts[:-1], cuts[1:]], axis=1)
    ends[1:, 0] -= gap
    ends[:-1, 1] += gap
    edge = np.full((implement.sections, 2, 3), Z_EDGE, dtype=np.float32)
    for side in (0, 1):
        edge[:, side, :2] = place.of(np.column_stack([np.zeros(implement.sections), ends[:, side]]))
    return edge


def hollow_strokes(tractor: Tractor, implement: Implement, place: Place) -> Segments:
    """Tractor and implement as outlines, for a position that is no longer believed."""
    parts = (tractor_outline(tractor), place.of(implement_outline(implement)))
    return np.concatenate([segments(part, Z_HOLLOW) for part in parts])


def ring_strokes(radius: float = 1.6, count: int = 32) -> Segments:
    """A ring around the tractor's position, while its heading is not known."""
    angle = np.linspace(0.0, math.tau, count + 1)
    return segments(np.column_stack([np.cos(angle), np.sin(angle)]) * radius, Z_HOLLOW)


def arc_strokes(snapshot: Snapshot) -> Segments:
    """The way to the predicted pose; empty without one."""
    if snapshot.prediction is None or snapshot.pose is None:
        return np.empty((0, 2, 3), np.float32)
    return segments(_array_in_body(snapshot.pose, snapshot.prediction.arc), Z_ARC)


def ghost_strokes(snapshot: Snapshot, tractor: Tractor, implement: Implement) -> Segments:
    """Outlines of tractor and implement where the look-ahead takes them; empty without a prediction."""
    if snapshot.prediction is None or snapshot.pose is None:
        return np.empty((0, 2, 3), np.float32)
    ahead = snapshot.prediction.pose
    place = in_body(snapshot.pose, ahead.east, ahead.north, ahead.heading)
    now = implement_place(snapshot, implement)
    carried = _carried_place(snapshot.pose, snapshot.prediction, implement, now)
    parts = (place.of(tractor_outline(tractor)), carried.of(implement_outline(implement)))
    return np.concatenate([segments(part, Z_GHOST) for part in parts])


def _carried_place(pose: Pose, prediction: Prediction, implement: Implement, now: Place) -> Place:
    """The implement's place at the end of the arc: fixed to the body, or drawn along the hitch's way."""
    ahead = in_body(pose, prediction.pose.east, prediction.pose.north, prediction.pose.heading)
    if implement.hitch is HitchKind.MOUNTED:
        moved = ahead.of(np.array([[now.x, now.y]]))[0]
        return Place(float(moved[0]), float(moved[1]), ahead.yaw + now.yaw)
    way = _array_in_body(pose, prediction.arc)
    steps = np.diff(way, axis=0)
    courses = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    yaws = np.concatenate([[0.0], courses + (math.pi if pose.speed < 0 else 0.0)])
    hitches = way - implement.hitch_back * np.column_stack([np.cos(yaws), np.sin(yaws)])
    yaw = _drawn_along(hitches, now.yaw, implement.drawbar)
    behind = implement.offset_back - implement.hitch_back
    hitch = ahead.of(np.array([[-implement.hitch_back, 0.0]]))[0]
    point = Place(float(hitch[0]), float(hitch[1]), yaw).of(np.array([[-behind, -implement.offset_right]]))[0]
    return Place(float(point[0]), float(point[1]), yaw)


def _drawn_along(hitches: FloatArray, yaw: float, drawbar: float) -> float:
    """The yaw of something drawn by its hitch along these points: its axle follows on a tractrix."""
    axle = hitches[0] - drawbar * np.array([math.cos(yaw), math.sin(yaw)])
    for hitch in hitches[1:]:
        pull = hitch - axle
        axle = hitch - pull * (drawbar / (float(np.hypot(*pull)) or 1.0))
    last = hitches[-1] - axle
    return math.atan2(float(last[1]), float(last[0]))
