"""What a driver does that no motion model foresees: a hard stop, a racing start, a sharp turn. Compiled by numba.

At one fix a second much happens between two of them. A filter that knows only its motion models takes what then comes
for an outlier, drives on blindly and reports centimetres while it is metres off. Two things are done against that:

* A fix is measured from the nearest place to which the tractor *could* have come since the last one. Only what lies
  beyond is an outlier. The reach grows with the square of the interval: 16 cm ahead at 5 Hz, 4 m at 1 Hz.
* A fix that only a manoeuvre explains is not forced on the most mobile model by its covariance: with headings tens of
  degrees off no linearisation holds, and such a filter spins. The model starts again from the way between the last two
  fixes, heading along it. On a car's and a tractor's logs at 1 Hz this holds every fix (worst error 0.3 m instead of
  13) and makes the headings three times calmer than the fixes' own.
"""

import math

import numba
import numpy as np

from guidance_app.estimation.kernels import (
    CURVATURE,
    DRIFT_EAST,
    EAST,
    GYRO_BIAS,
    HEADING,
    NORTH,
    SPEED,
)
from guidance_app.estimation.observation_kernels import CELL_EAST, CELL_NORTH, WHITE, Z_EAST, Z_NORTH, antenna
from guidance_app.model import FloatArray

UNFORESEEN = 10.0
"""A fix farther off than this (chi-square of 2) from the most mobile model needs another explanation than chance."""
FORWARD, BRAKING, SIDEWAYS = 4.0, 6.0, 4.0
"""What a driver may do between two fixes beyond what the models foresee, in m/s2."""
TIGHTEST = 0.4
"""Tightest turn, in 1/m: a slow tractor does not get far sideways."""
CREEP = 0.3
"""Sideways in m/s, by sliding or by the receiver's wandering at rest."""
AIMED, LOOSE = math.radians(4), math.radians(25)
"""The least doubt of the heading in which a manoeuvre leads, when driving and at rest: nothing shows it at rest."""
CRAWLING = 0.5
"""Below this speed in m/s the doubt grows from the one to the other."""
REVERSAL = math.radians(110)
"""A way that leads off by more than this was driven backwards."""
LEAST_BEND = 0.05
"""Doubt of the curvature after a new start, in 1/m."""

LAST_EAST, LAST_NORTH, LAST_HEADING, LAST_SPEED, LAST_AGO = range(5)
"""The pose at the last fix that was believed, and how many seconds ago that was."""


@numba.njit(cache=True)
def _innovation_covariance(
    x: FloatArray, p: FloatArray, n: int, z: FloatArray, innovation: FloatArray
) -> tuple[float, float, float]:
    """Var east, cov, var north, rounding counted as if it were normal; ``innovation`` becomes (east, north)."""
    he = np.zeros(n)
    hn = np.zeros(n)
    innovation[0] = z[Z_EAST] - antenna(x, z, EAST, he)
    innovation[1] = z[Z_NORTH] - antenna(x, z, NORTH, hn)
    ee = z[CELL_EAST] ** 2 / 12.0 + z[WHITE] ** 2
    nn = z[CELL_NORTH] ** 2 / 12.0 + z[WHITE] ** 2
    en = 0.0
    for i in range(n):
        for j in range(n):
            ee += he[i] * p[i, j] * he[j]
            nn += hn[i] * p[i, j] * hn[j]
            en += he[i] * p[i, j] * hn[j]
    return ee, en, nn


@numba.njit(cache=True)
def _squared(a: float, b: float, ee: float, en: float, nn: float) -> float:
    """Squared Mahalanobis distance of (a, b)."""
    return (nn * a * a - 2.0 * en * a * b + ee * b * b) / (ee * nn - en * en)


@numba.njit(cache=True)
def distances(
    x: FloatArray, p: FloatArray, n: int, dt: float, z: FloatArray, innovation: FloatArray
) -> tuple[float, float]:
    """Chi-square distance of the fix from the predicted state, and from the nearest place within reach.

    ``innovation`` becomes (east, north).
    """
    ee, en, nn = _innovation_covariance(x, p, n, z, innovation)
    a, b = innovation[0], innovation[1]
    distance = _squared(a, b, ee, en, nn)
    if distance <= UNFORESEEN:
        return distance, distance
    sine, cosine = math.sin(x[HEADING]), math.cos(x[HEADING])
    along, across = a * sine + b * cosine, a * cosine - b * sine
    speed = abs(x[SPEED])
    gained = FORWARD * dt * dt
    lost = min(BRAKING * dt, speed + FORWARD * dt) * dt
    ahead, behind = (gained, lost) if x[SPEED] >= 0.0 else (lost, gained)
    driven = min(max(along, -behind), ahead)
    fast = speed + abs(driven) / dt
    aside = 0.5 * min(SIDEWAYS, fast * fast * TIGHTEST) * dt * dt + CREEP * dt
    across -= min(max(across, -aside), aside)
    along -= driven
    doubt = max(p[HEADING, HEADING], (AIMED + (LOOSE - AIMED) * max(0.0, 1.0 - speed / CRAWLING)) ** 2)
    swung = driven * driven * doubt
    ee += swung * cosine * cosine
    nn += swung * sine * sine
    en -= swung * sine * cosine
    return distance, _squared(along * sine + across * cosine, along * cosine - across * sine, ee, en, nn)


@numba.njit(cache=True)
def begin_again(x: FloatArray, p: FloatArray, n: int, z: FloatArray, innovation: FloatArray, last: FloatArray) -> float:
    """A state that knows only the way from the ``last`` pose to this fix, in place of a predicted one.

    The gyro's bias, the slip and the receiver's drift stay as they are. Gives the log likelihood of a fix that came
    one standard deviation away.
    """
    x[EAST] += innovation[0]
    x[NORTH] += innovation[1]
    dt = last[LAST_AGO]
    east, north = x[EAST] - last[LAST_EAST], x[NORTH] - last[LAST_NORTH]
    way = math.sqrt(east * east + north * north)
    cell = max(z[CELL_EAST], z[CELL_NORTH])
    noise = math.sqrt(cell * cell / 6.0 + 2.0 * z[WHITE] ** 2)
    turned = (math.atan2(east, north) - last[LAST_HEADING] + math.pi) % (2.0 * math.pi) - math.pi
    speed = way / dt
    if abs(turned) > REVERSAL:
        speed = -speed
        turned = (turned + 2.0 * math.pi) % (2.0 * math.pi) - math.pi
    before = p[HEADING, HEADING] + (0.5 * TIGHTEST * way) ** 2
    aimed = (noise / max(way, 0.01 * noise)) ** 2
    turned *= before / (before + aimed)
    bend = min(max(turned / max(way, noise), -TIGHTEST), TIGHTEST)
    _forget_motion(p, n, z)
    x[HEADING] = last[LAST_HEADING] + turned
    x[SPEED] = speed
    x[CURVATURE] = bend
    p[HEADING, HEADING] = before * aimed / (before + aimed) + (0.5 * turned) ** 2
    p[SPEED, SPEED] = (0.5 * (speed - last[LAST_SPEED])) ** 2 + (noise / dt) ** 2
    p[CURVATURE, CURVATURE] = bend**2 + LEAST_BEND**2
    spread = (innovation[0] ** 2 + p[EAST, EAST]) * (innovation[1] ** 2 + p[NORTH, NORTH])
    return -1.0 - 0.5 * math.log(4.0 * math.pi**2 * spread)


@numba.njit(cache=True)
def _forget_motion(p: FloatArray, n: int, z: FloatArray) -> None:
    """Leaves of a covariance what does not concern the motion, in place; the position's is that of one fix."""
    for i in range(n):
        if i < GYRO_BIAS:
            p[i, :] = 0.0
            p[:, i] = 0.0
    for axis in range(2):
        for other in range(DRIFT_EAST, n):
            drift = p[DRIFT_EAST + axis, other]
            p[axis, other - DRIFT_EAST] = drift
            p[axis, other] = -drift
            p[other, axis] = -drift
        p[axis, axis] += z[CELL_EAST + axis] ** 2 / 12.0 + z[WHITE] ** 2
