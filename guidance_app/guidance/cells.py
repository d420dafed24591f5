"""Passes over the mainland: strips across it, cut where they leave it, and the cells of neighbouring strips.

A strip of one swath spacing is cut from the mainland; each piece is worked from the first to the last point where the
strip touches it, so that whole ends are worked and not only what lies under the middle. Two pieces of neighbouring
strips belong to one cell while each is the other's best neighbour.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import Polygon

from guidance_app.angles import east_north
from guidance_app.guidance.request import LastPass
from guidance_app.model import FloatArray

__all__ = ["Piece", "Strips", "cells_of", "cut", "cut_inside", "strips_over"]

ROUNDING = 1e-6
SLIVER = 0.02
"""Square metres of mainland in a strip that are not worth a pass."""

SHORTEST = 0.5
"""Metres; a shorter piece of a strip that is not lengthened is not worth a pass."""

BESIDE = 0.2
"""Swath spacings beside a strip's middle up to which it lies in the mainland where it is not lengthened.

Cut at its middle, half of every slanting end would be worked twice: 2.5 % of a field at 12 m instead of 1.4 %.
"""


@dataclass(frozen=True, slots=True)
class Strips:
    """Parallel strips: strip k has its middle ``first`` + k x ``spacing`` right of the origin along ``heading``."""

    heading: float
    first: float
    spacing: float
    count: int

    def middle(self, row: int) -> float:
        """Metres right of the origin of one strip's middle."""
        return self.first + row * self.spacing

    def along_across(self, points: FloatArray) -> FloatArray:
        """Shape (N, 2): metres along the heading and to its right, from east, north."""
        east, north = east_north(self.heading)
        turned: FloatArray = points @ np.array([[east, north], [north, -east]])
        return turned

    def east_north(self, points: FloatArray) -> FloatArray:
        """The way back; the transform is its own inverse."""
        return self.along_across(points)


@dataclass(frozen=True, slots=True)
class Piece:
    """One pass before it has a number: strip ``row`` from ``low`` to ``high`` metres along the heading."""

    row: int
    low: float
    high: float

    @property
    def length(self) -> float:
        """Metres to work."""
        return self.high - self.low


def strips_over(
    mainland: Sequence[Polygon], heading: float, spacing: float, last: LastPass, line_across: float | None
) -> Strips:
    """Strips that cover the mainland. With ``line_across`` their middles keep whole spacings from that line."""
    frame = Strips(heading, 0.0, spacing, 0)
    across = frame.along_across(shapely.get_coordinates(list(mainland)))[:, 1]
    low, high = float(across.min()), float(across.max())
    if line_across is not None:
        first = math.floor((low - line_across) / spacing + 0.5 + ROUNDING)
        final = math.ceil((high - line_across) / spacing - 0.5 - ROUNDING)
        return Strips(heading, line_across + first * spacing, spacing, max(1, final - first + 1))
    exact = (high - low) / spacing
    count = max(1, math.ceil(exact - ROUNDING))
    if last is LastPass.EVEN:
        spacing = (high - low) / count
    elif last is LastPass.GAP and count > 1 and exact - (count - 1) < 0.5:
        count -= 1
    return Strips(heading, low + spacing / 2, spacing, count)


def cut(mainland: Sequence[Polygon], strips: Strips) -> tuple[Piece, ...]:
    """The pieces of all strips, by row, then along; each as long as the strip touches the mainland."""
    turned = [shapely.transform(part, strips.along_across) for part in mainland]
    half = strips.spacing / 2
    pieces: list[Piece] = []
    for row in range(strips.count):
        middle = strips.middle(row)
        spans = [span for part in turned for span in _spans(part, middle - half, middle + half)]
        pieces.extend(Piece(row, low, high) for low, high in _joined(spans))
    return tuple(pieces)


def cut_inside(mainland: Sequence[Polygon], strips: Strips) -> tuple[Piece, ...]:
    """The pieces no longer than both lines beside the strips' middles lie in the mainland.

    Hardly anything is worked twice at slanting ends, wedges are missed.
    """
    turned = [shapely.transform(part, strips.along_across) for part in mainland]
    pieces: list[Piece] = []
    for row in range(strips.count):
        middle, beside = strips.middle(row), BESIDE * strips.spacing
        right, left = _crossed(turned, middle - beside), _crossed(turned, middle + beside)
        both = [(max(one[0], two[0]), min(one[1], two[1])) for one in right for two in left]
        pieces.extend(Piece(row, low, high) for low, high in sorted(both) if high - low > SHORTEST)
    return tuple(pieces)


def _crossed(parts: Sequence[Polygon], across: float) -> list[tuple[float, float]]:
    """From where to where a line along the strips lies in the mainland."""
    left, _, right, _ = shapely.total_bounds(list(parts))
    line = shapely.LineString([(left - 1, across), (right + 1, across)])
    inner = [piece for part in parts for piece in shapely.get_parts(shapely.intersection(part, line))]
    return _joined([(piece.bounds[0], piece.bounds[2]) for piece in inner if piece.length > SHORTEST])


def _spans(part: Polygon, bottom: float, top: float) -> list[tuple[float, float]]:
    """Extents along the strip of each piece of mainland in it."""
    left, low, right, high = part.bounds
    if high <= bottom or low >= top:
        return []
    cuts = shapely.get_parts(shapely.clip_by_rect(part, left - 1.0, bottom, right + 1.0, top))
    areas = shapely.area(cuts)
    bounds = shapely.bounds(cuts[areas > SLIVER])
    return [(float(west), float(east)) for west, _, east, _ in bounds]


def _joined(spans: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Spans that overlap as one."""
    joined: list[tuple[float, float]] = []
    for low, high in sorted(spans):
        if joined and low <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], high))
        else:
            joined.append((low, high))
    return joined


def cells_of(pieces: Sequence[Piece]) -> tuple[tuple[Piece, ...], ...]:
    """Runs of pieces on neighbouring strips, each the best neighbour of the next."""
    rows: dict[int, list[int]] = {}
    for place, piece in enumerate(pieces):
        rows.setdefault(piece.row, []).append(place)
    following = {}
    for row, here in rows.items():
        beyond = rows.get(row + 1, [])
        for place in here:
            best = _best(pieces, place, beyond)
            if best is not None and _best(pieces, best, here) == place:
                following[place] = best
    begun = set(following.values())
    cells: list[tuple[Piece, ...]] = []
    for place in range(len(pieces)):
        if place in begun:
            continue
        run = [place]
        while run[-1] in following:
            run.append(following[run[-1]])
        cells.append(tuple(pieces[each] for each in run))
    return tuple(cells)


def _best(pieces: Sequence[Piece], place: int, others: Sequence[int]) -> int | None:
    here = pieces[place]
    shared = [(min(here.high, pieces[each].high) - max(here.low, pieces[each].low), each) for each in others]
    overlap, best = max(shared, default=(0.0, -1))
    return best if overlap > 0 else None
