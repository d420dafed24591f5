"""A stretch of a recording as the smoother's kernels take it: arrays, with the gaps filled and the holds recognised.

A **hold** is a run of identical fixes of a second or more: the tractor stands, or moves less than a cell. All of them
but the first and the last are one and the same statement, which repeated would be taken for certainty; what they do say
is how slow the tractor was.
"""

import math
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from guidance_app.estimation.filter import FilterSettings, MotionModel
from guidance_app.estimation.kernels import SLIP, STATES
from guidance_app.estimation.observation_kernels import ARM_FORWARD, ARM_RIGHT, READINGS, WHITE, Z_EAST, Z_NORTH
from guidance_app.estimation.readings import common_noise, readings
from guidance_app.estimation.receiver_noise import DEFAULT_CELL, ReceiverNoise, noise_of
from guidance_app.estimation.stillness import HELD_FOR, Stillness
from guidance_app.model import FloatArray, Measurement

__all__ = ["Epochs", "epochs_of"]

KEPT_IN_GAPS = (Z_EAST, Z_NORTH, ARM_FORWARD, ARM_RIGHT)
"""What an epoch put into a gap has of its neighbour's readings: nothing that is believed."""


@dataclass(frozen=True, slots=True, eq=False)
class Epochs:
    """Times (N,), reading vectors (N, 16), motion models (N, 3), common noise (N, 6), and how many states are live.

    ``real`` (N,) is False for the epochs put into gaps, so that no step is longer than a second and a half. A scatter
    of zero in a reading vector says that its fix is not to be used. ``models`` is the smoother's to change.
    """

    t: FloatArray
    z: FloatArray
    models: FloatArray
    common: FloatArray
    real: NDArray[np.bool_]
    n: int


def epochs_of(piece: list[Measurement], settings: FilterSettings) -> Epochs:
    """The piece as arrays. Its times must grow."""
    noises = [noise_of(z) for z in piece]
    bounds, silent = _standing(piece, noises)
    rows, common = [], []
    for z, noise, bound in zip(piece, noises, bounds, strict=True):
        rows.append(readings(z, noise, settings.adaptive, bound))
        common.append(common_noise(z, noise, settings.adaptive))
    n = SLIP + 1 if any(z.heading is not None for z in piece) else SLIP
    if any(noise.drift > 0.0 for noise in noises):
        n = STATES
    model = _model(piece, settings)
    t, from_row, real = _filled(np.array([z.t for z in piece]))
    z_rows = np.array(rows)
    z_rows[silent, WHITE] = 0.0
    z_rows = z_rows[from_row]
    empty = np.setdiff1d(np.arange(READINGS), KEPT_IN_GAPS)
    z_rows[np.ix_(~real, empty)] = 0.0
    models = np.tile((model.acceleration, model.curvature, model.memory), (len(t), 1))
    return Epochs(t, z_rows, models, np.array(common)[from_row], real, n)


def _model(piece: list[Measurement], settings: FilterSettings) -> MotionModel:
    alone = all(z.speed is None and z.yaw_rate is None and z.heading is None for z in piece)
    return settings.smoother.position if alone else settings.smoother.sensors


def _filled(t: FloatArray) -> tuple[FloatArray, NDArray[np.int64], NDArray[np.bool_]]:
    """Times with the gaps filled, which row each comes from, and whether it is a real epoch."""
    times, rows, real = [float(t[0])], [0], [True]
    for k in range(1, len(t)):
        gap = float(t[k] - t[k - 1])
        parts = max(1, math.ceil(gap - 0.5))
        for j in range(1, parts + 1):
            times.append(float(t[k]) if j == parts else float(t[k - 1]) + j * gap / parts)
            rows.append(k)
            real.append(j == parts)
    return np.array(times), np.array(rows), np.array(real)


def _standing(piece: list[Measurement], noises: list[ReceiverNoise]) -> tuple[list[float | None], list[bool]]:
    """For each epoch the bound of a standing tractor's speed, and whether its fix only repeats a hold's first."""
    bounds: list[float | None] = []
    silent: list[bool] = []
    still = Stillness.of(piece[0])
    for _, group in groupby(zip(piece, noises, strict=True), key=lambda pair: (pair[0].east, pair[0].north)):
        held = list(group)
        duration = held[-1][0].t - held[0][0].t
        for z, noise in held:
            still = still.after(z, noise.white)
            bound = still.speed_bound(z, noise.white)
            if z.speed is None and duration >= HELD_FOR:
                bound = max(z.cell or (DEFAULT_CELL,)) / (duration * math.sqrt(3.0))
            bounds.append(bound)
        whole = duration >= HELD_FOR
        silent += [whole and 0 < k < len(held) - 1 for k in range(len(held))]
    return bounds, silent
