"""What sensors make of a true path: rounding to the receiver's grid, Doppler velocity, gyro, drift, steps, outliers.

The numbers are those of the two papers where they give any (grid and rate: Gomez-Gil et al. 2013, section 2.2), else
of data sheets: Doppler 5 cm/s per axis, a cheap gyro with 0.2 deg/s bias and 0.15 deg/s noise.
"""

import math
from dataclasses import dataclass

import numpy as np

from guidance_app.evaluation.tracks import Recording, Track
from guidance_app.model import FixQuality, FloatArray

__all__ = [
    "PAPER_CELL",
    "Sensors",
    "doppler",
    "gauss_markov",
    "gyro",
    "outliers",
    "record",
    "rounded",
    "steps",
]

PAPER_CELL = (0.14, 0.18)
"""Rounding (east, north) in metres of eight and nine digit NMEA at 41.3 degrees north, as the paper gives it."""

DOPPLER_SIGMA = 0.05
GYRO_BIAS = math.radians(0.2)
GYRO_NOISE = math.radians(0.15)
GYRO_WALK = math.radians(0.003)


@dataclass(frozen=True, slots=True)
class Sensors:
    """Which sensors there are beside the position."""

    velocity: bool = False
    gyro: bool = False


def rounded(position: FloatArray, cell: tuple[float, float]) -> FloatArray:
    """The nearest grid point; shape (N, 2). Nearest, not cut off: only so is the paper's 6.56 cm reached."""
    grid = np.asarray(cell)
    nearest: FloatArray = np.floor(position / grid + 0.5) * grid
    return nearest


def doppler(truth: Track, random: np.random.Generator, sigma: float = DOPPLER_SIGMA) -> FloatArray:
    """Shape (N, 2): velocity east, north with white noise of ``sigma`` m/s an axis."""
    return truth.velocity + random.normal(0.0, sigma, (len(truth), 2))


def gyro(truth: Track, random: np.random.Generator) -> FloatArray:
    """Shape (N,): yaw rate with a constant bias, a slow walk and white noise, positive clockwise."""
    interval = float(truth.t[1] - truth.t[0])
    walk = np.cumsum(random.normal(0.0, GYRO_WALK * math.sqrt(interval), len(truth)))
    noise = random.normal(0.0, GYRO_NOISE, len(truth))
    return truth.yaw_rate + GYRO_BIAS * random.standard_normal() + walk + noise


def gauss_markov(
    samples: int, interval: float, sigma: float, time_constant: float, random: np.random.Generator
) -> FloatArray:
    """Shape (N, 2): first-order Gauss-Markov drift, stationary from the start."""
    keep = math.exp(-interval / time_constant)
    noise = random.normal(0.0, sigma * math.sqrt(1 - keep * keep), (samples, 2))
    drift = np.empty((samples, 2))
    drift[0] = random.normal(0.0, sigma, 2)
    for k in range(1, samples):
        drift[k] = keep * drift[k - 1] + noise[k]
    return drift


def steps(
    samples: int,
    interval: float,
    size: float,
    every: float,
    random: np.random.Generator,
    hold: tuple[float, float] = (3.0, 12.0),
) -> FloatArray:
    """Shape (N, 2): jumps of ``size`` in a random direction, about ``every`` seconds, each held and then gone."""
    error = np.zeros((samples, 2))
    k = 0
    while k < samples:
        k += int(random.exponential(every) / interval) + 1
        length = int(random.uniform(*hold) / interval)
        direction = random.uniform(-math.pi, math.pi)
        error[k : k + length] += size * np.array([math.sin(direction), math.cos(direction)])
        k += length
    return error


def outliers(
    samples: int, share: float, random: np.random.Generator, size: tuple[float, float] = (1.0, 5.0)
) -> FloatArray:
    """Shape (N, 2): single wrong fixes, a ``share`` of all, ``size`` metres off in a random direction."""
    hit = random.random(samples) < share
    direction = random.uniform(-math.pi, math.pi, samples)
    length = np.where(hit, random.uniform(size[0], size[1], samples), 0.0)
    return np.column_stack([length * np.sin(direction), length * np.cos(direction)])


def record(
    truth: Track,
    random: np.random.Generator,
    sensors: Sensors = Sensors(),
    *,
    cell: tuple[float, float] = PAPER_CELL,
    error: FloatArray | None = None,
    quality: FixQuality = FixQuality.RTK_FIXED,
) -> Recording:
    """The path as a rounding receiver reports it; ``error`` (N, 2) is added before the rounding.

    Velocity and gyro are always drawn, used or not, so that the same run with more sensors is the same run.
    """
    velocity = doppler(truth, random)
    yaw_rate = gyro(truth, random)
    position = truth.positions if error is None else truth.positions + error
    return Recording(
        t=truth.t,
        position=rounded(position, cell),
        cell=cell,
        velocity=velocity if sensors.velocity else None,
        yaw_rate=yaw_rate if sensors.gyro else None,
        quality=quality,
    )
