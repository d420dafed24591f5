"""The compiled objective of the tuning: the four-state filter over many recordings, fused with its error.

The filter is that of Gomez-Gil et al. (2013), equations 4 to 12, as ``estimation.filters`` has it; here it keeps no
poses and returns only the sum of squares, for one evaluation is one of two million. Three facts make it fast and
change nothing: the heading's variance does not meet the others, so it is a scalar; with H the identity, P after an
update is R - R S^-1 R, one small inverse; and a draw whose sum already exceeds the best one's cannot win any more.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from guidance_app.model import FloatArray

__all__ = ["COLUMNS", "IntArray", "best_of", "squared_error"]

IntArray = NDArray[np.int64]
Six = tuple[float, float, float, float, float, float]

COLUMNS = ("dt", "east", "north", "heading", "speed", "target_east", "target_north", "ahead", "weight")
"""Columns of the table of epochs: interval since the epoch before, what was measured, what the estimate is compared
with after ``ahead`` seconds of straight travel, and how much it counts."""


@numba.njit(cache=True, error_model="numpy")
def _inverse(ee: float, en: float, es: float, nn: float, ns: float, ss: float) -> Six:
    """The upper triangle of the inverse of a symmetric 3 x 3 matrix, given by its own, row by row."""
    a, b, c = nn * ss - ns * ns, es * ns - en * ss, en * ns - es * nn
    scale = 1.0 / (ee * a + en * b + es * c)
    d, e, f = ee * ss - es * es, en * es - ee * ns, ee * nn - en * en
    return a * scale, b * scale, c * scale, d * scale, e * scale, f * scale


@numba.njit(cache=True, error_model="numpy")
def _one_recording(rows: FloatArray, noise: FloatArray, limit: float) -> float:
    """Weighted sum of squared distances over the epochs of one recording, infinity once it exceeds ``limit``."""
    east, north, heading, speed = rows[0, 1], rows[0, 2], rows[0, 3], rows[0, 4]
    r_e, r_n, r_s = noise[4], noise[5], noise[7]
    # covariance of east (e), north (n) and speed (s); the heading's variance (hh) stands alone
    ee, nn, hh, ss = noise[8], noise[9], noise[10], noise[11]
    en, es, ns = 0.0, 0.0, 0.0
    to_east, to_north = math.sin(heading), math.cos(heading)
    total = 0.0
    for k in range(len(rows)):
        if k > 0:
            # P = F P F' + Q with F of equation 9
            a, b = rows[k, 0] * to_east, rows[k, 0] * to_north
            ee += 2 * a * es + a * a * ss + noise[0]
            nn += 2 * b * ns + b * b * ss + noise[1]
            en += a * ns + b * es + a * b * ss
            es += a * ss
            ns += b * ss
            ss += noise[3]
            hh += noise[2]
            # H = I: with S = P + R the update is x = z - R S^-1 (z - x) and P = R - R S^-1 R
            iee, ien, ies, inn, ins, iss = _inverse(ee + r_e, en, es, nn + r_n, ns, ss + r_s)
            ee, nn, ss = r_e - r_e * iee * r_e, r_n - r_n * inn * r_n, r_s - r_s * iss * r_s
            en, es, ns = -r_e * ien * r_n, -r_e * ies * r_s, -r_n * ins * r_s
            new_e = rows[k, 1] - east - a * speed
            new_n = rows[k, 2] - north - b * speed
            new_s = rows[k, 4] - speed
            east = rows[k, 1] - r_e * (iee * new_e + ien * new_n + ies * new_s)
            north = rows[k, 2] - r_n * (ien * new_e + inn * new_n + ins * new_s)
            speed = rows[k, 4] - r_s * (ies * new_e + ins * new_n + iss * new_s)
            new_h = rows[k, 3] - heading
            gain = hh / (hh + noise[6])
            heading += gain * (new_h - math.tau * math.floor((new_h + math.pi) / math.tau))
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
