"""A photo or a scanned map laid on the ground by points that are known in both (the map method of Inoue et al.).

Two points give a similarity (turned, scaled, moved; a photo from straight above has no more), three or more an affine
map by least squares, whose residuals say how well the points agree. Pixels count right and down from the upper left
corner, ground is east and north in metres of the frame that is passed in.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from guidance_app.documents import MatchedPoint
from guidance_app.geodesy import FieldFrame
from guidance_app.model import FloatArray

__all__ = ["Fit", "FitError", "fitted"]

LEAST_PIXELS = 20.0
"""Matched points nearer to each other on the photo give no direction."""
FINEST, COARSEST = 0.005, 50.0
"""Metres that a pixel may be; outside, a point must be wrong."""
MOST_SHEAR = 0.35
"""How far from square the photo's sides may be laid, as the cosine between them."""


class FitError(ValueError):
    """Points that lay no photo; the message is one sentence."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Ground = ``matrix`` (2, 2) times pixel plus ``offset`` (2,). ``residuals`` in metres, one a point."""

    matrix: FloatArray
    offset: FloatArray
    residuals: tuple[float, ...]

    def ground(self, pixels: FloatArray | Sequence[tuple[float, float]]) -> FloatArray:
        """East and north of pixels, both of shape (N, 2)."""
        placed: FloatArray = np.asarray(pixels, dtype=float).reshape(-1, 2) @ self.matrix.T + self.offset
        return placed

    def pixels(self, ground: FloatArray | Sequence[tuple[float, float]]) -> FloatArray:
        """The other way round."""
        points = np.asarray(ground, dtype=float).reshape(-1, 2)
        back: FloatArray = np.asarray(np.linalg.solve(self.matrix, (points - self.offset).T).T, dtype=np.float64)
        return back

    @property
    def metres_per_pixel(self) -> float:
        """The size of a pixel, the mean of its sides."""
        return float(math.sqrt(abs(np.linalg.det(self.matrix))))

    @property
    def rms(self) -> float:
        """The root mean square of the residuals, in metres."""
        return math.sqrt(sum(one**2 for one in self.residuals) / max(len(self.residuals), 1))


def fitted(points: Sequence[MatchedPoint], frame: FieldFrame) -> Fit:
    """The photo on the ground.

    Raises ``FitError`` for too few points, points in one place or on one line, and points far from the frame's origin.
    """
    if len(points) < 2:
        msg = f"{len(points)} point is matched; two or more are needed"
        raise FitError(msg)
    pixels = np.array([(one.right, one.down) for one in points], dtype=float)
    try:
        ground = np.array([frame.east_north_from_degrees(one.latitude_deg, one.longitude_deg) for one in points])
    except ValueError as error:
        raise FitError(*error.args) from error
    spread = np.hypot(*(pixels - pixels.mean(axis=0)).T)
    if float(spread.max()) < LEAST_PIXELS / 2:
        msg = "the points lie in nearly one place of the photo: choose points far apart"
        raise FitError(msg)
    matrix, offset = _similarity(pixels, ground) if len(points) == 2 else _affine(pixels, ground)
    _check(matrix)
    away = np.hypot(*(pixels @ matrix.T + offset - ground).T)
    return Fit(matrix, offset, tuple(float(one) for one in away))


def _similarity(pixels: FloatArray, ground: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Turned, scaled and moved: a complex factor, with the photo's down turned to north."""
    step = complex(pixels[1, 0] - pixels[0, 0], -(pixels[1, 1] - pixels[0, 1]))
    way = complex(*(ground[1] - ground[0]))
    factor = way / step
    matrix = np.array([[factor.real, factor.imag], [factor.imag, -factor.real]])
    return matrix, ground[0] - matrix @ pixels[0]


def _affine(pixels: FloatArray, ground: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least squares with six numbers."""
    middle = pixels.mean(axis=0)
    centred = pixels - middle
    singular = np.linalg.svd(centred, compute_uv=False)
    if singular[1] < 0.02 * singular[0]:
        msg = "the points lie on one line of the photo: choose one beside it"
        raise FitError(msg)
    solved, *_ = np.linalg.lstsq(centred, ground - ground.mean(axis=0), rcond=None)
    matrix = solved.T
    return matrix, ground.mean(axis=0) - matrix @ middle


def _check(matrix: FloatArray) -> None:
    """Raises ``FitError`` for a photo that would be laid mirrored, skewed or in no sensible size."""
    determinant = float(np.linalg.det(matrix))
    if determinant >= 0:
        msg = "these points would lay the photo upside down: two of them are exchanged, or one is wrong"
        raise FitError(msg)
    size = math.sqrt(-determinant)
    if not FINEST <= size <= COARSEST:
        msg = f"these points make a pixel {size:.3g} m; {FINEST:g} to {COARSEST:g} m are possible: one is wrong"
        raise FitError(msg)
    right, down = matrix[:, 0], matrix[:, 1]
    shear = abs(float(right @ down)) / (float(np.hypot(*right)) * float(np.hypot(*down)))
    if shear > MOST_SHEAR:
        msg = "these points skew the photo by more than a camera does: one of them is wrong"
        raise FitError(msg)
