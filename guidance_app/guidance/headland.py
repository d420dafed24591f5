"""The headland: laps along the boundary and round the obstacles, and the mainland that they enclose.

A lap keeps its distance from the boundary and never bends more than the machine can: where the boundary turns away, it
swings out round the tip on a circle; where the boundary turns in, it cuts the corner on a circle, and the corner is
worked by backing up where that is worth it (``corners``).
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from guidance_app.guidance.blunting import eased
from guidance_app.guidance.clearance import ARC, free_ground, obstacles_within, parts_of
from guidance_app.guidance.corners import ON_THE_LINE, CornerFinder
from guidance_app.guidance.lap import Lap
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.ring import LONG, Ring
from guidance_app.model import FloatArray

__all__ = ["Headland", "default_depth", "headland_of", "laps_only"]

RADIUS_MARGIN = 1.05
"""Laps are laid on circles wider by this, a reserve for the driver and for the evening of their lines."""

SLIVER = 0.05
"""Square metres of ground cut off by an arc that are no corner."""

MAINLAND = 0.2
"""Part of the field that the laps by default leave at least; they are fewer in a small field."""


@dataclass(frozen=True, slots=True, eq=False)
class Headland:
    """Laps outermost first, the mainland's parts (none when the laps take all), and the depth between.

    ``undrivable`` counts laps that cannot be driven with the turning radius and are left out.
    """

    depth: float
    laps: tuple[Lap, ...]
    mainland: tuple[Polygon, ...]
    undrivable: int = 0


def default_depth(request: PlanRequest) -> float:
    """Metres that a square turn needs: radius, half the implement, and what the tractor overruns the pass's end."""
    overrun = max(request.offset_back, 0.0)
    half = max(request.width / 2, request.body.half_width + abs(request.offset_right))
    swing = math.hypot(request.path_radius + half, request.offset_back + request.length / 2)
    return overrun + swing


def headland_of(ground: Polygon, request: PlanRequest) -> Headland:
    """Laps and mainland for the wished turning space, or the space that a turn needs.

    Where nothing is left inside, laps take the whole field.
    """
    rest = (request.width - request.spacing) / 2
    count, depth = _count_and_depth(ground, request, rest)
    if not count:
        return Headland(0.0, (), (ground,))
    mainland = parts_of(ground.buffer(-depth, quad_segs=ARC))
    if not mainland:
        return laps_only(ground, request)
    step = (depth - rest) / count
    laps = [_laps_at(ground, place, request.width / 2 + place * step, request) for place in range(count)]
    return _headland(depth, laps, mainland)


def laps_only(ground: Polygon, request: PlanRequest) -> Headland:
    """Laps from the boundary inward until no room is left for one."""
    laps: list[list[Lap | None]] = []
    for place in itertools.count():
        found = _laps_at(ground, place, request.width / 2 + place * request.spacing, request)
        if not found:
            return _headland(place * request.spacing, laps, ())
        laps.append(found)
    raise AssertionError


def _headland(depth: float, found: list[list[Lap | None]], mainland: tuple[Polygon, ...]) -> Headland:
    everything = list(itertools.chain.from_iterable(found))
    laps = tuple(lap for lap in everything if lap is not None)
    return Headland(depth, laps, mainland, len(everything) - len(laps))


def _count_and_depth(ground: Polygon, request: PlanRequest, rest: float) -> tuple[int, float]:
    if request.laps is not None:
        return request.laps, request.laps * request.spacing + rest
    if request.turning_space is not None:
        count = math.ceil(max(0.0, request.turning_space - rest) / request.spacing - 1e-6)
        return count, max(request.turning_space, rest)
    count = max(1, math.ceil((default_depth(request) - rest) / request.spacing))
    while count > 1 and ground.buffer(-count * request.spacing - rest).area < MAINLAND * ground.area:
        count -= 1
    return count, count * request.spacing + rest


def _laps_at(ground: Polygon, place: int, inset: float, request: PlanRequest) -> list[Lap | None]:
    """The laps at one distance from the boundary; None for one that bends too tightly."""
    radius = request.path_radius * RADIUS_MARGIN
    free = free_ground(ground, inset, radius)
    drivable = shapely.orient_polygons(free.buffer(-radius, quad_segs=ARC).buffer(radius, quad_segs=ARC))
    squared = request.square_corners and request.reverse_allowed
    cuts = parts_of(free.difference(drivable.buffer(ON_THE_LINE)), SLIVER) if squared else ()
    finder = CornerFinder(ground, cuts, inset, request)
    return [
        None if points is None else _lap(place, points, ground, finder, request)
        for points in _lines(ground, drivable, radius, request)
    ]


def _lap(place: int, points: FloatArray, ground: Polygon, finder: CornerFinder, request: PlanRequest) -> Lap:
    ring = Ring(_driven(points, clockwise=request.laps_clockwise))
    nest = int(np.argmin(shapely.distance([ground.exterior, *ground.interiors], shapely.linestrings(ring.points))))
    return Lap(place, nest, ring, finder.corners(ring))


def _lines(ground: Polygon, drivable: BaseGeometry, radius: float, request: PlanRequest) -> Iterator[FloatArray | None]:
    """The edges of the drivable ground, bent no tighter than the machine can; the ground lies left of each."""
    for part in parts_of(drivable):
        for number, ring in enumerate((part.exterior, *part.interiors)):
            if ring.length < 2 * radius:
                continue
            points = eased(shapely.get_coordinates(ring)[:-1], request.path_radius)
            if points is None and number:
                wide = obstacles_within(ground, ring, radius)
                points = None if wide is None else eased(shapely.get_coordinates(wide)[:-1], request.path_radius)
            yield points


def _driven(points: FloatArray, *, clockwise: bool) -> FloatArray:
    """A closed line with the ground on its left, in driving order, from the middle of its longest straight."""
    if clockwise:
        points = points[::-1]
    following = np.roll(points, -1, axis=0)
    steps = np.hypot(*(following - points).T)
    longest = int(np.argmax(steps))
    if steps[longest] < LONG:
        return points
    middle = (points[longest] + following[longest]) / 2
    return np.concatenate([[middle], np.roll(points, -longest - 1, axis=0)])
