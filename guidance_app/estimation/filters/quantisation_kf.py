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
from dataclasses import dataclass, replace

from guidance_app.angles import wrap_2pi, wrap_pi
from guidance_app.estimation.filter import Filter, FilterSettings, QuantisationSettings, Start
from guidance_app.estimation.receiver_noise import fix_covariance
from guidance_app.estimation.reference_point import offset_point
from guidance_app.estimation.travel import Travel
from guidance_app.model import Measurement, Pose

__all__ = ["QuantisationFilter"]

LONGEST_GAP = 5.0
STANDING = 0.1
STEPS = 2
"""Heading and speed are read over this many steps where the receiver gives none."""
INNOVATION_MEMORY = 0.1
"""Weight of the newest innovation in the running scale of the covariance."""


@dataclass(frozen=True, slots=True)
class _State:
    """Mean and covariance. ``pxu`` is the covariance of east and speed, and so on; ``pt`` the heading's variance."""

    x: float
    y: float
    theta: float
    u: float
    pxx: float
    pxy: float
    pxu: float
    pyy: float
    pyu: float
    puu: float
    pt: float
    scale: float = 1.0


@dataclass(frozen=True, slots=True)
class _Memory:
    """What is kept from epoch to epoch. ``fixes`` are the last two with their times."""

    fixes: tuple[tuple[float, float, float], ...]
    travel: Travel
    course: float | None
    state: _State | None
    pose: Pose


class QuantisationFilter:
    """Four-state Kalman filter that smooths the receiver's rounding on straight lines."""

    def __init__(self, settings: FilterSettings) -> None:
        self._settings = settings
        self._memory: _Memory | None = None

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
        state = _next_state(memory, z, measured, self._settings.quantisation_kf)
        pose = _pose(z, state, travel)
        course = measured[0] if measured else None
        self._memory = _Memory((*fixes, (z.t, z.east, z.north))[-STEPS:], travel, course, state, pose)
        return pose

    def begin(self, start: Start) -> None:
        """Nothing to take over: only the ratio of Q to R matters here, and both are the paper's."""

    def fork(self) -> Filter:
        """An independent copy."""
        other = QuantisationFilter(self._settings)
        other._memory = self._memory
        return other


def _course_and_speed(
    z: Measurement, fixes: tuple[tuple[float, float, float], ...], travel: Travel, course: float | None
) -> tuple[float, float] | None:
    """The two derived measurements: heading of the body, and speed, negative in reverse. None before there are any."""
    if z.speed is not None and (z.course is not None or course is not None):
        speed = z.speed
        measured = course if z.course is None else _body(z.course, travel)
    elif len(fixes) == STEPS:
        t, east, north = fixes[0]
        de, dn = z.east - east, z.north - north
        speed = math.hypot(de, dn) / (z.t - t)
        measured = course if de == 0.0 == dn else _body(math.atan2(de, dn), travel)
    else:
        return None
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
) -> _State | None:
    before = memory.state if memory else None
    if measured is None:
        return before
    theta, u = measured
    if memory is None or before is None:
        p0 = settings.start_covariance
        return _State(z.east, z.north, theta, u, p0[0], 0.0, 0.0, p0[1], 0.0, p0[3], p0[2])
    predicted = _predicted(before, z.t - memory.pose.t, settings)
    return _updated(predicted, (z.east, z.north, theta, u), settings)


def _predicted(s: _State, dt: float, settings: QuantisationSettings) -> _State:
    """Eqs 4 to 9: straight on. P = F P F' + Q with a = dt sin(heading), b = dt cos(heading) in F."""
    a = dt * math.sin(s.theta)
    b = dt * math.cos(s.theta)
    q = settings.process_noise
    return replace(
        s,
        x=s.x + a * s.u,
        y=s.y + b * s.u,
        pxx=s.pxx + a * (2.0 * s.pxu + a * s.puu) + q[0],
        pxy=s.pxy + b * s.pxu + a * s.pyu + a * b * s.puu,
        pxu=s.pxu + a * s.puu,
        pyy=s.pyy + b * (2.0 * s.pyu + b * s.puu) + q[1],
        pyu=s.pyu + b * s.puu,
        puu=s.puu + q[3],
        pt=s.pt + q[2],
    )


def _updated(s: _State, z: tuple[float, float, float, float], settings: QuantisationSettings) -> _State:
    """Eq. 10 with H = I, one component after the other, which is the same because R is diagonal."""
    r = settings.measurement_noise
    ratio = 0.5 * ((z[0] - s.x) ** 2 / (s.pxx + r[0]) + (z[1] - s.y) ** 2 / (s.pyy + r[1]))
    scale = s.scale + INNOVATION_MEMORY * (ratio - s.scale)
    x, y, u = s.x, s.y, s.u
    pxx, pxy, pxu, pyy, pyu, puu = s.pxx, s.pxy, s.pxu, s.pyy, s.pyu, s.puu

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

    kt = s.pt / (s.pt + r[2])
    theta = wrap_pi(s.theta + kt * wrap_pi(z[2] - s.theta))
    return _State(x, y, theta, u, pxx, pxy, pxu, pyy, pyu, puu, (1.0 - kt) * s.pt, scale)


def _pose(z: Measurement, state: _State | None, travel: Travel) -> Pose:
    if state is None:
        return Pose(
            z.t, z.arrival, z.east, z.north, 0.0, 0.0, covariance=fix_covariance(z), heading_known=False, roll=z.roll,
            pitch=z.pitch,
        )  # fmt: skip
    forward, right, _ = z.antenna
    east, north = offset_point(state.x, state.y, state.theta, -forward, -right)
    floor_east, _, floor_north = fix_covariance(z)
    return Pose(
        t=z.t,
        arrival=z.arrival,
        east=east,
        north=north,
        heading=wrap_2pi(state.theta),
        speed=state.u,
        covariance=(
            max(state.scale * state.pxx, floor_east / 4),
            state.scale * state.pxy,
            max(state.scale * state.pyy, floor_north / 4),
        ),
        heading_known=travel.heading is not None or z.course is not None,
        standing=abs(state.u) < STANDING,
        reverse=travel.reverse,
        roll=z.roll,
        pitch=z.pitch,
    )
