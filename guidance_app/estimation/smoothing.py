"""Poses of a whole recording with the future known: for review, ledger and maps, never for steering.

Expectation propagation over the receiver's cells with one motion model whose liveliness follows the drive itself (see
``smoothing_kernels``). A recording is cut at gaps over 10 s, and every 20 000 fixes with an overlap, so that its memory
stays bounded. Fixes that all others contradict are left out. The first heading is the way of the first metres; if the
whole then ran mostly in reverse, it was the other way round.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from guidance_app.angles import wrap_2pi
from guidance_app.estimation.filter import FilterSettings
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
from guidance_app.estimation.observation_kernels import ARM_FORWARD, ARM_RIGHT, READINGS, STANDING_SD, Z_EAST, Z_NORTH
from guidance_app.estimation.readings import common_noise, readings, slip_of
from guidance_app.estimation.receiver_noise import DEFAULT_CELL, noise_of
from guidance_app.estimation.reference_point import offset_point
from guidance_app.estimation.smoothing_kernels import (
    backward,
    driven_backwards,
    first_sites,
    forward,
    move_sites,
)
from guidance_app.estimation.starting import Departure, Waiting
from guidance_app.estimation.stillness import Stillness
from guidance_app.model import FloatArray, Measurement, Pose

__all__ = ["smooth"]

SWEEPS = 6
LONGEST_GAP = 10.0
PIECE = 20_000
OVERLAP = 200
STANDING_SPEED = 0.06
LATE = 1.5
"""A heading told later than this many seconds after the start means that the tractor stood first."""
WHERE = (Z_EAST, Z_NORTH, ARM_FORWARD, ARM_RIGHT)
"""What an epoch put into a gap keeps of its neighbour's readings: nothing that is believed."""


SHARP = (2.0, 0.3, 2.0)
"""Acceleration noise, curvature and memory where the fixes contradict the motion model: the tractor did more there."""


def smooth(measurements: Sequence[Measurement], settings: FilterSettings | None = None) -> tuple[Pose, ...]:
    """The smoothed pose of every measurement whose time is later than the one before; others are left out.

    A piece in which the tractor never moved has poses with ``heading_known`` False.
    """
    settings = settings or FilterSettings()
    poses: list[Pose] = []
    for stretch in _stretches(measurements):
        for first in range(0, len(stretch), PIECE):
            start = max(0, first - OVERLAP)
            piece = stretch[start : first + PIECE + OVERLAP]
            poses.extend(_smoothed(piece, settings)[first - start : first - start + PIECE])
    return tuple(poses)


def _stretches(measurements: Sequence[Measurement]) -> Iterator[list[Measurement]]:
    """The recording cut at long gaps, without repeated epochs."""
    stretch: list[Measurement] = []
    for z in measurements:
        if stretch and z.t <= stretch[-1].t:
            continue
        if stretch and z.t - stretch[-1].t > LONGEST_GAP:
            yield stretch
            stretch = []
        stretch.append(z)
    if stretch:
        yield stretch


@dataclass(frozen=True, slots=True, eq=False)
class _Epochs:
    """A piece as arrays: times (N,), reading vectors (N, 16), motion models (N, 3), common noise (N, 6).

    ``real`` (N,) is False for the epochs put into gaps, so that no step is longer than a second and a half.
    """

    t: FloatArray
    z: FloatArray
    models: FloatArray
    common: FloatArray
    real: NDArray[np.bool_]
    n: int


def _epochs(piece: list[Measurement], settings: FilterSettings) -> _Epochs:
    adaptive = settings.adaptive
    still = Stillness.of(piece[0])
    times, rows, common, real = [], [], [], []
    alone = all(z.speed is None and z.yaw_rate is None and z.heading is None for z in piece)
    model = settings.smoother.position if alone else settings.smoother.sensors
    drifting = False
    for k, z in enumerate(piece):
        noise = noise_of(z)
        drifting = drifting or noise.drift > 0.0
        still = still.after(z, noise.white)
        row, shared = readings(z, noise, adaptive, still.speed_bound(z, noise.white)), common_noise(z, noise, adaptive)
        gap = 0.0 if k == 0 else z.t - piece[k - 1].t
        for j in range(1, math.ceil(gap - 0.5)):
            times.append(piece[k - 1].t + j * gap / math.ceil(gap - 0.5))
            rows.append(np.where(np.isin(np.arange(READINGS), WHERE), row, 0.0))
            common.append(shared)
            real.append(False)
        times.append(z.t)
        rows.append(row)
        common.append(shared)
        real.append(True)
    n = STATES if drifting else SLIP + 1 if any(z.heading is not None for z in piece) else SLIP
    models = np.tile((model.acceleration, model.curvature, model.memory), (len(times), 1))
    return _Epochs(np.array(times), np.array(rows), models, np.array(common), np.array(real), n)


def _smoothed(piece: list[Measurement], settings: FilterSettings) -> list[Pose]:
    departure = _first_departure(piece)
    epochs = _epochs(piece, settings)
    start = departure or Departure(0.0, math.pi, 0.0, 0.3)
    means, covariances = _swept(piece[0], start, epochs)
    if departure is not None and driven_backwards(means) and piece[0].heading is None:
        means, covariances = _swept(piece[0], replace(start, heading=start.heading + math.pi), epochs)
    standing = epochs.z[:, STANDING_SD] > 0.0
    return [
        _pose(z, means[k], covariances[k], known=departure is not None, still=bool(standing[k]))
        for z, k in zip(piece, np.flatnonzero(epochs.real), strict=True)
    ]


def _first_departure(piece: list[Measurement]) -> Departure | None:
    """The first heading that can be told, and the speed that the piece starts with; None if it never moves."""
    waiting = Waiting()
    for k, z in enumerate(piece):
        waiting = waiting.to(z)
        departure = waiting.departure(noise_of(z).white)
        if departure is None:
            continue
        late = k > 0 and z.t - piece[0].t > LATE
        speed = 0.0 if late else departure.speed
        return replace(departure, speed=speed, heading_sd=max(departure.heading_sd, 0.2), speed_sd=0.3)
    return None


def _swept(first: Measurement, departure: Departure, epochs: _Epochs) -> tuple[FloatArray, FloatArray]:
    """Means (N, 9) and covariances (N, n, n) after all sweeps."""
    sites = first_sites(epochs.z, epochs.t)
    sites[~epochs.real, 2:] = 0.0
    for sweep in range(SWEEPS):
        x, p = _first_state(first, departure, epochs)
        tape = forward(x, p, epochs.t, epochs.z, (epochs.models, epochs.common), sites)
        means, covariances = backward(tape)
        if sweep < SWEEPS - 1:
            wrong = move_sites(epochs.z, means, covariances, sites)
            epochs.models[wrong > 0.0] = SHARP
            sites[~epochs.real, 2:] = 0.0
    return means, covariances


def _first_state(z: Measurement, departure: Departure, epochs: _Epochs) -> tuple[FloatArray, FloatArray]:
    noise = noise_of(z)
    x = np.zeros(STATES)
    x[EAST], x[NORTH] = offset_point(z.east, z.north, departure.heading, -z.antenna[0], -z.antenna[1])
    x[HEADING], x[SPEED] = departure.heading, departure.speed
    cell = z.cell or (DEFAULT_CELL, DEFAULT_CELL)
    p = np.zeros((STATES, STATES))
    for axis in range(2):
        p[axis, axis] = cell[axis] ** 2 + 4 * noise.white**2
    p[HEADING, HEADING], p[SPEED, SPEED] = departure.heading_sd**2, departure.speed_sd**2
    p[CURVATURE, CURVATURE] = min(float(epochs.models[0, 1]), 0.1) ** 2
    p[GYRO_BIAS, GYRO_BIAS] = 0.01**2
    p[SLIP, SLIP] = slip_of(z)[0] ** 2
    if epochs.n == STATES:
        for drift, axis in ((DRIFT_EAST, EAST), (DRIFT_NORTH, NORTH)):
            p[drift, drift] = noise.drift**2
            p[axis, axis] += noise.drift**2
            p[drift, axis] = p[axis, drift] = -(noise.drift**2)
    return x, np.ascontiguousarray(p[: epochs.n, : epochs.n])


def _pose(z: Measurement, mean: FloatArray, covariance: FloatArray, *, known: bool, still: bool) -> Pose:
    speed = float(mean[SPEED])
    standing = still and abs(speed) < STANDING_SPEED
    return Pose(
        t=z.t,
        arrival=z.arrival,
        east=float(mean[EAST]),
        north=float(mean[NORTH]),
        heading=wrap_2pi(float(mean[HEADING])),
        speed=speed,
        curvature=float(mean[CURVATURE]),
        covariance=(float(covariance[EAST, EAST]), float(covariance[EAST, NORTH]), float(covariance[NORTH, NORTH])),
        heading_sigma=math.sqrt(float(covariance[HEADING, HEADING])),
        heading_known=known,
        standing=standing,
        reverse=speed < -STANDING_SPEED,
        roll=z.roll,
        pitch=z.pitch,
    )
