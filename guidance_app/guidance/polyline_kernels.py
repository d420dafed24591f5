"""Compiled search for the foot point on a polyline. Plain functions on arrays; ``polyline.py`` is their only user.

A line is an array of shape (N, 4): east, north, distance along it, and heading of the segment that begins there.
"""

import math

import numba
import numpy as np

from guidance_app.model import FloatArray

__all__ = ["ALONG", "CLOSED", "EAST", "ENDLESS", "HEADING", "NORTH", "OPEN", "foot_on"]

EAST, NORTH, ALONG, HEADING = 0, 1, 2, 3

OPEN, ENDLESS, CLOSED = 0, 1, 2
"""How a line ends: at its ends, never (its outer segments run on), or where it began."""

BLEND = 1.0
"""Within this distance of a corner the direction turns from one segment's to the next one's."""


@numba.njit(cache=True)
def _wrapped(angle: float) -> float:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


@numba.njit(cache=True)
def _along_segment(line: FloatArray, i: int, east: float, north: float) -> float:
    """Where the foot point lies on the line through segment ``i``: 0 at its start, 1 at its end."""
    step_east = line[i + 1, EAST] - line[i, EAST]
    step_north = line[i + 1, NORTH] - line[i, NORTH]
    across = (east - line[i, EAST]) * step_east + (north - line[i, NORTH]) * step_north
    return float(across / (step_east * step_east + step_north * step_north))


@numba.njit(cache=True)
def _squared_distance(line: FloatArray, i: int, fraction: float, east: float, north: float) -> float:
    away_east = east - line[i, EAST] - fraction * (line[i + 1, EAST] - line[i, EAST])
    away_north = north - line[i, NORTH] - fraction * (line[i + 1, NORTH] - line[i, NORTH])
    return float(away_east * away_east + away_north * away_north)


@numba.njit(cache=True)
def _window(line: FloatArray, ends: int, near: float, reach: float) -> tuple[int, int]:
    """First and last segment within ``reach`` along the line from ``near``; a closed line's may lie outside 0..N-2."""
    count = line.shape[0] - 1
    total = line[count, ALONG]
    if reach >= total:
        return 0, count - 1
    start = min(max(np.searchsorted(line[:, ALONG], near, side="right") - 1, 0), count - 1)
    first = last = start
    while last - start < count:
        following = last + 1
        beyond = line[following % count, ALONG] + (total if following >= count else 0.0)
        if (following >= count and ends != CLOSED) or beyond - near > reach:
            break
        last = following
    while start - first < count:
        before = first - 1
        beyond = line[before % count + 1, ALONG] - (total if before < 0 else 0.0)
        if (before < 0 and ends != CLOSED) or near - beyond > reach:
            break
        first = before
    return first, last


@numba.njit(cache=True)
def _nearest(
    line: FloatArray, ends: int, east: float, north: float, near: float, reach: float
) -> tuple[int, float, float]:
    """Segment, fraction and squared distance of the nearest point; outer segments of an endless line run on."""
    count = line.shape[0] - 1
    first, last = _window(line, ends, near, reach)
    best_segment, best_fraction, best = first % count, 0.0, math.inf
    for unwrapped in range(first, last + 1):
        i = unwrapped % count
        fraction = _along_segment(line, i, east, north)
        if fraction < 0.0 and not (ends == ENDLESS and i == 0):
            fraction = 0.0
        elif fraction > 1.0 and not (ends == ENDLESS and i == count - 1):
            fraction = 1.0
        squared = _squared_distance(line, i, fraction, east, north)
        if squared < best:
            best_segment, best_fraction, best = i, fraction, squared
    return best_segment, best_fraction, best


@numba.njit(cache=True)
def _corner_turn(line: FloatArray, ends: int, i: int) -> float:
    """Heading change where segment ``i`` begins; 0 where the line begins or ends."""
    count = line.shape[0] - 1
    if 0 < i < count:
        return _wrapped(line[i, HEADING] - line[i - 1, HEADING])
    if ends == CLOSED:
        return _wrapped(line[0, HEADING] - line[count - 1, HEADING])
    return 0.0


@numba.njit(cache=True)
def _direction(line: FloatArray, ends: int, i: int, from_start: float) -> float:
    """Heading of the line ``from_start`` metres into segment ``i``, without a step at its corners."""
    length = line[i + 1, ALONG] - line[i, ALONG]
    blend = min(BLEND, 0.5 * length)
    heading = line[i, HEADING]
    to_end = length - from_start
    if from_start < blend:
        heading -= 0.5 * _corner_turn(line, ends, i) * (1.0 - max(from_start, 0.0) / blend)
    elif to_end < blend:
        heading += 0.5 * _corner_turn(line, ends, i + 1) * (1.0 - max(to_end, 0.0) / blend)
    return _wrapped(heading)


@numba.njit(cache=True)
def _side(line: FloatArray, ends: int, i: int, fraction: float, east: float, north: float) -> float:
    """Positive right of the line, by both segments where the foot point is a corner."""
    count = line.shape[0] - 1
    corner, other = i, i
    if fraction <= 0.0 and (i > 0 or ends == CLOSED):
        other = (i - 1) % count
    elif fraction >= 1.0 and (i < count - 1 or ends == CLOSED):
        corner, other = i + 1, (i + 1) % count
    toward_east = math.sin(line[i, HEADING]) + math.sin(line[other, HEADING])
    toward_north = math.cos(line[i, HEADING]) + math.cos(line[other, HEADING])
    return float((east - line[corner, EAST]) * toward_north - (north - line[corner, NORTH]) * toward_east)


@numba.njit(cache=True)
def foot_on(
    line: FloatArray, ends: int, east: float, north: float, near: float, reach: float
) -> tuple[float, float, float, float]:
    """Along-track, cross-track (positive right), heading of the line, and distance, of the nearest point.

    Before its first and behind its last point a line that is not closed is prolonged straight: along-track is
    negative or beyond the length there and cross-track is sideways only.
    """
    i, fraction, squared = _nearest(line, ends, east, north, near, reach)
    distance = math.sqrt(squared)
    length = line[i + 1, ALONG] - line[i, ALONG]
    unclamped = _along_segment(line, i, east, north)
    before = i == 0 and unclamped < 0.0
    behind = i == line.shape[0] - 2 and unclamped > 1.0
    if ends != CLOSED and (before or behind):
        heading = line[i, HEADING]
        toward_east, toward_north = math.sin(heading), math.cos(heading)
        cross = (east - line[i, EAST]) * toward_north - (north - line[i, NORTH]) * toward_east
        return line[i, ALONG] + unclamped * length, cross, heading, distance
    cross = distance if _side(line, ends, i, fraction, east, north) >= 0.0 else -distance
    return line[i, ALONG] + fraction * length, cross, _direction(line, ends, i, fraction * length), distance
