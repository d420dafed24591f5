"""Follow the last pass: each pass runs beside the one driven before, whatever its shape."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import shapely

from guidance_app.angles import wrap_pi
from guidance_app.guidance.family import offset_line
from guidance_app.guidance.line_type import LineType
from guidance_app.guidance.polyline import Polyline
from guidance_app.model import FloatArray, Pass

__all__ = ["LINE", "LastPass", "following_last"]

THINNED = 0.05
"""How far the line that is followed may stay from the pass that was driven."""

FARTHEST = 20
"""Passes beyond the last one driven that are offered."""


@dataclass(frozen=True, eq=False)
class LastPass:
    """Passes beside those in ``lines`` (by number, all in the direction of pass 0); none before the first is driven.

    A pass that was driven keeps its own line; another runs beside the nearest driven one.
    """

    spacing: float
    lines: Mapping[int, FloatArray] = field(default_factory=dict)
    offset: float = 0.0
    count: None = None

    @cached_property
    def _made(self) -> dict[int, Pass | None]:
        return {}

    @cached_property
    def _tree(self) -> tuple[tuple[int, ...], shapely.STRtree]:
        return tuple(self.lines), shapely.STRtree([shapely.LineString(line) for line in self.lines.values()])

    def pass_numbered(self, number: int) -> Pass | None:
        """None farther than 20 passes from any driven one, and where bends leave no line."""
        if number not in self._made:
            self._made[number] = self._beside(number)
        return self._made[number]

    def _beside(self, number: int) -> Pass | None:
        if not self.lines:
            return None
        nearest = min(self.lines, key=lambda driven: abs(driven - number))
        if abs(nearest - number) > FARTHEST:
            return None
        metres = (number - nearest) * self.spacing + self.offset
        points = offset_line(self.lines[nearest], metres, run_out=4.0 * abs(metres) + 10.0)
        return None if points is None else Pass(number, points, endless=True)

    def nearest_number(self, east: float, north: float) -> int:
        """Counted from the nearest driven pass; 0 before the first."""
        if not self.lines:
            return 0
        numbers, tree = self._tree
        number = numbers[int(tree.nearest(shapely.Point(east, north)))]
        foot = Polyline.through(self.lines[number], endless=True).foot(east, north)
        return number + round((foot.cross - self.offset) / self.spacing)

    def shifted(self, metres: float) -> "LastPass":
        """The same beside passes that lie further to the right."""
        return replace(self, offset=self.offset + metres)

    def driven(self, number: int, points: FloatArray) -> "LastPass":
        """With one more line, where it was driven; what lies beside it follows it from now on."""
        line = shapely.LineString(points)
        thin = shapely.get_coordinates(shapely.simplify(line, THINNED, preserve_topology=False))
        before = self.pass_numbered(number)
        if before is not None and _runs_against(thin, before):
            thin = thin[::-1]
        unmoved = offset_line(thin, -self.offset)
        if unmoved is None:
            return self
        return replace(self, lines={**self.lines, number: unmoved})


def _runs_against(points: FloatArray, before: Pass) -> bool:
    """By most of the line: a driven pass may begin or end with a bend."""
    other = Polyline.of(before)
    steps = np.diff(points, axis=0)
    middles = points[:-1] + 0.5 * steps
    agreement = 0.0
    for (east, north), (to_east, to_north) in zip(middles.tolist(), steps.tolist(), strict=True):
        turned = wrap_pi(np.arctan2(to_east, to_north) - other.foot(east, north).direction)
        agreement += float(np.hypot(to_east, to_north) * np.cos(turned))
    return agreement < 0


def following_last(points: FloatArray, spacing: float) -> LastPass:
    """Beside a first pass through the points, or, without points, beside the first that will be driven."""
    family = LastPass(spacing)
    return family if len(points) < 2 else family.driven(0, points)


LINE = LineType(
    name="last-pass",
    title="Follow the last pass",
    explanation="Drive the first pass as you like; each next one runs beside the one before.",
    family=following_last,
)
