"""Poses of a whole recording with the future known: for review, ledger and maps, never for steering.

Expectation propagation over the receiver's cells with one motion model whose liveliness follows the drive itself (see
``smoothing_kernels``): stiff on a line, it gives way where the last sweep saw the drive change. That alone takes a
quarter off the error of the same smoother with fixed noise, and makes its ellipse true in stop and go. A recording is
cut at gaps over 10 s, and every 20 000 fixes with an overlap, so that its memory stays bounded. The first heading is
the way of the first metres; if the whole then ran mostly in reverse, it was the other way round.

Fixes that all others contradict are left out. Where, at about one fix a second, several contradict the first sweep,
all is linearised about the filter for driving instead, at the price of its time: that keeps lively drives from running
away.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from guidance_app.angles import wrap_2pi
from guidance_app.estimation.filter import FilterSettings
from guidance_app.estimation.filters.adaptive import Adaptive
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
from guidance_app.estimation.observation_kernels import STANDING_SD, WHITE
from guidance_app.estimation.readings import slip_of
from guidance_app.estimation.receiver_noise import DEFAULT_CELL, noise_of
from guidance_app.estimation.recorded import Epochs, epochs_of
from guidance_app.estimation.reference_point import offset_point
from guidance_app.estimation.smoothing_kernels import (
    backward,
    driven_backwards,
    first_sites,
    forward,
    move_sites,
)
from guidance_app.estimation.starting import Departure, Waiting
from guidance_app.model import FloatArray, Measurement, Pose

__all__ = ["smooth"]

SWEEPS = 6
LONGEST_GAP = 10.0
PIECE = 20_000
OVERLAP = 200
STANDING_SPEED = 0.06
LATE = 1.5
"""A heading told later than this many seconds after the start means that the tractor stood first."""
ABOUT = 2.0
GIVE = 1.0
"""How much of the drive's own change within so many seconds the motion model takes over."""
FARTHEST = np.array([2.0, 2.0, 0.3, 2.0, 0.1, 1.0, 1.0, 2.0, 2.0])
"""How far a sweep moves, at most, the states about which the next one is linearised."""
NOWHERE = np.zeros((0, STATES))
SHOWN_ROWS, SHOWN_COLUMNS = (EAST, EAST, NORTH, HEADING), (EAST, NORTH, NORTH, HEADING)
"""What a pose tells of the covariance: var east, cov, var north, var heading."""
OFTEN = 0.4
"""At fixes no farther apart than this many seconds no sweep runs away, and the filter's time is saved."""
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
    """The recording cut at long gaps and where the receiver's clock was set back, without repeated epochs."""
    stretch: list[Measurement] = []
    for z in measurements:
        if stretch and z.t == stretch[-1].t:
            continue
        if stretch and not 0.0 < z.t - stretch[-1].t <= LONGEST_GAP:
            yield stretch
            stretch = []
        stretch.append(z)
    if stretch:
        yield stretch


def _smoothed(piece: list[Measurement], settings: FilterSettings) -> list[Pose]:
    departure = _first_departure(piece)
    epochs = epochs_of(piece, settings)
    start = departure or Departure(0.0, math.pi, 0.0, 0.3)
    means, covariances = _swept(piece, start, epochs, settings)
    if departure is not None and driven_backwards(means) and piece[0].heading is None:
        means, covariances = _swept(piece, replace(start, heading=start.heading + math.pi), epochs, settings)
    still = epochs.z[:, STANDING_SD] > 0.0
    shown = np.column_stack([means[:, : CURVATURE + 1], covariances[:, SHOWN_ROWS, SHOWN_COLUMNS], still])
    known = departure is not None
    return [_pose(z, row, known=known) for z, row in zip(piece, shown[epochs.real].tolist(), strict=True)]


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
        least = 0.5 if late else 0.2  # what came before may have been a turn
        return replace(departure, speed=speed, heading_sd=max(departure.heading_sd, least), speed_sd=0.3)
    return None


def _swept(
    piece: list[Measurement], departure: Departure, epochs: Epochs, settings: FilterSettings
) -> tuple[FloatArray, FloatArray]:
    """Means (N, 9) and covariances (N, n, n) after all sweeps.

    Where the fixes contradict the first sweep, as on a lively drive at one fix a second, linearising about it would
    lead astray. Then every sweep is linearised about the one before, and the first about the filter for driving.
    """
    first = _sweep(piece[0], departure, epochs, _Sweeping.of(epochs))
    if first.sharp.any() and float(np.median(np.diff(epochs.t))) > OFTEN:
        about, believed = _filtered(piece, departure, epochs, settings)
        first = _sweep(piece[0], departure, epochs, replace(_Sweeping.of(epochs), about=about, believed=believed))
    now = first
    for _ in range(SWEEPS - 1):
        now = _sweep(piece[0], departure, epochs, now)
    return now.means, now.covariances


@dataclass(frozen=True, slots=True, eq=False)
class _Sweeping:
    """What one sweep leaves for the next.

    The fixes as sites, the motion models, where the models were wrong (N,), the means and covariances, the states
    about which to linearise (none for the sweep's own), and which fixes are no outliers (N,).
    """

    sites: FloatArray
    models: FloatArray
    sharp: NDArray[np.bool_]
    means: FloatArray
    covariances: FloatArray
    about: FloatArray
    believed: FloatArray

    @staticmethod
    def of(epochs: Epochs) -> "_Sweeping":
        """Before the first sweep."""
        sites = first_sites(epochs.z, epochs.t)
        sites[epochs.z[:, WHITE] == 0.0, 2:] = 0.0
        sharp = np.zeros(len(epochs.t), dtype=bool)
        covariances = np.zeros((0, epochs.n, epochs.n))
        return _Sweeping(sites, epochs.models, sharp, NOWHERE, covariances, NOWHERE, np.zeros(len(epochs.t)))


def _sweep(first: Measurement, departure: Departure, epochs: Epochs, before: _Sweeping) -> _Sweeping:
    """Forward and back, and what the next sweep needs."""
    x, p = _first_state(first, departure, epochs)
    drive = (before.models, epochs.common, before.about)
    means, covariances = backward(forward(x, p, epochs.t, epochs.z, drive, before.sites))
    sites = before.sites.copy()
    wrong = move_sites(epochs.z, means, covariances, sites, before.believed)
    sites[epochs.z[:, WHITE] == 0.0, 2:] = 0.0
    sharp = before.sharp | (wrong > 0.0)
    models = _livelier(epochs.models, epochs.t, means)
    models[sharp] = SHARP
    about = before.about
    if len(about):
        about = about + np.clip(means - about, -FARTHEST, FARTHEST)
    return _Sweeping(sites, models, sharp, means, covariances, about, before.believed)


def _filtered(
    piece: list[Measurement], departure: Departure, epochs: Epochs, settings: FilterSettings
) -> tuple[FloatArray, FloatArray]:
    """The states of the filter for driving (N, 9), which nothing leads astray, and which fixes it believed (N,)."""
    estimator = Adaptive(settings)
    first = replace(piece[0], heading=departure.heading, heading_sigma=departure.heading_sd)
    poses = [estimator.step(z) for z in (first, *piece[1:])]
    known = [pose for pose in poses if pose.heading_known] or poses
    t = np.array([pose.t for pose in poses])
    about = np.zeros((len(epochs.t), STATES))
    about[:, EAST] = np.interp(epochs.t, t, np.array([pose.east for pose in poses]))
    about[:, NORTH] = np.interp(epochs.t, t, np.array([pose.north for pose in poses]))
    about[:, SPEED] = np.interp(epochs.t, t, np.array([pose.speed for pose in poses]))
    about[:, CURVATURE] = np.interp(epochs.t, t, np.array([pose.curvature for pose in poses]))
    heading = np.unwrap(np.array([pose.heading for pose in known]))
    about[:, HEADING] = np.interp(epochs.t, np.array([pose.t for pose in known]), heading)
    believed = np.zeros(len(epochs.t))
    believed[epochs.real] = [0.0 if pose.dead_reckoned else 1.0 for pose in poses]
    return about, believed


def _livelier(calm: FloatArray, t: FloatArray, means: FloatArray) -> FloatArray:
    """The motion model of every epoch, as lively as the drive was about it in the last sweep.

    What changed within two seconds, spread evenly, is added to the calm model's noise: on a line the smoother is stiff,
    in a turn or a stop it gives way.
    """
    before = np.maximum(np.searchsorted(t, t - 0.5 * ABOUT), 0)
    after = np.minimum(np.searchsorted(t, t + 0.5 * ABOUT), len(t) - 1)
    span = np.maximum(t[after] - t[before], 0.5 * ABOUT)
    faster = (means[after, SPEED] - means[before, SPEED]) ** 2 / span
    sharper = (means[after, CURVATURE] - means[before, CURVATURE]) ** 2 / span
    models = calm.copy()
    models[:, 0] = np.minimum(np.sqrt(calm[:, 0] ** 2 + GIVE * faster), SHARP[0])
    models[:, 1] = np.minimum(np.sqrt(calm[:, 1] ** 2 + 0.5 * GIVE * calm[:, 2] * sharper), SHARP[1])
    return models


def _first_state(z: Measurement, departure: Departure, epochs: Epochs) -> tuple[FloatArray, FloatArray]:
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


def _pose(z: Measurement, row: list[float], *, known: bool) -> Pose:
    """``row`` is the state's first five, the covariance's four that are shown, and 1 if the tractor stands."""
    east, north, heading, speed, curvature, var_east, cov, var_north, var_heading, still = row
    return Pose(
        t=z.t,
        arrival=z.arrival,
        east=east,
        north=north,
        heading=wrap_2pi(heading),
        speed=speed,
        curvature=curvature,
        covariance=(var_east, cov, var_north),
        heading_sigma=math.sqrt(var_heading),
        heading_known=known,
        standing=still == 1.0 and abs(speed) < STANDING_SPEED,
        reverse=speed < -STANDING_SPEED,
        roll=z.roll,
        pitch=z.pitch,
    )
