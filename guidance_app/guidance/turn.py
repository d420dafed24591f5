"""A turn as it is drawn: its legs, each in one gear, with points close enough on its arcs."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from guidance_app.guidance.manoeuvres import Manoeuvres, poses_along
from guidance_app.model import FloatArray

__all__ = ["Leg", "Turn", "leg_of", "turns_along"]

POINTS = 60
"""A leg never has more points."""

ARC_STEP = 0.1
"""Radians between the points of an arc, where there are points enough."""

SHORTEST = 1e-6
"""Metres; a shorter piece is left out."""


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """A stretch of a turn in one gear, shape (N, 2)."""

    points: FloatArray
    reverse: bool
    length: float


@dataclass(frozen=True, slots=True, eq=False)
class Turn:
    """A way from pose to pose. ``missing`` is 0 when it fits; ``transfer`` if it follows something on its way."""

    legs: tuple[Leg, ...]
    length: float
    missing: float = 0.0
    transfer: bool = False

    @property
    def fits(self) -> bool:
        """Whether the machine stays inside."""
        return self.missing == 0


def leg_of(points: FloatArray, *, reverse: bool) -> Leg:
    """A leg along these points."""
    return Leg(points.copy(), reverse, float(shapely.length(shapely.linestrings(points))))


def turns_along(moves: Manoeuvres) -> list[Turn]:
    """The turns of some candidates, cut where the gear changes; their points come from one computation."""
    pieces = zip(moves.lengths.tolist(), moves.turns.tolist(), strict=True)
    legs = [list(_legs(lengths, turns, moves.radius)) for lengths, turns in pieces]
    most = max((sum(len(stations) for stations, _, _ in some) for some in legs), default=0)
    padded = np.zeros((len(legs), most))
    for row, some in enumerate(legs):
        together = list(itertools.chain.from_iterable(stations for stations, _, _ in some))
        padded[row, : len(together)] = together
    points = poses_along(moves, padded)[..., :2]
    return [_turn(points[row], some) for row, some in enumerate(legs)]


_Stations = tuple[list[float], bool, float]


def _turn(points: FloatArray, legs: Sequence[_Stations]) -> Turn:
    begins = [0, *itertools.accumulate(len(stations) for stations, _, _ in legs)]
    drawn = tuple(
        Leg(points[begin : begin + len(stations)].copy(), reverse, length)
        for begin, (stations, reverse, length) in zip(begins, legs, strict=False)
    )
    return Turn(drawn, sum(leg.length for leg in drawn))


def _legs(lengths: Sequence[float], turns: Sequence[float], radius: float) -> Iterator[_Stations]:
    """For each leg how far along the turn its points lie, whether it is backward, and its length."""
    ends = list(itertools.accumulate(abs(length) for length in lengths))
    pieces = [place for place, length in enumerate(lengths) if abs(length) > SHORTEST]
    for reverse, run in itertools.groupby(pieces, key=lambda place: lengths[place] < 0):
        leg = list(run)
        begin = ends[leg[0]] - abs(lengths[leg[0]])
        bent = sum(abs(lengths[place]) for place in leg if turns[place])
        step = max(ARC_STEP * radius, bent / (POINTS - 1 - 2 * len(leg)))
        stations = [begin]
        for place in leg:
            size = abs(lengths[place])
            count = math.ceil(size / step) if turns[place] else 1
            stations.extend(ends[place] - size * (count - number) / count for number in range(1, count + 1))
        yield stations, reverse, stations[-1] - begin
