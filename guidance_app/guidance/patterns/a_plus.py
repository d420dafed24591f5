"""A+: endless straight passes beside a line through one point, in a heading that is given."""

import numpy as np

from guidance_app.angles import east_north
from guidance_app.guidance.family import GuidanceLineError, ParallelLines
from guidance_app.guidance.line_type import LineType
from guidance_app.language import sentence
from guidance_app.model import FloatArray

__all__ = ["LINE", "lines_through", "points_of"]

DRAWN = 100.0
"""Metres from A to the second point, which only tells the heading."""


def points_of(point: tuple[float, float], heading: float) -> FloatArray:
    """Shape (2, 2): A and a point in its heading, as such a line is stored."""
    return np.array([point, np.add(point, np.multiply(east_north(heading), DRAWN))])


def lines_through(points: FloatArray, spacing: float) -> ParallelLines:
    """Through the first point towards the second."""
    if len(points) != 2:
        msg = sentence("an A+ line is stored as its point and one in its heading")
        raise GuidanceLineError(msg)
    (east, north), (toward_east, toward_north) = points.tolist()
    return ParallelLines((east, north), (toward_east, toward_north), spacing)


LINE = LineType(
    name="a-plus",
    title="A+ and heading",
    explanation="Straight passes through point A in a heading that you type.",
    family=lines_through,
)
