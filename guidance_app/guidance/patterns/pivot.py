"""Pivot: circles around the centre of an irrigation boom."""

import math

import numpy as np

from guidance_app.guidance.family import Circles, GuidanceLineError
from guidance_app.guidance.line_type import LineType
from guidance_app.language import sentence
from guidance_app.model import FloatArray

__all__ = ["LINE", "circles_around", "points_of_arc"]

LARGEST = 5_000.0
"""Metres; an arc that gives a larger radius is a straight line."""


def points_of_arc(driven: FloatArray) -> FloatArray:
    """Shape (2, 2): centre and a point on the circle, from points driven along a part of it.

    Least squares of x2 + y2 = 2 a x + 2 b y + c (Kasa 1976).
    """
    middle = driven.mean(axis=0)
    away = driven - middle
    system = np.column_stack([2.0 * away, np.ones(len(away))])
    (east, north, rest), _, rank, _ = np.linalg.lstsq(system, np.square(away).sum(axis=1), rcond=None)
    radius = math.sqrt(max(rest + east * east + north * north, 0.0))
    if rank < 3 or radius > LARGEST:
        msg = sentence("these points lie on a straight line: drive a longer part of the circle")
        raise GuidanceLineError(msg)
    centre_east, centre_north = float(middle[0] + east), float(middle[1] + north)
    return np.array([[centre_east, centre_north], [centre_east + radius, centre_north]])


def circles_around(points: FloatArray, spacing: float) -> Circles:
    """Around the first point, through the second."""
    if len(points) != 2:
        msg = sentence("a pivot is stored as its centre and one point of its circle")
        raise GuidanceLineError(msg)
    (east, north), rim = points.tolist()
    return Circles((east, north), math.dist((east, north), rim), spacing)


LINE = LineType(
    name="pivot",
    title="Pivot",
    explanation="Circles around a centre; higher numbers lie further inside.",
    family=circles_around,
)
