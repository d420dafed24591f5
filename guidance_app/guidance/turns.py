"""Turns between two poses: the shortest drivable manoeuvre that stays inside with the whole machine.

Each begins by running straight on until the implement has worked the pass's end, and ends where the next pass begins.
Where no manoeuvre from there fits, the tractor may first back up along the pass it has worked, or overrun the start of
the next and back up to it, or drive backward all the way. What fits is compared by length; what does not fit is given
with the metres that are missing, on a path that itself stays inside.
"""

import copy
import itertools
from collections.abc import Sequence

import numpy as np

from guidance_app.guidance.manoeuvres import WORDS, Manoeuvres, backed, join, stacked, with_straights
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.room import Room
from guidance_app.guidance.turn import Turn, turns_along
from guidance_app.model import FloatArray

__all__ = ["Turner", "ahead"]

RADIUS_MARGIN = 1.0055
"""Turns are laid on a circle wider by this: then even their longest chords bend no more than the turning radius."""

TRIES = 8
"""Candidates of which the missing metres are measured where none fits, shortest first."""

AT_ONCE, MOST_TRIED = 160, 480
"""Candidates checked at a time, and in all, when any of many ends will do."""

MOST_AT_ONCE = 64
"""Candidates of one pair that are checked at a time at most."""

BACKING = (0.5, 1.0, 1.75, 3.0)
"""Turning radii by which a tractor backs up along a pass when nothing shorter fits."""

FARTHEST_BACK = 4.0
"""Turning radii that a driver backs up in the middle of a turn."""

MOST_BENT_BACK = 1.6
"""Radians that a driver steers through when he backs all the way."""

SMALLEST_MISSING = 0.01
"""Metres; a turn that does not fit misses at least this."""


class Turner:
    """Finds turns in one field for one machine."""

    def __init__(self, room: Room, request: PlanRequest) -> None:
        self.room = room
        self.radius = request.path_radius * RADIUS_MARGIN
        self.reverse = request.reverse_allowed
        self.out = max(request.offset_back, 0.0)
        self.into = max(-request.offset_back, 0.0)

    def turns(self, starts: FloatArray, ends: FloatArray) -> list[Turn | None]:
        """The shortest turn that fits for each pair of poses (M, 3); None where nothing fits."""
        found: list[Turn | None] = [None] * len(starts)
        left = np.arange(len(starts))
        for kind in (self.plain, self.awkward):
            if len(left):
                turns = kind(starts[left], ends[left])
                for place, turn in zip(left, turns, strict=True):
                    found[place] = turn
                left = np.array([place for place in left if found[place] is None], dtype=int)
        return found

    def plain(self, starts: FloatArray, ends: FloatArray) -> list[Turn | None]:
        """The same, of the manoeuvres that begin and end forward."""
        return self._shortest(self._plain(starts, ends), len(starts))

    def awkward(self, starts: FloatArray, ends: FloatArray) -> list[Turn | None]:
        """The same, of those that back up before, after or all the way; nothing where that is not allowed."""
        if not self.reverse:
            return [None] * len(starts)
        kinds = [self._backing(starts, ends), self._backward(starts, ends)]
        return self._shortest(stacked(kinds, len(starts)), len(starts))

    def onto(self, start: FloatArray, ends: FloatArray, back: float = 0.0) -> Manoeuvres:
        """Candidates from a worked pass's end, or from ``back`` metres before it, to each of many poses (M, 3)."""
        many = np.tile(start, (len(ends), 1))
        words = self._join(ahead(many, self.out - back), ends)
        rows = len(words.start)
        return with_straights(words, np.tile([self.out, -back], (rows, 1)), np.zeros((rows, 2)))

    def off(self, starts: FloatArray, end: FloatArray, over: float = 0.0) -> Manoeuvres:
        """Candidates from each of many poses (M, 3) to the start of a pass, or ``over`` metres on and back to it."""
        many = np.tile(end, (len(starts), 1))
        words = self._join(starts, ahead(many, over or -self.into))
        rows = len(words.start)
        after = [0.0, -over] if over else [self.into, 0.0]
        return with_straights(words, np.zeros((rows, 1)), np.tile(after, (rows, 1)))

    def straight(self, pose: FloatArray, metres: Sequence[float]) -> int:
        """How many of these ways straight on, or back where negative, fit; from the first to one that does not."""
        rows = len(metres)
        moves = Manoeuvres(
            np.tile(pose, (rows, 1)), np.zeros((rows, 1)), np.array(metres, dtype=float)[:, None], self.radius
        )
        return int(np.argmin(np.append(self.room.fits(moves), False)))

    def within(self, room: Room) -> "Turner":
        """The same machine in another room."""
        other = copy.copy(self)
        other.room = room
        return other

    def nearest(self, start: FloatArray, ends: FloatArray) -> tuple[int, Turn] | None:
        """Of many end poses (M, 3) the one with the shortest turn."""
        moves = self._plain(np.tile(start, (len(ends), 1)), ends)
        words = len(moves.start) // len(ends)
        total = moves.total
        order = np.argsort(total)
        order = order[np.isfinite(total[order])][:MOST_TRIED]
        for low in range(0, len(order), AT_ONCE):
            rows = order[low : low + AT_ONCE]
            fits = self.room.fits(moves.take(rows))
            if fits.any():
                row = int(rows[np.argmax(fits)])
                return row // words, turns_along(moves.take(np.array([row])))[0]
        return None

    def missing(self, start: FloatArray, end: FloatArray) -> float:
        """Metres by which the machine sticks out at least, on the best of all manoeuvres from pose to pose."""
        moves = self._plain(start[None], end[None])
        moves = moves.take(np.argsort(moves.total)[:TRIES])
        moves = moves.take(np.flatnonzero(np.isfinite(moves.total)))
        worst = self.room.missing(self.room.poses(moves)) if len(moves.start) else np.zeros(0)
        return max(SMALLEST_MISSING, float(worst.min(initial=self.radius)))

    def _plain(self, starts: FloatArray, ends: FloatArray) -> Manoeuvres:
        words = self._join(ahead(starts, self.out), ahead(ends, -self.into))
        return self._framed(words, self.into)

    def _join(self, starts: FloatArray, ends: FloatArray) -> Manoeuvres:
        """Words without those that back up farther than a driver would."""
        words = join(starts, ends, self.radius, reverse=self.reverse)
        words.lengths[(words.lengths < -FARTHEST_BACK * self.radius).any(axis=1)] = np.nan
        return words

    def _backing(self, starts: FloatArray, ends: FloatArray) -> Manoeuvres:
        """Backing up before the manoeuvre, or to the next pass's start after it, or both."""
        metres = [0.0, *(part * self.radius for part in BACKING)]
        both = np.array([(first, last) for first, last in itertools.product(metres, metres) if first or last])
        first, last = np.tile(both, (len(starts), 1)).T
        begin = ahead(np.repeat(starts, len(both), axis=0), self.out - first)
        end = ahead(np.repeat(ends, len(both), axis=0), np.where(last > 0, last, -self.into))
        words = self._join(begin, end)
        first, last = np.repeat(first, WORDS), np.repeat(last, WORDS)
        before = np.column_stack([np.full(len(first), self.out), -first])
        after = np.column_stack([np.where(last > 0, 0.0, self.into), -last])
        return with_straights(words, before, after)

    def _backward(self, starts: FloatArray, ends: FloatArray) -> Manoeuvres:
        words = backed(ahead(starts, self.out), ends, self.radius)
        bent = np.abs(words.lengths * words.turns).sum(axis=1)
        words.lengths[bent > MOST_BENT_BACK * self.radius] = np.nan
        return self._framed(words, 0.0)

    def _framed(self, words: Manoeuvres, into: float) -> Manoeuvres:
        rows = len(words.start)
        return with_straights(words, np.tile([self.out, 0.0], (rows, 1)), np.tile([into, 0.0], (rows, 1)))

    def _shortest(self, moves: Manoeuvres, pairs: int) -> list[Turn | None]:
        """Each pair's shortest candidate that fits; ever more candidates are checked at a time."""
        total = moves.total.reshape(pairs, -1)
        ranked = np.argsort(total, axis=1)
        found: list[Turn | None] = [None] * pairs
        left = np.arange(pairs)
        low, many = 0, 1
        while len(left) and low < total.shape[1]:
            tried = ranked[left, low : low + many]
            rows = left[:, None] * total.shape[1] + tried
            fits = np.isfinite(total[left[:, None], tried])
            fits[fits] = self.room.fits(moves.take(rows[fits]))
            good = fits.any(axis=1)
            if good.any():
                chosen = moves.take(rows[good, fits[good].argmax(axis=1)])
                for place, turn in zip(left[good], turns_along(chosen), strict=True):
                    found[place] = turn
                left = left[~good]
            low, many = low + many, min(2 * many, MOST_AT_ONCE)
        return found


def ahead(poses: FloatArray, metres: float | FloatArray) -> FloatArray:
    """Poses (M, 3) so many metres ahead: the same for all, or (M,)."""
    moved = poses.copy()
    moved[:, 0] += metres * np.cos(poses[:, 2])
    moved[:, 1] += metres * np.sin(poses[:, 2])
    return moved
