"""A line with places measured along it: where one is, which way it runs there, and the stretch between two."""

import itertools
from dataclasses import dataclass, field

import numpy as np

from guidance_app.model import FloatArray

__all__ = ["LONG", "Ring", "Stroke"]

BESIDE = 0.1
"""Metres on either side of a place between which the direction there is taken."""

LONG = 1.5
"""Metres; a longer step between neighbouring points is a straight, a shorter one may be an arc's chord."""

SAME = 1e-9
"""Metres; nearer points are one."""


@dataclass(frozen=True, slots=True, eq=False)
class Stroke:
    """An open line; ``points`` (N, 2) in driving order, no two neighbours the same."""

    points: FloatArray
    _along: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Measures the line once."""
        object.__setattr__(self, "_along", _measured(self.points))

    @property
    def length(self) -> float:
        """Metres from end to end."""
        return float(self._along[-1])

    def reversed(self) -> "Stroke":
        """The line driven the other way."""
        return Stroke(self.points[::-1])

    @property
    def period(self) -> float:
        """Metres after which the line comes round again: never."""
        return np.inf

    def places(self, step: float) -> FloatArray:
        """Where the line may be joined or left, about ``step`` metres apart."""
        return _places(self._along, step)

    def at(self, along: FloatArray) -> FloatArray:
        """Points (M, 2) at so many metres from the first point; the ends beyond the ends."""
        return _interpolated(self.points, self._along, along)

    def poses(self, along: FloatArray) -> FloatArray:
        """Poses (M, 3): east, north, yaw of travel."""
        ahead = self.at(along + BESIDE) - self.at(along - BESIDE)
        return np.column_stack([self.at(along), np.arctan2(ahead[:, 1], ahead[:, 0])])

    def stretch(self, begin: float, end: float) -> FloatArray:
        """Points from ``begin`` to ``end``, which lies ahead."""
        inner = self.points[np.searchsorted(self._along, begin, "right") : np.searchsorted(self._along, end)]
        return _distinct(np.vstack([self.at(np.array([begin])), inner, self.at(np.array([end]))]))


@dataclass(frozen=True, slots=True, eq=False)
class Ring:
    """A closed line; ``points`` (N, 2) in driving order, the first one not repeated."""

    points: FloatArray
    _closed: FloatArray = field(init=False, repr=False)
    _along: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Measures the line once."""
        closed = np.vstack([self.points, self.points[:1]])
        object.__setattr__(self, "_closed", closed)
        object.__setattr__(self, "_along", _measured(closed))

    @property
    def length(self) -> float:
        """Metres once round."""
        return float(self._along[-1])

    def reversed(self) -> "Ring":
        """The line driven the other way."""
        return Ring(self.points[::-1])

    @property
    def period(self) -> float:
        """Metres after which the line comes round again."""
        return self.length

    @property
    def along(self) -> FloatArray:
        """Metres (N,) from the first point to each."""
        return self._along[:-1]

    def places(self, step: float) -> FloatArray:
        """Where the line may be joined or left, about ``step`` metres apart."""
        return _places(self._along, step)

    def at(self, along: FloatArray) -> FloatArray:
        """Points (M, 2) at so many metres from the first point, taken round and round."""
        return _interpolated(self._closed, self._along, np.mod(along, self.length))

    def poses(self, along: FloatArray) -> FloatArray:
        """Poses (M, 3): east, north, yaw of travel."""
        ahead = self.at(along + BESIDE) - self.at(along - BESIDE)
        return np.column_stack([self.at(along), np.arctan2(ahead[:, 1], ahead[:, 0])])

    def stretch(self, begin: float, end: float) -> FloatArray:
        """Points from ``begin`` on to ``end``, over the seam if need be; once round when both are the same."""
        starts = self._along[:-1]
        first, last = np.searchsorted(starts, begin, "right"), np.searchsorted(starts, end)
        inner = self.points[first:last] if begin < end else np.vstack([self.points[first:], self.points[:last]])
        ends = self.at(np.array([begin, end]))
        return _distinct(np.vstack([ends[:1], inner, ends[1:]]))


def _measured(points: FloatArray) -> FloatArray:
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _places(along: FloatArray, step: float) -> FloatArray:
    """Places on straights, and points of arcs: a place between two points of an arc would lie off the circle."""
    places: list[float] = []
    for begin, end in itertools.pairwise(along.tolist()):
        if end - begin > LONG:
            count = max(1, int((end - begin) / step))
            places.extend(begin + (end - begin) * (number + 0.5) / count for number in range(count))
        elif not places or begin - places[-1] > step / 2:
            places.append(begin)
    return np.array(places)


def _interpolated(points: FloatArray, along: FloatArray, places: FloatArray) -> FloatArray:
    return np.column_stack([np.interp(places, along, points[:, axis]) for axis in range(2)])


def _distinct(points: FloatArray) -> FloatArray:
    apart = np.hypot(*np.diff(points, axis=0).T)
    kept: FloatArray = points[np.concatenate([[True], apart > SAME])]
    return kept
