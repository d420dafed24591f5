"""A measurement as the compiled kernels take it: a vector of readings, and the process noise that goes with it."""

import math

from guidance_app.estimation.filter import AdaptiveSettings
from guidance_app.estimation.observation_kernels import NO_COURSE
from guidance_app.estimation.receiver_noise import DEFAULT_CELL, ReceiverNoise
from guidance_app.model import Measurement

__all__ = ["common_noise", "readings", "slip_of"]

SLIP_SD = math.radians(1.5)
SLIP_TIME = 30.0
"""A dual antenna differs from the direction of travel by the crab angle on a slope, which lasts for a pass."""
SENSOR_TIME = 200.0
"""Correlation time of a drifting heading sensor, in seconds."""
FASTEST_GYRO = 4.0
"""A yaw rate in rad/s beyond anything a tractor does is a broken reading."""


def slip_of(z: Measurement) -> tuple[float, float]:
    """Standard deviation and correlation time of what lies between a heading sensor and the direction of travel."""
    if z.heading_sigma is None:
        return SLIP_SD, SLIP_TIME
    return z.heading_sigma, SENSOR_TIME


def common_noise(z: Measurement, noise: ReceiverNoise, settings: AdaptiveSettings) -> tuple[float, ...]:
    """The process noise that all motion models share; see ``kernels`` for the order."""
    slip_sd, slip_time = slip_of(z)
    return settings.gyro_walk, slip_sd, slip_time, noise.drift, noise.drift_time, settings.heading_walk


def readings(
    z: Measurement, noise: ReceiverNoise, settings: AdaptiveSettings, bound: float | None
) -> tuple[float, ...]:
    """The epoch as a reading vector, sixteen numbers; ``bound`` is the standing tractor's, see ``stillness``.

    Standing is a better reading than the few centimetres a second that a receiver shows at rest, and replaces them.
    """
    cell_east, cell_north = z.cell or (DEFAULT_CELL, DEFAULT_CELL)
    gyro = z.yaw_rate if z.yaw_rate is not None and abs(z.yaw_rate) < FASTEST_GYRO else None
    return (
        z.east,
        z.north,
        cell_east,
        cell_north,
        noise.white,
        z.antenna[0],
        z.antenna[1],
        settings.gate,
        z.speed or 0.0,
        NO_COURSE if z.course is None else z.course,
        0.0 if z.speed is None or bound is not None else settings.velocity_noise,
        gyro or 0.0,
        0.0 if gyro is None else settings.gyro_noise,
        z.heading or 0.0,
        0.0 if z.heading is None else math.radians(settings.heading_noise_deg),
        bound or 0.0,
    )
