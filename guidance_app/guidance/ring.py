"""A closed line with places measured along it: where one is, which way it runs there, and the stretch between two."""

from dataclasses import dataclass, field

import numpy as np

from guidance_app.model import FloatArray

__all__ = ["Ring"]

BESIDE = 0.1
"""Metres on either side of a place between which the direction there is taken."""


@dataclass(frozen=True, slots=True, eq=False)
class Ring:
    """``points`` (N, 2) in driving order, the first one not repeated."""

    points: FloatArray
    _closed: FloatArray = field(init=False, repr=False)
    _along: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Measures the line once."""
        closed = np.vstack([self.points, self.points[:1]])
        steps = np.hypot(*np.diff(closed, axis=0).T)
        object.__setattr__(self, "_closed", closed)
        object.__setattr__(self, "_along", np.concatenate([[0.0], np.cumsum(steps)]))

    @property
    def length(self) -> float:
        """Metres once round."""
        return float(self._along[-1])

    def at(self, along: FloatArray) -> FloatArray:
        """Points (M, 2) at so many metres from the first point, taken round and round."""
        place = np.mod(along, self.length)
        return np.column_stack([np.interp(place, self._along, self._closed[:, axis]) for axis in range(2)])

    def poses(self, along: FloatArray) -> FloatArray:
        """Poses (M, 3): east, north, yaw of travel."""
        ahead = self.at(along + BESIDE) - self.at(along - BESIDE)
        return np.column_stack([self.at(along), np.arctan2(ahead[:, 1], ahead[:, 0])])

    def stretch(self, begin: float, end: float) -> FloatArray:
        """Points from ``begin`` on to ``end``, over the seam if need be; once round when both are the same."""
        if begin < end:
            inner = self.points[
                np.searchsorted(self._along[:-1], begin, "right") : np.searchsorted(self._along[:-1], end)
            ]
        else:
            after = self.points[np.searchsorted(self._along[:-1], begin, "right") :]
            inner = np.vstack([after, self.points[: np.searchsorted(self._along[:-1], end)]])
        ends = self.at(np.array([begin, end]))
        points = np.vstack([ends[:1], inner, ends[1:]])
        apart = np.hypot(*np.diff(points, axis=0).T)
        return points[np.concatenate([[True], apart > 1e-9])]
