"""Fields of any shape, for tests that hold on every field."""

import math

import numpy as np
import shapely
from hypothesis import strategies as st


@st.composite
def stars(draw: st.DrawFn) -> shapely.Polygon:
    """Fields of any shape round a middle, some with a hole, some with points again and again."""
    count = draw(st.integers(3, 14))
    radii = draw(st.lists(st.floats(4, 70), min_size=count, max_size=count))
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False)
    points = [(radius * math.cos(angle), radius * math.sin(angle)) for radius, angle in zip(radii, angles, strict=True)]
    if draw(st.booleans()):
        points = [point for point in points for _ in range(2)]
    polygon = shapely.Polygon(points)
    hole = draw(st.none() | st.floats(1, 20))
    if hole is None:
        return polygon
    place = draw(st.tuples(st.floats(-35, 35), st.floats(-35, 35)))
    cut = polygon.difference(shapely.Point(place).buffer(hole, quad_segs=3))
    return cut if isinstance(cut, shapely.Polygon) else polygon
