"""The filter of Inoue, Nii, Zhang and Atanasov: speed and gyro heading carry the position, the fixes correct both.

State east, north (of the reference point), eps_v (what the speed lacks), eps_theta (what the gyro's heading lacks).
The paper's angle is a heading already; its B is the antenna's distance to the left. With t = theta + eps_theta and
D = (v + eps_v) dt - a dt^2 / 2 the model is

    east += D sin t,    north += D cos t                                            (2)-(8), corrected
    antenna = (east + L sin t - B cos t,  north + L cos t + B sin t)                (9)-(11), corrected

and P, K and the update are the paper's (12)-(14), linearised at t. Corrected against the print: the sign of a dt^2 /
2 (v is the speed at the end of the interval; the printed sign errs by 5 cm/s at 0.5 m/s2), d with its B terms, the
second printed form of H, R in (14). The acceleration's own error is left out: its column is dt / 2 times that of
eps_v, so no measurement tells the two apart (rank 4 of 5). ``as_printed`` in the settings puts all of that back,
linearised at eps = 0, and with it the paper's remedy for its divergence: raw data in turns faster than 15 degrees a
second.

Inputs: the receiver's speed; the attitude sensor's heading, else the gyro's rate carried on from the first course.
What is missing is held at its first value, and its error walks faster: without both it is a filter of constant
velocity. A fix beyond the gate is dead-reckoned over, five at most. Standing, nothing moves. Time: a gap of more than
5 s takes the next fix as it is and keeps the heading's correction.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from guidance_app.angles import wrap_2pi, wrap_pi
from guidance_app.estimation.correction_kernels import carried_covariance, corrected, gate_distance
from guidance_app.estimation.filter import Filter, FilterSettings, GyroSettings, Start
from guidance_app.estimation.receiver_noise import DEFAULT_CELL, fix_covariance, noise_of
from guidance_app.estimation.reference_point import offset_point
from guidance_app.estimation.starting import without_heading
from guidance_app.estimation.stillness import Stillness
from guidance_app.estimation.travel import Travel
from guidance_app.model import FloatArray, Measurement, Pose
from guidance_app.model.making import made_quickly

__all__ = ["GyroFilter", "Inputs", "antenna_position", "moved", "observation_jacobian", "transition_jacobian"]

EAST, NORTH, SPEED_ERROR, HEADING_ERROR = range(4)
ACCELERATION_ERROR = 4
LONGEST_GAP = 5.0
DEAD_RECKONED = 5
STANDING = 0.1
FAST_TURN = math.radians(15)
FIRST_SPEED_VARIANCE = 0.1**2
FIRST_HEADING_VARIANCE = math.radians(6) ** 2
FIRST_ACCELERATION_VARIANCE = 0.1**2
MISSING_SPEED_VARIANCE = 2.0**2
MISSING_SPEED_WALK = 0.2**2
MISSING_HEADING_WALK = 0.06**2
STANDING_VARIANCE = 0.01**2


@made_quickly
@dataclass(frozen=True, slots=True)
class Inputs:
    """What drives the model over one interval: speed, acceleration and heading at its end, and its length."""

    speed: float
    acceleration: float
    heading: float
    dt: float


def moved(x: FloatArray, u: Inputs, *, as_printed: bool = False) -> FloatArray:
    """Eqs 2 and 3: the state after the interval. As printed the acceleration's term has the other sign."""
    sign = 1.0 if as_printed else -1.0
    acceleration = u.acceleration + (x[ACCELERATION_ERROR] if as_printed else 0.0)
    way = (u.speed + x[SPEED_ERROR]) * u.dt + sign * acceleration * u.dt**2 / 2
    t = u.heading + x[HEADING_ERROR]
    after = x.copy()
    after[EAST] += way * math.sin(t)
    after[NORTH] += way * math.cos(t)
    return after


def transition_jacobian(x: FloatArray, u: Inputs, *, as_printed: bool = False) -> FloatArray:
    """A of eq. 7 about ``x``: derivative of ``moved``."""
    sign = 1.0 if as_printed else -1.0
    acceleration = u.acceleration + (x[ACCELERATION_ERROR] if as_printed else 0.0)
    way = (u.speed + x[SPEED_ERROR]) * u.dt + sign * acceleration * u.dt**2 / 2
    t = u.heading + x[HEADING_ERROR]
    F = np.eye(x.size)
    F[EAST, SPEED_ERROR], F[NORTH, SPEED_ERROR] = math.sin(t) * u.dt, math.cos(t) * u.dt
    F[EAST, HEADING_ERROR], F[NORTH, HEADING_ERROR] = way * math.cos(t), -way * math.sin(t)
    if as_printed:
        half = sign * u.dt**2 / 2
        F[EAST, ACCELERATION_ERROR], F[NORTH, ACCELERATION_ERROR] = half * math.sin(t), half * math.cos(t)
    return F


def antenna_position(x: FloatArray, heading: float, forward: float, left: float) -> FloatArray:
    """Eq. 9: where the antenna is, (east, north). ``forward`` and ``left`` are the paper's L and B."""
    t = heading + x[HEADING_ERROR]
    sine, cosine = math.sin(t), math.cos(t)
    return np.array([x[EAST] + forward * sine - left * cosine, x[NORTH] + forward * cosine + left * sine])


def observation_jacobian(x: FloatArray, heading: float, forward: float, left: float) -> FloatArray:
    """H of eq. 11, second printed form, about ``x``: derivative of ``antenna_position``."""
    t = heading + x[HEADING_ERROR]
    sine, cosine = math.sin(t), math.cos(t)
    H = np.zeros((2, x.size))
    H[0, EAST] = H[1, NORTH] = 1.0
    H[0, HEADING_ERROR] = forward * cosine + left * sine
    H[1, HEADING_ERROR] = -forward * sine + left * cosine
    return H


@made_quickly
@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """``speed`` and ``heading`` are the inputs, not the estimates; ``x`` and ``p`` are replaced, never written to."""

    z: Measurement
    travel: Travel
    still: Stillness
    speed: float
    heading: float | None
    x: FloatArray | None
    p: FloatArray | None
    rejected: int
    pose: Pose


class GyroFilter:
    """Extended Kalman filter of speed, gyro and fixes."""

    def __init__(self, settings: FilterSettings) -> None:
        self._settings = settings
        self._state: _State | None = None
        self._start: Start | None = None

    def step(self, z: Measurement) -> Pose:
        """The pose; until there is a heading it is the fix itself with ``heading_known`` False."""
        before = self._state
        if before is not None and z.t <= before.z.t:
            return before.pose
        travel = (before.travel if before else Travel()).to(z.east, z.north, z.heading)
        still = before.still.after(z, noise_of(z).white) if before else Stillness.of(z)
        standing = still.speed_bound(z, noise_of(z).white) is not None
        heading = _input_heading(before, z, travel, self._gyro_bias(), standing=standing)
        if heading is None:
            pose = without_heading(z)
            self._state = _State(z, travel, still, pose.speed, None, None, None, 0, pose)
        else:
            self._state = self._next(before, z, (travel, still), heading, standing=standing)
        return self._state.pose

    def begin(self, start: Start) -> None:
        """R becomes the fixes' sample covariance, the gyro's rate loses its bias."""
        self._start = start

    def fork(self) -> Filter:
        """An independent copy: the state is frozen, so it is shared."""
        other = GyroFilter(self._settings)
        other._state, other._start = self._state, self._start
        return other

    def _next(
        self, before: _State | None, z: Measurement, way: tuple[Travel, Stillness], heading: float, *, standing: bool
    ) -> _State:
        travel, still = way
        settings = self._settings.gyro_ekf
        R = self._fix_noise(z)
        speed = _input_speed(before, z, travel, standing=standing)
        if before is None or before.x is None or before.p is None or _wrong_way(before, z, travel):
            x, p, rejected = *_first(z, heading, R, settings), 0
        elif z.t - before.z.t > LONGEST_GAP:
            x, p, rejected = *_taken_up(before.x, before.p, z, heading, R), 0
        else:
            dt = z.t - before.z.t
            u = Inputs(speed, (speed - before.speed) / dt, heading, dt)
            x, p = _predicted(before.x, before.p, u, _walks(z, settings, standing=standing))
            x, p, rejected = _corrected(x, p, z, heading, R, (settings, before.rejected))
        if standing:
            x, p = _stopped(x, p, speed)
        rate = _yaw_rate(before, z, heading)
        pose = _pose(z, (x, p), (heading, speed, rate), standing=standing, dead_reckoned=rejected > 0)
        if settings.as_printed and abs(rate) > FAST_TURN:
            pose = _raw(pose, z)
        return _State(z, travel, still, speed, heading, x, p, rejected, pose)

    def _fix_noise(self, z: Measurement) -> FloatArray:
        """R: what was measured at the start point, but not less than the rounding; else by the quality of the fix."""
        noise = noise_of(z)
        if self._start is None and noise.drift > 0.0:
            return np.eye(2) * self._settings.gyro_ekf.position_noise
        cell = z.cell or (DEFAULT_CELL, DEFAULT_CELL)
        least = np.diag([cell[0] ** 2 / 12 + noise.white**2, cell[1] ** 2 / 12 + noise.white**2])
        if self._start is None:
            return least
        east, cross, north = self._start.covariance
        measured = np.array([[east, cross], [cross, north]])
        return measured if np.trace(measured) > np.trace(least) else least

    def _gyro_bias(self) -> float:
        """The gyro's mean rate while standing at the start point, zero when there was none."""
        return 0.0 if self._start is None or self._start.gyro_bias is None else self._start.gyro_bias


def _wrong_way(before: _State, z: Measurement, travel: Travel) -> bool:
    """Whether a first heading from a start in reverse has now shown itself as such."""
    if z.heading is not None or travel.heading is None or before.travel.reverse <= travel.reverse:
        return False
    return abs(wrap_pi(travel.heading - before.pose.heading)) > math.pi / 2


def _input_heading(
    before: _State | None, z: Measurement, travel: Travel, bias: float, *, standing: bool
) -> float | None:
    """The attitude sensor's heading, else the gyro carried on; without both the first course, held."""
    if z.heading is not None:
        return z.heading
    if before is None or before.heading is None or _wrong_way(before, z, travel):
        return travel.heading
    if z.yaw_rate is None or standing or z.t - before.z.t > LONGEST_GAP:
        return before.heading
    mean_rate = z.yaw_rate if before.z.yaw_rate is None else 0.5 * (z.yaw_rate + before.z.yaw_rate)
    return before.heading + (mean_rate - bias) * (z.t - before.z.t)


def _input_speed(before: _State | None, z: Measurement, travel: Travel, *, standing: bool) -> float:
    """The receiver's speed, negative when its course runs against the body; without one zero, all of it an error."""
    if z.speed is None or standing:
        return 0.0
    backwards = travel.reverse
    if z.course is not None and before is not None and before.pose.heading_known:
        backwards = math.cos(z.course - before.pose.heading) < 0.0
    return -z.speed if backwards else z.speed


def _walks(z: Measurement, settings: GyroSettings, *, standing: bool) -> FloatArray:
    """Variances per second of the state's random walks."""
    speed = settings.speed_walk if z.speed is not None else MISSING_SPEED_WALK
    heading = settings.heading_walk if z.heading is not None or z.yaw_rate is not None else MISSING_HEADING_WALK
    walks = [settings.position_walk, settings.position_walk, speed, 0.0 if standing else heading]
    return np.array([*walks, settings.speed_walk] if settings.as_printed else walks)


def _stopped(x: FloatArray, p: FloatArray, speed: float) -> tuple[FloatArray, FloatArray]:
    """The speed is known to be zero."""
    H = np.zeros(x.size)
    H[SPEED_ERROR] = 1.0
    S = float(p[SPEED_ERROR, SPEED_ERROR]) + STANDING_VARIANCE
    K = p[:, SPEED_ERROR] / S
    return x - K * (speed + x[SPEED_ERROR]), p - np.outer(K, K) * S


def _yaw_rate(before: _State | None, z: Measurement, heading: float) -> float:
    if z.yaw_rate is not None:
        return z.yaw_rate
    if before is None or before.heading is None:
        return 0.0
    return wrap_pi(heading - before.heading) / (z.t - before.z.t)


def _first(z: Measurement, heading: float, R: FloatArray, settings: GyroSettings) -> tuple[FloatArray, FloatArray]:
    size = 5 if settings.as_printed else 4
    x = np.zeros(size)
    x[:2] = offset_point(z.east, z.north, heading, -z.antenna[0], -z.antenna[1])
    p = np.zeros((size, size))
    p[:2, :2] = R
    p[SPEED_ERROR, SPEED_ERROR] = FIRST_SPEED_VARIANCE if z.speed is not None else MISSING_SPEED_VARIANCE
    p[HEADING_ERROR, HEADING_ERROR] = (z.heading_sigma or 0.0) ** 2 + FIRST_HEADING_VARIANCE
    if settings.as_printed:
        p[ACCELERATION_ERROR, ACCELERATION_ERROR] = FIRST_ACCELERATION_VARIANCE
    return x, p


def _taken_up(
    x: FloatArray, p: FloatArray, z: Measurement, heading: float, R: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """After a gap: the fix as it is, and what was learnt of speed and heading."""
    x, p = x.copy(), p.copy()
    t = heading + x[HEADING_ERROR]
    x[:2] = offset_point(z.east, z.north, t, -z.antenna[0], -z.antenna[1])
    p[:2, :] = 0.0
    p[:, :2] = 0.0
    p[:2, :2] = R
    return x, p


def _predicted(x: FloatArray, p: FloatArray, u: Inputs, walks: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Eq. 6 and the second half of eq. 14. As printed (five states), linear about eps = 0."""
    if x.size > ACCELERATION_ERROR:
        origin = np.zeros(x.size)
        origin[:2] = x[:2]
        F = transition_jacobian(origin, u, as_printed=True)
        after = moved(origin, u, as_printed=True) + F @ (x - origin)
    else:
        F = transition_jacobian(x, u)
        after = moved(x, u)
    return after, carried_covariance(F, p, walks, u.dt)


def _corrected(
    x: FloatArray,
    p: FloatArray,
    z: Measurement,
    heading: float,
    R: FloatArray,
    gate: tuple[GyroSettings, int],
) -> tuple[FloatArray, FloatArray, int]:
    """Eqs 12 and 13 with a gate; ``gate`` holds how many fixes were rejected in a row. The last is the new count."""
    settings, rejected = gate
    forward, left = z.antenna[0], -z.antenna[1]
    if settings.as_printed:
        origin = np.zeros(x.size)
        H = observation_jacobian(origin, heading, forward, left)
        d = forward * np.array([math.sin(heading), math.cos(heading)])
        expected = H @ x + d
    else:
        H = observation_jacobian(x, heading, forward, left)
        expected = antenna_position(x, heading, forward, left)
    innovation = np.array([z.east, z.north]) - expected
    if gate_distance(H, p, R, innovation) > settings.gate:
        if rejected < DEAD_RECKONED:
            return x, p, rejected + 1
        p = p.copy()
        p[:2, :2] += np.eye(2) * float(innovation @ innovation)
    return *corrected(x, p, H, R, innovation), 0


def _pose(
    z: Measurement,
    estimate: tuple[FloatArray, FloatArray],
    inputs: tuple[float, float, float],
    *,
    standing: bool,
    dead_reckoned: bool,
) -> Pose:
    """From state and covariance, and the inputs heading, speed and yaw rate."""
    x, p = estimate
    heading, speed, rate = inputs
    forward = speed + float(x[SPEED_ERROR])
    drift = noise_of(z).drift ** 2
    return Pose(
        t=z.t,
        arrival=z.arrival,
        east=float(x[EAST]),
        north=float(x[NORTH]),
        heading=wrap_2pi(heading + float(x[HEADING_ERROR])),
        speed=forward,
        curvature=rate / forward if abs(forward) > 0.3 else 0.0,
        covariance=(float(p[0, 0]) + drift, float(p[0, 1]), float(p[1, 1]) + drift),
        heading_sigma=math.sqrt(float(p[HEADING_ERROR, HEADING_ERROR])),
        standing=standing,
        reverse=forward < -STANDING,
        dead_reckoned=dead_reckoned,
        roll=z.roll,
        pitch=z.pitch,
    )


def _raw(pose: Pose, z: Measurement) -> Pose:
    east, north = offset_point(z.east, z.north, pose.heading, -z.antenna[0], -z.antenna[1])
    return replace(pose, east=east, north=north, covariance=fix_covariance(z))
