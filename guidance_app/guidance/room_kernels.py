"""Compiled check whether an outline driven along a path crosses a boundary. ``room.py`` is the only user.

The boundary's edges are kept by the cells of a grid, so that a short line is compared with the few edges near it; where
no edge is near, nothing is compared at all. What touches an edge counts as crossing it.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from guidance_app.model import FloatArray

__all__ = ["Bools", "Cells", "Ints", "cells_away", "edges_by_cell", "moves_clear", "poses_clear"]

Ints = NDArray[np.int32]
Bools = NDArray[np.bool_]

Cells = tuple[int, int, Ints, Ints, Ints]
"""Columns, rows, where each cell's edges begin in a list, the list, and how many cells away the nearest edge is."""

SLACK = 1e-6
"""Metres by which an edge is taken to reach into a neighbouring cell, against rounding."""


@numba.njit(cache=True, error_model="numpy")
def _cell(value: float, origin: float, size: float, count: int) -> int:
    return min(max(math.floor((value - origin) / size), 0), count - 1)


@numba.njit(cache=True, error_model="numpy")
def _rows_in_column(edge: FloatArray, grid: FloatArray, column: int, rows: int) -> tuple[int, int]:
    """First and last row that an edge (east, north, east, north) crosses in a column of cells."""
    west, east = grid[0] + column * grid[2] - SLACK, grid[0] + (column + 1) * grid[2] + SLACK
    run = edge[2] - edge[0]
    first, last = 0.0, 1.0
    if abs(run) > SLACK:
        one, other = (west - edge[0]) / run, (east - edge[0]) / run
        first, last = max(0.0, min(one, other)), min(1.0, max(one, other))
    low, high = edge[1] + first * (edge[3] - edge[1]), edge[1] + last * (edge[3] - edge[1])
    bottom = _cell(min(low, high) - SLACK, grid[1], grid[2], rows)
    return bottom, _cell(max(low, high) + SLACK, grid[1], grid[2], rows)


@numba.njit(cache=True, error_model="numpy")
def edges_by_cell(edges: FloatArray, grid: FloatArray, columns: int, rows: int) -> tuple[Ints, Ints]:
    """Where each cell's edges begin in a list (columns x rows + 1), and the list.

    ``edges`` (E, 4) are east, north of both ends; ``grid`` is the west and south side, and the cells' size.
    """
    begins = np.zeros(columns * rows + 1, dtype=np.int32)
    listed = np.zeros(0, dtype=np.int32)
    place = np.zeros(0, dtype=np.int32)
    for counting in (True, False):
        if not counting:
            for cell in range(columns * rows):
                begins[cell + 1] += begins[cell]
            listed = np.zeros(begins[-1], dtype=np.int32)
            place = begins[:-1].copy()
        for number in range(len(edges)):
            edge = edges[number]
            low = _cell(min(edge[0], edge[2]) - SLACK, grid[0], grid[2], columns)
            high = _cell(max(edge[0], edge[2]) + SLACK, grid[0], grid[2], columns)
            for column in range(low, high + 1):
                bottom, top = _rows_in_column(edge, grid, column, rows)
                for cell in range(column * rows + bottom, column * rows + top + 1):
                    if counting:
                        begins[cell + 1] += 1
                    else:
                        listed[place[cell]] = number
                        place[cell] += 1
    return begins, listed


@numba.njit(cache=True, error_model="numpy")
def cells_away(begins: Ints, columns: int, rows: int) -> Ints:
    """For each cell (columns x rows) how many steps, straight or diagonal, lead to the nearest one with an edge."""
    away = np.full(columns * rows, columns + rows, dtype=np.int32)
    for forward in (True, False):
        for number in range(columns * rows):
            cell = number if forward else columns * rows - 1 - number
            if begins[cell + 1] > begins[cell]:
                away[cell] = 0
                continue
            column, row = cell // rows, cell % rows
            back = -1 if forward else 1
            for aside, on in ((back, -1), (back, 0), (back, 1), (0, back)):
                if 0 <= column + aside < columns and 0 <= row + on < rows:
                    away[cell] = min(away[cell], away[cell + aside * rows + on] + 1)
    return away


@numba.njit(cache=True, error_model="numpy")
def _room(east: float, north: float, grid: FloatArray, cells: Cells) -> float:
    """Metres round a place in which there is no edge; beyond the grid none."""
    columns, rows, _, _, away = cells
    column, row = math.floor((east - grid[0]) / grid[2]), math.floor((north - grid[1]) / grid[2])
    if not (0 <= column < columns and 0 <= row < rows):
        return 0.0
    return float((away[column * rows + row] - 1) * grid[2] - SLACK)


@numba.njit(cache=True, error_model="numpy")
def _side(one: FloatArray, other: FloatArray, east: float, north: float) -> float:
    return float((other[0] - one[0]) * (north - one[1]) - (other[1] - one[1]) * (east - one[0]))


@numba.njit(cache=True, error_model="numpy")
def _meets(one: FloatArray, other: FloatArray, edge: FloatArray) -> bool:
    if max(one[0], other[0]) < min(edge[0], edge[2]) or min(one[0], other[0]) > max(edge[0], edge[2]):
        return False
    if max(one[1], other[1]) < min(edge[1], edge[3]) or min(one[1], other[1]) > max(edge[1], edge[3]):
        return False
    if _side(one, other, edge[0], edge[1]) * _side(one, other, edge[2], edge[3]) > 0:
        return False
    return bool(_side(edge[:2], edge[2:], one[0], one[1]) * _side(edge[:2], edge[2:], other[0], other[1]) <= 0)


@numba.njit(cache=True, error_model="numpy")
def _clear(one: FloatArray, other: FloatArray, edges: FloatArray, grid: FloatArray, cells: Cells) -> bool:
    """Whether the line between two places touches no edge."""
    columns, rows, begins, listed, _ = cells
    left = _cell(min(one[0], other[0]), grid[0], grid[2], columns)
    right = _cell(max(one[0], other[0]), grid[0], grid[2], columns)
    low = _cell(min(one[1], other[1]), grid[1], grid[2], rows)
    high = _cell(max(one[1], other[1]), grid[1], grid[2], rows)
    for column in range(left, right + 1):
        first, last = begins[column * rows + low], begins[column * rows + high + 1]
        for place in range(first, last):
            if _meets(one, other, edges[listed[place]]):
                return False
    return True


@numba.njit(cache=True, error_model="numpy")
def _laid(outline: FloatArray, east: float, north: float, yaw: float, corners: FloatArray) -> None:
    """Writes the outline's corners at a pose into ``corners``."""
    cosine, sine = math.cos(yaw), math.sin(yaw)
    for corner in range(len(outline)):
        forward, left = outline[corner, 0], outline[corner, 1]
        corners[corner, 0] = east + forward * cosine - left * sine
        corners[corner, 1] = north + forward * sine + left * cosine


@numba.njit(cache=True, error_model="numpy")
def _ring_clear(corners: FloatArray, edges: FloatArray, grid: FloatArray, cells: Cells) -> bool:
    for corner in range(len(corners) - 1):  # noqa: SIM110 - the compiler knows no generators
        if not _clear(corners[corner], corners[corner + 1], edges, grid, cells):
            return False
    return True


@numba.njit(cache=True, error_model="numpy")
def _swept_clear(before: FloatArray, after: FloatArray, edges: FloatArray, grid: FloatArray, cells: Cells) -> bool:
    for corner in range(len(after) - 1):
        if not _clear(before[corner], after[corner], edges, grid, cells):
            return False
    return bool(_ring_clear(after, edges, grid, cells))


@numba.njit(cache=True, error_model="numpy")
def poses_clear(
    poses: FloatArray,
    outline: FloatArray,
    edges: FloatArray,
    grid: FloatArray,
    cells: Cells,
) -> Bools:
    """For poses (M, 3) whether the outline (B, 2), closed, touches no edge there."""
    clear = np.zeros(len(poses), dtype=np.bool_)
    corners = np.zeros_like(outline)
    for place in range(len(poses)):
        _laid(outline, poses[place, 0], poses[place, 1], poses[place, 2], corners)
        clear[place] = _ring_clear(corners, edges, grid, cells)
    return clear


@numba.njit(cache=True, error_model="numpy")
def _advanced(pose: FloatArray, turn: float, length: float, radius: float) -> None:
    """Moves a pose along a circle or a straight."""
    yaw = pose[2]
    if turn == 0.0:
        pose[0] += length * math.cos(yaw)
        pose[1] += length * math.sin(yaw)
        return
    end = yaw + turn * length / radius
    pose[0] += radius * turn * (math.sin(end) - math.sin(yaw))
    pose[1] += radius * turn * (math.cos(yaw) - math.cos(end))
    pose[2] = end


@numba.njit(cache=True, error_model="numpy")
def _reach(outline: FloatArray) -> float:
    """Metres from the working centre to the outline's farthest corner."""
    return float(np.sqrt((outline**2).sum(axis=1).max()))


@numba.njit(cache=True, error_model="numpy")
def _move_clear(
    pose: FloatArray,
    move: tuple[FloatArray, FloatArray, float, float],
    outline: FloatArray,
    edges: FloatArray,
    grid: FloatArray,
    cells: Cells,
) -> bool:
    """The outline along one move from ``pose``, which is moved: at its places, and the corners' ways between them.

    As many places are passed over at a time as there is room for.
    """
    turns, lengths, radius, step = move
    reach = _reach(outline)
    before, corners = np.zeros_like(outline), np.zeros_like(outline)
    _laid(outline, pose[0], pose[1], pose[2], before)
    if not _ring_clear(before, edges, grid, cells):
        return False
    for piece in range(len(lengths)):
        count = math.ceil(abs(lengths[piece]) / step)
        place = 0
        while place < count:
            free = int((_room(pose[0], pose[1], grid, cells) - reach) / step)
            places = min(max(free, 1), count - place)
            _laid(outline, pose[0], pose[1], pose[2], before)
            _advanced(pose, turns[piece], places * lengths[piece] / count, radius)
            place += places
            if free < 1:
                _laid(outline, pose[0], pose[1], pose[2], corners)
                if not _swept_clear(before, corners, edges, grid, cells):
                    return False
    return True


@numba.njit(cache=True, error_model="numpy")
def moves_clear(
    starts: FloatArray,
    moves: tuple[FloatArray, FloatArray, float, float],
    outline: FloatArray,
    edges: FloatArray,
    grid: FloatArray,
    cells: Cells,
) -> Bools:
    """For each move whether the outline touches no edge all along.

    ``starts`` (C, 3) are poses; ``moves`` are turns (C, P), lengths (C, P), the radius, and the metres between the
    places at which the outline is tried: an obstacle may lie between its corners' ways.
    """
    turns, lengths, radius, step = moves
    clear = np.zeros(len(starts), dtype=np.bool_)
    for row in range(len(starts)):
        clear[row] = _move_clear(
            starts[row].copy(), (turns[row], lengths[row], radius, step), outline, edges, grid, cells
        )
    return clear
