"""Bundles of passes side by side, and the ways to drive one.

Within a bundle the operation method says the order of passes; what is open is which side counts as the first, and in
which direction the first pass is driven. From pass to pass the nearer end is taken, which is the to-and-fro of every
farmer wherever the field is regular.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from guidance_app.guidance.pattern import PassOrder
from guidance_app.guidance.task import Task
from guidance_app.model import FloatArray

__all__ = ["Bundle", "Run", "runs_in_sequence", "runs_of"]

BothWays = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class Bundle:
    """Passes from one side to the other; each as the line (2, 2) worked along the bundle's heading, and against it.

    ``rows`` are the first and the last strip of the mainland, None beside it. ``numbers`` are the passes' numbers where
    they have them already. Those of a ``spare`` bundle may be left out of a plan.
    """

    lines: tuple[BothWays, ...]
    rows: tuple[int, int] | None = None
    numbers: tuple[int, ...] | None = None
    spare: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """A bundle in a driving order: lines (2, 2) in driving direction, and each one's place from the first side.

    ``empty`` is the distance, as the crow flies, from each pass's end to the next one's start.
    """

    bundle: Bundle
    lines: tuple[FloatArray, ...]
    places: tuple[int, ...]
    from_last: bool
    along: bool
    empty: float

    @property
    def start(self) -> FloatArray:
        """Where it begins, (2,): east, north."""
        first: FloatArray = self.lines[0][0]
        return first

    @property
    def end(self) -> FloatArray:
        """Where it ends."""
        last: FloatArray = self.lines[-1][1]
        return last

    def tasks(self, done: int) -> list[Task]:
        """The passes, numbered from ``done`` + 1 across the bundle from the side at which it is entered."""
        spare = self.bundle.spare
        numbered = zip(self.lines, self._numbers(done), strict=True)
        return [Task.along(line, number, spare=spare) for line, number in numbered]

    def _numbers(self, done: int) -> list[int]:
        known = self.bundle.numbers
        if known is None:
            return [done + place + 1 for place in self.places]
        return [known[len(known) - 1 - place if self.from_last else place] for place in self.places]


def runs_of(bundle: Bundle, order: PassOrder) -> list[Run]:
    """The four ways to drive a bundle in the method's order; two where it has only one pass."""
    sides = (False, True) if len(bundle.lines) > 1 else (False,)
    ways = itertools.product(sides, (True, False))
    places = _places(bundle)
    return [_run(bundle, places, order, from_last=from_last, along=along) for from_last, along in ways]


def runs_in_sequence(bundle: Bundle, sequence: Sequence[int], *, one_way: bool) -> Iterator[Run]:
    """The two ways to drive a bundle in just this order."""
    places, order = _places(bundle), PassOrder(tuple(sequence), one_way)
    for along in (True, False):
        yield _run(bundle, places, order, from_last=False, along=along)


_Line = tuple[tuple[float, float], tuple[float, float]]


def _places(bundle: Bundle) -> list[tuple[_Line, _Line]]:
    """Both lines of each pass as plain numbers: measuring between them is then ten times as fast."""
    plain: list[tuple[_Line, _Line]] = np.array(bundle.lines).tolist()
    return plain


def _run(
    bundle: Bundle, places: Sequence[tuple[_Line, _Line]], order: PassOrder, *, from_last: bool, along: bool
) -> Run:
    strips, plain = (bundle.lines[::-1], places[::-1]) if from_last else (bundle.lines, places)
    sequence, way = order.sequence, 0 if along else 1
    lines = [strips[sequence[0]][way]]
    end = plain[sequence[0]][way][1]
    empty = 0.0
    for place in sequence[1:]:
        there, back = plain[place]
        apart = math.dist(there[0], end), math.dist(back[0], end)
        chosen = way if order.one_way or apart[0] == apart[1] else int(apart[1] < apart[0])
        lines.append(strips[place][chosen])
        end = plain[place][chosen][1]
        empty += apart[chosen]
    return Run(bundle, tuple(lines), sequence, from_last, along, empty)
