"""The default filter: four motion models side by side, and every sensor that the epoch holds.

State: see ``kernels``. Its curvature is what lets it follow a turn without lag, and four models of driving
(``motion_models``), mixed by how well each foresees the fixes (``imm_kernels``), are what lets it be smooth on a line
as well: one model alone trades the two, 4.4 cm against 2.7 in the mean over eight scenarios.

* **Position** lies somewhere in its cell, whose size travels with the fix: a truncated normal, not a Gaussian with
  Sheppard's variance, worth 13 % here and most of all on lines along an axis.
* **Velocity** (course and speed of the receiver), **gyro**, **heading sensor**: each where the epoch holds it. There is
  one set of models per kind of input. The lever arm swings all of them.
* **Drift**: a fix that is not RTK carries two more states, the receiver's slow error. A change of fix quality changes
  what is believed of a fix, never the state.
* **Gate**: a fix beyond chi-square 15 of what is within reach of the most mobile model (``manoeuvre_kernels``) is
  dead-reckoned over, at most five in a row. Four that agree within 15 cm are a step of the receiver's: it goes into
  the drift, or, with RTK, is followed. At 1 Hz a metre ahead may be a driver's doing; to the side it is not.
* **Standing**: speed is held at zero (ZUPT), which holds the heading and lets the gyro's bias be learnt (ZARU). The
  same fix again tells a standing tractor nothing new, as long as it is believed within that fix's cell; taken as news
  it would shrink the ellipse below the truth.
* **Reverse**: the heading stays and the speed goes negative. Thirty metres of it without a heading sensor are taken for
  a start in the wrong direction, and turned round.

Time: gaps up to 10 s are predicted over, in steps of half a second; after a longer one it starts anew, with the heading
kept if the tractor stood and still stands there.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from guidance_app.angles import wrap_2pi
from guidance_app.estimation.filter import AdaptiveSettings, Filter, FilterSettings, Start
from guidance_app.estimation.imm_kernels import (
    MODELS,
    REOPENED,
    WITH_POSITION,
    WITHOUT_POSITION,
    Belief,
    Motion,
    imm_step,
    summary,
)
from guidance_app.estimation.kernels import (
    CURVATURE,
    DRIFT_EAST,
    DRIFT_NORTH,
    EAST,
    GYRO_BIAS,
    HEADING,
    NORTH,
    SLIP,
    SPEED,
    STATES,
)
from guidance_app.estimation.motion import MotionTables
from guidance_app.estimation.motion_models import ModelSet
from guidance_app.estimation.observation_kernels import CELL_EAST, CELL_NORTH
from guidance_app.estimation.readings import common_noise, readings, slip_of
from guidance_app.estimation.receiver_noise import DEFAULT_CELL, ReceiverNoise, noise_of
from guidance_app.estimation.reference_point import offset_point
from guidance_app.estimation.refused import Refused, is_lost, step_of
from guidance_app.estimation.starting import Departure, Waiting, without_heading
from guidance_app.estimation.stillness import Stillness
from guidance_app.model import FloatArray, Measurement, Pose
from guidance_app.model.making import made_quickly

__all__ = ["Adaptive"]

LONGEST_GAP = 10.0
LONGEST_BACKING = 30.0
HEADING_LOST = math.radians(35)
"""With a heading less certain than this the screen says that the direction is unknown."""
STANDING_SPEED = 0.06
MOST_SCATTER = 1.0
"""Of a standing receiver's scatter not more than so many metres is believed to be white."""
GYRO_BIAS_SD = 0.01
NO_LAG = np.zeros(2)


@made_quickly
@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """All that is remembered; replaced in each step, its arrays never written to.

    ``belief`` is each model's mean (4, 9), covariance (4, 9, 9) and weight (4,); ``n`` how many states are live;
    ``believed`` the pose at the last fix that was not rejected; ``lag`` (2,) how far the last fixes lay off the poses.
    """

    t: float
    belief: Belief
    n: int
    still: Stillness
    pose: Pose
    believed: Pose
    lag: FloatArray
    rejected: tuple[Refused, ...] = ()
    backed: float = 0.0


@dataclass(frozen=True, slots=True)
class _Before:
    """Before the first heading: what has been seen, and what is kept from an earlier life.

    ``pointed`` is the heading of a moment ago, which tells whether the way that is driven now is a way back.
    """

    waiting: Waiting
    pose: Pose
    gyro_bias: float
    gyro_bias_sd: float
    still: Stillness
    pointed: float | None = None


class Adaptive:
    """Four-model filter over position, heading, speed, curvature and the sensors' slow errors."""

    def __init__(self, settings: FilterSettings, tables: MotionTables | None = None) -> None:
        self._settings = settings
        self._tables = tables or MotionTables(settings.adaptive)
        self._memory: _State | _Before | None = None
        self._start: Start | None = None

    def step(self, z: Measurement) -> Pose:
        """The pose; before the tractor has moved enough it is the fix itself with ``heading_known`` False."""
        memory = self._memory
        if memory is not None and z.t <= memory.pose.t:
            return memory.pose
        noise = self._noise(z)
        if isinstance(memory, _State) and z.t - memory.t > LONGEST_GAP:
            memory = _after_gap(memory, z)
        if isinstance(memory, _State):
            memory = _advanced(memory, z, noise, self._settings.adaptive, self._tables)
            if is_lost(memory.rejected):
                memory = _lost(memory)
        if isinstance(memory, _State):
            self._memory = memory
        else:
            self._memory = self._begun(memory, z, noise)
        return self._memory.pose

    def begin(self, start: Start) -> None:
        """Takes the fixes' scatter and the gyro's bias from the measuring time at the start point."""
        self._start = start

    def fork(self) -> Filter:
        """An independent copy: the state is frozen, so it is shared."""
        other = Adaptive(self._settings, self._tables)
        other._memory, other._start = self._memory, self._start
        return other

    def _noise(self, z: Measurement) -> ReceiverNoise:
        noise = noise_of(z)
        if self._start is None:
            return noise
        east, _, north = self._start.covariance
        cell = z.cell or (DEFAULT_CELL, DEFAULT_CELL)
        flicker = 0.125 * (cell[0] ** 2 + cell[1] ** 2)  # between two cells, by the rounding alone
        measured = math.sqrt(max(0.5 * (east + north) - flicker, 0.0))
        return replace(noise, white=min(max(measured, 0.5 * noise.white), MOST_SCATTER))

    def _begun(self, before: _Before | None, z: Measurement, noise: ReceiverNoise) -> "_State | _Before":
        waiting = (before.waiting if before else Waiting()).to(z)
        still = before.still.after(z, noise.white) if before else Stillness.of(z)
        bias, bias_sd = (before.gyro_bias, before.gyro_bias_sd) if before else (0.0, GYRO_BIAS_SD)
        if self._start is not None and self._start.gyro_bias is not None:
            bias, bias_sd = self._start.gyro_bias, 0.001
        departure = waiting.departure(noise.white)
        if departure is None:
            stands = z.speed is not None and z.speed < STANDING_SPEED
            pose = without_heading(z, standing=stands)
            return _Before(waiting, pose, bias, bias_sd, still, before.pointed if before else None)
        if before is not None and before.pointed is not None and z.heading is None:
            departure = departure.as_before(before.pointed)
        return _started(z, departure, noise, (self._settings.adaptive, self._tables.models(z)), (bias, bias_sd), still)


def _started(
    z: Measurement,
    departure: Departure,
    noise: ReceiverNoise,
    kit: tuple[AdaptiveSettings, ModelSet],
    gyro: tuple[float, float],
    still: Stillness,
) -> _State:
    settings, models = kit
    forward, right, _ = z.antenna
    east, north = offset_point(z.east, z.north, departure.heading, -forward, -right)
    x = np.zeros((MODELS, STATES))
    x[:, EAST], x[:, NORTH] = east, north
    x[:, HEADING], x[:, SPEED] = departure.heading, departure.speed
    x[:, GYRO_BIAS] = gyro[0]
    p = np.zeros((MODELS, STATES, STATES))
    cell = z.cell or (DEFAULT_CELL, DEFAULT_CELL)
    for axis in range(2):
        p[:, axis, axis] = cell[axis] ** 2 / 12 + noise.white**2
    p[:, HEADING, HEADING] = departure.heading_sd**2
    p[:, SPEED, SPEED] = departure.speed_sd**2
    for j, model in enumerate(models.models):
        p[j, CURVATURE, CURVATURE] = min(model.curvature, 0.1) ** 2
    p[:, GYRO_BIAS, GYRO_BIAS] = gyro[1] ** 2
    p[:, SLIP, SLIP] = slip_of(z)[0] ** 2
    n = _live(z, noise, 0)
    if n == STATES:
        for drift, axis in ((DRIFT_EAST, EAST), (DRIFT_NORTH, NORTH)):
            p[:, drift, drift] = noise.drift**2
            p[:, axis, axis] += noise.drift**2
            p[:, drift, axis] = p[:, axis, drift] = -(noise.drift**2)
    w = np.full(MODELS, 1.0 / MODELS)
    belief = (x, p, w)
    epoch = np.array(readings(z, noise, settings, None))
    shown = summary(belief, n, epoch, NO_LAG, fresh=False).tolist()
    pose = _pose(z, shown, None, blind=False)
    return _State(z.t, belief, n, still, pose, pose, NO_LAG)


def _after_gap(state: _State, z: Measurement) -> "_State | _Before":
    """What remains after a long gap: all, if the tractor stood and still stands there; else the gyro's bias."""
    at = offset_point(state.pose.east, state.pose.north, state.pose.heading, z.antenna[0], z.antenna[1])
    x, p, w = state.belief
    drift = x[:, DRIFT_EAST:].mean(axis=0)
    away = math.hypot(z.east - at[0] - drift[0], z.north - at[1] - drift[1])
    if state.pose.standing and away < 1.0:
        p = p.copy()
        p[:, HEADING, HEADING] += math.radians(5) ** 2
        p[:, EAST, EAST] += away**2
        p[:, NORTH, NORTH] += away**2
        return replace(state, t=z.t - 1.0, belief=(x, p, w))
    return replace(_lost(state), waiting=Waiting(), still=Stillness.of(z), pointed=None)


def _lost(state: _State) -> _Before:
    """What remains when the filter is lost: the gyro's bias, and the refused fixes, which tell where it really is."""
    x, p, w = state.belief
    bias = float(w @ x[:, GYRO_BIAS])
    bias_sd = math.sqrt(float(w @ p[:, GYRO_BIAS, GYRO_BIAS])) + 1e-3
    pointed = state.pose.heading if state.pose.heading_known else None
    waiting = Waiting()
    for refused in state.rejected[:-1]:
        waiting = waiting.to(refused.z)
    return _Before(waiting, state.pose, bias, bias_sd, state.still, pointed)


def _advanced(
    state: _State, z: Measurement, noise: ReceiverNoise, settings: AdaptiveSettings, tables: MotionTables
) -> _State:
    """One epoch of a running filter."""
    state = _with_drift(state, z, noise)
    dt = z.t - state.t
    still = state.still.after(z, noise.white)
    bound = still.speed_bound(z, noise.white)
    epoch = np.array(readings(z, noise, settings, bound))
    seen = state.believed
    last = np.array((seen.east, seen.north, seen.heading, seen.speed, z.t - seen.t))
    motion = (tables.rows(z), tables.moves(z, dt), np.array(common_noise(z, noise, settings)), last)
    unchanged = None
    if bound is not None and still.repeats(z):
        unchanged = _unchanged(state, dt, epoch, motion)
    belief, rejected = unchanged or _corrected(state, z, dt, epoch, motion)
    belief, backed = _turned_round(belief, z, state.backed, dt)
    shown = summary(belief, state.n, epoch, state.lag, fresh=unchanged is None and not rejected)
    pose = _pose(z, shown.tolist(), bound, blind=bool(rejected))
    believed = state.believed if rejected else pose
    return _State(z.t, belief, state.n, still, pose, believed, shown[9:], rejected, backed)


def _unchanged(
    state: _State, dt: float, epoch: FloatArray, motion: Motion
) -> tuple[Belief, tuple[Refused, ...]] | None:
    """What a standing tractor knows after the same fix again; None if it is believed outside of that fix's cell."""
    belief, report = imm_step(state.belief, state.n, dt, epoch, WITHOUT_POSITION, motion)
    outside = abs(report[2]) > 0.5 * epoch[CELL_EAST] or abs(report[3]) > 0.5 * epoch[CELL_NORTH]
    return None if outside else (belief, state.rejected)


def _corrected(
    state: _State, z: Measurement, dt: float, epoch: FloatArray, motion: Motion
) -> tuple[Belief, tuple[Refused, ...]]:
    """The new belief, and the fixes rejected in a row until now."""
    belief, report = imm_step(state.belief, state.n, dt, epoch, WITH_POSITION, motion)
    if report[0] == 1.0:
        return belief, ()
    rejected = (*state.rejected, Refused(z, float(report[2]), float(report[3])))
    stepped = step_of(rejected)
    if stepped is not None and state.n == STATES:
        shifted, report = imm_step(_shifted(state.belief, stepped), state.n, dt, epoch, WITH_POSITION, motion)
        if report[0] == 1.0:
            return shifted, ()
    if stepped is not None:
        belief, _ = imm_step(state.belief, state.n, dt, epoch, REOPENED, motion)
        return belief, ()
    return belief, rejected


def _live(z: Measurement, noise: ReceiverNoise, now: int) -> int:
    """How many states are needed."""
    if noise.drift > 0.0:
        return STATES
    if z.heading is not None or now > SLIP:
        return SLIP + 1
    return SLIP


def _with_drift(state: _State, z: Measurement, noise: ReceiverNoise) -> _State:
    """Switches states on and off with the fix quality and the sensors; the position stays where it is."""
    n = _live(z, noise, state.n)
    if n == state.n:
        return state
    x, p, w = state.belief[0].copy(), state.belief[1].copy(), state.belief[2]
    if n < state.n:
        x[:, n:] = 0.0
        p[:, n:, :] = 0.0
        p[:, :, n:] = 0.0
    if state.n <= SLIP < n:
        p[:, SLIP, SLIP] = slip_of(z)[0] ** 2
    if n == STATES:
        p[:, DRIFT_EAST, DRIFT_EAST] = noise.drift**2
        p[:, DRIFT_NORTH, DRIFT_NORTH] = noise.drift**2
    return replace(state, belief=(x, p, w), n=n)


def _shifted(belief: Belief, step: tuple[float, float]) -> Belief:
    """The step is the receiver's: into its drift."""
    x, p, w = belief[0].copy(), belief[1].copy(), belief[2]
    x[:, DRIFT_EAST] += step[0]
    x[:, DRIFT_NORTH] += step[1]
    p[:, DRIFT_EAST, DRIFT_EAST] += 0.03**2
    p[:, DRIFT_NORTH, DRIFT_NORTH] += 0.03**2
    return x, p, w


def _turned_round(belief: Belief, z: Measurement, backed: float, dt: float) -> tuple[Belief, float]:
    """Counts the metres in reverse; after thirty without a heading sensor the body is taken to point the other way."""
    x, p, w = belief
    speed = float(w @ x[:, SPEED])
    if speed > -0.1 or z.heading is not None:
        return belief, (0.0 if speed > 0.1 else backed)
    backed -= speed * dt
    if backed < LONGEST_BACKING:
        return belief, backed
    x, p = x.copy(), p.copy()
    x[:, HEADING] += math.pi
    x[:, (SPEED, CURVATURE)] *= -1.0
    p[:, (SPEED, CURVATURE), :] *= -1.0
    p[:, :, (SPEED, CURVATURE)] *= -1.0
    return (x, p, w), 0.0


def _pose(z: Measurement, shown: list[float], bound: float | None, *, blind: bool) -> Pose:
    """The models' ``summary`` as a pose; ``bound`` is a standing tractor's, ``blind`` says that the fix was refused."""
    east, north, heading, speed, curvature, var_east, cov, var_north, var_heading, _, _ = shown
    sigma = math.sqrt(var_heading)
    return Pose(
        t=z.t,
        arrival=z.arrival,
        east=east,
        north=north,
        heading=wrap_2pi(heading),
        speed=speed,
        curvature=curvature,
        covariance=(var_east, cov, var_north),
        heading_sigma=sigma,
        heading_known=sigma < HEADING_LOST,
        standing=bound is not None and abs(speed) < STANDING_SPEED,
        dead_reckoned=blind,
        reverse=speed < -STANDING_SPEED,
        roll=z.roll,
        pitch=z.pitch,
    )
