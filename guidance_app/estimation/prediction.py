"""Where the tractor will be: to the redraw's instant, and after the look-ahead.

Two ways of looking ahead are here. ``TRACK`` is Inoue et al.'s: "an approximation curve of the swept track", a second
degree polynomial in time through the last seconds' poses, carried on. ``FILTER`` takes the filter's own curvature and
lets it fade, because a driver steers back: constant curvature overshoots by half a metre in 2 s of a meander.
"""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from guidance_app.angles import wrap_2pi
from guidance_app.estimation.filter import FilterSettings
from guidance_app.estimation.prediction_kernels import fading_arc
from guidance_app.model import FloatArray, Pose, Prediction

__all__ = ["LOOK_AHEAD_MAX", "LOOK_AHEAD_MIN", "Predictor", "Way", "pose_after"]

LOOK_AHEAD_MIN, LOOK_AHEAD_MAX = 0.5, 3.0
SLOWEST = 0.3
"""Below this speed in m/s there is no direction of travel worth showing."""
FADING = 1.5
"""The predicted curvature fades with this time constant in seconds."""
ARC_STEP = 0.1
TRACK_WINDOW = 1.2
"""The swept track is fitted over this many seconds: its bend is known half of that late, and 2.5 s is worse in a
meander than going straight on."""
FEWEST = 4
"""But over no fewer poses than this, for a receiver of 1 Hz."""
LONGEST_GAP = 2.0


def pose_after(pose: Pose, seconds: float) -> Pose:
    """The pose so many seconds later, at constant speed and with a fading curvature; earlier for a negative number.

    Going back in time the curvature is kept. A standing tractor stays where it is; an unknown heading is not
    followed.
    """
    return _along(pose, seconds)[0]


def _along(pose: Pose, seconds: float) -> tuple[Pose, FloatArray]:
    """The pose then, and the places from now to then, every tenth of a second; shape (K, 2)."""
    if seconds == 0.0 or pose.standing or not pose.heading_known:
        here = np.array([(pose.east, pose.north)])
        return _at(pose, seconds, pose.east, pose.north, pose.heading, pose.curvature), here
    steps = max(1, math.ceil(abs(seconds) / ARC_STEP))
    places = np.empty((steps + 1, 2))
    places[0] = pose.east, pose.north
    turn, fade = fading_arc(places, pose.heading, pose.speed, pose.curvature, seconds, FADING)
    east, north = places[-1].tolist()
    return _at(pose, seconds, east, north, pose.heading + turn, pose.curvature * fade), places


def _at(pose: Pose, after: float, east: float, north: float, heading: float, curvature: float) -> Pose:
    return Pose(
        t=pose.t + after,
        arrival=pose.arrival + after,
        east=east,
        north=north,
        heading=wrap_2pi(heading),
        speed=pose.speed,
        curvature=curvature,
        covariance=pose.covariance,
        heading_sigma=pose.heading_sigma,
        heading_known=pose.heading_known,
        standing=pose.standing,
        reverse=pose.reverse,
        dead_reckoned=pose.dead_reckoned,
        roll=pose.roll,
        pitch=pose.pitch,
    )


class Way(StrEnum):
    """How the look-ahead is made."""

    FILTER = "filter"
    TRACK = "track"


@dataclass(frozen=True, slots=True)
class _Swept:
    """The last seconds' track: time, east, north, heading made continuous, and the speed."""

    poses: tuple[Pose, ...] = ()

    def after(self, pose: Pose) -> "_Swept":
        """With one more pose; a gap or a step back in time forgets what was."""
        kept = self.poses
        if kept and not 0.0 < pose.t - kept[-1].t <= LONGEST_GAP:
            if pose.t == kept[-1].t:
                return self
            kept = ()
        old = sum(p.t < pose.t - TRACK_WINDOW for p in kept)
        return _Swept((*kept[min(old, max(0, len(kept) - FEWEST + 1)) :], pose))


class Predictor:
    """Looks ahead from each pose in turn. Remembers the last seconds' track, which one of the two ways needs."""

    def __init__(self, settings: FilterSettings | None = None, way: Way = Way.FILTER) -> None:
        self._settings = settings or FilterSettings()
        self._way = way
        self._swept = _Swept()

    def step(self, pose: Pose, look_ahead_s: float | None = None) -> Prediction | None:
        """The pose after the look-ahead (the settings' own when None) and the arc there.

        None below 0.3 m/s and with an unknown heading. Raises ``ValueError`` outside 0.5 to 3 s.
        """
        seconds = self._settings.look_ahead if look_ahead_s is None else look_ahead_s
        if not LOOK_AHEAD_MIN <= seconds <= LOOK_AHEAD_MAX:
            msg = f"look ahead: {seconds:g} s is not between {LOOK_AHEAD_MIN:g} and {LOOK_AHEAD_MAX:g} s"
            raise ValueError(msg)
        if self._way is Way.TRACK:
            self._swept = self._swept.after(pose)
        if abs(pose.speed) < SLOWEST or not pose.heading_known:
            return None
        if self._way is Way.TRACK and len(self._swept.poses) >= 3:
            later, places = _carried_on(self._swept.poses, seconds)
        else:
            later, places = _along(pose, seconds)
        places.setflags(write=False)
        return Prediction(look_ahead_s=seconds, pose=later, arc=places)

    def fork(self) -> "Predictor":
        """An independent copy."""
        other = Predictor(self._settings, self._way)
        other._swept = self._swept
        return other


def _carried_on(swept: tuple[Pose, ...], seconds: float) -> tuple[Pose, FloatArray]:
    """The pose at the end of the swept track's own curve, carried on from the newest pose, and the places there."""
    newest = swept[-1]
    t = np.array([p.t - newest.t for p in swept])
    track = np.array([(p.east - newest.east, p.north - newest.north) for p in swept])
    degree = 2 if len(swept) >= FEWEST else 1
    curve = _fitted(t, track, degree)
    times = np.linspace(0.0, seconds, max(2, math.ceil(seconds / ARC_STEP)) + 1)
    powers = times[:, np.newaxis] ** np.arange(degree + 1)
    places = (powers @ curve) - curve[0]
    slopes = (powers[:, :-1] * np.arange(1, degree + 1)) @ curve[1:]
    backwards = math.pi if newest.speed < 0 else 0.0
    headings = np.unwrap(np.arctan2(slopes[:, 0], slopes[:, 1]))
    stretch = float(np.hypot(*slopes[-1])) or abs(newest.speed)
    turn_rate = float(headings[-1] - headings[-2]) / (seconds / (len(times) - 1))
    ahead = places + np.array([newest.east, newest.north])
    later = _at(
        newest,
        seconds,
        float(ahead[-1, 0]),
        float(ahead[-1, 1]),
        float(headings[-1]) + backwards,
        turn_rate / math.copysign(max(stretch, SLOWEST), newest.speed),
    )
    return later, ahead


def _fitted(t: FloatArray, track: FloatArray, degree: int) -> FloatArray:
    """Least squares, shape (degree + 1, 2): coefficients of east and north in rising powers of time."""
    powers = t[:, np.newaxis] ** np.arange(degree + 1)
    return np.asarray(np.linalg.lstsq(powers, track, rcond=None)[0], dtype=np.float64)
