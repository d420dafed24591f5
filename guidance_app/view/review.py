"""What a review shows: a track in colours by what was good or bad on it, its legend, charts' rows and a small map.

Colours run from green over yellow to red for what should be small, and from blue to orange for what has no good side;
each colour's meaning stands in the legend in numbers.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from guidance_app.language import Words, message
from guidance_app.model import NO_PASS, DriveLog, FixQuality, FloatArray
from guidance_app.view.colours import Rgb

__all__ = [
    "COLOURINGS",
    "ColourBy",
    "Coloured",
    "Legend",
    "coloured_track",
    "error_along",
    "names_of_quality",
    "thumbnail_svg",
]

MOST_STROKES = 12_000
LONGEST_STROKE = 25.0
"""Two fixes farther apart (m) are not joined by a line."""
GREEN, YELLOW, RED, BLUE, ORANGE, GREY = (
    (47, 158, 68),
    (240, 180, 0),
    (224, 49, 49),
    (51, 101, 180),
    (232, 119, 34),
    (134, 142, 150),
)
ERRORS = (0.05, 0.10, 0.20, 0.30)
"""Metres; the colour changes at each."""
ERROR_COLOURS: tuple[Rgb, ...] = (GREEN, (130, 170, 40), YELLOW, (235, 120, 20), RED)
SPEED_STEPS = 5
QUALITY_COLOURS: dict[int, Rgb] = {4: GREEN, 5: (130, 170, 40), 2: YELLOW, 3: YELLOW, 1: (235, 120, 20), 0: RED}
OVERLAP_SHARE = 0.15
"""A stretch on which more than this part of the width was worked before counts as worked twice."""


class ColourBy(StrEnum):
    """What the colours mean."""

    ERROR = "error"
    SPEED = "speed"
    QUALITY = "quality"
    OVERLAP = "overlap"


@dataclass(frozen=True, slots=True)
class Legend:
    """What a colour means, in words."""

    colour: Rgb
    words: str


@dataclass(frozen=True, slots=True, eq=False)
class Coloured:
    """Strokes of shape (N, 2, 2), east and north of their ends, with a colour each of shape (N, 3)."""

    strokes: FloatArray
    colours: NDArray[np.uint8]
    legend: tuple[Legend, ...]


def coloured_track(log: DriveLog, by: ColourBy, words: Words, width: float = 3.0) -> Coloured:
    """The whole way in colours; what has no value is grey."""
    points = np.column_stack([log.east, log.north])
    good = np.isfinite(points).all(axis=1)
    chosen = np.flatnonzero(good)
    chosen = chosen[:: max(len(chosen) // MOST_STROKES, 1)]
    ends = np.stack([points[chosen[:-1]], points[chosen[1:]]], axis=1) if len(chosen) > 1 else np.zeros((0, 2, 2))
    joined = np.hypot(*(ends[:, 1] - ends[:, 0]).T) < LONGEST_STROKE if len(ends) else np.zeros(0, bool)
    kinds, legend = _kinds(log, by, words, width)
    palette = np.array([one.colour for one in legend], dtype=np.uint8)
    colours = palette[kinds[chosen[1:]]] if len(chosen) > 1 else np.zeros((0, 3), np.uint8)
    return Coloured(ends[joined], colours[joined], legend)


def _kinds(log: DriveLog, by: ColourBy, words: Words, width: float) -> tuple[NDArray[np.intp], tuple[Legend, ...]]:
    """For each row the place in the legend."""
    match by:
        case ColourBy.ERROR:
            return _by_error(log, words)
        case ColourBy.SPEED:
            return _by_speed(log, words)
        case ColourBy.QUALITY:
            return _by_quality(log, words)
        case ColourBy.OVERLAP:
            return _by_overlap(log, words, width)


def _by_error(log: DriveLog, words: Words) -> tuple[NDArray[np.intp], tuple[Legend, ...]]:
    known = np.isfinite(log.cross_track) & (log.pass_number != NO_PASS) & log.on_pass
    kinds = np.where(known, np.digitize(np.abs(np.nan_to_num(log.cross_track)), ERRORS), len(ERROR_COLOURS))
    texts = [words("up to {centimetres} cm", centimetres=round(ERRORS[0] * 100))]
    texts += [
        words("{low} to {high} cm", low=round(low * 100), high=round(high * 100))
        for low, high in itertools.pairwise(ERRORS)
    ]
    texts.append(words("more than {centimetres} cm", centimetres=round(ERRORS[-1] * 100)))
    legend = [Legend(colour, text) for colour, text in zip(ERROR_COLOURS, texts, strict=True)]
    return kinds.astype(np.intp), (*legend, Legend(GREY, words("not on a pass")))


def _by_speed(log: DriveLog, words: Words) -> tuple[NDArray[np.intp], tuple[Legend, ...]]:
    speeds = np.abs(log.speed) * 3.6
    known = speeds[np.isfinite(speeds)]
    top = max(math.ceil(float(np.percentile(known, 98))), SPEED_STEPS) if len(known) else SPEED_STEPS
    edges = np.linspace(0, top, SPEED_STEPS + 1)[1:-1]
    kinds = np.where(np.isfinite(speeds), np.digitize(np.nan_to_num(speeds), edges), SPEED_STEPS)
    bounds = [0.0, *edges.tolist(), float(top)]
    legend = tuple(
        Legend(
            _between(BLUE, ORANGE, step / (SPEED_STEPS - 1)),
            words("{low} to {high} km/h", low=words.number(bounds[step], 1), high=words.number(bounds[step + 1], 1)),
        )
        for step in range(SPEED_STEPS)
    )
    return kinds.astype(np.intp), (*legend, Legend(GREY, words("unknown")))


def names_of_quality(words: Words) -> dict[int, str]:
    """What people call each fix quality."""
    return {
        FixQuality.NONE: words("no fix"),
        FixQuality.AUTONOMOUS: words("GPS"),
        FixQuality.DGPS: "DGPS",
        FixQuality.PPS: "PPS",
        FixQuality.RTK_FIXED: words("RTK fixed"),
        FixQuality.RTK_FLOAT: words("RTK float"),
        FixQuality.DEAD_RECKONING: words("dead reckoning"),
        FixQuality.MANUAL: words("manual"),
        FixQuality.SIMULATED: words("simulated"),
    }


def _by_quality(log: DriveLog, words: Words) -> tuple[NDArray[np.intp], tuple[Legend, ...]]:
    names = names_of_quality(words)
    there = sorted({int(one) for one in log.quality}, reverse=True) or [0]
    kinds = np.searchsorted(np.array(there[::-1]), log.quality)
    legend = [Legend(QUALITY_COLOURS.get(one, GREY), names.get(one, str(one))) for one in there[::-1]]
    return kinds.astype(np.intp), tuple(legend)


def _by_overlap(log: DriveLog, words: Words, width: float) -> tuple[NDArray[np.intp], tuple[Legend, ...]]:
    if len(log) < 2:
        return np.zeros(len(log), np.intp), (Legend(GREY, words("nothing worked")),)
    steps = np.hypot(np.diff(log.east, prepend=log.east[:1]), np.diff(log.north, prepend=log.north[:1]))
    twice = np.diff(log.overlap, prepend=log.overlap[:1])
    share = twice / np.maximum(np.nan_to_num(steps) * width, 1e-3)
    kinds = np.where(log.working, np.where(share > OVERLAP_SHARE, 1, 0), 2)
    legend = (
        Legend(GREEN, words("worked once")),
        Legend(RED, words("worked twice")),
        Legend(GREY, words("not working")),
    )
    return kinds.astype(np.intp), legend


def _between(one: Rgb, other: Rgb, part: float) -> Rgb:
    red, green, blue = (round(a + (b - a) * part) for a, b in zip(one, other, strict=True))
    return red, green, blue


def error_along(log: DriveLog, number: int | None, most: int = 1500) -> tuple[FloatArray, FloatArray]:
    """Distance driven on the pass in metres and the error there in centimetres; all passes in a row for None."""
    mine = log.on_pass & log.working & np.isfinite(log.cross_track)
    mine &= (log.pass_number == number) if number is not None else (log.pass_number != NO_PASS)
    rows = np.flatnonzero(mine)
    rows = rows[:: max(len(rows) // most, 1)]
    if not len(rows):
        return np.zeros(0), np.zeros(0)
    steps = np.hypot(
        np.diff(log.east[rows], prepend=log.east[rows[0]]), np.diff(log.north[rows], prepend=log.north[rows[0]])
    )
    steps[steps > LONGEST_STROKE] = 0.0
    return np.cumsum(np.nan_to_num(steps)), log.cross_track[rows] * 100.0


def thumbnail_svg(log: DriveLog, boundary: Sequence[FloatArray] = (), pixels: int = 96) -> str:
    """A small map: boundary, what was worked, and the rest of the way."""
    points = np.column_stack([log.east, log.north])
    good = points[np.isfinite(points).all(axis=1)]
    every = [ring for ring in (*boundary, good) if len(ring)]
    if not every:
        return f'<svg width="{pixels}" height="{pixels}" role="img"></svg>'
    together = np.vstack(every)
    low, high = together.min(axis=0), together.max(axis=0)
    size = max(float((high - low).max()), 10.0) * 1.1
    middle = (low + high) / 2
    scale = pixels / size

    def path(way: FloatArray, *, closed: bool = False) -> str:
        right = (way[:, 0] - middle[0]) * scale + pixels / 2
        down = (middle[1] - way[:, 1]) * scale + pixels / 2
        return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in zip(right, down, strict=True)) + ("Z" if closed else "")

    field = "".join(path(ring, closed=True) for ring in boundary if len(ring) > 2)
    thin = good[:: max(len(good) // 400, 1)]
    way = path(thin) if len(thin) > 1 else ""
    return (
        f'<svg width="{pixels}" height="{pixels}" viewBox="0 0 {pixels} {pixels}" role="img">'
        f'<path d="{field}" fill="#dccdb2" fill-rule="evenodd" stroke="#a07018"/>'
        f'<path d="{way}" fill="none" stroke="#2f7d3b" stroke-width="1.5"/></svg>'
    )


COLOURINGS = {
    message("Error"): ColourBy.ERROR,
    message("Speed"): ColourBy.SPEED,
    message("Fix"): ColourBy.QUALITY,
    message("Overlap"): ColourBy.OVERLAP,
}
"""The names of the choice, in its order."""
