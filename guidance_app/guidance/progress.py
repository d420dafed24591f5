"""How much of each pass has been worked: stretches of along-track, merged as they grow.

Work on the prolongation of a pass counts too, because the implement hangs behind the guided point: it begins and ends
its work when that point is already some metres further.
"""

import bisect
import itertools
import math

__all__ = ["SHORTEST", "Progress", "driven_stretches", "enough"]

DONE_FRACTION = 0.9
"""A pass counts as done when this much of its length has been worked."""

SHORT_REST = 3.0
"""On a short pass so many metres may be missing: two fixes at its entry are more than a tenth of it."""

JOINED = 0.5
"""Stretches with less than this between them are one."""

MOST_STRETCHES = 64
"""More stretches of one pass than this are joined across their smallest gap: bounded memory."""

SHORTEST = 3.0
"""Metres; a stretch that is shorter counts as done when it is driven along, for nobody can lower an implement on it."""


def enough(length: float) -> float:
    """Metres that have to be worked of a pass of this length; at least half of it."""
    return min(DONE_FRACTION * length, max(length - SHORT_REST, 0.5 * length))


def driven_stretches(start: float, end: float, length: float, *, closed: bool) -> tuple[tuple[float, float], ...]:
    """What lies between two along-track distances, in two where the end of a lap of this length was crossed."""
    if not closed or abs(end - start) <= 0.5 * length:
        return ((start, end),)
    return (0.0, min(start, end)), (max(start, end), length)


Stretches = tuple[tuple[float, float], ...]


class Progress:
    """Worked stretches by pass; ``fork`` costs one copy of a dictionary, the stretches themselves are values."""

    def __init__(self, done: frozenset[int] = frozenset()) -> None:
        self.done = done
        self._stretches: dict[int, Stretches] = {}

    def fork(self) -> "Progress":
        """An independent copy."""
        copy = Progress(self.done)
        copy._stretches = dict(self._stretches)
        return copy

    def add(self, key: int, start: float, end: float) -> None:
        """Counts the stretch between two along-track distances, in either order."""
        low, high = min(start, end), max(start, end)
        known = self._stretches.get(key, ())
        if len(known) == 1 and known[0][0] <= high + JOINED and low - JOINED <= known[0][1]:
            self._stretches[key] = ((min(low, known[0][0]), max(high, known[0][1])),)  # as nearly every time
            return
        first = bisect.bisect_left(known, low - JOINED, key=lambda stretch: stretch[1])
        last = bisect.bisect_right(known, high + JOINED, key=lambda stretch: stretch[0])
        if first < last:
            low, high = min(low, known[first][0]), max(high, known[last - 1][1])
        stretches = (*known[:first], (low, high), *known[last:])
        self._stretches[key] = stretches if len(stretches) <= MOST_STRETCHES else _joined(stretches)

    def worked(self, key: int) -> float:
        """Metres of the pass worked so far."""
        return math.fsum([high - low for low, high in self._stretches.get(key, ())])

    def spans(self, key: int) -> Stretches:
        """The stretches worked so far, each from and to so many metres along the pass."""
        return self._stretches.get(key, ())

    def stretches(self, key: int) -> int:
        """In how many stretches that is remembered."""
        return len(self._stretches.get(key, ()))

    def open_keys(self) -> tuple[int, ...]:
        """The passes that are begun and not done."""
        return tuple(key for key in self._stretches if key not in self.done)

    @property
    def begun(self) -> bool:
        """Whether any pass has been worked on."""
        return bool(self._stretches or self.done)

    def finish(self, key: int) -> None:
        """Counts a pass as done."""
        if key not in self.done:
            self.done |= {key}


def _joined(stretches: Stretches) -> Stretches:
    gaps = [after[0] - before[1] for before, after in itertools.pairwise(stretches)]
    i = gaps.index(min(gaps))
    return (*stretches[:i], (stretches[i][0], stretches[i + 1][1]), *stretches[i + 2 :])
