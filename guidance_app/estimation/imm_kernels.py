"""One epoch of the interacting multiple models (Blom and Bar-Shalom, 1988), compiled by numba.

Four motion models run side by side on the same state; each epoch they are mixed by how likely the driver changed from
one to another, predicted, corrected, and weighed by how well they foresaw the measurement. A single model always
trades smoothness for lag; four escape the trade.
"""

import math

import numba
import numpy as np

from guidance_app.estimation.kernels import (
    DRIFT_EAST,
    EAST,
    HEADING,
    NORTH,
    SPEED,
    STATES,
    gaussian_update,
    interval_update,
    predict,
    robust_update,
)
from guidance_app.estimation.manoeuvre_kernels import UNFORESEEN, begin_again, distances
from guidance_app.estimation.observation_kernels import (
    CELL_EAST,
    GATE,
    GYRO,
    MEASUREMENTS,
    SPEED_SD,
    STANDING,
    VELOCITY_ALONG,
    WHITE,
    Z_EAST,
    antenna,
    observe,
)
from guidance_app.model import FloatArray

MODELS = 4

TEMPER = 1 / 3
"""The weights' power in the covariance that is shown. Successive roundings err alike, so the weights are surer of a
model than they may be: untempered, the 95 % ellipse held 85 % on a spiral."""

CAUTION = (0.31, 0.8, 0.49, 0.9)
CAUTION_WITH_SPEED = (0.37, 0.84, 0.44, 0.9)
"""How much of the four models' covariance of the position is shown, without and with the receiver's speed. What is left
of a rounding error ends sharply, a normal one does not: shown whole, the 95 % ellipse holds 99.9 % on a line, which is
as dishonest as 90."""
DRIVING = 0.3
"""Slower than this many m/s there is less and less to average, and more is shown: all of it at rest."""
NEWEST, BEHIND = 0.1, 5.0
"""Weight of the newest fix in the mean of how far the last ones lie off the estimates, and how many times its square is
added: on a spiral the estimate is behind, and the ellipse held 87 % where it now holds 90."""
SUMMARY = 11
"""East, north, heading, speed, curvature; var east, cov, var north, var heading; the mean of how far the fixes lie off,
east and north."""

WITH_POSITION, WITHOUT_POSITION, REOPENED = range(3)
"""How the position is taken: through the gate, not at all, or believed whatever the distance."""

Belief = tuple[FloatArray, FloatArray, FloatArray]
Motion = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""A row per motion model, the probabilities of changing between them, the noise they share, the last believed pose."""


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
def _sensors(x: FloatArray, p: FloatArray, n: int, z: FloatArray) -> float:
    """Takes everything but the position, in place; gives the log likelihood.

    Velocity and heading sensor are doubted when far off. The gyro is not: at the start of a turn it is the first to
    know, and doubting it there costs 2 degrees.
    """
    h = np.zeros(n)
    likelihood = 0.0
    for which in range(VELOCITY_ALONG, MEASUREMENTS):
        innovation, variance = observe(x, z, which, h)
        if variance == 0.0:
            continue
        if which == GYRO:
            likelihood += gaussian_update(x, p, h, innovation, variance)
        elif which == STANDING:
            gaussian_update(x, p, h, innovation, variance)
        else:
            likelihood += robust_update(x, p, h, innovation, variance)
    return likelihood


@numba.njit(cache=True)
def _position(x: FloatArray, p: FloatArray, n: int, z: FloatArray) -> float:
    """Takes the position, in place; gives the log likelihood."""
    h = np.zeros(n)
    likelihood = 0.0
    for axis in range(2):
        innovation, variance = observe(x, z, axis, h)
        likelihood += interval_update(x, p, h, innovation, z[CELL_EAST + axis], variance)
    return likelihood


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

    ``belief`` is means (4, 9), covariances (4, 9, 9), weights (4,). The report: 1 if the position was taken else 0; the
    fix's distance (chi-square) from what is within reach of the last model, which is the most mobile; the innovation's
    east and north.
    """
    x, p, w = belief
    models, moves, common, last = motion
    x_new = x.copy()
    w_new = w.copy()
    p_new = _mix(x, p, w_new, moves, x_new, n)
    report = np.zeros(4)
    for j in range(MODELS):
        predict(x_new[j], p_new[j], n, dt, models[j], common)
    innovation = np.zeros(2)
    jump, distance = distances(x_new[MODELS - 1], p_new[MODELS - 1], n, dt, z, innovation)
    taken = how == REOPENED or (how == WITH_POSITION and distance <= z[GATE])
    manoeuvre = how == WITH_POSITION and jump > UNFORESEEN
    log_weight = np.empty(MODELS)
    for j in range(MODELS):
        if how == REOPENED:
            _reopen(p_new[j], n, innovation)
        log_weight[j] = math.log(w_new[j])
        if taken and manoeuvre and j == MODELS - 1:
            log_weight[j] += begin_again(x_new[j], p_new[j], n, z, innovation, last)
        elif taken:
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
def summary(belief: Belief, n: int, z: FloatArray, lag: FloatArray, fresh: bool) -> FloatArray:
    """What is shown of the models together, in the order of ``SUMMARY``; a ``fresh`` fix is added to the ``lag``."""
    mean, covariance = combined(belief, n)
    out = np.empty(SUMMARY)
    out[:5] = mean[:5]
    h = np.zeros(n)
    calm = 0.0  # how much of the covariance is shown
    for j in range(MODELS):
        calm += belief[2][j] * (CAUTION_WITH_SPEED[j] if z[SPEED_SD] > 0.0 else CAUTION[j])
    calm = 1.0 - (1.0 - calm) * min(1.0, abs(mean[SPEED]) / DRIVING)
    for axis in range(2):
        out[9 + axis] = lag[axis]
        if fresh:
            out[9 + axis] += NEWEST * (z[Z_EAST + axis] - antenna(mean, z, axis, h) - lag[axis])
    out[5] = calm * covariance[EAST, EAST] + BEHIND * out[9] * out[9]
    out[6] = calm * covariance[EAST, NORTH] + BEHIND * out[9] * out[10]
    out[7] = calm * covariance[NORTH, NORTH] + BEHIND * out[10] * out[10]
    out[8] = covariance[HEADING, HEADING]
    if not fresh and abs(mean[SPEED]) < DRIVING:
        _bound_by_cell(covariance, n, z, out)
    return out


@numba.njit(cache=True)
def _bound_by_cell(covariance: FloatArray, n: int, z: FloatArray, out: FloatArray) -> None:
    """A tractor that stands on the fix that it had is in that fix's cell, however long; ``out`` is changed in place."""
    for axis in range(2):
        most = z[CELL_EAST + axis] ** 2 / 12.0 + z[WHITE] ** 2
        if n > DRIFT_EAST:
            most += covariance[DRIFT_EAST + axis, DRIFT_EAST + axis]
        share = min(1.0, most / out[5 + 2 * axis])
        out[5 + 2 * axis] *= share
        out[6] *= math.sqrt(share)


@numba.njit(cache=True)
def combined(belief: Belief, n: int) -> tuple[FloatArray, FloatArray]:
    """Mean (9,) and covariance (9, 9) of the four models together; the covariance with tempered weights."""
    x, p, w = belief
    mean = np.zeros(STATES)
    covariance = np.zeros((STATES, STATES))
    for j in range(MODELS):
        for a in range(n):
            mean[a] += w[j] * x[j, a]
    doubt = w**TEMPER
    doubt /= doubt.sum()
    for j in range(MODELS):
        for a in range(n):
            for b in range(n):
                away = (x[j, a] - mean[a]) * (x[j, b] - mean[b])
                covariance[a, b] += doubt[j] * (p[j, a, b] + away)
    return mean, covariance
