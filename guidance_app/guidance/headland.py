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

from guidance_app.guidance.blunting import eased
from guidance_app.guidance.lap import Corner, Lap
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.ring import LONG, Ring
from guidance_app.model import FloatArray

__all__ = ["Headland", "Lap", "default_depth", "free_ground", "headland_of", "parts_of"]

ARC = 16
"""Chords in a quarter circle of a rounded corner: 7 mm from the circle at a radius of 6 m."""

SMALLEST = 1.0
"""Square metres; smaller leftovers of an offset are not ground."""

ON_THE_LINE = 0.02
"""Metres within which a point counts as lying on a line."""

BEND = math.radians(10.0)
"""Where the boundary turns away by less at a corner, a lap need not swing out: blunting it costs a centimetre."""

MOST_ROUND = math.radians(165.0)
"""Half the angle of the longest arc."""

BLUNT = 0.3
"""Metres within which a boundary's corners count as one."""

RADIUS_MARGIN = 1.05
"""Laps are laid on circles wider by this, so that their chords do not bend more than the turning radius."""

WORTH = 0.2
"""A corner of which more than this part of the working width would stay unworked is worth backing up for."""

LIFT = 1.0
"""A corner is followed until the lap is this near to the next side, in halves of the working width."""

RUN_OUT = 1.5
"""Metres after a corner within which its next side is looked for; a bent one is then followed from there."""

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
    free = free_ground(ground, inset, radius)
    drivable = shapely.orient_polygons(free.buffer(-radius, quad_segs=ARC).buffer(radius, quad_segs=ARC))
    cuts = (
        parts_of(free.difference(drivable.buffer(ON_THE_LINE)), 0.05)
        if request.square_corners and request.reverse_allowed
        else ()
    )
    corners = _Corners(ground, cuts, request)
    for part in parts_of(drivable):
        for number, ring in enumerate((part.exterior, *part.interiors)):
            if ring.length < 2 * radius:
                continue
            points = eased(shapely.get_coordinates(ring)[:-1], request.path_radius)
            if points is None and number:
                wide = _round(ground, Polygon(ring), radius)
                points = None if wide is None else eased(wide, request.path_radius)
            if points is None:
                print("NOT EASED", place, number, ring.length)
                continue
            yield corners.lap(place, _driven(points, clockwise=request.laps_clockwise))


def _round(ground: Polygon, within: Polygon, radius: float) -> FloatArray | None:
    """A wide lap round the obstacles within a lap, as a ring with the ground on its left."""
    obstacles = [hole for hole in map(Polygon, ground.interiors) if within.intersects(hole)]
    if not obstacles:
        return None
    wide = shapely.union_all(obstacles).convex_hull.buffer(radius, quad_segs=ARC)
    return shapely.get_coordinates(shapely.orient_polygons(wide).exterior)[:0:-1]


def free_ground(ground: Polygon, inset: float, radius: float) -> shapely.Geometry:
    """What lies ``inset`` inside, less the circles that go round where the boundary turns away too sharply."""
    free = ground.buffer(-inset, quad_segs=ARC)
    return free if inset >= radius else free.difference(_swings(ground, inset, radius))


def _swings(ground: Polygon, inset: float, radius: float) -> shapely.Geometry:
    """Pieces of circles round which a lap has to go where the boundary turns away from it too sharply."""
    pieces: list[shapely.Geometry] = []
    for number, ring in enumerate((ground.exterior, *ground.interiors)):
        if number:
            core = _core(ring)
            if shapely.hausdorff_distance(core, ring) + inset <= radius:
                pieces.append(core.buffer(radius, quad_segs=ARC))
                continue
        pieces.extend(_segments(shapely.simplify(ring, BLUNT), inset, radius))
    return shapely.union_all(pieces) if pieces else Polygon()


def _core(ring: shapely.LinearRing) -> shapely.Geometry:
    """The middle line of a small obstacle: round it a lap is an oval."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(ring))
    sides = corners[1:3] - corners[:2]
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    long, short = int(np.argmax(lengths)), float(lengths.min())
    middle = (corners[0] + corners[2]) / 2
    half = sides[long] / lengths[long] * (lengths[long] - short) / 2
    return shapely.linestrings(np.array([middle - half, middle + half])) if np.any(half) else shapely.points(middle)


def _segments(ring: shapely.LinearRing, inset: float, radius: float) -> Iterator[Polygon]:
    """A piece of a circle for each tip where the boundary turns away; the ground lies left of the ring.

    The circle lies ``inset`` off the tip's corners. Its arc ends where it is nearer to the edges than the lap is.
    """
    points = shapely.get_coordinates(ring)[:-1]
    before = points - np.roll(points, 1, axis=0)
    after = np.roll(before, -1, axis=0)
    yaw = np.arctan2(before[:, 1], before[:, 0])
    turn = np.mod(np.arctan2(after[:, 1], after[:, 0]) - yaw + np.pi, 2 * np.pi) - np.pi
    depth = radius - inset
    for tip in _tips(points, turn, 1.8 * depth):
        half = min(-float(turn[tip].sum()) / 2, MOST_ROUND / 2)
        inward = float(yaw[tip[0]]) - half + math.pi / 2
        out = -np.array([math.cos(inward), math.sin(inward)])
        middle = (points[tip[0]] + points[tip[-1]]) / 2
        away = middle - points[tip]
        along = away @ out
        room = depth**2 - (away**2).sum(axis=1) + along**2
        if (room < 0).any():
            continue
        centre = middle + float((np.sqrt(room) - along).min()) * out
        off_edge = depth * math.cos(half) + inset
        reach = min(half + math.acos(min(max(off_edge / radius, 0.0), 1.0)) + BEND, MOST_ROUND)
        angles = inward + reach * np.linspace(-1.0, 1.0, 4 * ARC + 1)
        yield Polygon(centre + radius * np.column_stack([np.cos(angles), np.sin(angles)]))


def _tips(points: FloatArray, turn: FloatArray, widest: float) -> Iterator[list[int]]:
    """Corners where the boundary turns away, by their places; those that follow closely on each other are one tip."""
    away = turn < -BEND
    count = len(points)
    begin = next((place for place in range(count) if not away[place - 1]), 0)
    tip: list[int] = []
    for place in (each % count for each in range(begin, begin + count)):
        if tip and (not away[place] or math.dist(points[place], points[tip[0]]) > widest):
            yield tip
            tip = []
        if away[place]:
            tip.append(place)
    if tip:
        yield tip


def _driven(points: FloatArray, *, clockwise: bool) -> FloatArray:
    """Points of a ring with the ground on its left, in driving order, from the middle of its longest straight."""
    if clockwise:
        points = points[::-1]
    following = np.roll(points, -1, axis=0)
    steps = np.hypot(*(following - points).T)
    longest = int(np.argmax(steps))
    if steps[longest] < LONG:
        return points
    middle = (points[longest] + following[longest]) / 2
    return np.concatenate([[middle], np.roll(points, -longest - 1, axis=0)])


# --- corners that are worked by backing up ---------------------------------------------------------------------------


class _Corners:
    """Finds where a lap's rounded corner would leave too much unworked."""

    def __init__(self, ground: Polygon, cuts: tuple[Polygon, ...], request: PlanRequest) -> None:
        self._ground = ground.buffer(ON_THE_LINE)
        self._rings = [ground.exterior, *ground.interiors]
        self._cuts = cuts
        self._half_width = request.width / 2
        self._half_length = request.length / 2
        self._growth = 1.0 + self._half_width / request.path_radius
        self._worth = WORTH * request.width
        shapely.prepare(self._ground)

    def lap(self, place: int, points: FloatArray) -> Lap:
        """The lap along the closed ``points``."""
        line = LineString(np.vstack([points, points[:1]]))
        ring = Ring(points)
        found = (self._corner(ring, line, cut) for cut in self._cuts)
        corners = sorted((each for each in found if each is not None), key=lambda corner: corner.end)
        nest = int(np.argmin(shapely.distance(self._rings, line)))
        return Lap(place, nest, ring, tuple(_apart(corners)))

    def _corner(self, ring: Ring, line: LineString, cut: Polygon) -> Corner | None:
        """The corner that the lap cuts off, if it is worth backing up for."""
        tips = shapely.get_coordinates(cut.exterior)
        apart = shapely.distance(line, shapely.points(tips))
        touching = tips[apart < 2 * ON_THE_LINE]
        deepest = int(np.argmax(apart))
        if apart[deepest] * self._growth < self._worth or len(touching) < 2:
            return None
        along = shapely.line_locate_point(line, shapely.points(touching))
        first, last = np.searchsorted(ring.along, [along.min() - ON_THE_LINE, along.max() - ON_THE_LINE])
        last = _straight_from(ring, int(last))
        if last is None:
            return None
        here, ahead = ring.points[last], ring.at(ring.along[last : last + 1] + LONG)[0]
        direction = (ahead - here) / np.hypot(*(ahead - here))
        metres = self._back(here, direction, float(np.hypot(*(tips[deepest] - here))))
        if metres is None:
            return None
        arc = slice(first, last + 1)
        lift = self._lift(ring.along[arc], ring.points[arc] - here, direction)
        return Corner(lift, float(ring.along[last]), here - metres * direction)

    def _back(self, here: FloatArray, direction: FloatArray, tip: float) -> float | None:
        """How far the implement stays inside when it is backed up from the corner's end along the next side."""
        across = np.array([-direction[1], direction[0]]) * self._half_width
        metres = np.arange(0.0, tip + self._half_width, STEP)
        rear = here - (metres + self._half_length)[:, None] * direction
        bars = shapely.linestrings(np.stack([rear - across, rear + across], axis=1))
        inside = shapely.covers(self._ground, bars)
        steps = len(metres) if inside.all() else int(np.argmin(inside))
        return float(metres[steps - 1]) if steps > 1 else None

    def _lift(self, along: FloatArray, points: FloatArray, direction: FloatArray) -> float:
        """Where the lap has come into the swath of the next side, so that the implement may be lifted."""
        aside = np.abs(points @ np.array([-direction[1], direction[0]]))
        return float(along[int(np.argmax(aside <= LIFT * self._half_width))])


def _straight_from(ring: Ring, place: int) -> int | None:
    """The point from which the lap runs straight after a corner, or as near to straight as it comes."""
    following = np.append(ring.along[1:], ring.length)
    for number in range(place, len(following)):
        if following[number] - ring.along[number] > LONG or ring.along[number] - ring.along[place] > RUN_OUT:
            return number
    return None


def _apart(corners: list[Corner]) -> Iterator[Corner]:
    """The corners without those that begin before the one before is passed."""
    passed = 0.0
    for corner in corners:
        if corner.lift > passed:
            yield corner
            passed = corner.end
