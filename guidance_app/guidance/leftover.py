"""What laps and passes leave unworked is worked by passes of its own: tongues, strips beside obstacles, narrow fields.

Each leftover gets strips along its longer side. A strip is worked as far as the whole machine stays inside: in a dead
end it stops where the front reaches the boundary, and is driven out of backward.
"""

import math

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from guidance_app.angles import heading_between
from guidance_app.guidance.bundle import Bundle
from guidance_app.guidance.cells import Strips
from guidance_app.guidance.clearance import parts_of
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.room import Room
from guidance_app.guidance.swaths import without_slivers
from guidance_app.model import FloatArray

__all__ = ["leftovers"]

SLIVER = 0.12
"""Working widths; what is narrower than twice this is not worth a pass."""

SMALLEST = 0.5
"""Square working widths; a smaller leftover is not worth the way there, nor one shorter than a radius."""

NEGLIGIBLE = 2e-4
"""Part of the field below which a leftover is left, however large."""

WORTH = 0.3
"""Part of a swath that has to be unworked for a pass."""

STEP = 0.5
"""Metres between the places at which the machine is tried."""

SHORTEST = 0.8
"""Turning radii; a shorter pass is not worth driving."""

SHIFTS = (0.0, 0.15, -0.15, 0.3, -0.3, 0.45, -0.45)
"""Working widths by which a strip is shifted sideways to find room."""


def leftovers(
    ground: Polygon, rest: BaseGeometry, room: Room, request: PlanRequest, heading: float | None = None
) -> list[Bundle]:
    """Strips for every part of ``rest`` that is worth working and has room for the machine.

    ``rest`` is the ground that nothing works yet; the strips run along ``heading`` if given.
    """
    wide = without_slivers(rest, SLIVER * request.width)
    smallest = max(request.width * max(SMALLEST * request.width, request.radius), NEGLIGIBLE * ground.area)
    found = (_strips(part, room, request, heading) for part in parts_of(wide, smallest))
    return [each for each in found if each.lines]


def _strips(part: Polygon, room: Room, request: PlanRequest, heading: float | None) -> Bundle:
    strips = Strips(_long_heading(part) if heading is None else heading, 0.0, request.spacing, 0)
    turned = shapely.transform(part, strips.along_across)
    _, low, _, high = turned.bounds
    count = max(1, math.ceil((high - low) / request.spacing - SLIVER))
    inner = max(0.0, high - low - request.width)
    middles = [(low + high) / 2 + inner * (place / (count - 1) - 0.5 if count > 1 else 0.0) for place in range(count)]
    axes = tuple(strips.east_north(np.eye(2)))
    lines = []
    for middle in middles:
        for reach in _reaches(turned, middle, request.width):
            line = _both_ways(middle, reach, axes, room, request)
            if line is not None:
                lines.append(line)
    return Bundle(tuple(lines), spare=True)


def _reaches(turned: Polygon, middle: float, width: float) -> list[tuple[float, float]]:
    """From where to where a strip crosses a leftover, wherever enough of it is unworked."""
    left, _, right, _ = turned.bounds
    band = shapely.clip_by_rect(turned, left - 1.0, middle - width / 2, right + 1.0, middle + width / 2)
    pieces = [(part.bounds, part.area) for part in parts_of(band, SLIVER)]
    return [(low, high) for (low, _, high, _), area in pieces if area > WORTH * width * (high - low)]


def _long_heading(part: Polygon) -> float:
    """Heading of the longer side of the smallest rectangle around."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(part))
    sides = np.diff(corners[:3], axis=0)
    east, north = sides[int(np.argmax(np.hypot(sides[:, 0], sides[:, 1])))]
    return heading_between((0.0, 0.0), (float(east), float(north)))


def _both_ways(
    middle: float, reach: tuple[float, float], axes: tuple[FloatArray, FloatArray], room: Room, request: PlanRequest
) -> tuple[FloatArray, FloatArray] | None:
    """The line to work along and against the heading, shifted sideways to where it is longest."""
    best: tuple[FloatArray, FloatArray] | None = None
    for shift in SHIFTS:
        off = (middle + shift * request.width) * axes[1]
        there = _line(off, reach, axes[0], room, request)
        back = _line(off, (-reach[1], -reach[0]), -axes[0], room, request)
        if there is None or back is None:
            continue
        if best is None or _length(there) > 1.2 * _length(best[0]):
            best = (there, back)
        if _length(best[0]) > 0.8 * (reach[1] - reach[0]):
            break
    return best


def _line(
    off: FloatArray, reach: tuple[float, float], along: FloatArray, room: Room, request: PlanRequest
) -> FloatArray | None:
    """The longest stretch that can be worked in one direction, from where the machine fits to where it still does."""
    ahead = max(request.offset_back, 0.0)
    places = np.arange(reach[0], reach[1] + ahead + STEP, STEP)
    yaw = math.atan2(along[1], along[0])
    points = off + places[:, None] * along
    fits = room.fits_each(np.column_stack([points, np.full(len(places), yaw)]))
    edges = np.flatnonzero(np.diff(np.concatenate([[False], fits, [False]]).astype(int)))
    runs = [(places[first], places[last - 1]) for first, last in edges.reshape(-1, 2)]
    begin, end = max(runs, key=lambda run: run[1] - run[0], default=(0.0, 0.0))
    end = min(end - ahead, reach[1])
    if end - begin < SHORTEST * request.radius:
        return None
    return off + np.array([[begin], [end]]) * along


def _length(line: FloatArray) -> float:
    return math.dist(line[0], line[1])
