"""The filter of Gomez-Gil et al., Sensors 13 (2013), equations 4 to 14: it takes the staircase out of coarse fixes.

State east, north, heading, speed; the paper's x is east, its y north, and its angle is written as a heading here,
which changes no number. F by eq. 9, for mean and covariance alike; H is the identity (eq. 11); Q, R and the start
covariance of eq. 14. F couples the heading to nothing in the covariance, so the heading is a filter of its own beside
one of three states, and the update can be made one component at a time; both are exact, not approximations.

What the paper leaves open, and what was chosen:

* Heading and speed "measured by the receiver" are its RMC or VTG course and speed where given, else differences over
  two steps. One-step differences of rounded fixes are biased: 4.7 against 3.8 cm on the paper's own lines.
* The innovation of the heading is wrapped. Without it, headings beyond 180 degrees give 27 cm instead of 5.

**Where it fails.** It is a filter for straight lines: 18 cm out on an arc of 50 m radius, 25 cm in a U-turn of 5 m, its
heading 2.2 to 2.8 s late, because its model never turns. It has no gate: an outlier of 3 m moves it by about 1.7 m on
its first fix. It is offered because it is in the literature, not as the default.

Time: Q is per step, as printed. A gap of more than 5 s starts it anew. The covariance that is shown is scaled by what
the innovations really are, because eq. 14 carries no unit.
"""

from dataclasses import dataclass

import numpy as np

from guidance_app.estimation.filter import Filter, FilterSettings, Start
from guidance_app.estimation.observation_kernels import NO_COURSE
from guidance_app.estimation.quantisation_kernels import NO_SPEED, POSE, advance, nothing_seen
from guidance_app.estimation.receiver_noise import fix_covariance
from guidance_app.model import FloatArray, Measurement, Pose

__all__ = ["QuantisationFilter"]


@dataclass(frozen=True, slots=True, eq=False)
class _Memory:
    """``kernel`` is what ``quantisation_kernels`` keep from epoch to epoch, never written to."""

    kernel: FloatArray
    pose: Pose


class QuantisationFilter:
    """Four-state Kalman filter that smooths the receiver's rounding on straight lines."""

    def __init__(self, settings: FilterSettings) -> None:
        self._settings = settings
        self._noise = np.array(settings.quantisation_kf.numbers)
        self._memory: _Memory | None = None
        self._scatter: tuple[float, float, float] | None = None

    def step(self, z: Measurement) -> Pose:
        """The pose; until heading and speed are there it is the fix itself with ``heading_known`` False."""
        memory = self._memory
        if memory is not None and z.t <= memory.pose.t:
            return memory.pose
        kernel = memory.kernel.copy() if memory is not None else nothing_seen()
        shown = np.empty(POSE)
        advance(kernel, _epoch(z, self._scatter), self._noise, shown)
        pose = _pose(z, shown.tolist())
        self._memory = _Memory(kernel, pose)
        return pose

    def begin(self, start: Start) -> None:
        """The scatter of the fixes at the start point is what the ellipse is at least.

        R stays the paper's: only its ratio to Q matters, and neither has a unit. There is no gyro here.
        """
        self._scatter = start.covariance

    def fork(self) -> Filter:
        """An independent copy."""
        other = QuantisationFilter(self._settings)
        other._memory, other._scatter = self._memory, self._scatter
        return other


def _epoch(z: Measurement, scatter: tuple[float, float, float] | None) -> FloatArray:
    """What the kernels take of one epoch."""
    return np.array(
        (
            z.t,
            z.east,
            z.north,
            NO_SPEED if z.speed is None else z.speed,
            NO_COURSE if z.course is None else z.course,
            NO_COURSE if z.heading is None else z.heading,
            z.antenna[0],
            z.antenna[1],
            *fix_covariance(z, scatter),
        )
    )


def _pose(z: Measurement, shown: list[float]) -> Pose:
    east, north, heading, speed, var_east, cov, var_north, known, standing, reverse = shown
    return Pose(
        t=z.t,
        arrival=z.arrival,
        east=east,
        north=north,
        heading=heading,
        speed=speed,
        covariance=(var_east, cov, var_north),
        heading_known=known == 1.0,
        standing=standing == 1.0,
        reverse=reverse == 1.0,
        roll=z.roll,
        pitch=z.pitch,
    )
