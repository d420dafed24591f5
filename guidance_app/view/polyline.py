"""Polylines as arrays of shape (N, 2): lengths along them, dashes, thinning, and the strokes a renderer takes."""

import numpy as np

from guidance_app.model import FloatArray

__all__ = [
    "Segments",
    "along",
    "closed_ring",
    "cut",
    "dashed",
    "lengths",
    "point_at",
    "segments",
    "stretched",
    "thinned",
]

Segments = np.ndarray[tuple[int, ...], np.dtype[np.float32]]
"""Shape (M, 2, 3): begin and end of each stroke."""


def segments(points: FloatArray, z: float = 0.0) -> Segments:
    """The strokes along ``points`` of shape (N, 2), all at height ``z``; shape (N - 1, 2, 3)."""
    strokes = np.full((max(len(points) - 1, 0), 2, 3), z, dtype=np.float32)
    strokes[:, 0, :2] = points[:-1]
    strokes[:, 1, :2] = points[1:]
    return strokes


def closed_ring(points: FloatArray) -> FloatArray:
    """The points with the first one repeated at the end, unless it is already."""
    if len(points) and not np.array_equal(points[0], points[-1]):
        return np.vstack([points, points[:1]])
    return points


def lengths(points: FloatArray) -> FloatArray:
    """Metres from the first point to each, shape (N,)."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    return np.concatenate([[0.0], np.cumsum(steps)])


def point_at(points: FloatArray, metres: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """(east, north) so many metres along, and the unit vector of the direction there. Clamped to the ends."""
    run = lengths(points)
    k = int(np.clip(np.searchsorted(run, metres, side="right") - 1, 0, len(points) - 2))
    span = run[k + 1] - run[k]
    share = 0.0 if span == 0 else float(np.clip((metres - run[k]) / span, 0.0, 1.0))
    step = points[k + 1] - points[k]
    place = points[k] + share * step
    size = float(np.hypot(*step)) or 1.0
    return (float(place[0]), float(place[1])), (float(step[0]) / size, float(step[1]) / size)


def along(points: FloatArray, east: float, north: float) -> tuple[float, float]:
    """Metres along to the place nearest to (east, north), and its distance from there."""
    start, step = points[:-1], np.diff(points, axis=0)
    square = np.maximum((step**2).sum(axis=1), 1e-12)
    share = np.clip((((east, north) - start) * step).sum(axis=1) / square, 0.0, 1.0)
    gap = np.hypot(*(start + share[:, None] * step - (east, north)).T)
    k = int(np.argmin(gap))
    return float(lengths(points)[k] + share[k] * np.sqrt(square[k])), float(gap[k])


def cut(points: FloatArray, longest: float = 40.0) -> FloatArray:
    """The same line with a point at least every ``longest`` metres.

    A stroke that begins far behind the camera is drawn at a wrong depth, and sinks into the ground.
    """
    run = lengths(points)
    counts = np.maximum(np.ceil(np.diff(run) / longest).astype(int), 1)
    steps = [np.linspace(run[k], run[k + 1], count, endpoint=False) for k, count in enumerate(counts)]
    places = np.concatenate([*steps, run[-1:]])
    return np.column_stack([np.interp(places, run, points[:, 0]), np.interp(places, run, points[:, 1])])


def stretched(points: FloatArray, metres: float) -> FloatArray:
    """The line made longer by so many metres at both ends, in the direction of its end points."""
    head, tail = points[0] - points[1], points[-1] - points[-2]
    first = points[0] + head / (np.hypot(*head) or 1.0) * metres
    last = points[-1] + tail / (np.hypot(*tail) or 1.0) * metres
    return np.vstack([first, points, last])


def dashed(points: FloatArray, on: float, off: float, most: int = 400) -> FloatArray:
    """Dashes of ``on`` metres with gaps of ``off``; shape (M, 2, 2). A long line gets longer dashes.

    A dash bends with the line: it is cut where the line has a corner.
    """
    run = lengths(points)
    total = float(run[-1])
    if total <= 0:
        return np.empty((0, 2, 2))
    period = max(on + off, total / (most / 2))
    on *= period / (on + off)
    starts = np.arange(0.0, total, period)
    cuts = np.unique(np.concatenate([starts, np.minimum(starts + on, total), run]))
    middles = (cuts[:-1] + cuts[1:]) / 2
    inked = (middles % period) < on
    east, north = np.interp(cuts, run, points[:, 0]), np.interp(cuts, run, points[:, 1])
    places = np.column_stack([east, north])
    return np.stack([places[:-1][inked], places[1:][inked]], axis=1)


def thinned(points: FloatArray, tolerance: float) -> FloatArray:
    """Fewer points, none of those left out farther than ``tolerance`` from the rest (Douglas and Peucker 1973)."""
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    stack = [(0, len(points) - 1)]
    while stack:
        first, last = stack.pop()
        if last - first < 2:
            continue
        between, chord = points[first + 1 : last] - points[first], points[last] - points[first]
        size = float((chord**2).sum())
        share = np.clip(between @ chord / size, 0.0, 1.0) if size > 0 else np.zeros(len(between))
        gap = ((between - share[:, None] * chord) ** 2).sum(axis=1)
        worst = int(np.argmax(gap))
        if gap[worst] > tolerance**2:
            middle = first + 1 + worst
            keep[middle] = True
            stack += [(first, middle), (middle, last)]
    return points[keep]
