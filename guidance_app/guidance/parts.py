"""The parts of a field: what a gap too narrow for a lap divides, each with laps and passes of its own.

A part is worked to its end before the next one is begun, so that the way through the gap is driven once.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import Polygon

from guidance_app.guidance.bundle import Bundle, Run
from guidance_app.guidance.lap import Lap
from guidance_app.model import FloatArray

__all__ = ["Part", "next_laps", "parts_in"]


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Laps, and the ways to drive each bundle of passes."""

    laps: tuple[Lap, ...]
    choices: tuple[Sequence[Run], ...]

    def away(self, place: FloatArray) -> float:
        """Metres from a place (2,) or a pose (3,) to the nearest point of a pass or a lap."""
        points = [lap.points for lap in self.laps]
        points += [line for runs in self.choices for line in runs[0].lines]
        return min(float(np.hypot(*(each - place[:2]).T).min()) for each in points)


def parts_in(laps: Sequence[Lap], choices: Sequence[Sequence[Run]]) -> list[Part]:
    """All laps and passes, by the outermost lap that encloses them or is the nearest; one part where there is one."""
    rings = [Polygon(lap.points) for lap in laps]
    outer = [ring for ring in rings if not any(_within(ring, other) for other in rings)]
    if len(outer) < 2:
        return [Part(tuple(laps), tuple(choices))]
    of_laps = [_enclosing(outer, _place_on(lap.points)) for lap in laps]
    of_choices = [_enclosing(outer, _middle(runs[0].bundle)) for runs in choices]
    return [
        Part(
            tuple(lap for lap, part in zip(laps, of_laps, strict=True) if part == number),
            tuple(runs for runs, part in zip(choices, of_choices, strict=True) if part == number),
        )
        for number in range(len(outer))
    ]


def next_laps(left: Sequence[Lap], *, inward: bool) -> list[Lap]:
    """Those laps about one ring of the boundary that may come next: nothing before them encloses them, or they it.

    From the boundary inward or the other way.
    """
    first, *others = sorted(left, key=lambda lap: lap.place, reverse=not inward)
    return [first, *(lap for lap in others if not any(_waits(lap, other, inward=inward) for other in left))]


def _waits(lap: Lap, other: Lap, *, inward: bool) -> bool:
    before = other.place < lap.place if inward else other.place > lap.place
    if not before:
        return False
    one, two = Polygon(lap.points), Polygon(other.points)
    return _within(one, two) or _within(two, one)


def _within(one: Polygon, other: Polygon) -> bool:
    return one is not other and one.area < other.area and bool(other.intersects(_place_on(one.exterior.coords[:1])))


def _enclosing(outer: Sequence[Polygon], place: shapely.Point) -> int:
    return int(np.argmin(shapely.distance(list(outer), place)))


def _place_on(points: FloatArray | Sequence[tuple[float, ...]]) -> shapely.Point:
    return shapely.Point(points[0][:2])


def _middle(bundle: Bundle) -> shapely.Point:
    line = bundle.lines[len(bundle.lines) // 2][0]
    return shapely.Point(math.fsum(line[:, 0]) / 2, math.fsum(line[:, 1]) / 2)
