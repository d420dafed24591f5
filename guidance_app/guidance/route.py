"""The order in which cells are worked, and at which of its four corners each is entered.

Within a cell the operation method says the order of passes; this module says which side of the cell counts as the
first, and in which direction the first pass is driven. From pass to pass the nearer end is taken, which is the
to-and-fro of every farmer wherever the field is regular.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from guidance_app.guidance.cells import Piece, Strips
from guidance_app.guidance.pattern import PassOrder
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.task import Task, pass_line
from guidance_app.model import FloatArray

__all__ = ["Cell", "Run", "Way", "route", "runs_of"]

MOST_EXACT = 5
"""Cells up to which every order is compared; with more the nearest is taken next."""


FIRSTS = 6
"""First runs from which a route is built when there are too many cells to compare all orders."""

_Place = tuple[float, float] | None


@dataclass(frozen=True, slots=True, eq=False)
class Cell:
    """Neighbouring pieces, by row, and the frame of their strips; ``numbers`` where they have them already."""

    pieces: tuple[Piece, ...]
    strips: Strips
    numbers: tuple[int, ...] | None = None


class Way(Protocol):
    """A group of passes in a driving order."""

    @property
    def start(self) -> FloatArray:
        """Where it begins, (2,): east, north."""

    @property
    def end(self) -> FloatArray:
        """Where it ends."""

    def tasks(self, done: int) -> list[Task]:
        """The passes, numbered from ``done`` + 1."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """A cell driven from one of its corners: its pieces' places in driving order, and which are driven along."""

    cell: Cell
    sequence: tuple[int, ...]
    along: tuple[bool, ...]
    from_last: bool

    @property
    def start(self) -> FloatArray:
        """Where it begins, (2,): east, north."""
        return self._end(0, start=True)

    @property
    def end(self) -> FloatArray:
        """Where it ends."""
        return self._end(-1, start=False)

    def _end(self, place: int, *, start: bool) -> FloatArray:
        end: FloatArray = self.points(place)[0 if start else -1]
        return end

    def points(self, place: int) -> FloatArray:
        """The line of one pass in driving order, (2, 2)."""
        line = pass_line(self.cell.pieces[self.sequence[place]], self.cell.strips)
        return line if self.along[place] else line[::-1]

    def tasks(self, done: int) -> list[Task]:
        """The passes, numbered from ``done`` + 1 across the cell from the side at which it is entered."""
        count = len(self.sequence)
        if self.cell.numbers is not None:
            numbers = [self.cell.numbers[place] for place in self.sequence]
        else:
            numbers = [done + (count - place if self.from_last else place + 1) for place in self.sequence]
        return [Task.along(self.points(place), number) for place, number in enumerate(numbers)]


def route(choices: Sequence[Sequence[Way]], request: PlanRequest, start: tuple[float, float] | None) -> list[Way]:
    """One way from each group, from ``start`` towards the request's exit, with little driving between."""
    if not choices:
        return []
    first = _preferred(choices, request)
    if len(choices) <= MOST_EXACT:
        return _best_of_all(choices, first, (start, request.exit))
    return _nearest_next(choices, first, (start, request.exit))


def runs_of(cell: Cell, order: PassOrder) -> list[Run]:
    """The four ways into a cell; two when all passes are driven one way or there is only one pass."""
    sides = (False, True) if len(cell.pieces) > 1 else (False,)
    return [_run(cell, order, from_last, along) for from_last in sides for along in (True, False)]


def _run(cell: Cell, order: PassOrder, from_last: bool, along: bool) -> Run:
    count = len(cell.pieces)
    sequence = tuple(count - 1 - place if from_last else place for place in order.sequence)
    ways = [along]
    for before, here in itertools.pairwise(sequence):
        ways.append(along if order.one_way else _nearer(cell.pieces[before], cell.pieces[here], ways[-1]))
    return Run(cell, sequence, tuple(ways), from_last)


def _nearer(before: Piece, here: Piece, along: bool) -> bool:
    """Whether the next piece is driven along the strips' heading, from its end nearer to where the last one ended."""
    at = before.high if along else before.low
    return abs(here.low - at) < abs(here.high - at)


def _preferred(choices: Sequence[Sequence[Way]], request: PlanRequest) -> list[tuple[int, int]]:
    """The runs with which the work may begin, as (cell, way); every one when any corner will do."""
    everything = [(cell, way) for cell, ways in enumerate(choices) for way in range(len(ways))]
    if request.start_corner == "nearest":
        return everything
    from_last = request.start_corner.startswith("last")
    along = request.start_corner.endswith("right")
    runs = [[run for run in ways if isinstance(run, Run)] for ways in choices]
    cells = [cell for cell, ways in enumerate(runs) if ways]
    if not cells:
        return everything
    edge = (max if from_last else min)(cells, key=lambda cell: runs[cell][0].cell.pieces[-1 if from_last else 0].row)
    wanted = [
        (edge, way)
        for way, run in enumerate(runs[edge])
        if (run.from_last == from_last or len(run.sequence) == 1) and run.along[0] == along
    ]
    return wanted or everything


def _best_of_all(
    choices: Sequence[Sequence[Way]], first: Sequence[tuple[int, int]], ends: tuple[_Place, _Place]
) -> list[Way]:
    """The order with the least distance between runs, over all orders (dynamic programming over sets of cells)."""
    states: dict[tuple[int, int, int], tuple[float, tuple[Way, ...]]] = {}
    for cell, way in first:
        run = choices[cell][way]
        states[1 << cell, cell, way] = (_apart(ends[0], run.start), (run,))
    for _ in range(len(choices) - 1):
        states = _extended(states, choices)
    return list(min(states.values(), key=lambda state: state[0] + _apart(ends[1], state[1][-1].end))[1])


def _extended(
    states: dict[tuple[int, int, int], tuple[float, tuple[Way, ...]]], choices: Sequence[Sequence[Way]]
) -> dict[tuple[int, int, int], tuple[float, tuple[Way, ...]]]:
    longer: dict[tuple[int, int, int], tuple[float, tuple[Way, ...]]] = {}
    for (seen, _, _), (cost, runs) in states.items():
        for cell, ways in enumerate(choices):
            if seen >> cell & 1:
                continue
            for way, run in enumerate(ways):
                key = (seen | 1 << cell, cell, way)
                total = cost + _apart(runs[-1].end, run.start)
                if key not in longer or total < longer[key][0]:
                    longer[key] = (total, (*runs, run))
    return longer


def _nearest_next(
    choices: Sequence[Sequence[Way]], first: Sequence[tuple[int, int]], ends: tuple[_Place, _Place]
) -> list[Way]:
    """Always the nearest run next, from each of the likeliest first ones; the best of these."""
    likeliest = sorted(first, key=lambda each: _apart(ends[0], choices[each[0]][each[1]].start))[:FIRSTS]
    routes = [_nearest_from(choices, cell, way) for cell, way in likeliest]
    return min(routes, key=lambda route: _empty_way(route, ends))


def _nearest_from(choices: Sequence[Sequence[Way]], cell: int, way: int) -> list[Way]:
    runs = [choices[cell][way]]
    left = set(range(len(choices))) - {cell}
    while left:
        cell, run = min(
            ((cell, run) for cell in left for run in choices[cell]),
            key=lambda each: _apart(runs[-1].end, each[1].start),
        )
        runs.append(run)
        left.remove(cell)
    return runs


def _empty_way(runs: Sequence[Way], ends: tuple[_Place, _Place]) -> float:
    between = sum(_apart(before.end, after.start) for before, after in itertools.pairwise(runs))
    return _apart(ends[0], runs[0].start) + between + _apart(ends[1], runs[-1].end)


def _apart(one: FloatArray | tuple[float, float] | None, other: FloatArray) -> float:
    return 0.0 if one is None else math.hypot(one[0] - other[0], one[1] - other[1])
