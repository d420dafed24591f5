"""What one epoch's readings should be for a given state, and how that changes with the state. Compiled by numba.

A reading vector holds one epoch as numbers. Its seven measurements are scalars that can be taken one after the other:
the antenna's position (two), its velocity (two; one if only a speed is known), standing still, gyro, heading sensor.
The lever arm is in all of the first four: a turning tractor swings its antenna.
"""

import math

import numba

from guidance_app.estimation.kernels import (
    CURVATURE,
    DRIFT_EAST,
    EAST,
    GYRO_BIAS,
    HEADING,
    NORTH,
    SLIP,
    SPEED,
)
from guidance_app.model import FloatArray

(
    Z_EAST,
    Z_NORTH,
    CELL_EAST,
    CELL_NORTH,
    WHITE,
    ARM_FORWARD,
    ARM_RIGHT,
    GATE,
    SPEED_READING,
    COURSE_READING,
    SPEED_SD,
    GYRO_READING,
    GYRO_SD,
    HEADING_READING,
    HEADING_SD,
    STANDING_SD,
) = range(16)
"""The reading vector. A standard deviation of zero says that the sensor said nothing this time."""
READINGS = 16

NO_COURSE = 1000.0
"""In place of a course: the receiver gave a speed alone."""

POSITION_EAST, POSITION_NORTH, VELOCITY_ALONG, VELOCITY_ACROSS, STANDING, GYRO, COMPASS = range(7)
"""The seven measurements. The velocity is taken along and across the body, so that one that is far off along it, in a
hard stop, can be doubted without turning the heading."""
MEASUREMENTS = 7


@numba.njit(cache=True)
def antenna(x: FloatArray, z: FloatArray, axis: int, h: FloatArray) -> float:
    """Where the antenna should be read on this axis; ``h`` becomes the derivative of that."""
    sine = math.sin(x[HEADING])
    cosine = math.cos(x[HEADING])
    h[:] = 0.0
    h[axis] = 1.0
    if h.size > DRIFT_EAST:
        h[DRIFT_EAST + axis] = 1.0
    if axis == EAST:
        h[HEADING] = z[ARM_FORWARD] * cosine - z[ARM_RIGHT] * sine
        return float(x[EAST] + x[DRIFT_EAST] + z[ARM_FORWARD] * sine + z[ARM_RIGHT] * cosine)
    h[HEADING] = -z[ARM_FORWARD] * sine - z[ARM_RIGHT] * cosine
    return float(x[NORTH] + x[DRIFT_EAST + NORTH] + z[ARM_FORWARD] * cosine - z[ARM_RIGHT] * sine)


@numba.njit(cache=True)
def antenna_velocity(x: FloatArray, z: FloatArray, direction: float, h: FloatArray) -> float:
    """How fast the antenna should be read to move along ``direction``; ``h`` becomes the derivative of that.

    With the body's velocity u (sin, cos) and the swing u k of the lever arm.
    """
    along = math.cos(x[HEADING] - direction)
    across = -math.sin(x[HEADING] - direction)
    k = x[CURVATURE]
    u = x[SPEED]
    swing = z[ARM_FORWARD] * across - z[ARM_RIGHT] * along
    h[:] = 0.0
    h[SPEED] = along + k * swing
    h[CURVATURE] = u * swing
    h[HEADING] = u * across - u * k * (z[ARM_FORWARD] * along + z[ARM_RIGHT] * across)
    return float(u * (along + k * swing))


@numba.njit(cache=True)
def observe(x: FloatArray, z: FloatArray, which: int, h: FloatArray) -> tuple[float, float]:
    """Innovation and variance of one of the seven measurements; ``h`` becomes its derivative by the state.

    A variance of zero says that there is no such measurement. The position's is that of its scatter, without the cell.
    The gyro's derivative by the speed is left out on purpose: at the sudden end of a turn the rate falls to nothing,
    and the product of speed and curvature would as soon stop the tractor as straighten its path.
    """
    if which <= POSITION_NORTH:
        return z[Z_EAST + which] - antenna(x, z, which, h), z[WHITE] ** 2
    if which <= VELOCITY_ACROSS:
        return _velocity(x, z, which, h)
    h[:] = 0.0
    if which == STANDING:
        h[SPEED] = 1.0
        return -x[SPEED], z[STANDING_SD] ** 2
    if which == GYRO:
        h[CURVATURE] = x[SPEED]
        h[GYRO_BIAS] = 1.0
        return z[GYRO_READING] - x[SPEED] * x[CURVATURE] - x[GYRO_BIAS], z[GYRO_SD] ** 2
    h[HEADING] = 1.0
    if h.size <= SLIP:
        return 0.0, 0.0
    h[SLIP] = 1.0
    away = z[HEADING_READING] - x[HEADING] - x[SLIP]
    return (away + math.pi) % (2.0 * math.pi) - math.pi, z[HEADING_SD] ** 2


@numba.njit(cache=True)
def _velocity(x: FloatArray, z: FloatArray, which: int, h: FloatArray) -> tuple[float, float]:
    """As ``observe``; a speed without a course is taken once, along the body, forward or back as the state has it."""
    if z[COURSE_READING] < NO_COURSE:
        direction = x[HEADING] if which == VELOCITY_ALONG else x[HEADING] + 0.5 * math.pi
        read = z[SPEED_READING] * math.cos(z[COURSE_READING] - direction)
        return read - antenna_velocity(x, z, direction, h), z[SPEED_SD] ** 2
    h[:] = 0.0
    h[SPEED] = 1.0
    if which == VELOCITY_ACROSS:
        return 0.0, 0.0
    return math.copysign(z[SPEED_READING], x[SPEED]) - x[SPEED], z[SPEED_SD] ** 2
