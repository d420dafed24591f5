"""Families of passes for driving without a plan: one guidance line and its neighbours at the swath spacing.

Pass 0 is the guidance line, positive numbers lie to its right, seen in the order of its points. A family is a value:
moving it sideways gives another one. Passes that cost something to make (offset curves) are kept once made; as they
depend on nothing but the family and the number, sharing them between copies is harmless.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np
import shapely

from guidance_app.guidance.polyline import Polyline
from guidance_app.language import sentence
from guidance_app.model import FloatArray, Pass

__all__ = [
    "Circles",
    "GuidanceLineError",
    "Learner",
    "OffsetCurves",
    "ParallelLines",
    "PassFamily",
    "drawn_line",
    "offset_line",
    "passes_within",
]

LEAST_OFFSET = 1e-6
"""Metres; nudges there and back leave less, and GEOS cannot offset a line by so little."""

MOST_DRAWN = 2_000
"""Passes to either side of the guidance line that are ever drawn."""

MAX_NUMBER = 100_000
"""No field has more passes to one side; a number beyond is answered by None."""


class GuidanceLineError(ValueError):
    """A guidance line cannot be used; the message is a sentence for the driver."""


class PassFamily(Protocol):
    """Numbered passes without a plan."""

    @property
    def count(self) -> int | None:
        """How many passes there are; None for endlessly many."""

    def pass_numbered(self, number: int) -> Pass | None:
        """The pass of this number; None where the family has none."""

    def nearest_number(self, east: float, north: float) -> int:
        """Number of the pass nearest to a position (it may be one that ``pass_numbered`` answers with None)."""

    def shifted(self, metres: float) -> "PassFamily":
        """The same family moved to the right, seen along the guidance line."""


@runtime_checkable
class Learner(PassFamily, Protocol):
    """A family that makes its next passes from those driven."""

    @property
    def lines(self) -> Mapping[int, FloatArray]:
        """Those driven, by their numbers; empty while the first one is driven."""

    def driven(self, number: int, points: FloatArray) -> PassFamily:
        """The family after pass ``number`` was driven along ``points`` of shape (N, 2)."""


@dataclass(frozen=True, slots=True, eq=False)
class ParallelLines:
    """Endless straight lines beside that from A to B."""

    start: tuple[float, float]
    end: tuple[float, float]
    spacing: float
    offset: float = 0.0
    count: None = None

    def __post_init__(self) -> None:
        """Checks spacing and points."""
        _check_spacing(self.spacing)
        if not math.dist(self.start, self.end) > 0:
            msg = sentence("A and B are the same point: drive on before setting B")
            raise GuidanceLineError(msg)

    def _right(self) -> tuple[float, float]:
        length = math.dist(self.start, self.end)
        return (self.end[1] - self.start[1]) / length, (self.start[0] - self.end[0]) / length

    def pass_numbered(self, number: int) -> Pass | None:
        """The line ``number`` spacings to the right."""
        if abs(number) > MAX_NUMBER:
            return None
        right = np.array(self._right()) * (number * self.spacing + self.offset)
        points = np.array([self.start, self.end]) + right
        points.setflags(write=False)
        return Pass(number, points, endless=True)

    def nearest_number(self, east: float, north: float) -> int:
        """By the distance to the right of A to B."""
        right_east, right_north = self._right()
        across = (east - self.start[0]) * right_east + (north - self.start[1]) * right_north
        return round((across - self.offset) / self.spacing)

    def shifted(self, metres: float) -> "ParallelLines":
        """The same lines, moved to the right."""
        return replace(self, offset=self.offset + metres)


@dataclass(frozen=True, eq=False)
class OffsetCurves:
    """Lines at a constant distance of a curve, prolonged straight at both ends; loops of inner bends are cut off."""

    line: FloatArray
    spacing: float
    offset: float = 0.0
    count: None = None
    _made: dict[int, Pass | None] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        """Checks spacing and line."""
        _check_spacing(self.spacing)
        try:
            Polyline.through(self.line)
        except ValueError as error:
            msg = sentence("the curve cannot be followed: {reason}", reason=str(error))
            raise GuidanceLineError(msg) from error

    @cached_property
    def _base(self) -> Polyline:
        return Polyline.through(self.line, endless=True)

    def pass_numbered(self, number: int) -> Pass | None:
        """None where the curve is so bent that no line is left at this distance."""
        if abs(number) > MAX_NUMBER:
            return None
        if number not in self._made:
            metres = number * self.spacing + self.offset
            points = offset_line(self.line, metres, run_out=4.0 * abs(metres) + 10.0)
            self._made[number] = None if points is None else Pass(number, points, endless=True)
        return self._made[number]

    def nearest_number(self, east: float, north: float) -> int:
        """By the distance to the curve, for every point of an offset curve has the same."""
        foot = self._base.foot(east, north)
        return round((foot.cross - self.offset) / self.spacing)

    def shifted(self, metres: float) -> "OffsetCurves":
        """The same curves, moved to the right."""
        return OffsetCurves(self.line, self.spacing, self.offset + metres)


CHORD_ERROR = 1e-3
"""How far a circle's chords stay from it."""


@dataclass(frozen=True, slots=True, eq=False)
class Circles:
    """Circles around a pivot, driven clockwise in the order of their points: positive numbers lie inside."""

    centre: tuple[float, float]
    radius: float
    spacing: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        """Checks spacing and radius."""
        _check_spacing(self.spacing)
        if not self.radius > 0:
            msg = sentence("a pivot's circle needs a radius: drive away from its centre")
            raise GuidanceLineError(msg)

    @property
    def count(self) -> None:
        """Endlessly many: there is always another circle outside."""

    def pass_numbered(self, number: int) -> Pass | None:
        """None where the circle would be smaller than half a spacing."""
        radius = self.radius - self.offset - number * self.spacing
        if radius < 0.5 * self.spacing or abs(number) > MAX_NUMBER:
            return None
        corners = max(12, math.ceil(math.pi / math.acos(1.0 - min(CHORD_ERROR / radius, 1.0))))
        turn = np.arange(corners) * (math.tau / corners)
        points = np.column_stack([np.sin(turn), np.cos(turn)]) * radius + np.array(self.centre)
        points.setflags(write=False)
        return Pass(number, points, closed=True)

    def nearest_number(self, east: float, north: float) -> int:
        """By the distance to the centre."""
        away = math.hypot(east - self.centre[0], north - self.centre[1])
        innermost = math.floor((self.radius - self.offset) / self.spacing - 0.5)
        return min(round((self.radius - self.offset - away) / self.spacing), innermost)

    def shifted(self, metres: float) -> "Circles":
        """The same circles, moved towards the pivot."""
        return replace(self, offset=self.offset + metres)


def _check_spacing(spacing: float) -> None:
    if not (math.isfinite(spacing) and spacing > 0):
        msg = sentence("a swath spacing of {spacing:g} m cannot be driven: it must be more than 0", spacing=spacing)
        raise GuidanceLineError(msg)


def offset_line(points: FloatArray, metres: float, *, closed: bool = False, run_out: float = 0.0) -> FloatArray | None:
    """Shape (M, 2): the line ``metres`` to the right, loops of inner bends cut off; None where nothing is left.

    An open line is first prolonged straight by ``run_out`` at both ends, so that the inner side of a bend near an end
    need not eat the line up.
    """
    if abs(metres) < LEAST_OFFSET:
        return points
    if closed:
        return _offset_ring(points, metres)
    longer = _prolonged(points, run_out) if run_out > 0 else points
    moved = shapely.offset_curve(shapely.linestrings(longer), -metres, quad_segs=16)
    parts = [part for part in shapely.get_parts(moved) if part.length > 0]
    if not parts:
        return None
    longest = shapely.get_coordinates(max(parts, key=lambda part: part.length))
    longest.setflags(write=False)
    return longest


def _prolonged(points: FloatArray, metres: float) -> FloatArray:
    line = Polyline.through(points)
    first, last = line.first_heading, line.last_heading
    before = line.vertices[0] - metres * np.array([math.sin(first), math.cos(first)])
    behind = line.vertices[-1] + metres * np.array([math.sin(last), math.cos(last)])
    return np.vstack([before, line.vertices, behind])


def _offset_ring(points: FloatArray, metres: float) -> FloatArray | None:
    ring = shapely.linearrings(points)
    outward = metres if shapely.is_ccw(ring) else -metres
    polygon = shapely.buffer(shapely.polygons(ring), outward, quad_segs=16)
    parts = [part for part in shapely.get_parts(polygon) if not part.is_empty]
    if not parts:
        return None
    largest = max(parts, key=lambda part: part.area).exterior
    moved = shapely.get_coordinates(largest)[:-1]
    if shapely.is_ccw(largest) != shapely.is_ccw(ring):
        moved = moved[::-1]
    start = int(np.argmin(np.hypot(*(moved - points[0]).T)))
    moved = np.ascontiguousarray(np.roll(moved, -start, axis=0))
    moved.setflags(write=False)
    return moved


def passes_within(family: PassFamily, area: shapely.Polygon) -> tuple[Pass, ...]:
    """The passes that cross ``area``, in the order of their numbers: what a screen draws of an endless family.

    Each is whole; at most 2,000 to either side of the guidance line.
    """
    corners = shapely.get_coordinates(area.exterior.segmentize(0.02 * area.exterior.length))
    numbers = [family.nearest_number(float(east), float(north)) for east, north in corners]
    found = []
    for number in range(max(min(numbers) - 1, -MOST_DRAWN), min(max(numbers) + 1, MOST_DRAWN) + 1):
        candidate = family.pass_numbered(number)
        if candidate is not None and area.intersects(drawn_line(candidate, area)):
            found.append(candidate)
    return tuple(found)


def drawn_line(target: Pass, area: shapely.Polygon) -> shapely.LineString:
    """A pass as a line; an endless one runs on to beyond ``area``."""
    if target.closed:
        return shapely.LineString(np.vstack([target.points, target.points[:1]]))
    if not target.endless:
        return shapely.LineString(target.points)
    west, south, east, north = area.bounds
    corners = np.array([[west, south], [west, north], [east, south], [east, north]])
    ends = target.points[[0, -1]]
    reach = float(np.max(np.hypot(*(corners[:, None] - ends[None]).reshape(-1, 2).T)))
    return shapely.LineString(_prolonged(target.points, reach + 1.0))
