"""Prediction and correction of a covariance with a measured position, compiled by numba: small sums, written out.

The matrices have two to five rows; calling a library of linear algebra for each costs ten times the arithmetic.
"""

import numba
import numpy as np

from guidance_app.model import FloatArray

__all__ = ["carried_covariance", "corrected", "gate_distance"]


@numba.njit(cache=True)
def _product(a: FloatArray, b: FloatArray) -> FloatArray:
    out = np.zeros((a.shape[0], b.shape[1]))
    for i in range(a.shape[0]):
        for j in range(b.shape[1]):
            total = 0.0
            for k in range(a.shape[1]):
                total += a[i, k] * b[k, j]
            out[i, j] = total
    return out


@numba.njit(cache=True)
def carried_covariance(F: FloatArray, p: FloatArray, walks: FloatArray, dt: float) -> FloatArray:
    """F p F' with the random walks' variances, which grow with time, on the diagonal."""
    after = _product(_product(F, p), F.T)
    for i in range(walks.size):
        after[i, i] += walks[i] * dt
    return after


@numba.njit(cache=True)
def _innovation_covariance(H: FloatArray, p: FloatArray, R: FloatArray) -> FloatArray:
    return _product(_product(H, p), H.T) + R


@numba.njit(cache=True)
def _inverse(S: FloatArray) -> FloatArray:
    """Of a symmetric matrix (2, 2)."""
    determinant = S[0, 0] * S[1, 1] - S[0, 1] * S[1, 0]
    out = np.empty((2, 2))
    out[0, 0], out[1, 1] = S[1, 1] / determinant, S[0, 0] / determinant
    out[0, 1], out[1, 0] = -S[0, 1] / determinant, -S[1, 0] / determinant
    return out


@numba.njit(cache=True)
def gate_distance(H: FloatArray, p: FloatArray, R: FloatArray, innovation: FloatArray) -> float:
    """The innovation's squared length in standard deviations, chi-square of 2."""
    inverse = _inverse(_innovation_covariance(H, p, R))
    east, north = innovation[0], innovation[1]
    cross = (inverse[0, 1] + inverse[1, 0]) * east * north
    return float(inverse[0, 0] * east * east + cross + inverse[1, 1] * north * north)


@numba.njit(cache=True)
def corrected(
    x: FloatArray, p: FloatArray, H: FloatArray, R: FloatArray, innovation: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """State and covariance after the measurement, the covariance in Joseph's form."""
    K = _product(_product(p, H.T), _inverse(_innovation_covariance(H, p, R)))
    after = x.copy()
    for i in range(x.size):
        after[i] += K[i, 0] * innovation[0] + K[i, 1] * innovation[1]
    joseph = -_product(K, H)
    for i in range(x.size):
        joseph[i, i] += 1.0
    return after, _product(_product(joseph, p), joseph.T) + _product(_product(K, R), K.T)
