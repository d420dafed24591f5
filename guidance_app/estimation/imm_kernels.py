"""One epoch of the interacting multiple models (Blom and Bar-Shalom, 1988), compiled by numba.

Three motion models run side by side on the same state; each epoch they are mixed by how likely the driver changed from
one to another, predicted, corrected, and weighed by how well they foresaw the measurement. A single model always
trades smoothness for lag; three escape the trade.
"""

import math

import numba
import numpy as np

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
    gaussian_update,
    interval_update,
    predict,
    robust_update,
)
from guidance_app.model import FloatArray

MODELS = 3

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

WITH_POSITION, WITHOUT_POSITION, REOPENED = range(3)
"""How the position is taken: through the gate; not at all; or believed whatever the distance."""

Belief = tuple[FloatArray, FloatArray, FloatArray]
Motion = tuple[FloatArray, FloatArray, FloatArray]

NO_COURSE = 1000.0
"""In place of a course: the receiver gave a speed alone."""


@numba.njit(cache=True)
def _mix(x: FloatArray, p: FloatArray, w: FloatArray, moves: FloatArray, mixed: FloatArray, n: int) -> FloatArray:
    """Mixes the models into ``mixed`` (means) and gives the mixed covariances; ``w`` becomes the prior weights."""
    prior = np.zeros(MODELS)
    spread = np.zeros((MODELS, STATES, STATES))
    away = np.empty(STATES)
    for j in range(MODELS):
        for i in range(MODELS):
            prior[j] += moves[i, j] * w[i]
    for j in range(MODELS):
        for a in range(n):
            mixed[j, a] = 0.0
            for i in range(MODELS):
                mixed[j, a] += moves[i, j] * w[i] / prior[j] * x[i, a]
        for i in range(MODELS):
            share = moves[i, j] * w[i] / prior[j]
            for a in range(n):
                away[a] = x[i, a] - mixed[j, a]
            for a in range(n):
                for b in range(n):
                    spread[j, a, b] += share * (p[i, a, b] + away[a] * away[b])
    w[:] = prior
    return spread


@numba.njit(cache=True)
def _antenna_row(x: FloatArray, z: FloatArray, axis: int, h: FloatArray) -> float:
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
    return float(x[NORTH] + x[DRIFT_NORTH] + z[ARM_FORWARD] * cosine - z[ARM_RIGHT] * sine)


@numba.njit(cache=True)
def _velocity_row(x: FloatArray, z: FloatArray, axis: int, h: FloatArray) -> float:
    """How fast the antenna should be read to move along this axis; ``h`` becomes the derivative of that."""
    sine = math.sin(x[HEADING])
    cosine = math.cos(x[HEADING])
    k = x[CURVATURE]
    u = x[SPEED]
    along = sine if axis == EAST else cosine
    across = cosine if axis == EAST else -sine
    swing = z[ARM_FORWARD] * across - z[ARM_RIGHT] * along
    h[:] = 0.0
    h[SPEED] = along + k * swing
    h[CURVATURE] = u * swing
    h[HEADING] = u * across + u * k * (-z[ARM_FORWARD] * along - z[ARM_RIGHT] * across)
    return float(u * (along + k * swing))


@numba.njit(cache=True)
def _sensors(x: FloatArray, p: FloatArray, n: int, z: FloatArray) -> float:
    """Takes everything but the position, in place; gives the log likelihood."""
    h = np.zeros(n)
    likelihood = 0.0
    if z[SPEED_SD] > 0.0 and z[COURSE_READING] < NO_COURSE:
        for axis in range(2):
            read = z[SPEED_READING] * (math.sin(z[COURSE_READING]) if axis == EAST else math.cos(z[COURSE_READING]))
            expected = _velocity_row(x, z, axis, h)
            likelihood += robust_update(x, p, h, read - expected, z[SPEED_SD] ** 2)
    elif z[SPEED_SD] > 0.0:
        h[SPEED] = 1.0
        read = math.copysign(z[SPEED_READING], x[SPEED])
        likelihood += robust_update(x, p, h, read - x[SPEED], z[SPEED_SD] ** 2)
    if z[STANDING_SD] > 0.0:
        h[:] = 0.0
        h[SPEED] = 1.0
        gaussian_update(x, p, h, -x[SPEED], z[STANDING_SD] ** 2)
    if z[GYRO_SD] > 0.0:
        h[:] = 0.0
        h[SPEED] = x[CURVATURE]
        h[CURVATURE] = x[SPEED]
        h[GYRO_BIAS] = 1.0
        expected = x[SPEED] * x[CURVATURE] + x[GYRO_BIAS]
        likelihood += robust_update(x, p, h, z[GYRO_READING] - expected, z[GYRO_SD] ** 2)
    if z[HEADING_SD] > 0.0:
        h[:] = 0.0
        h[HEADING] = 1.0
        h[SLIP] = 1.0
        away = z[HEADING_READING] - x[HEADING] - x[SLIP]
        away = (away + math.pi) % (2.0 * math.pi) - math.pi
        likelihood += robust_update(x, p, h, away, z[HEADING_SD] ** 2)
    return likelihood


@numba.njit(cache=True)
def _position(x: FloatArray, p: FloatArray, n: int, z: FloatArray) -> float:
    """Takes the position, in place; gives the log likelihood."""
    h = np.zeros(n)
    likelihood = 0.0
    for axis in range(2):
        expected = _antenna_row(x, z, axis, h)
        innovation = z[Z_EAST + axis] - expected
        likelihood += interval_update(x, p, h, innovation, z[CELL_EAST + axis], z[WHITE] ** 2)
    return likelihood


@numba.njit(cache=True)
def _distance(x: FloatArray, p: FloatArray, n: int, z: FloatArray, innovation: FloatArray) -> float:
    """Chi-square distance of the fix from a predicted state; ``innovation`` becomes (east, north)."""
    he = np.zeros(n)
    hn = np.zeros(n)
    innovation[0] = z[Z_EAST] - _antenna_row(x, z, EAST, he)
    innovation[1] = z[Z_NORTH] - _antenna_row(x, z, NORTH, hn)
    ee = z[CELL_EAST] ** 2 / 12.0 + z[WHITE] ** 2
    nn = z[CELL_NORTH] ** 2 / 12.0 + z[WHITE] ** 2
    en = 0.0
    for i in range(n):
        for j in range(n):
            ee += he[i] * p[i, j] * he[j]
            nn += hn[i] * p[i, j] * hn[j]
            en += he[i] * p[i, j] * hn[j]
    a, b = innovation[0], innovation[1]
    return float((nn * a * a - 2.0 * en * a * b + ee * b * b) / (ee * nn - en * en))


@numba.njit(cache=True)
def _reopen(p: FloatArray, n: int, innovation: FloatArray) -> None:
    """Doubts the position by as much as the fix is away, in place; with drift half of it is the receiver's."""
    for axis in range(2):
        doubt = innovation[axis] ** 2
        if n > DRIFT_EAST:
            doubt *= 0.5
            p[DRIFT_EAST + axis, DRIFT_EAST + axis] += doubt
        p[axis, axis] += doubt


@numba.njit(cache=True)
def imm_step(belief: Belief, n: int, dt: float, z: FloatArray, how: int, motion: Motion) -> tuple[Belief, FloatArray]:
    """One epoch. Gives the new belief and a report.

    ``belief`` is means (3, 9), covariances (3, 9, 9), weights (3,). ``motion`` is a row per motion model, the
    probabilities of changing between them in this ``dt``, and the process noise that all share. The report: 1 if the
    position was taken else 0; the fix's distance (chi-square, against the last model, which is the most mobile); the
    innovation's east and north.
    """
    x, p, w = belief
    models, moves, common = motion
    x_new = x.copy()
    w_new = w.copy()
    p_new = _mix(x, p, w_new, moves, x_new, n)
    report = np.zeros(4)
    for j in range(MODELS):
        predict(x_new[j], p_new[j], n, dt, models[j], common)
    innovation = np.zeros(2)
    distance = _distance(x_new[MODELS - 1], p_new[MODELS - 1], n, z, innovation)
    taken = how == REOPENED or (how == WITH_POSITION and distance <= z[GATE])
    log_weight = np.empty(MODELS)
    for j in range(MODELS):
        if how == REOPENED:
            _reopen(p_new[j], n, innovation)
        log_weight[j] = math.log(w_new[j])
        if taken:
            log_weight[j] += _position(x_new[j], p_new[j], n, z)
        log_weight[j] += _sensors(x_new[j], p_new[j], n, z)
        for a in range(n):
            p_new[j, a, a] = max(p_new[j, a, a], 1e-14)
        turns = round((x_new[j, HEADING] - x_new[0, HEADING]) / (2.0 * math.pi))
        x_new[j, HEADING] -= turns * 2.0 * math.pi
    best = log_weight.max()
    for j in range(MODELS):
        w_new[j] = max(math.exp(log_weight[j] - best), 1e-9)
    w_new /= w_new.sum()
    report[0] = 1.0 if taken else 0.0
    report[1] = distance
    report[2] = innovation[0]
    report[3] = innovation[1]
    return (x_new, p_new, w_new), report


@numba.njit(cache=True)
def combined(belief: Belief, n: int) -> tuple[FloatArray, FloatArray]:
    """Mean (9,) and covariance (9, 9) of the three models together."""
    x, p, w = belief
    mean = np.zeros(STATES)
    covariance = np.zeros((STATES, STATES))
    for j in range(MODELS):
        for a in range(n):
            mean[a] += w[j] * x[j, a]
    for j in range(MODELS):
        for a in range(n):
            for b in range(n):
                away = (x[j, a] - mean[a]) * (x[j, b] - mean[b])
                covariance[a, b] += w[j] * (p[j, a, b] + away)
    return mean, covariance
