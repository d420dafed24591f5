"""The offline smoother's passes over a whole recording, compiled by numba.

Forward: the extended Kalman filter of one motion model, every measurement taken as a scalar. Backward: the modified
Bryson-Frazier form of the fixed-interval smoother (Bierman, 1977), which carries the adjoint of state and covariance
and inverts no matrix. Between the passes each fix is a Gaussian "site" whose mean and variance expectation propagation
(Minka, 2001) moves to where the truth of the matter, "somewhere in this cell", would put it: the cell's own
information given what all other fixes say.
"""

import math

import numba
import numpy as np

from guidance_app.estimation.kernels import (
    DRIFT_EAST,
    MEMORY,
    SPEED,
    STATES,
    TRANSITION,
    add_process_noise,
    projected,
    spread,
    transition,
    truncated_moments,
)
from guidance_app.estimation.observation_kernels import (
    CELL_EAST,
    COMPASS,
    MEASUREMENTS,
    VELOCITY_ACROSS,
    VELOCITY_ALONG,
    WHITE,
    Z_EAST,
    antenna,
    observe,
)
from guidance_app.model import FloatArray

ROBUST = 9.0
ROUNDING = 1e-12
"""A smoothed variance below this share of the predicted one is what is left of two equal numbers."""
DAMPING = 0.7
OUTLIER = 4.5
"""A fix this many standard deviations outside what all the others say is left out."""
MOST_OUTLIERS = 2
"""More than so many in a row are no outliers."""
SHARPEST = 1.5
FASTEST = 10.0
"""What a tractor may do between two fixes, in m/s2 and m/s, before one is suspected."""
LOOSEST = 1e-3
"""The least information, in 1/m2, that a fix keeps."""

SITE_MEAN, SITE_VARIANCE = 0, 2
"""Columns of a site: mean east, mean north, variance east, variance north. A variance of zero is a fix left out."""
SITE = 4

Tape = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""What the forward pass writes for the backward one: predicted means (N, n), predicted covariances (N, n, n), the
transitions (N, 11), the rows h (N, 7, n) and per measurement innovation and its variance (N, 7, 2)."""


@numba.njit(cache=True)
def _moved(x: FloatArray, near: FloatArray, dt: float, model: FloatArray, common: FloatArray, f: FloatArray) -> None:
    """Moves ``x`` on by the motion's derivative at ``near``, which becomes ``f``; both are moved in place."""
    away = x - near
    transition(near, dt, model[MEMORY], common, f)
    x[:] = near + away
    x[0] += f[0] * away[2] + f[1] * away[3] + f[2] * away[4]
    x[1] += f[3] * away[2] + f[4] * away[3] + f[5] * away[4]
    x[2] += f[6] * away[3] + f[7] * away[4]
    x[4] += (f[8] - 1.0) * away[4]
    for slow in range(6, x.size):
        x[slow] += ((f[9] if slow == 6 else f[10]) - 1.0) * away[slow]


@numba.njit(cache=True)
def forward(
    x: FloatArray,
    p: FloatArray,
    t: FloatArray,
    z: FloatArray,
    drive: tuple[FloatArray, FloatArray, FloatArray],
    sites: FloatArray,
) -> Tape:
    """Filters all epochs from the first state. ``x`` and ``p`` are used up.

    ``z`` holds a reading vector a row; ``drive`` a motion model a row, the common noise a row, and the states (N, 9)
    about which everything is linearised: those of an earlier sweep, or none, that is about the estimate itself.
    """
    models, common, about = drive
    count = t.size
    n = p.shape[0]
    means = np.zeros((count, STATES))
    covariances = np.zeros((count, n, n))
    transitions = np.zeros((count, TRANSITION))
    rows = np.zeros((count, MEASUREMENTS, n))
    taken = np.zeros((count, MEASUREMENTS, 2))
    column = np.empty(n)
    given = about.shape[0] == count
    for k in range(count):
        if k > 0:
            dt = t[k] - t[k - 1]
            near = about[k - 1].copy() if given else x.copy()
            _moved(x, near, dt, models[k], common[k], transitions[k])
            spread(p, transitions[k], n)
            add_process_noise(near, p, dt, models[k], common[k])
        means[k] = x
        covariances[k] = p
        for which in range(MEASUREMENTS):
            h = rows[k, which]
            near = about[k] if given else x
            innovation, variance = observe(near, z[k], which, h)
            for i in range(n):
                innovation -= h[i] * (x[i] - near[i])
            if which < 2:
                innovation += sites[k, SITE_MEAN + which] - z[k, Z_EAST + which]
                variance = sites[k, SITE_VARIANCE + which]
            if variance == 0.0:
                continue
            total = projected(p, h, column) + variance
            if which in (VELOCITY_ALONG, VELOCITY_ACROSS, COMPASS):
                total = max(total, innovation * innovation / ROBUST)
            taken[k, which, 0] = innovation
            taken[k, which, 1] = total
            for i in range(n):
                x[i] += column[i] * innovation / total
                for j in range(i + 1):
                    p[i, j] -= column[i] * column[j] / total
                    p[j, i] = p[i, j]
    return means, covariances, transitions, rows, taken


@numba.njit(cache=True)
def _back_through_measurement(
    adjoint: FloatArray, weight: FloatArray, h: FloatArray, column: FloatArray, taken: FloatArray
) -> None:
    """The adjoint before a measurement, from that after it, in place.

    With K = c / S and B = I - K h':  weight = B' weight B + h h' / S,  adjoint = B' adjoint - h v / S.
    """
    n = h.size
    total = taken[1]
    along = 0.0
    across = np.zeros(n)
    twice = 0.0
    for i in range(n):
        along += column[i] * adjoint[i]
        for j in range(n):
            across[i] += weight[i, j] * column[j]
    for i in range(n):
        twice += column[i] * across[i]
    for i in range(n):
        adjoint[i] -= h[i] * (along + taken[0]) / total
    for i in range(n):
        for j in range(n):
            weight[i, j] += (-h[i] * across[j] - across[i] * h[j] + h[i] * h[j] * (1.0 + twice / total)) / total


@numba.njit(cache=True)
def _back_through_time(adjoint: FloatArray, weight: FloatArray, f: FloatArray) -> None:
    """Adjoint = F' adjoint, weight = F' weight F, in place, for the sparse F of ``kernels.transition``."""
    n = adjoint.size
    _columns_times(adjoint.reshape(1, n), f)
    _columns_times(weight, f)
    _columns_times(weight.T, f)


@numba.njit(cache=True)
def _columns_times(m: FloatArray, f: FloatArray) -> None:
    """M = M F in place."""
    for i in range(m.shape[0]):
        row = m[i]
        row[3] += f[1] * row[0] + f[4] * row[1] + f[6] * row[2]
        row[4] = f[2] * row[0] + f[5] * row[1] + f[7] * row[2] + f[8] * row[4]
        row[2] += f[0] * row[0] + f[3] * row[1]
        if row.size > 6:
            row[6] *= f[9]
        if row.size > DRIFT_EAST:
            row[7] *= f[10]
            row[8] *= f[10]


@numba.njit(cache=True)
def _back_through_epoch(
    adjoint: FloatArray, weight: FloatArray, before: FloatArray, rows: FloatArray, taken: FloatArray
) -> None:
    """The adjoint before an epoch's measurements, from that after them, in place; ``before`` is P before them."""
    n = adjoint.size
    p = before.copy()
    columns = np.zeros((MEASUREMENTS, n))
    for which in range(MEASUREMENTS):
        total = taken[which, 1]
        if total > 0.0:
            projected(p, rows[which], columns[which])
            for i in range(n):
                for j in range(n):
                    p[i, j] -= columns[which, i] * columns[which, j] / total
    for which in range(MEASUREMENTS - 1, -1, -1):
        if taken[which, 1] > 0.0:
            _back_through_measurement(adjoint, weight, rows[which], columns[which], taken[which])


@numba.njit(cache=True)
def _less(p: FloatArray, weight: FloatArray, out: FloatArray) -> None:
    """``out`` becomes P - P weight P, symmetric; P itself where rounding has eaten up the difference."""
    n = p.shape[0]
    across = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            for m in range(n):
                across[i, j] += p[i, m] * weight[m, j]
    for i in range(n):
        for j in range(i + 1):
            away = 0.0
            for m in range(n):
                away += across[i, m] * p[m, j]
            out[i, j] = p[i, j] - away
            out[j, i] = out[i, j]
    for i in range(n):
        if out[i, i] <= ROUNDING * p[i, i]:
            out[:] = p
            return


@numba.njit(cache=True)
def backward(tape: Tape) -> tuple[FloatArray, FloatArray]:
    """Smoothed means (N, 9) and covariances (N, n, n)."""
    means, covariances, transitions, rows, taken = tape
    count, n = covariances.shape[0], covariances.shape[1]
    smooth = means.copy()
    spreads = np.zeros((count, n, n))
    adjoint = np.zeros(n)
    weight = np.zeros((n, n))
    for k in range(count - 1, -1, -1):
        _back_through_epoch(adjoint, weight, covariances[k], rows[k], taken[k])
        for i in range(n):
            for j in range(n):
                smooth[k, i] -= covariances[k, i, j] * adjoint[j]
        _less(covariances[k], weight, spreads[k])
        _back_through_time(adjoint, weight, transitions[k])
    return smooth, spreads


@numba.njit(cache=True)
def first_sites(z: FloatArray, t: FloatArray) -> FloatArray:
    """Each fix as a Gaussian of its cell's and scatter's variance; one far from its neighbours' median is left out.

    Of five places in a row on any way the median is the middle one's, but for what a turn or a stop does to it in half
    that time.
    """
    count = t.size
    sites = np.empty((count, SITE))
    for k in range(count):
        first = max(0, min(k - 2, count - 5))
        last = min(count, first + 5)
        half = 0.5 * (t[last - 1] - t[first])
        away = 0.0
        for axis in range(2):
            cell = z[k, CELL_EAST + axis]
            sites[k, SITE_MEAN + axis] = z[k, Z_EAST + axis]
            sites[k, SITE_VARIANCE + axis] = cell * cell / 12.0 + z[k, WHITE] ** 2
            middle = np.median(z[first:last, Z_EAST + axis])
            reach = 0.5 + 1.5 * cell + 4.0 * z[k, WHITE] + 0.5 * SHARPEST * half * half
            if k - first != 2:  # near the ends it is not the middle one
                way = 0.5 * abs(z[last - 1, Z_EAST + axis] - z[first, Z_EAST + axis])
                reach += min(way, FASTEST * half)
            away = max(away, abs(z[k, Z_EAST + axis] - middle) / reach)
        if away > 1.0:
            sites[k, SITE_VARIANCE] = 0.0
            sites[k, SITE_VARIANCE + 1] = 0.0
    return sites


@numba.njit(cache=True)
def move_sites(
    z: FloatArray, smooth: FloatArray, spreads: FloatArray, sites: FloatArray, believed: FloatArray
) -> FloatArray:
    """One round of expectation propagation: every fix's site, in place, against what all the others say.

    ``believed`` is 1 for a fix that is no outlier whatever the others say. Gives shape (N,): 1 where the fixes
    contradict the motion model.
    """
    n = spreads.shape[1]
    h = np.zeros(n)
    column = np.empty(n)
    far = np.zeros(z.shape[0])
    for k in range(z.shape[0]):
        if z[k, WHITE] == 0.0:  # an epoch put into a gap: there is no fix
            continue
        for axis in range(2):
            cell = z[k, CELL_EAST + axis]
            white = z[k, WHITE] ** 2
            mean = antenna(smooth[k], z[k], axis, h)
            variance = max(projected(spreads[k], h, column), 1e-10)
            at = SITE_VARIANCE + axis
            others = 1.0 / variance - (1.0 / sites[k, at] if sites[k, at] > 0.0 else 0.0)
            if others <= 1e-6:
                continue
            held = (mean / variance - (sites[k, axis] / sites[k, at] if sites[k, at] > 0.0 else 0.0)) / others
            doubt = math.sqrt(1.0 / others + white)
            away = max(abs(z[k, Z_EAST + axis] - held) - 0.5 * cell, 0.0)
            far[k] = max(far[k], away / doubt)
            _move_site(sites[k], axis, (z[k, Z_EAST + axis], cell, white), (held, 1.0 / others))
    return _leave_out(z, far, sites, believed)


@numba.njit(cache=True)
def _leave_out(z: FloatArray, far: FloatArray, sites: FloatArray, believed: FloatArray) -> FloatArray:
    """Leaves out the fixes that are ``far``, in standard deviations, from what all the others say, in place.

    More than two of them in a row are not outliers, nor is one that is ``believed``: there the motion model is wrong,
    and they stay.
    """
    real = np.flatnonzero(z[:, WHITE] > 0.0)
    wrong = np.zeros(z.shape[0])
    run = 0
    for i in range(real.size + 1):
        if i < real.size and far[real[i]] > OUTLIER:
            run += 1
            continue
        for j in range(i - run, i):
            if run > MOST_OUTLIERS or believed[real[j]] > 0.0:
                wrong[real[max(j - 2, 0)] : real[min(j + 2, real.size - 1)] + 1] = 1.0
            else:
                sites[real[j], SITE_VARIANCE] = 0.0
                sites[real[j], SITE_VARIANCE + 1] = 0.0
        run = 0
    return wrong


@numba.njit(cache=True)
def _move_site(site: FloatArray, axis: int, fix: tuple[float, float, float], others: tuple[float, float]) -> None:
    """The site that turns what the others say (mean, variance) into its truth given the cell (middle, size, noise)."""
    z, cell, white = fix
    mean, variance = others
    total = variance + white
    sd = math.sqrt(total)
    information = 1.0 / (cell * cell / 12.0 + white)
    product = information * z
    if cell > 0.25 * sd and abs(z - mean) - 0.5 * cell < 3.5 * sd:
        inside, rest, _ = truncated_moments(mean, sd, z - 0.5 * cell, z + 0.5 * cell)
        tilted = mean + variance / total * (inside - mean)
        left = variance - variance * variance / total * (1.0 - rest / total)
        information = max(1.0 / left - 1.0 / variance, LOOSEST)
        product = tilted / left - mean / variance
    at = SITE_VARIANCE + axis
    old = 1.0 / site[at] if site[at] > 0.0 else 0.0
    mixed = (1.0 - DAMPING) * old + DAMPING * information
    site[axis] = ((1.0 - DAMPING) * site[axis] * old + DAMPING * product) / mixed
    site[at] = 1.0 / mixed


@numba.njit(cache=True)
def driven_backwards(smooth: FloatArray) -> bool:
    """Whether more way was made in reverse than forward: then the first heading was the wrong way round."""
    return bool(smooth[:, SPEED].sum() < 0.0)
