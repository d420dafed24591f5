"""The compiled objective of the tuning: the four-state filter over many recordings, fused with its error.

The filter is that of Gomez-Gil et al. (2013), equations 4 to 12, as ``estimation.filters`` has it; here it keeps no
poses and returns only the sum of squares, for one evaluation is one of two million. Three facts make it fast and
change nothing: with diagonal R the four measurements may be taken one after the other; the heading's variance does
not meet the others, so it is a scalar; and a draw whose sum already exceeds the best one's cannot win any more.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from guidance_app.model import FloatArray

__all__ = ["COLUMNS", "IntArray", "best_of", "squared_error"]

IntArray = NDArray[np.int64]
Six = tuple[float, float, float, float, float, float]
Nine = tuple[float, float, float, float, float, float, float, float, float]

COLUMNS = ("dt", "east", "north", "heading", "speed", "target_east", "target_north", "ahead", "weight")
"""Columns of the table of epochs: interval since the epoch before, what was measured, what the estimate is compared
with after ``ahead`` seconds of straight travel, and how much it counts."""


@numba.njit(cache=True, error_model="numpy")
def _corrected(covariance: Six, r: float) -> Nine:
    """Gains of a, b, c and their covariance (aa, ab, ac, bb, bc, cc) after a measurement of a with variance r.

    Equations 10 and 12 for one component.
    """
    aa, ab, ac, bb, bc, cc = covariance
    inverse = 1.0 / (aa + r)
    a, b, c = aa * inverse, ab * inverse, ac * inverse
    return a, b, c, aa - a * aa, ab - a * ab, ac - a * ac, bb - b * ab, bc - b * ac, cc - c * ac


@numba.njit(cache=True, error_model="numpy")
def _one_recording(rows: FloatArray, noise: FloatArray, limit: float) -> float:
    """Weighted sum of squared distances over the epochs of one recording, infinity once it exceeds ``limit``."""
    east, north, heading, speed = rows[0, 1], rows[0, 2], rows[0, 3], rows[0, 4]
    # covariance of east (e), north (n) and speed (s); the heading's variance (hh) stands alone
    ee, nn, hh, ss = noise[8], noise[9], noise[10], noise[11]
    en, es, ns = 0.0, 0.0, 0.0
    to_east, to_north = math.sin(heading), math.cos(heading)
    total = 0.0
    for k in range(len(rows)):
        if k > 0:
            along_east = rows[k, 0] * to_east
            along_north = rows[k, 0] * to_north
            east += speed * along_east
            north += speed * along_north
            # P = F P F' + Q with F of equation 9
            ee += 2 * along_east * es + along_east * along_east * ss + noise[0]
            nn += 2 * along_north * ns + along_north * along_north * ss + noise[1]
            en += along_east * ns + along_north * es + along_east * along_north * ss
            es += along_east * ss
            ns += along_north * ss
            ss += noise[3]
            hh += noise[2]

            new = rows[k, 1] - east
            a, b, c, ee, en, es, nn, ns, ss = _corrected((ee, en, es, nn, ns, ss), noise[4])
            east, north, speed = east + a * new, north + b * new, speed + c * new
            new = rows[k, 2] - north
            a, b, c, nn, en, ns, ee, es, ss = _corrected((nn, en, ns, ee, es, ss), noise[5])
            north, east, speed = north + a * new, east + b * new, speed + c * new
            new = rows[k, 4] - speed
            a, b, c, ss, es, ns, ee, en, nn = _corrected((ss, es, ns, ee, en, nn), noise[7])
            speed, east, north = speed + a * new, east + b * new, north + c * new
            new = rows[k, 3] - heading
            gain = hh / (hh + noise[6])
            heading += gain * (new - math.tau * math.floor((new + math.pi) / math.tau))
            hh -= gain * hh
            to_east, to_north = math.sin(heading), math.cos(heading)
        if rows[k, 8] > 0.0:
            ahead = rows[k, 7] * speed
            off_east = east + ahead * to_east - rows[k, 5]
            off_north = north + ahead * to_north - rows[k, 6]
            total += rows[k, 8] * (off_east * off_east + off_north * off_north)
            if not total <= limit:
                return math.inf
    return total


@numba.njit(cache=True, error_model="numpy")
def squared_error(table: FloatArray, starts: IntArray, noise: FloatArray, limit: float) -> float:
    """Weighted sum of squared distances over all recordings, or infinity as soon as it exceeds ``limit``.

    ``table`` has shape (M, 9), see ``COLUMNS``; ``starts`` the first rows of the recordings and M at the end.
    ``noise`` holds the diagonals of Q, R and P0 (12 numbers) in the order east, north, heading, speed.
    """
    total = 0.0
    for recording in range(len(starts) - 1):
        rows = table[starts[recording] : starts[recording + 1]]
        total += _one_recording(rows, noise, limit - total)
        if not total <= limit:
            return math.inf
    return total


@numba.njit(cache=True, error_model="numpy")
def best_of(table: FloatArray, starts: IntArray, draws: FloatArray, limit: float) -> tuple[float, int]:
    """The smallest sum of squares among ``draws`` (shape (N, 12)) and its row; (inf, -1) when all exceed ``limit``."""
    best = limit
    winner = -1
    for number in range(len(draws)):
        total = squared_error(table, starts, draws[number], best)
        if total < best:
            best = total
            winner = number
    if winner < 0:
        return np.inf, winner
    return best, winner
