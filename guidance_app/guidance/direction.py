"""The heading of the passes: typed, along an edge, or the cheapest of all."""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely import Polygon

from guidance_app.angles import heading_between, wrap_2pi
from guidance_app.documents import Direction
from guidance_app.guidance.request import PlanRequest
from guidance_app.model import FloatArray

__all__ = ["best_heading", "longest_edge", "pass_heading"]


def pass_heading(ground: Polygon, mainland: Sequence[Polygon], request: PlanRequest) -> float:
    """Radians in [0, 2 pi) as the request wants it."""
    match request.direction:
        case Direction.TYPED:
            assert request.heading is not None
            return wrap_2pi(request.heading)
        case Direction.LINE:
            assert request.line is not None
            return heading_between(*request.line)
        case Direction.LONGEST_EDGE:
            return longest_edge(ground)
        case Direction.BEST:
            return best_heading(mainland or (ground,), request.spacing)


def longest_edge(ground: Polygon) -> float:
    """Heading of the longest straight stretch of the boundary; bends below 3 degrees do not end a stretch."""
    corners = shapely.get_coordinates(shapely.simplify(ground.exterior, 1.0))
    edges = np.diff(corners, axis=0)
    east, north = edges[np.argmax(np.hypot(edges[:, 0], edges[:, 1]))]
    return wrap_2pi(math.atan2(east, north))


def best_heading(mainland: Sequence[Polygon], spacing: float) -> float:
    """Heading with the fewest passes."""
    headings = np.radians(np.arange(0.0, 180.0, 0.5))
    edges = np.concatenate([_edges(part) for part in mainland])
    across = np.abs(edges @ np.stack([np.cos(headings), -np.sin(headings)]))
    passes = across.sum(axis=0) / (2 * spacing)
    return float(headings[np.argmin(passes)])


def _edges(part: Polygon) -> FloatArray:
    rings = [part.exterior, *part.interiors]
    edges: FloatArray = np.concatenate([np.diff(shapely.get_coordinates(ring), axis=0) for ring in rings])
    return edges
