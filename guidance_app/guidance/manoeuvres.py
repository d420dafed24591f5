"""Paths of bounded curvature between poses: arcs of one radius and straights, forward or with one leg backward.

The words are the six of Dubins (1957), and after Reeds and Shepp (1990) those whose middle leg is driven backward,
which turn on a narrow headland (fishtail), or that are driven backward all the way. All functions work on many pairs of
poses at once. Angles here are yaws, counter-clockwise from east, because the arithmetic is that of circles;
nothing of it leaves this file but polylines and lengths.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from guidance_app.model import FloatArray

IntArray = NDArray[np.intp]

__all__ = ["WORDS", "Manoeuvres", "backed", "join", "poses_along", "stacked", "with_straights"]

WORDS = 14
"""Number of candidates that ``join`` gives for a pair; a three-arc word counts for each side of its middle circle."""

LEFT, STRAIGHT, RIGHT = 1.0, 0.0, -1.0
ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Manoeuvres:
    """Candidates as pieces of constant curvature.

    ``start`` (C, 3): east, north, yaw. ``turns`` (C, P): 1 left, 0 straight, -1 right. ``lengths`` (C, P): metres,
    negative backward; NaN where a candidate does not exist.
    """

    start: FloatArray
    turns: FloatArray
    lengths: FloatArray
    radius: float

    @property
    def total(self) -> FloatArray:
        """Metres driven, shape (C,); infinite where a candidate does not exist."""
        total: FloatArray = np.abs(self.lengths).sum(axis=1)
        return np.where(np.isnan(total), np.inf, total)

    def take(self, rows: IntArray) -> "Manoeuvres":
        """Only these candidates."""
        return Manoeuvres(self.start[rows], self.turns[rows], self.lengths[rows], self.radius)


def join(start: FloatArray, end: FloatArray, radius: float, *, reverse: bool) -> Manoeuvres:
    """Every word from each ``start`` (M, 3) to its ``end`` (M, 3), pair by pair: row = pair x WORDS + word."""
    words = [
        *_same_sense(start, end, radius),
        *_cross(start, end, radius),
        *_three_arcs(start, end, radius),
    ]
    turns = np.array([turns for turns, _, _ in words])
    lengths = np.stack([lengths for _, lengths, _ in words], axis=1)
    if not reverse:
        backward = np.array([backward for _, _, backward in words])
        lengths[:, backward, :] = np.nan
    pairs = len(start)
    return Manoeuvres(
        start=np.repeat(start, WORDS, axis=0),
        turns=np.tile(turns, (pairs, 1)),
        lengths=lengths.reshape(pairs * WORDS, 3),
        radius=radius,
    )


def with_straights(words: Manoeuvres, before: FloatArray, after: FloatArray) -> Manoeuvres:
    """The candidates with straights before and after, shapes (C, B) and (C, A), negative backward.

    The words themselves stay where they are; the start moves so that the straights lead to them.
    """
    yaw = words.start[:, 2]
    start = words.start.copy()
    start[:, 0] -= before.sum(axis=1) * np.cos(yaw)
    start[:, 1] -= before.sum(axis=1) * np.sin(yaw)
    return Manoeuvres(
        start,
        np.column_stack([np.zeros_like(before), words.turns, np.zeros_like(after)]),
        np.column_stack([before, words.lengths, after]),
        words.radius,
    )


def backed(start: FloatArray, end: FloatArray, radius: float) -> Manoeuvres:
    """The six words of Dubins driven backward all the way, pair by pair; rows as of ``join``."""
    turned = join(_about(start), _about(end), radius, reverse=False)
    return Manoeuvres(np.repeat(start, WORDS, axis=0), -turned.turns, -turned.lengths, radius)


def _about(poses: FloatArray) -> FloatArray:
    turned: FloatArray = poses + np.array([0.0, 0.0, np.pi])
    return turned


def stacked(several: Sequence[Manoeuvres], pairs: int) -> Manoeuvres:
    """Candidates of several kinds for the same pairs, those of one pair next to each other."""
    each = [len(kind.start) // pairs for kind in several]

    def together(arrays: Sequence[FloatArray]) -> FloatArray:
        width = arrays[0].shape[1]
        shaped = [array.reshape(pairs, rows, width) for array, rows in zip(arrays, each, strict=True)]
        return np.concatenate(shaped, axis=1).reshape(-1, width)

    return Manoeuvres(
        together([kind.start for kind in several]),
        together([kind.turns for kind in several]),
        together([kind.lengths for kind in several]),
        several[0].radius,
    )


def poses_along(moves: Manoeuvres, stations: FloatArray) -> FloatArray:
    """Poses (C, K, 3): east, north, yaw at ``stations`` (C, K), metres driven from the start."""
    size = np.abs(moves.lengths)
    begins = np.concatenate([np.zeros((len(size), 1)), np.cumsum(size, axis=1)], axis=1)
    poses = [moves.start]
    for piece in range(moves.lengths.shape[1]):
        poses.append(_advance(poses[-1], moves.turns[:, piece], moves.lengths[:, piece], moves.radius))
    starts = np.stack(poses[:-1], axis=1)
    piece = (stations[:, :, None] > begins[:, None, 1:-1]).sum(axis=2)
    row = np.arange(len(size))[:, None]
    along = (stations - begins[row, piece]) * np.sign(moves.lengths[row, piece])
    return _advance(starts[row, piece], moves.turns[row, piece], along, moves.radius)


def _advance(pose: FloatArray, turn: FloatArray, length: FloatArray, radius: float) -> FloatArray:
    """Poses after ``length`` on a circle or a straight; all of one leading shape, pose with a last axis of 3."""
    yaw = pose[..., 2]
    end = yaw + turn * length / radius
    curved = turn != 0
    sense = np.where(curved, turn, 1.0)
    east = np.where(curved, radius * sense * (np.sin(end) - np.sin(yaw)), length * np.cos(yaw))
    north = np.where(curved, radius * sense * (np.cos(yaw) - np.cos(end)), length * np.sin(yaw))
    return np.stack([pose[..., 0] + east, pose[..., 1] + north, end], axis=-1)


_Word = tuple[tuple[float, float, float], FloatArray, bool]


def _same_sense(start: FloatArray, end: FloatArray, radius: float) -> list[_Word]:
    """Arc, straight, arc in one sense; the straight forward, or backward (fishtail)."""
    words: list[_Word] = []
    for sense in (RIGHT, LEFT):
        apart = _centre(end, sense, radius) - _centre(start, sense, radius)
        distance = np.hypot(apart[:, 0], apart[:, 1])
        towards = np.arctan2(apart[:, 1], apart[:, 0])
        for backward in (False, True):
            yaw = towards + np.pi if backward else towards
            first = _turned(yaw - start[:, 2], sense) * radius
            last = _turned(end[:, 2] - yaw, sense) * radius
            middle = -distance if backward else distance
            words.append(((sense, STRAIGHT, sense), np.column_stack([first, middle, last]), backward))
    return words


def _cross(start: FloatArray, end: FloatArray, radius: float) -> list[_Word]:
    """Arc, straight, arc in the other sense; only where the circles do not overlap."""
    words: list[_Word] = []
    for sense in (RIGHT, LEFT):
        apart = _centre(end, -sense, radius) - _centre(start, sense, radius)
        square = apart[:, 0] ** 2 + apart[:, 1] ** 2 - 4 * radius**2
        middle = np.sqrt(np.where(square < 0, np.nan, square))
        yaw = np.arctan2(apart[:, 1], apart[:, 0]) + sense * np.arctan2(2 * radius, middle)
        first = _turned(yaw - start[:, 2], sense) * radius
        last = _turned(end[:, 2] - yaw, -sense) * radius
        words.append(((sense, STRAIGHT, -sense), np.column_stack([first, middle, last]), False))
    return words


def _three_arcs(start: FloatArray, end: FloatArray, radius: float) -> list[_Word]:
    """Arc, counter-arc, arc; the middle forward (bulb) or backward (fishtail), its circle on either side."""
    words: list[_Word] = []
    for sense in (RIGHT, LEFT):
        first_centre = _centre(start, sense, radius)
        last_centre = _centre(end, sense, radius)
        apart = last_centre - first_centre
        distance = np.hypot(apart[:, 0], apart[:, 1])
        square = 4 * radius**2 - distance**2 / 4
        reach = np.sqrt(np.where(square < 0, np.nan, square))
        across = np.column_stack([-apart[:, 1], apart[:, 0]]) / np.maximum(distance, ROUNDING)[:, None]
        for side in (1.0, -1.0):
            middle = (first_centre + last_centre) / 2 + side * reach[:, None] * across
            leave = _yaw_on(first_centre, middle, sense)
            enter = _yaw_on(last_centre, middle, sense)
            first = _turned(leave - start[:, 2], sense) * radius
            last = _turned(end[:, 2] - enter, sense) * radius
            forward = _turned(enter - leave, -sense) * radius
            backward = -_turned(enter - leave, sense) * radius
            words.append(((sense, -sense, sense), np.column_stack([first, forward, last]), False))
            words.append(((sense, -sense, sense), np.column_stack([first, backward, last]), True))
    return words


def _centre(pose: FloatArray, sense: float, radius: float) -> FloatArray:
    """Centre (M, 2) of the circle to the left (1) or right (-1) of each pose."""
    yaw = pose[:, 2]
    return np.column_stack([pose[:, 0] - sense * radius * np.sin(yaw), pose[:, 1] + sense * radius * np.cos(yaw)])


def _yaw_on(centre: FloatArray, towards: FloatArray, sense: float) -> FloatArray:
    """Yaw of travel where the circle about ``centre`` touches the one about ``towards``."""
    return np.arctan2(towards[:, 1] - centre[:, 1], towards[:, 0] - centre[:, 0]) + sense * np.pi / 2


def _turned(angle: FloatArray, sense: float) -> FloatArray:
    """The turn in [0, 2 pi) that changes the yaw by ``angle`` when steering to one side."""
    turned: FloatArray = np.mod(sense * angle, 2 * np.pi)
    return np.where(turned > 2 * np.pi - ROUNDING, 0.0, turned)
