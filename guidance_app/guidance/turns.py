"""Turns between passes: the shortest drivable manoeuvre that stays inside with the whole machine.

Every candidate first runs straight on until the implement has worked the pass's end, and ends where the next pass
begins. Candidates are compared by length; one that does not fit is given with the metres that are missing.
"""

from dataclasses import dataclass

import numpy as np

from guidance_app.guidance.manoeuvres import WORDS, Manoeuvres, join, poses_along, with_straights
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.room import Room
from guidance_app.model import FloatArray

__all__ = ["POINTS", "Leg", "Turn", "Turner", "poses_of"]

POINTS = 60
"""A turn never has more points."""

RADIUS_MARGIN = 1.002
"""Turns are laid on a circle wider by this, so that their chords do not bend more than the turning radius."""

TRIES = 10
"""Candidates checked for a turn, shortest first, before it counts as one that does not fit."""


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """A stretch of a turn in one gear, shape (N, 2)."""

    points: FloatArray
    reverse: bool


@dataclass(frozen=True, slots=True, eq=False)
class Turn:
    """A way from pose to pose. ``missing`` is 0 when it fits."""

    legs: tuple[Leg, ...]
    length: float
    missing: float
    tight: bool


def poses_of(points: FloatArray, headings: FloatArray) -> FloatArray:
    """Shape (N, 3): east, north, yaw; from points and headings clockwise from north."""
    return np.column_stack([points, np.pi / 2 - headings])


class Turner:
    """Finds turns in one field for one machine."""

    def __init__(self, room: Room, request: PlanRequest) -> None:
        self.room = room
        self.radius = request.path_radius * RADIUS_MARGIN
        self.reverse = request.reverse_allowed
        self.out = max(request.offset_back, 0.0)
        self.into = max(-request.offset_back, 0.0)

    def turns(self, starts: FloatArray, ends: FloatArray) -> list[Turn]:
        """A turn for each pair of poses (M, 3), none of them longer than the shortest that fits."""
        moves = self._candidates(starts, ends)
        choice, fits = self._choose(moves, len(starts))
        return [self._turn(moves.take(np.array([row])), bool(fit)) for row, fit in zip(choice, fits, strict=True)]

    def _candidates(self, starts: FloatArray, ends: FloatArray) -> Manoeuvres:
        words = join(_ahead(starts, self.out), _ahead(ends, -self.into), self.radius, reverse=self.reverse)
        many = len(words.start)
        return with_straights(words, np.full(many, self.out), np.full(many, self.into))

    def _choose(self, moves: Manoeuvres, pairs: int) -> tuple[np.ndarray, np.ndarray]:
        """The row of each pair's choice and whether it fits; without a fit the shortest whose path is inside."""
        total = moves.total.reshape(pairs, -1)
        ranked = np.argsort(total, axis=1)
        base = np.arange(pairs) * total.shape[1]
        choice = base + ranked[:, 0]
        fits = np.zeros(pairs, dtype=bool)
        for rank in range(min(TRIES, ranked.shape[1])):
            open_pairs = np.flatnonzero(~fits & np.isfinite(total[np.arange(pairs), ranked[:, rank]]))
            if not len(open_pairs):
                break
            rows = base[open_pairs] + ranked[open_pairs, rank]
            good = self.room.fits(moves.take(rows))
            choice[open_pairs[good]] = rows[good]
            fits[open_pairs[good]] = True
        return choice, fits

    def _turn(self, move: Manoeuvres, fit: bool) -> Turn:
        stations = _stations(move)
        poses = poses_along(move, stations[None])
        missing = 0.0 if fit else max(0.01, float(self.room.missing(poses)[0]))
        length = float(move.total[0])
        straight = float(np.hypot(*(poses[0, -1, :2] - poses[0, 0, :2])))
        return Turn(_legs(move, stations, poses[0]), length, missing, tight=straight < 2 * self.radius)


def _ahead(poses: FloatArray, metres: float) -> FloatArray:
    moved = poses.copy()
    moved[:, 0] += metres * np.cos(poses[:, 2])
    moved[:, 1] += metres * np.sin(poses[:, 2])
    return moved


def _stations(move: Manoeuvres) -> FloatArray:
    """Metres from the start of at most ``POINTS`` points, every joint among them."""
    joints = np.concatenate([[0.0], np.cumsum(np.abs(move.lengths[0]))])
    even = np.linspace(0.0, joints[-1], POINTS - len(joints))
    stations = np.unique(np.concatenate([even, joints]))
    keep = np.concatenate([[True], np.diff(stations) > 1e-6])
    return stations[keep]


def _legs(move: Manoeuvres, stations: FloatArray, poses: FloatArray) -> tuple[Leg, ...]:
    """Cut where the gear changes; neighbouring legs share the point."""
    joints = np.cumsum(np.abs(move.lengths[0]))
    backward = move.lengths[0][np.minimum(np.searchsorted(joints, (stations[1:] + stations[:-1]) / 2), len(joints) - 1)]
    reverse = backward < 0
    changes = [0, *(np.flatnonzero(np.diff(reverse.astype(int))) + 1), len(reverse)]
    return tuple(
        Leg(poses[low : high + 1, :2].copy(), bool(reverse[low]))
        for low, high in zip(changes, changes[1:], strict=False)
    )
