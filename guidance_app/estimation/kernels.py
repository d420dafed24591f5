"""The numeric parts that the adaptive filter and the smoother share, compiled by numba. Plain arithmetic on arrays.

The state vector, by index:

====  =============  ============================================================
 0    EAST           reference point, m
 1    NORTH          reference point, m
 2    HEADING        direction of the rear axle's travel, rad, continuous (not wrapped)
 3    SPEED          m/s, negative in reverse
 4    CURVATURE      heading change per metre, 1/m, clockwise; forgotten exponentially
 5    GYRO_BIAS      rad/s
 6    SLIP           heading sensor less HEADING: crab angle and mounting, rad
 7    DRIFT_EAST     the receiver's slow error, m, forgotten exponentially
 8    DRIFT_NORTH    as above
====  =============  ============================================================

Only the first ``n`` are live: 6 without heading sensor and drift, 7 with a heading sensor, 9 with drift; a row ``h`` of
a measurement's derivatives has the length ``n``. A curvature
instead of a yaw rate keeps the heading frozen at standstill and makes the model the same at every speed (stop and go:
heading 1.6 instead of 3.5 degrees).

Arrays are changed in place where a function says so; it owns nothing else.
"""

import math

import numba
import numpy as np

from guidance_app.model import FloatArray

STATES = 9
EAST, NORTH, HEADING, SPEED, CURVATURE, GYRO_BIAS, SLIP, DRIFT_EAST, DRIFT_NORTH = range(STATES)

SIDEWAYS = 2.0
"""No tractor turns with more than so many m/s2 sideways: at 12 m/s on the road, not tighter than 72 m."""

ACCELERATION, CURVATURE_SD, MEMORY = range(3)
"""Columns of a motion model."""

GYRO_WALK, SLIP_SD, SLIP_TIME, DRIFT_SD, DRIFT_TIME, HEADING_WALK = range(6)
"""The common part of the process noise: what all motion models share."""
COMMON = 6

WANDER = 0.05
"""At rest the position walks by so many metres in a second: no receiver keeps to the millimetre. Without it the 95 %
ellipse held 65 to 72 % of a standing tractor's fixes."""

LONGEST_STEP = 0.5
"""A longer prediction is cut into equal steps no longer than this, in seconds."""

TAIL = 3.5
"""A cell farther than this many standard deviations is updated by a Gaussian: the moments there are mere rounding."""
FINE = 0.25
"""A cell smaller than this many standard deviations is as good as a Gaussian of the same variance."""

ROBUST = 9.0
"""A sensor reading farther off than three standard deviations is believed less, not thrown away."""


@numba.njit(cache=True)
def truncated_moments(mean: float, sd: float, low: float, high: float) -> tuple[float, float, float]:
    """Mean, variance and log probability of a normal number known to lie in [low, high].

    Good while the nearer end is within a few standard deviations; beyond, ``TAIL`` says what is done instead.
    """
    a = (low - mean) / sd
    b = (high - mean) / sd
    mass = 0.5 * (math.erfc(-b / math.sqrt(2.0)) - math.erfc(-a / math.sqrt(2.0)))
    if a > 0.0:  # the same by symmetry, without cancellation
        mass = 0.5 * (math.erfc(a / math.sqrt(2.0)) - math.erfc(b / math.sqrt(2.0)))
    density_a = math.exp(-0.5 * a * a) / math.sqrt(2.0 * math.pi)
    density_b = math.exp(-0.5 * b * b) / math.sqrt(2.0 * math.pi)
    shift = (density_a - density_b) / mass
    shrink = 1.0 + (a * density_a - b * density_b) / mass - shift * shift
    return mean + sd * shift, sd * sd * max(shrink, 1e-9), math.log(mass)


@numba.njit(cache=True)
def transition(x: FloatArray, dt: float, memory: float, common: FloatArray, f: FloatArray) -> None:
    """Moves ``x`` by one step and fills ``f`` with the derivative of that move.

    The chord of the arc: the heading in the middle of the step. ``f`` has the length of ``TRANSITION``: the only
    entries of the Jacobian that are not those of the identity.
    """
    turn = x[SPEED] * x[CURVATURE] * dt
    middle = x[HEADING] + 0.5 * turn
    sine = math.sin(middle)
    cosine = math.cos(middle)
    way = x[SPEED] * dt
    half = 0.5 * way * dt
    f[0] = way * cosine  # east by heading
    f[1] = dt * sine + half * x[CURVATURE] * cosine  # east by speed
    f[2] = half * x[SPEED] * cosine  # east by curvature
    f[3] = -way * sine  # north by heading
    f[4] = dt * cosine - half * x[CURVATURE] * sine  # north by speed
    f[5] = -half * x[SPEED] * sine  # north by curvature
    f[6] = x[CURVATURE] * dt  # heading by speed
    f[7] = way  # heading by curvature
    f[8] = math.exp(-dt / memory)  # curvature by itself
    f[9] = math.exp(-dt / common[SLIP_TIME])  # slip by itself
    f[10] = math.exp(-dt / common[DRIFT_TIME])  # drift by itself
    x[EAST] += way * sine
    x[NORTH] += way * cosine
    x[HEADING] += turn
    x[CURVATURE] *= f[8]
    x[SLIP] *= f[9]
    x[DRIFT_EAST] *= f[10]
    x[DRIFT_NORTH] *= f[10]


TRANSITION = 11


@numba.njit(cache=True)
def spread(p: FloatArray, f: FloatArray, n: int) -> None:
    """P = F P F' in place, by rows and then by columns, for the sparse F of ``transition``."""
    for j in range(n):
        p[EAST, j] += f[0] * p[HEADING, j] + f[1] * p[SPEED, j] + f[2] * p[CURVATURE, j]
        p[NORTH, j] += f[3] * p[HEADING, j] + f[4] * p[SPEED, j] + f[5] * p[CURVATURE, j]
        p[HEADING, j] += f[6] * p[SPEED, j] + f[7] * p[CURVATURE, j]
        p[CURVATURE, j] *= f[8]
    for i in range(n):
        p[i, EAST] += f[0] * p[i, HEADING] + f[1] * p[i, SPEED] + f[2] * p[i, CURVATURE]
        p[i, NORTH] += f[3] * p[i, HEADING] + f[4] * p[i, SPEED] + f[5] * p[i, CURVATURE]
        p[i, HEADING] += f[6] * p[i, SPEED] + f[7] * p[i, CURVATURE]
        p[i, CURVATURE] *= f[8]
    for slow in range(SLIP, n):
        factor = f[9] if slow == SLIP else f[10]
        for j in range(n):
            p[slow, j] *= factor
            p[j, slow] *= factor


@numba.njit(cache=True)
def add_process_noise(x: FloatArray, p: FloatArray, dt: float, model: FloatArray, common: FloatArray) -> None:
    """Adds Q in place: white acceleration along the heading, and what is forgotten is made up by fresh scatter."""
    sine = math.sin(x[HEADING])
    cosine = math.cos(x[HEADING])
    q = model[ACCELERATION] ** 2
    far = q * dt**3 / 3.0
    near = q * dt**2 / 2.0
    p[EAST, EAST] += far * sine * sine
    p[NORTH, NORTH] += far * cosine * cosine
    p[EAST, NORTH] += far * sine * cosine
    p[NORTH, EAST] += far * sine * cosine
    p[EAST, SPEED] += near * sine
    p[SPEED, EAST] += near * sine
    p[NORTH, SPEED] += near * cosine
    p[SPEED, NORTH] += near * cosine
    p[SPEED, SPEED] += q * dt
    moving = min(1.0, abs(x[SPEED]) / 0.3)
    p[HEADING, HEADING] += (common[HEADING_WALK] * moving) ** 2 * dt
    walk = (WANDER * (1.0 - moving)) ** 2 * dt
    p[EAST, EAST] += walk
    p[NORTH, NORTH] += walk
    sharpest = min(model[CURVATURE_SD], SIDEWAYS / max(x[SPEED] * x[SPEED], 0.01))
    bend = sharpest**2 * -math.expm1(-2.0 * dt / model[MEMORY])
    way = x[SPEED] * dt
    p[CURVATURE, CURVATURE] += bend
    p[HEADING, CURVATURE] += 0.5 * way * bend
    p[CURVATURE, HEADING] += 0.5 * way * bend
    p[HEADING, HEADING] += way * way * bend / 3.0
    p[GYRO_BIAS, GYRO_BIAS] += common[GYRO_WALK] ** 2 * dt
    if p.shape[0] > SLIP:
        p[SLIP, SLIP] += common[SLIP_SD] ** 2 * -math.expm1(-2.0 * dt / common[SLIP_TIME])
    if p.shape[0] <= DRIFT_EAST:
        return
    fresh = common[DRIFT_SD] ** 2 * -math.expm1(-2.0 * dt / common[DRIFT_TIME])
    p[DRIFT_EAST, DRIFT_EAST] += fresh
    p[DRIFT_NORTH, DRIFT_NORTH] += fresh


@numba.njit(cache=True)
def predict(x: FloatArray, p: FloatArray, n: int, dt: float, model: FloatArray, common: FloatArray) -> None:
    """Moves state and covariance on by ``dt`` in place."""
    f = np.empty(TRANSITION)
    steps = max(1, math.ceil(dt / LONGEST_STEP - 1e-9))
    for _ in range(steps):
        transition(x, dt / steps, model[MEMORY], common, f)
        spread(p, f, n)
        add_process_noise(x, p, dt / steps, model, common)


@numba.njit(cache=True)
def projected(p: FloatArray, h: FloatArray, column: FloatArray) -> float:
    """The variance of the measured number, h' P h; ``column`` becomes P h."""
    total = 0.0
    for i in range(h.size):
        column[i] = 0.0
        for j in range(h.size):
            column[i] += p[i, j] * h[j]
    for i in range(h.size):
        total += h[i] * column[i]
    return total


@numba.njit(cache=True)
def correct(x: FloatArray, p: FloatArray, column: FloatArray, shift: float, shrink: float) -> None:
    """Adds P h shift to the state and takes P h h' P shrink from the covariance, in place; ``column`` is P h."""
    for i in range(column.size):
        x[i] += column[i] * shift
    for i in range(column.size):
        for j in range(i + 1):
            p[i, j] -= column[i] * column[j] * shrink
            p[j, i] = p[i, j]


@numba.njit(cache=True)
def gaussian_update(x: FloatArray, p: FloatArray, h: FloatArray, innovation: float, variance: float) -> float:
    """The Kalman update of one scalar measurement, in place; gives its log likelihood."""
    column = np.empty(h.size)
    total = projected(p, h, column) + variance
    correct(x, p, column, innovation / total, 1.0 / total)
    return -0.5 * (innovation * innovation / total + math.log(2.0 * math.pi * total))


@numba.njit(cache=True)
def robust_update(x: FloatArray, p: FloatArray, h: FloatArray, innovation: float, variance: float) -> float:
    """As ``gaussian_update``, but a reading beyond three standard deviations gets the variance that puts it there."""
    column = np.empty(h.size)
    prior = projected(p, h, column)
    total = max(prior + variance, innovation * innovation / ROBUST)
    correct(x, p, column, innovation / total, 1.0 / total)
    return -0.5 * (innovation * innovation / total + math.log(2.0 * math.pi * total))


@numba.njit(cache=True)
def interval_update(
    x: FloatArray, p: FloatArray, h: FloatArray, innovation: float, cell: float, variance: float
) -> float:
    """The update by a rounded measurement, in place: it plus noise lies somewhere in its cell.

    Moment matching of the truncated normal (assumed density filtering). ``innovation`` is that of the cell's middle.
    Gives the log of the probability per metre, so that it compares with the Gaussian's, which is used for a cell that
    is small against the uncertainty, and for one that is far off.
    """
    column = np.empty(h.size)
    prior = projected(p, h, column)
    total = prior + variance
    sd = math.sqrt(total)
    if cell < FINE * sd or abs(innovation) - 0.5 * cell > TAIL * sd:
        total += cell * cell / 12.0
        correct(x, p, column, innovation / total, 1.0 / total)
        return -0.5 * (innovation * innovation / total + math.log(2.0 * math.pi * total))
    mean, rest, log_mass = truncated_moments(0.0, sd, innovation - 0.5 * cell, innovation + 0.5 * cell)
    correct(x, p, column, mean / total, (1.0 - rest / total) / total)
    return log_mass - math.log(cell)
