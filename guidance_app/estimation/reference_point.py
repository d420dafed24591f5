"""From the antenna to the ground: lever arm, tilt ("slant") correction, and where the implement is.

The body frame is forward, right, up, with its origin at the reference point: the centre of the rear axle, on the
ground. Turning by the heading, then the pitch (nose up), then the roll (right side down) brings a body vector into the
level frame; this is the only place in the package that does so.
"""

import math

from guidance_app.angles import wrap_2pi, wrap_pi
from guidance_app.documents import HitchKind, Implement, Tractor
from guidance_app.geodesy import FieldFrame
from guidance_app.model import Attitude, Fix, Measurement, Pose

__all__ = ["ImplementPoint", "carried", "level_lever_arm", "measurement_from_fix", "offset_point"]

FRESH = 1.0
"""An attitude older or newer than this many seconds against the fix says nothing about it."""

ATTITUDE_HEADING_SIGMA = math.radians(3.0)
"""A heading from an attitude sensor or a compass drifts by some degrees (2 degrees in Inoue et al.)."""

SHARPEST_HITCH = math.radians(75)
"""A trailed implement stands at most this far from straight; beyond, it would hit the tyres."""

LONGEST_STEP = 2.0
"""Over a longer gap than this many seconds a trailed implement is taken to hang straight again."""


def level_lever_arm(arm: tuple[float, float, float], roll: float, pitch: float) -> tuple[float, float, float]:
    """The antenna's (forward, right, up) in the level frame, from that in the body frame.

    With the roll to the right the antenna on the roof moves right; with the nose up it moves back.
    """
    forward, right, up = arm
    right_rolled = right * math.cos(roll) + up * math.sin(roll)
    up_rolled = up * math.cos(roll) - right * math.sin(roll)
    forward_level = forward * math.cos(pitch) - up_rolled * math.sin(pitch)
    up_level = forward * math.sin(pitch) + up_rolled * math.cos(pitch)
    return forward_level, right_rolled, up_level


def offset_point(east: float, north: float, heading: float, forward: float, right: float) -> tuple[float, float]:
    """(east, north) of the point so far ahead and to the right of another."""
    sine, cosine = math.sin(heading), math.cos(heading)
    return east + forward * sine + right * cosine, north + forward * cosine - right * sine


def measurement_from_fix(fix: Fix, attitude: Attitude | None, frame: FieldFrame, tractor: Tractor) -> Measurement:
    """What the epoch holds, in the field frame, with the antenna's lever arm turned by roll and pitch.

    An attitude more than 1 s from the fix is left out. Roll and pitch are taken less the tractor's zeros; without
    them the tractor is taken as level. Raises ``ValueError`` for a fix more than 100 km from the frame's origin.
    """
    if attitude is not None and abs(attitude.arrival - fix.arrival) > FRESH:
        attitude = None
    roll = _first(attitude.roll if attitude else None, fix.roll)
    pitch = _first(attitude.pitch if attitude else None, fix.pitch)
    roll = None if roll is None else roll - math.radians(tractor.roll_zero_deg)
    pitch = None if pitch is None else pitch - math.radians(tractor.pitch_zero_deg)
    heading = _first(fix.heading, attitude.heading if attitude else None)
    arm = (tractor.antenna_forward, tractor.antenna_right, tractor.antenna_height)
    east, north = frame.east_north_from_degrees(fix.latitude_deg, fix.longitude_deg)
    return Measurement(
        t=fix.t,
        arrival=fix.arrival,
        east=east,
        north=north,
        quality=fix.quality,
        cell=None if fix.cell is None else (fix.cell[1], fix.cell[0]),
        sigma=None if fix.sigma is None else (fix.sigma[1], fix.sigma[0]),
        speed=fix.speed,
        course=fix.course,
        heading=heading,
        heading_sigma=ATTITUDE_HEADING_SIGMA if heading is not None and fix.heading is None else None,
        yaw_rate=_first(attitude.yaw_rate if attitude else None, fix.yaw_rate),
        roll=roll,
        pitch=pitch,
        antenna=level_lever_arm(arm, roll or 0.0, pitch or 0.0),
    )


def carried(point: tuple[float, float], before: Pose, after: Pose) -> tuple[float, float]:
    """Where (east, north) of a point that is fixed to the tractor comes to lie when the pose changes."""
    sine, cosine = math.sin(before.heading), math.cos(before.heading)
    east, north = point[0] - before.east, point[1] - before.north
    forward, right = east * sine + north * cosine, east * cosine - north * sine
    return offset_point(after.east, after.north, after.heading, forward, right)


def _first(one: float | None, other: float | None) -> float | None:
    return one if one is not None else other


class ImplementPoint:
    """Follows the implement's working point. A mounted one is fixed to the body; a trailed one follows its hitch.

    The trailed implement's axle follows the hitch without sideways slip: towards the direction of the hitch's step the
    half angle's tangent shrinks by exp(-step / drawbar) (the tractrix). The step comes from speed and heading, not
    from the positions, so that a step of the receiver's does not swing the implement. Backing up, the angle grows as
    in reality, up to 75 degrees.
    """

    def __init__(self, implement: Implement) -> None:
        self._implement = implement
        self._last: Pose | None = None
        self._heading: float | None = None

    def step(self, pose: Pose) -> tuple[float, float, float]:
        """(east, north, heading) of the implement's working point when the tractor has this pose."""
        implement = self._implement
        if implement.hitch is HitchKind.MOUNTED:
            point = offset_point(pose.east, pose.north, pose.heading, -implement.offset_back, implement.offset_right)
            return (*point, pose.heading)
        heading = self._trailed_heading(pose)
        self._heading, self._last = heading, pose
        hitch = offset_point(pose.east, pose.north, pose.heading, -implement.hitch_back, 0.0)
        behind_hitch = implement.offset_back - implement.hitch_back
        point = offset_point(*hitch, heading, -behind_hitch, implement.offset_right)
        return (*point, heading)

    def fork(self) -> "ImplementPoint":
        """An independent copy."""
        other = ImplementPoint(self._implement)
        other._last, other._heading = self._last, self._heading
        return other

    def _trailed_heading(self, pose: Pose) -> float:
        last = self._last
        if last is None or self._heading is None or not pose.heading_known or not last.heading_known:
            return pose.heading
        dt = pose.t - last.t
        if not 0.0 <= dt <= LONGEST_STEP:
            return pose.heading
        forward = 0.5 * (pose.speed + last.speed) * dt
        turned = wrap_pi(pose.heading - last.heading)
        middle = last.heading + 0.5 * turned
        sideways = -self._implement.hitch_back * turned
        step = math.hypot(forward, sideways)
        if step == 0.0:
            return self._heading
        direction = middle + math.atan2(sideways, forward)
        angle = wrap_pi(self._heading - direction)
        angle = 2.0 * math.atan(math.tan(0.5 * angle) * math.exp(-step / self._implement.drawbar))
        hitch_angle = wrap_pi(direction + angle - pose.heading)
        hitch_angle = min(max(hitch_angle, -SHARPEST_HITCH), SHARPEST_HITCH)
        return wrap_2pi(pose.heading + hitch_angle)
