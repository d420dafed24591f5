"""Closed lines without bends that are tighter than a circle, and without the unevenness of offset polygons.

An offset of an offset is millimetres off its circle here and there, which bends its short chords visibly. ``eased``
replaces the bends that are really too tight by arcs and runs a short weighted mean along the line; on a circle of
radius R that draws in by s^2 / 2R for a width s, millimetres.

The points handed out are some of those at which the bend was measured. The turn at a point of such a line is the mean
of the bends along both its chords, so that leaving out more of them never makes a bend tighter.
"""

import math

import numpy as np
import shapely
from numpy.typing import NDArray

from guidance_app.guidance.ring import Ring, Stroke
from guidance_app.model import FloatArray

BoolArray = NDArray[np.bool_]

__all__ = ["blunted", "eased", "eased_stroke"]

MEAN_WIDTH = 0.06
"""Turning radii: the standard deviation of the mean that evens a line."""

MEAN_STEPS = 3
"""Points per standard deviation."""

REACH = 3 * MEAN_STEPS
"""Points on either side that the mean takes in."""

TREND = 4
"""Points over which a line's direction is taken when its bend is measured."""

SPREAD = 4 * MEAN_STEPS
"""Points beside a tight place that are drawn into the mean; even."""

EVEN_TOLERANCE = 0.98
"""Bends of the circle that even points may have."""

STRAIGHT = 1e-7
"""Radians between even points of a straight."""

FLAT = 0.003
"""Metres by which a dropped point may lie off the line."""

TOLERANCE = 1.02
"""A bend tighter than the circle by less is left to the rounding of chords."""

ARC_STEP = math.radians(6.0)
"""Between the points of an arc."""

ROUNDS = 200
"""Bends replaced at most in one line."""

MEANS = 150
"""Means taken at most in one line: more would move it by more than decimetres."""


def eased(points: FloatArray, radius: float) -> FloatArray | None:
    """The closed line ``points`` (N, 2) bent no tighter than the circle, with no more points than it needs.

    None where that cannot be done by moving it a little.
    """
    ring = blunted(_thinned(_evened(points, radius), closed=True), radius)
    even = _evened(ring, radius)
    for _ in range(MEANS):
        tight = _tight(even, radius)
        if not tight.any():
            break
        share = _share(np.concatenate([tight[-SPREAD:], tight, tight[:SPREAD]]))
        even = even + share[:, None] * (_mean(np.concatenate([even[-REACH:], even, even[:REACH]])) - even)
    else:
        return None
    return _thinned(even[::TREND], closed=True)


def eased_stroke(points: FloatArray, radius: float) -> FloatArray | None:
    """The same for an open line; its ends stay where they are."""
    stroke = Stroke(points)
    even = _stroke_mean(stroke.at(np.linspace(0.0, stroke.length, _count(stroke.length, radius) + 1)))
    for _ in range(MEANS):
        tight = _tight(even, radius)
        tight[:TREND] = tight[-TREND:] = False
        if not tight.any():
            break
        share = _share(np.pad(tight, SPREAD))
        even = even + share[:, None] * (_stroke_mean(even) - even)
    else:
        return None
    return _thinned(even[::TREND], closed=False)


def _count(length: float, radius: float) -> int:
    """Even points of a line, a multiple of those over which a bend is measured."""
    return TREND * max(2 * SPREAD // TREND, round(length * MEAN_STEPS / (MEAN_WIDTH * radius) / TREND))


def _evened(points: FloatArray, radius: float) -> FloatArray:
    """Even points of a closed line after one weighted mean."""
    ring = Ring(points)
    count = _count(ring.length, radius)
    even = ring.at(ring.length * np.arange(count) / count)
    return _mean(np.concatenate([even[-REACH:], even, even[:REACH]]))


def _stroke_mean(even: FloatArray) -> FloatArray:
    before = 2 * even[0] - even[REACH:0:-1]
    after = 2 * even[-1] - even[-2 : -REACH - 2 : -1]
    return _mean(np.concatenate([before, even, after]))


def _tight(even: FloatArray, radius: float) -> BoolArray:
    """Where even points of a closed line bend tighter than the circle."""
    ahead = np.roll(even, -TREND, axis=0) - even
    yaw = np.arctan2(ahead[:, 1], ahead[:, 0])
    turn = np.abs(np.mod(yaw - np.roll(yaw, TREND) + np.pi, 2 * np.pi) - np.pi)
    step = np.hypot(ahead[:, 0], ahead[:, 1])
    tight: BoolArray = turn * radius > (step + np.roll(step, TREND)) / 2 * EVEN_TOLERANCE
    return tight


def _share(tight: BoolArray) -> FloatArray:
    """How much of the mean each point takes: all where it is tight, less and less around it."""
    near = np.convolve(tight, np.ones(SPREAD + 1), "valid") > 0
    return np.convolve(near, np.ones(SPREAD + 1) / (SPREAD + 1), "valid")


def _mean(points: FloatArray) -> FloatArray:
    """Weighted means (N - 2 REACH, 2) of even points."""
    weights = np.exp(-0.5 * (np.arange(-REACH, REACH + 1) / MEAN_STEPS) ** 2)
    return np.column_stack([np.convolve(points[:, axis], weights / weights.sum(), "valid") for axis in range(2)])


def _thinned(points: FloatArray, *, closed: bool) -> FloatArray:
    """The line without points that lie on it; those of straights go first, since simplifying takes time squared."""
    turn, _ = _turns(points)
    bent = np.abs(turn) > STRAIGHT
    if not closed:
        bent[0] = bent[-1] = True
    bent[int(np.argmax(np.hypot(*(points - points.mean(axis=0)).T)))] = True
    rest = points[bent | np.roll(bent, 1) | np.roll(bent, -1)]
    line = shapely.linestrings(np.vstack([rest, rest[:1]]) if closed else rest)
    kept = shapely.get_coordinates(shapely.simplify(line, FLAT))
    return kept[:-1] if closed else kept


def blunted(points: FloatArray, radius: float) -> FloatArray:
    """The closed line ``points`` (N, 2) with every tight bend replaced; one that finds no room is left.

    A bend is tight where it turns more than the circle would over half the way to both neighbouring points. It takes
    in more and more neighbours, on its tighter side first, until an arc fits between the lines before and after it.
    """
    left = set[tuple[float, float]]()
    for _ in range(ROUNDS):
        worst = _tightest(points, radius, left)
        if worst is None:
            break
        replaced = _replaced(points, worst, radius)
        if replaced is None:
            left.add((float(points[worst, 0]), float(points[worst, 1])))
        else:
            points = replaced
    return points


def _turns(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The turn at each point, left positive, and the lengths of the steps from each point to the next."""
    steps = np.roll(points, -1, axis=0) - points
    yaw = np.arctan2(steps[:, 1], steps[:, 0])
    turn = np.mod(yaw - np.roll(yaw, 1) + np.pi, 2 * np.pi) - np.pi
    return turn, np.hypot(steps[:, 0], steps[:, 1])


def _tightness(points: FloatArray, radius: float) -> FloatArray:
    """The bend (N,) of a closed line at each point, in bends of the circle.

    Of an open line the first and the last mean nothing.
    """
    turn, steps = _turns(points)
    bend: FloatArray = np.abs(turn) * radius / ((steps + np.roll(steps, 1)) / 2)
    return bend


def _tightest(points: FloatArray, radius: float, left: set[tuple[float, float]]) -> int | None:
    excess = _tightness(points, radius)
    for place in np.argsort(-excess):
        if excess[place] <= TOLERANCE:
            return None
        if (float(points[place, 0]), float(points[place, 1])) not in left:
            return int(place)
    return None


def _replaced(points: FloatArray, place: int, radius: float) -> FloatArray | None:
    """The line with an arc instead of the bend at one point and as few neighbours as it takes."""
    count = len(points)
    rolled = np.roll(points, count // 2 - place, axis=0)
    low = high = count // 2
    while high - low < count // 2 and low > 1 and high < count - 2:
        arc = _arc(rolled[low - 1], rolled[low], rolled[high], rolled[high + 1], radius)
        if arc is not None:
            return np.concatenate([rolled[:low], arc, rolled[high + 1 :]])
        before = float(np.hypot(*(rolled[low] - rolled[low - 1])))
        after = float(np.hypot(*(rolled[high + 1] - rolled[high])))
        low, high = (low - 1, high) if before <= after else (low, high + 1)
    return None


def _arc(
    before: FloatArray, first: FloatArray, last: FloatArray, after: FloatArray, radius: float
) -> FloatArray | None:
    """The arc that touches the line from ``before`` to ``first`` and that from ``last`` to ``after``, within both."""
    into, out = first - before, after - last
    long_in, long_out = math.hypot(*into), math.hypot(*out)
    into, out = into / long_in, out / long_out
    turn = math.atan2(into[0] * out[1] - into[1] * out[0], float(into @ out))
    if abs(turn) < 1e-4 or abs(turn) > math.radians(150):
        return None
    apart = last - first
    ahead = (apart[0] * out[1] - apart[1] * out[0]) / math.sin(turn)
    behind = (into[0] * apart[1] - into[1] * apart[0]) / math.sin(turn)
    tangent = radius * math.tan(abs(turn) / 2)
    start, end = long_in + ahead - tangent, long_out + behind - tangent
    if start < 0 or end < 0:
        return None
    side = math.copysign(1.0, turn)
    begin = before + start * into
    centre = begin + side * radius * np.array([-into[1], into[0]])
    yaw = math.atan2(into[1], into[0]) + np.linspace(0.0, turn, max(2, math.ceil(abs(turn) / ARC_STEP) + 1))
    rim: FloatArray = centre + side * radius * np.column_stack([np.sin(yaw), -np.cos(yaw)])
    return rim
