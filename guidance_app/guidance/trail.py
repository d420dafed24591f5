"""What grows on the screen, in bounded pieces: the driven track, and the worked ground as strips.

A row is kept when it lies 0.3 m or 2 degrees from the one kept before; until then the last row follows the tractor.
A full piece is thinned (Douglas and Peucker, 1973, to 3 cm), sealed, and never changes again.
"""

import copy
import math

import numpy as np
import shapely

from guidance_app.guidance.continuity import Continuity, is_place
from guidance_app.model import FloatArray, Strip, Trail

__all__ = ["MOST_ROWS", "StripTrail", "TrackTrail"]

MOST_ROWS = 256
"""Rows of a piece, at most."""

STEP = 0.3
"""Metres between rows."""

TURNED = math.radians(2.0)
"""Heading between rows that makes one sooner."""

ROWS_BESIDE = 8
"""Rows of a piece that is not the open one."""

THINNED = 0.03
"""How far a sealed piece may stay from what was driven."""


Place = tuple[float, float, float]
"""East, north and heading, by which rows are spaced."""

Run = tuple[float, float, float, float]
"""A working part of the implement: east and north of its left end, then of its right."""


class _Rows:
    """A growing piece: rows of numbers, of which the last follows the tractor until it is far enough.

    The others lie in a table and never change.
    """

    def __init__(self, columns: int) -> None:
        self._table = np.empty((MOST_ROWS, columns))
        self._row: tuple[float, ...] = ()
        self._before: Place = (0.0, 0.0, 0.0)
        self._last: Place = (0.0, 0.0, 0.0)
        self.count = 0

    def fork(self) -> "_Rows":
        other = copy.copy(self)
        other._table = self._table.copy()  # noqa: SLF001 - its own class
        return other

    def add(self, row: tuple[float, ...], place: Place) -> None:
        """Only while not ``full``."""
        if self.count == 0:
            self._before = place
            self.count = 1
        elif self.count == 1 or _apart(self._before, self._last):
            self._table[self.count - 1] = self._row
            self._before = self._before if self.count == 1 else self._last
            self.count += 1
        self._row, self._last = row, place

    def full(self, rows: int = MOST_ROWS) -> bool:
        """Whether so many rows stand fast."""
        return self.count >= rows and _apart(self._before, self._last)

    def follower(self) -> "_Rows":
        """A new piece that begins where this one ends."""
        other = _Rows(self._table.shape[1])
        other.add(self._row, self._last)
        return other

    def now(self, strip: tuple[int, int | None] | None = None) -> "_Now":
        """As it is now: of the track, or of the ``strip`` with this index and pass."""
        return _Now(self._table, self._row, self.count, strip)

    def thinned(self) -> FloatArray:
        """The same without the rows that lie within 3 cm of the line through the others, in every pair of columns."""
        table = _whole(self._table, self._row, self.count)
        kept = np.zeros(self.count, dtype=bool)
        numbers = np.arange(self.count, dtype=float)
        for column in range(0, table.shape[1], 2):
            line = shapely.linestrings(np.column_stack([table[:, column : column + 2], numbers]))
            simple = shapely.simplify(line, THINNED, preserve_topology=False)
            kept[shapely.get_coordinates(simple, include_z=True)[:, 2].astype(int)] = True
        return _frozen(table[kept])


class _Now:
    """A growing piece at one instant, whatever happens to it later. Its arrays are made at the first look."""

    __slots__ = ("_count", "_made", "_row", "_strip", "_table")

    def __init__(
        self, table: FloatArray, row: tuple[float, ...], count: int, strip: tuple[int, int | None] | None
    ) -> None:
        self._table = table
        self._row = row
        self._count = count
        self._strip = strip
        self._made: FloatArray | Strip | None = None

    def __call__(self) -> FloatArray | Strip:
        if self._made is None:
            table = _frozen(_whole(self._table, self._row, self._count))
            self._made = table if self._strip is None else _strip(self._strip, table, sealed=False)
        return self._made


def _whole(table: FloatArray, row: tuple[float, ...], count: int) -> FloatArray:
    """The rows of a piece, the last one too."""
    rows = table[:count].copy()
    rows[-1] = row
    return rows


def _apart(before: Place, after: Place) -> bool:
    turned = abs((after[2] - before[2] + math.pi) % math.tau - math.pi)
    return turned >= TURNED or math.hypot(after[0] - before[0], after[1] - before[1]) >= STEP


def _frozen(array: FloatArray) -> FloatArray:
    array.setflags(write=False)
    return array


class TrackTrail:
    """The driven track: pieces of shape (N, 2), each beginning where the last ended unless the position jumped."""

    def __init__(self) -> None:
        self._pieces: list[FloatArray] = []
        self._rows = _Rows(2)
        self._continuity = Continuity()

    def fork(self) -> "TrackTrail":
        """An independent copy; sealed pieces are shared."""
        other = copy.copy(self)
        other._pieces = list(self._pieces)  # noqa: SLF001 - its own class, as in the lines below
        other._rows = self._rows.fork()  # noqa: SLF001
        other._continuity = copy.copy(self._continuity)  # noqa: SLF001
        return other

    def step(self, t: float, east: float, north: float, heading: float) -> None:
        """One position of the track; what is no place is left out."""
        if not is_place(east, north, t, heading):
            return
        if not self._continuity.step(t, east, north):
            self._seal(_Rows(2))
        elif self._rows.full():
            self._seal(self._rows.follower())
        self._rows.add((east, north), (east, north, heading))

    def _seal(self, following: _Rows) -> None:
        if self._rows.count >= 2:
            self._pieces.append(self._rows.thinned())
        self._rows = following

    @property
    def trail(self) -> Trail:
        """As it is now."""
        return Trail(self._pieces, len(self._pieces), self._rows.now() if self._rows.count else None)


class StripTrail:
    """Worked ground as strips, for drawing.

    A ``Trail`` has one open piece: that of the widest run. Where sections are off in the middle of an implement, the
    other runs are sealed every few rows and so appear a few metres behind it.
    """

    def __init__(self) -> None:
        self._pieces: list[Strip] = []
        self._lanes: list[_Rows] = []
        self._widest = 0
        self._index = 0
        self._used = 0
        self._pass_number: int | None = None

    def fork(self) -> "StripTrail":
        """An independent copy; sealed strips are shared."""
        other = copy.copy(self)
        other._pieces = list(self._pieces)  # noqa: SLF001 - its own class, as in the line below
        other._lanes = [lane.fork() for lane in self._lanes]  # noqa: SLF001
        return other

    def begin(self, runs: tuple[Run, ...], place: Place, pass_number: int | None) -> None:
        """A new strip starts, a lane for every run of working sections."""
        self.close()
        self._pass_number = pass_number
        self._lanes = [_Rows(4) for _ in runs]
        widths = [math.hypot(run[2] - run[0], run[3] - run[1]) for run in runs]
        self._widest = widths.index(max(widths)) if widths else 0
        self._index = self._new_index()
        self.add(runs, place)

    def add(self, runs: tuple[Run, ...], place: Place) -> None:
        """The strip goes on; as many runs as it began with."""
        for i, run in enumerate(runs):
            lane = self._lanes[i]
            if lane.full(MOST_ROWS if i == self._widest else ROWS_BESIDE):
                self._lanes[i] = lane.follower()
                self._seal(lane, i)
            self._lanes[i].add(run, place)

    def close(self) -> None:
        """The strip ends."""
        for i, lane in enumerate(self._lanes):
            self._seal(lane, i)
        self._lanes = []

    def _new_index(self) -> int:
        self._used += 1
        return self._used - 1

    def _seal(self, lane: _Rows, i: int) -> None:
        index = self._index if i == self._widest else self._new_index()
        if lane.count >= 2:
            self._pieces.append(_strip((index, self._pass_number), lane.thinned(), sealed=True))
        if i == self._widest:
            self._index = self._new_index()

    @property
    def trail(self) -> Trail:
        """As it is now."""
        widest = self._lanes[self._widest] if self._lanes else None
        grows = widest is not None and widest.count >= 2
        growing = widest.now((self._index, self._pass_number)) if widest is not None and grows else None
        return Trail(self._pieces, len(self._pieces), growing)


def _strip(which: tuple[int, int | None], table: FloatArray, *, sealed: bool) -> Strip:
    index, pass_number = which
    return Strip(index, table[:, :2], table[:, 2:], pass_number, sealed=sealed)
