"""The headland: laps along the boundary and round the obstacles, and the mainland that they enclose.

A lap keeps its distance from the boundary and never bends more than the machine can: where the boundary turns away, it
swings out round the corner on a circle; where the boundary turns in, it cuts the corner on a circle. What such a cut
leaves unworked is worked by backing up: the lap then ends after the corner, the machine backs along the next side to
the boundary, and starts that side from there. A lap with such corners is a row of sides.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import LineString, Polygon

from guidance_app.guidance.lap import Corner, Lap
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.ring import Ring
from guidance_app.model import FloatArray

__all__ = ["Headland", "Lap", "default_depth", "headland_of", "parts_of"]

ARC = 16
"""Chords in a quarter circle of a rounded corner: 7 mm from the circle at a radius of 6 m."""

SMALLEST = 1.0
"""Square metres; smaller leftovers of an offset are not ground."""

SHORTEST = 0.05
"""Metres between neighbouring points of a lap."""

ON_THE_LINE = 0.03
"""Metres within which a point counts as lying on a line."""

BEND = math.radians(3.0)
"""A boundary that turns away by less at a corner is straight there."""

RADIUS_MARGIN = 1.002
"""Laps are laid on circles wider by this, so that their chords do not bend more than the turning radius."""

WORTH = 0.2
"""A corner of which more than this part of the working width would stay unworked is worth backing up for."""

LIFT = 1.0
"""A corner is followed until the lap is this near to the next side, in halves of the working width."""

STEP = 0.25
"""Metres between the places where a side may begin."""


@dataclass(frozen=True, slots=True, eq=False)
class Headland:
    """Laps outermost first, the mainland's parts (none when the laps take all), and the depth between."""

    depth: float
    laps: tuple[Lap, ...]
    mainland: tuple[Polygon, ...]


def parts_of(geometry: shapely.Geometry, smallest: float = SMALLEST) -> tuple[Polygon, ...]:
    """The polygons in a geometry, without slivers."""
    return tuple(part for part in shapely.get_parts(geometry) if isinstance(part, Polygon) and part.area > smallest)


def default_depth(request: PlanRequest) -> float:
    """Metres that a square turn needs: radius, half the implement, and what the tractor overruns the pass's end."""
    overrun = max(request.offset_back, 0.0)
    half = max(request.width / 2, request.body.half_width + abs(request.offset_right))
    swing = math.hypot(request.path_radius + half, request.offset_back + request.length / 2)
    return overrun + swing


def headland_of(ground: Polygon, request: PlanRequest) -> Headland:
    """Laps and mainland for the wished turning space, or the space that a turn needs."""
    rest = (request.width - request.spacing) / 2
    count, depth = _count_and_depth(request, rest)
    step = (depth - rest) / count if count else request.spacing
    laps: list[Lap] = []
    for place in range(count):
        laps.extend(_laps_at(ground, place, request.width / 2 + place * step, request))
    mainland = parts_of(ground.buffer(-depth, quad_segs=ARC)) if count else (ground,)
    return Headland(depth if count else 0.0, tuple(laps), mainland)


def _count_and_depth(request: PlanRequest, rest: float) -> tuple[int, float]:
    if request.laps is not None:
        return request.laps, request.laps * request.spacing + rest
    if request.turning_space is not None:
        count = math.ceil(max(0.0, request.turning_space - rest) / request.spacing - 1e-6)
        return count, max(request.turning_space, rest)
    count = max(1, math.ceil((default_depth(request) - rest) / request.spacing))
    return count, count * request.spacing + rest


# --- one distance from the boundary ----------------------------------------------------------------------------------


def _laps_at(ground: Polygon, place: int, inset: float, request: PlanRequest) -> Iterator[Lap]:
    """The rings at one distance from the boundary."""
    radius = request.path_radius * RADIUS_MARGIN
    free = ground.buffer(-inset, quad_segs=ARC)
    if inset < radius:
        free = free.difference(_swings(ground, inset, radius))
    drivable = shapely.orient_polygons(free.buffer(-radius, quad_segs=ARC).buffer(radius, quad_segs=ARC))
    cuts = parts_of(free.difference(drivable), 0.1) if request.square_corners and request.reverse_allowed else ()
    corners = _Corners(ground, cuts, request)
    for part in parts_of(drivable):
        for ring in (part.exterior, *part.interiors):
            points = _driven(ring, clockwise=request.laps_clockwise)
            yield corners.lap(place, points)


def _swings(ground: Polygon, inset: float, radius: float) -> shapely.Geometry:
    """Circles that a lap has to go round where the boundary turns away from it too sharply."""
    discs: list[shapely.Geometry] = []
    for ring in (ground.exterior, *ground.interiors):
        depth = radius - inset
        if ring is not ground.exterior:
            circle = shapely.minimum_bounding_circle(ring)
            reach = math.sqrt(circle.area / math.pi)
            if reach + inset <= radius:
                discs.append(circle.centroid.buffer(radius, quad_segs=ARC))
                continue
            depth = min(depth, reach)
        points, outward = _corners_away(ring)
        discs.extend(shapely.buffer(shapely.points(points + outward * depth), radius, quad_segs=ARC))
    return shapely.union_all(discs) if discs else Polygon()


def _corners_away(ring: shapely.LinearRing) -> tuple[FloatArray, FloatArray]:
    """Corners (N, 2) where the ground's boundary turns away from the ground, and unit vectors out of the ground.

    The ground lies left of the ring, so such a corner bends to the right.
    """
    points = shapely.get_coordinates(ring)[:-1]
    before = points - np.roll(points, 1, axis=0)
    after = np.roll(before, -1, axis=0)
    yaw = np.arctan2(before[:, 1], before[:, 0])
    turn = np.mod(np.arctan2(after[:, 1], after[:, 0]) - yaw + np.pi, 2 * np.pi) - np.pi
    away = turn < -BEND
    out = (yaw + turn / 2 - np.pi / 2)[away]
    return points[away], np.column_stack([np.cos(out), np.sin(out)])


def _driven(ring: shapely.LinearRing, *, clockwise: bool) -> FloatArray:
    """Points of a ring with the ground on its left, in driving order, from the middle of its longest straight."""
    points = shapely.get_coordinates(shapely.simplify(ring, 0.005))[:-1]
    apart = np.hypot(*(points - np.roll(points, 1, axis=0)).T)
    points = points[apart > SHORTEST]
    if clockwise:
        points = points[::-1]
    following = np.roll(points, -1, axis=0)
    longest = int(np.argmax(np.hypot(*(following - points).T)))
    middle = (points[longest] + following[longest]) / 2
    return np.concatenate([[middle], np.roll(points, -longest - 1, axis=0)])


# --- corners that are worked by backing up ---------------------------------------------------------------------------


class _Corners:
    """Finds where a lap's rounded corner would leave too much unworked."""

    def __init__(self, ground: Polygon, cuts: tuple[Polygon, ...], request: PlanRequest) -> None:
        self._ground = ground.buffer(ON_THE_LINE)
        self._cuts = cuts
        self._half_width = request.width / 2
        self._half_length = request.length / 2
        self._growth = 1.0 + self._half_width / request.path_radius
        self._worth = WORTH * request.width
        shapely.prepare(self._ground)

    def lap(self, place: int, points: FloatArray) -> Lap:
        """The lap along the closed ``points``."""
        ring = LineString(np.vstack([points, points[:1]]))
        found = (self._corner(ring, cut) for cut in self._cuts)
        corners = sorted((each for each in found if each is not None), key=lambda corner: corner.end)
        return Lap(place, Ring(points), tuple(_apart(corners)))

    def _corner(self, ring: LineString, cut: Polygon) -> Corner | None:
        """The corner that the lap cuts off, if it is worth backing up for."""
        tips = shapely.get_coordinates(cut.exterior)
        apart = shapely.distance(ring, shapely.points(tips))
        touching = tips[apart < ON_THE_LINE]
        deepest = int(np.argmax(apart))
        if apart[deepest] * self._growth < self._worth or len(touching) < 2:
            return None
        along = shapely.line_locate_point(ring, shapely.points(touching))
        begin, end = float(along.min()), float(along.max())
        here = np.array(ring.interpolate(end).coords[0])
        ahead = np.array(ring.interpolate(min(end + 0.2, ring.length)).coords[0])
        direction = (ahead - here) / np.hypot(*(ahead - here))
        metres = self._back(here, direction, float(np.hypot(*(tips[deepest] - here))))
        if metres is None:
            return None
        return Corner(self._lift(ring, (begin, end), here, direction), end, here - metres * direction)

    def _back(self, here: FloatArray, direction: FloatArray, tip: float) -> float | None:
        """How far the implement stays inside when it is backed up from the corner's end along the next side."""
        across = np.array([-direction[1], direction[0]]) * self._half_width
        metres = np.arange(0.0, tip + self._half_width, STEP)
        rear = here - (metres + self._half_length)[:, None] * direction
        bars = shapely.linestrings(np.stack([rear - across, rear + across], axis=1))
        inside = shapely.covers(self._ground, bars)
        steps = len(metres) if inside.all() else int(np.argmin(inside))
        return float(metres[steps - 1]) if steps > 1 else None

    def _lift(self, ring: LineString, arc: tuple[float, float], here: FloatArray, direction: FloatArray) -> float:
        """Where the lap has come into the swath of the next side, so that the implement may be lifted."""
        along = np.arange(arc[0], arc[1], STEP)
        points = shapely.get_coordinates(shapely.line_interpolate_point(ring, along))
        aside = np.abs((points - here) @ np.array([-direction[1], direction[0]]))
        within = aside <= LIFT * self._half_width
        return float(along[int(np.argmax(within))]) if within.any() else arc[1]


def _apart(corners: list[Corner]) -> Iterator[Corner]:
    """The corners without those that begin before the one before is passed."""
    passed = 0.0
    for corner in corners:
        if corner.lift > passed:
            yield corner
            passed = corner.end
