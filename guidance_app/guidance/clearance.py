"""Where a machine of a certain turning radius may drive at a certain distance from the boundary.

The ground that lies so far inside, less what cannot be driven round: where the boundary turns away from the ground too
sharply (a spur, an obstacle's corner) a piece of a circle is taken away too, so that whatever follows the edge swings
out round the tip on that circle. A taut string in this ground, and the edge of its opening by the same circle, are
drivable but for the corners in between.
"""

import math
from collections.abc import Iterator

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from guidance_app.model import FloatArray

__all__ = ["ARC", "free_ground", "obstacles_within", "parts_of"]

ARC = 16
"""Chords in a quarter circle: 7 mm from the circle at a radius of 6 m."""

SMALLEST = 1.0
"""Square metres; smaller leftovers of an offset are not ground."""

BEND = math.radians(10.0)
"""Where the boundary turns away by less at a corner, a line need not swing out: blunting it costs a centimetre."""

MOST_ROUND = math.radians(165.0)
"""Half the angle of the longest arc round a tip."""

BLUNT = 0.3
"""Metres within which a boundary's corners count as one."""

NEAR = 1.8
"""Corners nearer to each other than this many times the room between circle and inset are one tip."""


def parts_of(geometry: BaseGeometry, smallest: float = SMALLEST) -> tuple[Polygon, ...]:
    """The polygons in a geometry, without slivers."""
    return tuple(part for part in shapely.get_parts(geometry) if isinstance(part, Polygon) and part.area > smallest)


def free_ground(ground: Polygon, inset: float, radius: float) -> BaseGeometry:
    """What lies ``inset`` inside and can be driven round; ``ground`` is oriented, its outer ring counter-clockwise."""
    free = ground.buffer(-inset, quad_segs=ARC)
    if inset >= radius:
        return free
    taken = [_around(ring, inset, radius) for ring in ground.interiors]
    taken.append(list(_segments(shapely.simplify(ground.exterior, BLUNT), inset, radius)))
    pieces = [piece for some in taken for piece in some]
    return free.difference(shapely.union_all(pieces)) if pieces else free


def obstacles_within(ground: Polygon, ring: shapely.LinearRing, radius: float) -> shapely.LinearRing | None:
    """A wide line round the obstacles inside ``ring``, drivable whatever they are; None where there are none."""
    inside = Polygon(ring)
    obstacles = [hole for hole in map(Polygon, ground.interiors) if inside.intersects(hole)]
    if not obstacles:
        return None
    wide = shapely.union_all(obstacles).convex_hull.buffer(radius, quad_segs=ARC)
    return shapely.orient_polygons(wide, exterior_cw=True).exterior


def _around(ring: shapely.LinearRing, inset: float, radius: float) -> list[BaseGeometry]:
    """What an obstacle takes: an oval about its middle line if it is small, else the pieces at its tips."""
    core = _core(ring)
    if shapely.hausdorff_distance(core, ring) + inset <= radius:
        return [core.buffer(radius, quad_segs=ARC)]
    return list(_segments(shapely.simplify(ring, BLUNT), inset, radius))


def _core(ring: shapely.LinearRing) -> BaseGeometry:
    """The middle line of the smallest rectangle around."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(ring))
    sides = corners[1:3] - corners[:2]
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    long, short = int(np.argmax(lengths)), float(lengths.min())
    middle = (corners[0] + corners[2]) / 2
    half = sides[long] / lengths[long] * (lengths[long] - short) / 2
    return shapely.LineString([middle - half, middle + half]) if np.any(half) else shapely.Point(middle)


def _segments(ring: shapely.LinearRing, inset: float, radius: float) -> Iterator[Polygon]:
    """A piece of a circle for each tip where the boundary turns away; the ground lies left of the ring.

    The circle lies ``inset`` off the tip's corners. Its arc ends where it is nearer to the edges than the line is.
    """
    points = shapely.get_coordinates(ring)[:-1]
    before = points - np.roll(points, 1, axis=0)
    after = np.roll(before, -1, axis=0)
    yaw = np.arctan2(before[:, 1], before[:, 0])
    turn = np.mod(np.arctan2(after[:, 1], after[:, 0]) - yaw + np.pi, 2 * np.pi) - np.pi
    depth = radius - inset
    for tip in _tips(points, turn, NEAR * depth):
        half = min(-float(turn[tip].sum()) / 2, MOST_ROUND / 2)
        inward = float(yaw[tip[0]]) - half + math.pi / 2
        out = -np.array([math.cos(inward), math.sin(inward)])
        centre = _centre(points[tip], out, depth)
        if centre is None:
            continue
        off_edge = depth * math.cos(half) + inset
        reach = min(half + math.acos(min(max(off_edge / radius, 0.0), 1.0)) + BEND, MOST_ROUND)
        angles = inward + reach * np.linspace(-1.0, 1.0, 4 * ARC + 1)
        yield Polygon(centre + radius * np.column_stack([np.cos(angles), np.sin(angles)]))


def _centre(corners: FloatArray, out: FloatArray, depth: float) -> FloatArray | None:
    """The place straight out from the corners' middle from which the farthest of them is ``depth`` away."""
    middle = (corners[0] + corners[-1]) / 2
    away = middle - corners
    along = away @ out
    room = depth**2 - (away**2).sum(axis=1) + along**2
    if (room < 0).any():
        return None
    centre: FloatArray = middle + float((np.sqrt(room) - along).min()) * out
    return centre


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
