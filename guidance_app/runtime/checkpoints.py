"""Engines as they stood at instants of a replay, to jump to; and where each pass began.

Some are kept while a recording is played; others come from an index that is made of the whole of it beside (see
``indexing``). Both are only good where the same commands were given.
"""

import bisect
import threading
from collections.abc import Iterable
from dataclasses import dataclass

from guidance_app.model import Snapshot
from guidance_app.runtime.engines import Engines

__all__ = ["Checkpoint", "Checkpoints", "PassStart", "PassStarts"]


@dataclass(frozen=True, slots=True, eq=False)
class Checkpoint:
    """The engines after the first ``index`` events and the first ``given`` commands beside, at ``arrival``."""

    arrival: float
    index: int
    given: int
    engines: Engines


class Checkpoints:
    """Sorted by their index; the first one stands at the beginning. Any thread may add."""

    def __init__(self, first: Engines) -> None:
        self._sorted = [Checkpoint(0.0, 0, 0, first)]
        self._changed_at: float | None = None
        self._lock = threading.Lock()

    def add(self, checkpoint: Checkpoint) -> None:
        """Keeps one that was made here."""
        with self._lock:
            self._insert(checkpoint)

    def add_found(self, checkpoint: Checkpoint) -> None:
        """Keeps one that was made elsewhere without commands, unless one was given here before its place."""
        with self._lock:
            if self._changed_at is None or checkpoint.arrival < self._changed_at:
                self._insert(checkpoint)

    def forget_after(self, index: int, arrival: float) -> None:
        """A command was given here: what lies farther on does not know it."""
        with self._lock:
            self._sorted = [one for one in self._sorted if one.index <= index]
            self._changed_at = arrival if self._changed_at is None else min(self._changed_at, arrival)

    def before(self, index: int) -> Checkpoint:
        """The last one at or before so many events."""
        with self._lock:
            return self._sorted[bisect.bisect_right(self._sorted, index, key=_index) - 1]

    def _insert(self, checkpoint: Checkpoint) -> None:
        place = bisect.bisect_left(self._sorted, checkpoint.index, key=_index)
        if place == len(self._sorted) or self._sorted[place].index != checkpoint.index:
            self._sorted.insert(place, checkpoint)


def _index(checkpoint: Checkpoint) -> int:
    return checkpoint.index


@dataclass(frozen=True, slots=True, order=True)
class PassStart:
    """When (seconds of the recording) the tractor came onto a pass."""

    position: float
    number: int


class PassStarts:
    """Where passes began, as far as it is known. Any thread may read ``found``."""

    def __init__(self) -> None:
        self._found: tuple[PassStart, ...] = ()
        self._on: int | None = None

    @property
    def found(self) -> tuple[PassStart, ...]:
        """In the order of their times."""
        return self._found

    def look(self, snapshot: Snapshot) -> PassStart | None:
        """The start of a pass, when the tractor has just come onto it."""
        guidance = snapshot.guidance
        if guidance is None or not guidance.on_pass:
            return None
        number = guidance.target.number
        if number == self._on:
            return None
        self._on = number
        return PassStart(snapshot.arrival, number)

    def take(self, starts: Iterable[PassStart]) -> None:
        """Adds what an index has found."""
        self._found = tuple(sorted({*self._found, *starts}))
