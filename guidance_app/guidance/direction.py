"""The heading of the passes: typed, along an edge, along a line, or the cheapest of all.

The cheapest is looked for in steps of half a degree. The passes at a heading need not be cut out to be counted: by
Euler's characteristic the pieces of all strips are the stretches of the lines between the strips, plus the mainland's
parts less its holes. What that says to be cheapest is then cut out exactly. A pass costs a turn, a metre of it the
time of a metre, and slanting ends make it longer.
"""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely import Polygon

from guidance_app.angles import heading_between, wrap_2pi
from guidance_app.documents import Direction
from guidance_app.guidance.cells import cut, strips_over
from guidance_app.guidance.request import LastPass, PlanError, PlanRequest
from guidance_app.language import sentence
from guidance_app.model import FloatArray

__all__ = ["best_heading", "edge_heading", "edges_of", "longest_edge", "nearest_edge", "pass_heading"]

STEP = math.radians(0.5)
"""Between the headings that are compared."""

EXACT, EXACT_PASSES = 20, 400
"""Headings that are cut out exactly at most, and passes of them all together."""

SLACK = 1
"""Passes more than the fewest that a heading may take if it is cheaper otherwise."""

AGAIN = 3.0
"""Metres that a metre worked again counts for: it costs seed, fertiliser and spray besides the time."""

STRAIGHT = 0.5
"""Metres by which a stretch of the boundary may bend and still be an edge."""

BLOCK = 20_000
"""Edges times headings that are counted at a time."""


def pass_heading(ground: Polygon, mainland: Sequence[Polygon], request: PlanRequest) -> float:
    """Radians in [0, 2 pi) as the request wants it."""
    match request.direction:
        case Direction.TYPED:
            assert request.heading is not None, "the request checks that"
            return wrap_2pi(request.heading)
        case Direction.LINE:
            assert request.line is not None, "the request checks that"
            return heading_between(*request.line)
        case Direction.LONGEST_EDGE:
            return longest_edge(ground)
        case Direction.EDGE:
            assert request.edge_near is not None, "the request checks that"
            return edge_heading(ground, request.edge_near)
        case Direction.BEST:
            return best_heading(mainland or (ground,), request)


def longest_edge(ground: Polygon) -> float:
    """Heading of the longest straight stretch of the outer boundary."""
    corners = _straightened(ground.exterior)
    east, north = max(np.diff(corners, axis=0), key=lambda edge: math.hypot(edge[0], edge[1]))
    return wrap_2pi(math.atan2(east, north))


def edge_heading(ground: Polygon, near: tuple[float, float]) -> float:
    """Heading of the straight stretch of boundary or obstacle nearest to a place."""
    edges = edges_of(ground)
    first, second = edges[nearest_edge(edges, near)]
    return heading_between((float(first[0]), float(first[1])), (float(second[0]), float(second[1])))


def edges_of(ground: Polygon) -> FloatArray:
    """The straight stretches of boundary and obstacles, both ends of each; shape (N, 2, 2)."""
    rings = [_straightened(ring) for ring in (ground.exterior, *ground.interiors)]
    edges: FloatArray = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])
    return edges


def nearest_edge(edges: FloatArray, place: tuple[float, float]) -> int:
    """Which of ``edges_of`` lies nearest to a place."""
    return int(np.argmin(shapely.distance(shapely.linestrings(edges), shapely.Point(place))))


def best_heading(mainland: Sequence[Polygon], request: PlanRequest) -> float:
    """The heading in [0, pi) at which working the mainland takes the least time."""
    headings = np.arange(0.0, math.pi, STEP)
    edges = np.concatenate([_edges(part) for part in mainland])
    stretches, slants = _counted(edges, headings, request.spacing)
    counts = stretches + len(mainland) - sum(len(part.interiors) for part in mainland)
    turn = (math.pi * request.path_radius + request.spacing) / request.turn_speed
    guess = counts * turn + AGAIN * slants / request.work_speed
    exact = int(np.clip(EXACT_PASSES / counts.min(), 2, EXACT))
    few = np.flatnonzero(counts <= counts.min() + SLACK)
    likely = few[np.argsort(guess[few])][:exact]
    cuts = {}
    for heading in headings[likely]:
        pieces = cut(mainland, strips_over(mainland, float(heading), request.spacing, LastPass.OVERLAP, None))
        cuts[float(heading)] = (len(pieces), sum(piece.length for piece in pieces))
    if not cuts or not any(count for count, _ in cuts.values()):
        msg = sentence("the mainland is too small for a pass")
        raise PlanError(msg)
    fewest = min(count for count, _ in cuts.values())
    return min(
        (heading for heading, (count, _) in cuts.items() if count <= fewest + SLACK),
        key=lambda heading: cuts[heading][0] * turn + AGAIN * cuts[heading][1] / request.work_speed,
    )


def _counted(edges: FloatArray, headings: FloatArray, spacing: float) -> tuple[FloatArray, FloatArray]:
    """For each heading the stretches of lines between strips, and the metres that slanting ends add to passes.

    ``edges`` has shape (N, 2, 2).
    """
    counts, slants = np.empty(len(headings)), np.empty(len(headings))
    step = max(1, BLOCK // len(edges))
    for low in range(0, len(headings), step):
        some = slice(low, low + step)
        along = np.stack([np.sin(headings[some]), np.cos(headings[some])])
        across = np.stack([along[1], -along[0]])
        ends = edges @ across
        lines = np.ceil((ends - ends.min(axis=(0, 1))) / spacing)
        crossed = np.abs(np.diff(lines, axis=1)).sum(axis=(0, 1))
        counts[some] = crossed / 2
        slants[some] = np.abs((edges[:, 1] - edges[:, 0]) @ along).sum(axis=0) / 2
    return counts, slants


def _edges(part: Polygon) -> FloatArray:
    """Shape (N, 2, 2): both ends of each edge."""
    rings = [shapely.get_coordinates(ring) for ring in (part.exterior, *part.interiors)]
    edges: FloatArray = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])
    return edges


def _straightened(ring: shapely.LinearRing) -> FloatArray:
    """Corners of a ring, closed, without its slight bends; begun at a corner, not in the middle of an edge."""
    corners = shapely.get_coordinates(ring)[:-1]
    middle = corners.mean(axis=0)
    farthest = int(np.argmax(np.hypot(*(corners - middle).T)))
    rolled = np.roll(corners, -farthest, axis=0)
    closed = shapely.linestrings(np.vstack([rolled, rolled[:1]]))
    return shapely.get_coordinates(shapely.simplify(closed, STRAIGHT))
