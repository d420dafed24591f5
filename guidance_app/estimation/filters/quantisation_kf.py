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

import math
from dataclasses import dataclass

from guidance_app.angles import wrap_2pi, wrap_pi
from guidance_app.estimation.filter import Filter, FilterSettings, QuantisationSettings, Start, Variances
from guidance_app.estimation.receiver_noise import fix_covariance
from guidance_app.estimation.reference_point import offset_point
from guidance_app.estimation.travel import Travel
from guidance_app.model import Measurement, Pose

__all__ = ["FourStates", "QuantisationFilter", "correct", "predict"]

LONGEST_GAP = 5.0
STANDING = 0.1
CREEPING = 0.15
STEPS = 2
"""Heading and speed are read over this many steps where the receiver gives none."""
INNOVATION_MEMORY = 0.1
"""Weight of the newest innovation in the running scale of the covariance."""


FourStates = tuple[float, float, float, float, float, float, float, float, float, float, float]
"""East, north, heading, speed; then the covariances east-east, east-north, east-speed, north-north, north-speed,
speed-speed, and the heading's variance. A plain tuple, because one is made for each fix."""


@dataclass(frozen=True, slots=True)
class _Memory:
    """What is kept from epoch to epoch. ``fixes`` are the last two with their times."""

    fixes: tuple[tuple[float, float, float], ...]
    travel: Travel
    course: float | None
    state: FourStates | None
    scale: float
    pose: Pose


class QuantisationFilter:
    """Four-state Kalman filter that smooths the receiver's rounding on straight lines."""

    def __init__(self, settings: FilterSettings) -> None:
        self._settings = settings
        self._memory: _Memory | None = None
        self._scatter: tuple[float, float, float] | None = None

    def step(self, z: Measurement) -> Pose:
        """The pose; until heading and speed are there it is the fix itself with ``heading_known`` False."""
        memory = self._memory
        if memory is not None and z.t <= memory.pose.t:
            return memory.pose
        if memory is not None and z.t - memory.pose.t > LONGEST_GAP:
            memory = None
        fixes = memory.fixes if memory else ()
        travel = (memory.travel if memory else Travel()).to(z.east, z.north, z.heading)
        measured = _course_and_speed(z, fixes, travel, memory.course if memory else None)
        state, scale = _next_state(memory, z, measured, self._settings.quantisation_kf)
        course = measured[0] if measured else None
        pose = _pose(z, state, scale, travel, fix_covariance(z, self._scatter))
        self._memory = _Memory((*fixes, (z.t, z.east, z.north))[-STEPS:], travel, course, state, scale, pose)
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


def _course_and_speed(
    z: Measurement, fixes: tuple[tuple[float, float, float], ...], travel: Travel, course: float | None
) -> tuple[float, float] | None:
    """The two derived measurements: heading of the body, and speed, negative in reverse. None before there are any.

    Slower than ``CREEPING`` a course is noise; the last one stays.
    """
    if z.speed is not None:
        speed = z.speed
        measured = course if z.course is None else _body(z.course, travel)
    elif len(fixes) == STEPS:
        t, east, north = fixes[0]
        de, dn = z.east - east, z.north - north
        speed = math.hypot(de, dn) / (z.t - t)
        measured = _body(math.atan2(de, dn), travel)
    else:
        return None
    if speed < CREEPING:
        measured = course
    if z.heading is not None:
        measured = z.heading
    if measured is None:
        return None
    return measured, -speed if travel.reverse else speed


def _body(course: float, travel: Travel) -> float:
    """The body's heading when it travels along ``course``."""
    return wrap_pi(course + math.pi) if travel.reverse else course


def _next_state(
    memory: _Memory | None, z: Measurement, measured: tuple[float, float] | None, settings: QuantisationSettings
) -> tuple[FourStates | None, float]:
    """The new state, and the running ratio of the innovations to what the covariance foresaw."""
    before = memory.state if memory else None
    if measured is None:
        return before, 1.0
    theta, u = measured
    if memory is None or before is None:
        p0 = settings.start_covariance
        return (z.east, z.north, theta, u, p0[0], 0.0, 0.0, p0[1], 0.0, p0[3], p0[2]), 1.0
    predicted = predict(before, z.t - memory.pose.t, settings.process_noise)
    r = settings.measurement_noise
    ratio = (z.east - predicted[0]) ** 2 / (predicted[4] + r[0]) + (z.north - predicted[1]) ** 2 / (predicted[7] + r[1])
    scale = memory.scale + INNOVATION_MEMORY * (0.5 * ratio - memory.scale)
    return correct(predicted, (z.east, z.north, theta, u), r), scale


def predict(s: FourStates, dt: float, q: Variances) -> FourStates:
    """Eqs 4 to 9: straight on. P = F P F' + Q with a = dt sin(heading), b = dt cos(heading) in F."""
    x, y, theta, u, pxx, pxy, pxu, pyy, pyu, puu, pt = s
    a = dt * math.sin(theta)
    b = dt * math.cos(theta)
    return (
        x + a * u,
        y + b * u,
        theta,
        u,
        pxx + a * (2.0 * pxu + a * puu) + q[0],
        pxy + b * pxu + a * pyu + a * b * puu,
        pxu + a * puu,
        pyy + b * (2.0 * pyu + b * puu) + q[1],
        pyu + b * puu,
        puu + q[3],
        pt + q[2],
    )


def correct(s: FourStates, z: tuple[float, float, float, float], r: Variances) -> FourStates:
    """Eq. 10 with H = I, one component after the other, which is the same because R is diagonal."""
    x, y, theta, u, pxx, pxy, pxu, pyy, pyu, puu, pt = s

    total = pxx + r[0]
    kx, ky, ku = pxx / total, pxy / total, pxu / total
    innovation = z[0] - x
    x, y, u = x + kx * innovation, y + ky * innovation, u + ku * innovation
    pyy, pyu, puu = pyy - ky * pxy, pyu - ky * pxu, puu - ku * pxu
    pxx, pxy, pxu = pxx - kx * pxx, pxy - kx * pxy, pxu - kx * pxu

    total = pyy + r[1]
    kx, ky, ku = pxy / total, pyy / total, pyu / total
    innovation = z[1] - y
    x, y, u = x + kx * innovation, y + ky * innovation, u + ku * innovation
    pxx, pxu, puu = pxx - kx * pxy, pxu - kx * pyu, puu - ku * pyu
    pxy, pyy, pyu = pxy - ky * pxy, pyy - ky * pyy, pyu - ky * pyu

    total = puu + r[3]
    kx, ky, ku = pxu / total, pyu / total, puu / total
    innovation = z[3] - u
    x, y, u = x + kx * innovation, y + ky * innovation, u + ku * innovation
    pxx, pxy, pyy = pxx - kx * pxu, pxy - kx * pyu, pyy - ky * pyu
    pxu, pyu, puu = pxu - ku * pxu, pyu - ku * pyu, puu - ku * puu

    kt = pt / (pt + r[2])
    theta = wrap_pi(theta + kt * wrap_pi(z[2] - theta))
    return x, y, theta, u, pxx, pxy, pxu, pyy, pyu, puu, (1.0 - kt) * pt


def _pose(
    z: Measurement, state: FourStates | None, scale: float, travel: Travel, floor: tuple[float, float, float]
) -> Pose:
    if state is None:
        return Pose(
            z.t,
            z.arrival,
            z.east,
            z.north,
            heading=0.0,
            speed=0.0,
            covariance=floor,
            heading_known=False,
            roll=z.roll,
            pitch=z.pitch,
        )
    x, y, theta, u, pxx, pxy, _, pyy, _, _, _ = state
    forward, right, _ = z.antenna
    east, north = offset_point(x, y, theta, -forward, -right)
    return Pose(
        t=z.t,
        arrival=z.arrival,
        east=east,
        north=north,
        heading=wrap_2pi(theta),
        speed=u,
        covariance=(scale * pxx + 0.25 * floor[0], scale * pxy, scale * pyy + 0.25 * floor[2]),
        standing=abs(u) < STANDING,
        reverse=travel.reverse,
        roll=z.roll,
        pitch=z.pitch,
    )
