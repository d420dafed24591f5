"""Compiled bookkeeping of worked ground: bits of a tile, set and counted row by row. ``coverage.py`` is the only user.

A tile is 256 x 256 cells, four words of 64 bits a row. A cell belongs to a quadrilateral when its centre does, edges
on one side only: quadrilaterals that share an edge share no cell and leave none out.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from guidance_app.model import FloatArray

__all__ = [
    "FIELD",
    "GROUND_PLANES",
    "MAINLAND",
    "TILE",
    "WORDS",
    "WORK_PLANES",
    "Bits",
    "inside_of",
    "paint",
    "settle",
]

Bits = NDArray[np.uint64]

TILE = 256
"""Cells along a tile's side."""

WORDS = TILE // 64
"""Words in a row of a tile."""

WORKED, SETTLED, TWICE = 0, 1, 2
WORK_PLANES = 3
"""Planes of a tile's work: ground worked at all, worked by an earlier crossing, worked twice."""

FIELD, MAINLAND = 0, 1
GROUND_PLANES = 2
"""Planes of what lies where."""

ALL = np.uint64(0xFFFFFFFFFFFFFFFF)
NONE = np.uint64(0)


@numba.njit(cache=True)
def _count(word: np.uint64) -> int:
    """Number of set bits, by halves (Warren, Hacker's Delight, 2nd edition, section 5-1)."""
    word = word - ((word >> np.uint64(1)) & np.uint64(0x5555555555555555))
    word = (word & np.uint64(0x3333333333333333)) + ((word >> np.uint64(2)) & np.uint64(0x3333333333333333))
    word = (word + (word >> np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
    return int((word * np.uint64(0x0101010101010101)) >> np.uint64(56))


@numba.njit(cache=True)
def _bits(word: int, low: int, high: int) -> np.uint64:
    """The bits of columns ``low`` up to but not with ``high`` that fall into this word."""
    first = max(low - 64 * word, 0)
    behind = min(high - 64 * word, 64)
    if first >= behind:
        return NONE
    upper = ALL if behind == 64 else (np.uint64(1) << np.uint64(behind)) - np.uint64(1)
    return upper & ~((np.uint64(1) << np.uint64(first)) - np.uint64(1))


@numba.njit(cache=True)
def _crossings(corners: FloatArray, y: float, found: FloatArray) -> int:
    """Where the outline crosses a row's centre line, ascending, into ``found``; how many."""
    count = 0
    for i in range(4):
        xa, ya = corners[i, 0], corners[i, 1]
        xb, yb = corners[(i + 1) % 4, 0], corners[(i + 1) % 4, 1]
        if (ya <= y) != (yb <= y):
            x = xa + (y - ya) * (xb - xa) / (yb - ya)
            place = count
            while place > 0 and found[place - 1] > x:
                found[place] = found[place - 1]
                place -= 1
            found[place] = x
            count += 1
    return count


@numba.njit(cache=True)
def _rows(corners: FloatArray, tile_y: int) -> tuple[int, int]:
    """First row and row behind the last whose centre lines can cross the outline."""
    low = math.ceil(corners[:, 1].min() - 0.5) - tile_y
    high = math.floor(corners[:, 1].max() - 0.5) - tile_y + 1
    return max(low, 0), min(high, TILE)


@numba.njit(cache=True)
def _columns(start: float, end: float, tile_x: int) -> tuple[int, int]:
    """First column and column behind the last whose centres lie between two crossings."""
    low = math.ceil(start - 0.5) - tile_x
    high = math.ceil(end - 0.5) - tile_x
    return max(low, 0), min(high, TILE)


@numba.njit(cache=True)
def paint(work: Bits, ground: Bits, tile_x: int, tile_y: int, corners: FloatArray) -> tuple[int, int, int, int]:
    """Marks a quadrilateral as worked; counts cells new, newly twice, new in the field, new outside the mainland.

    ``corners`` has shape (4, 2) in cells; where its outline crosses itself both triangles count. A cell is worked
    twice when an earlier crossing, settled by now, has worked it.
    """
    fresh_cells = twice_cells = field_cells = headland_cells = 0
    found = np.empty(4)
    first, behind = _rows(corners, tile_y)
    for row in range(first, behind):
        count = _crossings(corners, tile_y + row + 0.5, found)
        for pair in range(0, count - 1, 2):
            low, high = _columns(found[pair], found[pair + 1], tile_x)
            if low >= high:
                continue
            for word in range(low >> 6, ((high - 1) >> 6) + 1):
                bits = _bits(word, low, high)
                fresh = bits & ~work[WORKED, row, word]
                again = bits & work[SETTLED, row, word] & ~work[TWICE, row, word]
                work[WORKED, row, word] |= fresh
                work[TWICE, row, word] |= again
                if fresh:
                    fresh_cells += _count(fresh)
                    field_cells += _count(fresh & ground[FIELD, row, word])
                    headland_cells += _count(fresh & ~ground[MAINLAND, row, word])
                if again:
                    twice_cells += _count(again)
    return fresh_cells, twice_cells, field_cells, headland_cells


@numba.njit(cache=True)
def settle(work: Bits, tile_x: int, tile_y: int, corners: FloatArray) -> None:
    """From now on, work on this quadrilateral is a second time."""
    found = np.empty(4)
    first, behind = _rows(corners, tile_y)
    for row in range(first, behind):
        count = _crossings(corners, tile_y + row + 0.5, found)
        for pair in range(0, count - 1, 2):
            low, high = _columns(found[pair], found[pair + 1], tile_x)
            if low < high:
                for word in range(low >> 6, ((high - 1) >> 6) + 1):
                    work[SETTLED, row, word] |= _bits(word, low, high)


@numba.njit(cache=True)
def inside_of(edges: FloatArray, tile_x: int, tile_y: int, plane: Bits) -> None:
    """Sets the cells of ``plane`` (256 rows) whose centres lie inside rings of any number, holes and parts alike.

    ``edges`` has shape (N, 4): x, y of one end and x, y of the other, in cells. Each edge turns over what lies right
    of it; what is turned over an odd number of times is inside.
    """
    for edge in range(edges.shape[0]):
        xa, ya, xb, yb = edges[edge, 0], edges[edge, 1], edges[edge, 2], edges[edge, 3]
        low, high = min(ya, yb), max(ya, yb)
        first = max(math.ceil(low - 0.5) - tile_y, 0)
        behind = min(math.floor(high - 0.5) - tile_y + 1, TILE)
        for row in range(first, behind):
            y = tile_y + row + 0.5
            if (ya <= y) == (yb <= y):
                continue
            x = xa + (y - ya) * (xb - xa) / (yb - ya)
            column = max(math.ceil(x - 0.5) - tile_x, 0)
            for word in range(column >> 6, WORDS):
                plane[row, word] ^= _bits(word, column, TILE)
