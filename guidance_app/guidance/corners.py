"""Corners of a lap that are worked by backing up.

A lap that cuts a corner on a circle leaves its tip unworked. Where that is worth it, the lap ends after the corner, the
machine backs along the next side to the boundary (or into the lap outside), and starts that side from there. Where the
boundary bends in behind it, a straight way back would end as soon as the implement's end comes too near: the machine
then backs up on a wide circle.
"""

import math
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from shapely import LineString, Polygon

from guidance_app.guidance.clearance import ARC
from guidance_app.guidance.lap import Corner
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.ring import LONG, Ring
from guidance_app.guidance.room import BoolArray
from guidance_app.model import FloatArray

__all__ = ["ON_THE_LINE", "CornerFinder"]

ON_THE_LINE = 0.02
"""Metres within which a point counts as lying on a line."""

BESIDE = 0.2
"""Metres within which a lap that was evened still follows the ground that its arc cut off."""

WORTH = 0.2
"""A corner of which more than this part of the working width would stay unworked is worth backing up for."""

LIFT = 1.0
"""A corner is followed until the lap is this near to the next side, in halves of the working width."""

RUN_OUT = 1.5
"""Metres after a corner within which its next side is looked for; a bent one is then followed from there."""

SHORTEST_BACK = 1.0
"""Metres; nobody stops to back up by less."""

TIP = 0.7
"""Part of the working width, about its middle, that still finds unworked ground while it is worth backing on."""

STEP = 0.25
"""Metres between the places where a side may begin."""

BENDS = (0.0, 0.025, 0.05, 0.1, 0.2)
"""Of the turning circle's bend: how much the way back may bend away from the boundary."""


class CornerFinder:
    """Finds the corners of laps at one distance from the boundary.

    ``cuts`` is what the laps' arcs cut off the ground at this distance, ``inset`` the distance.
    """

    def __init__(self, ground: Polygon, cuts: Sequence[Polygon], inset: float, request: PlanRequest) -> None:
        self._ground = ground.buffer(ON_THE_LINE)
        self._cuts = cuts
        self._half_width = request.width / 2
        self._half_length = request.length / 2
        self._inward = -1.0 if request.laps_clockwise else 1.0
        self._radius = request.path_radius
        self._growth = 1.0 + self._half_width / request.path_radius
        self._worth = WORTH * request.width
        outside = inset - self._half_width
        self._unworked = ground.buffer(-outside, quad_segs=ARC) if outside > ON_THE_LINE else None
        shapely.prepare(self._ground)
        shapely.prepare(self._unworked)

    def corners(self, ring: Ring) -> tuple[Corner, ...]:
        """The corners worth backing up for, in driving order."""
        line = LineString(np.vstack([ring.points, ring.points[:1]]))
        found = (self._corner(ring, line, cut) for cut in self._cuts)
        ordered = sorted((each for each in found if each is not None), key=lambda corner: corner.end)
        return tuple(_apart(ordered))

    def _corner(self, ring: Ring, line: LineString, cut: Polygon) -> Corner | None:
        tips = shapely.get_coordinates(cut.exterior)
        apart: FloatArray = np.asarray(shapely.distance(line, shapely.points(tips)))
        touching = tips[apart < BESIDE]
        deepest = int(np.argmax(apart))
        if apart[deepest] * self._growth < self._worth or len(touching) < 2:
            return None
        along = shapely.line_locate_point(line, shapely.points(touching))
        first, passed = np.searchsorted(ring.along, [along.min() - ON_THE_LINE, along.max() - ON_THE_LINE])
        last = _straight_from(ring, int(passed))
        if last is None:
            return None
        here, ahead = ring.points[last], ring.points[(last + 1) % len(ring.points)]
        direction = (ahead - here) / np.hypot(*(ahead - here))
        back = self._back(here, direction, float(np.hypot(*(tips[deepest] - here))))
        if back is None:
            return None
        arc = slice(first, last + 1)
        lift = self._lift(ring.along[arc], ring.points[arc] - here, direction)
        return Corner(lift, float(ring.along[last]), back)

    def _back(self, here: FloatArray, direction: FloatArray, tip: float) -> FloatArray | None:
        """The way (N, 2) back from the corner's end: to the boundary, or into what is worked outside.

        It is straight, or bends away from the boundary, whichever gains most ground.
        """
        metres = np.arange(0.0, tip + 2 * self._half_width, STEP)
        bends = np.array(BENDS)[:, None] / self._radius
        inward = self._inward * np.array([-direction[1], direction[0]])
        places, ahead, across = _backed(bends, metres, direction, inward)
        rear, side = here + places - self._half_length * ahead, self._half_width * across
        bars = shapely.linestrings(np.stack([rear - side, rear + side], axis=2))
        possible: BoolArray = np.asarray(shapely.covers(self._ground, bars))
        if self._unworked is not None:
            inner = TIP * side
            possible &= shapely.intersects(
                self._unworked, shapely.linestrings(np.stack([rear - inner, rear + inner], axis=2))
            )
        steps = np.where(possible.all(axis=1), len(metres), np.argmin(possible, axis=1))
        far = metres[np.maximum(steps - 1, 0)]
        best = int(np.argmax(2 * self._half_width * far - bends[:, 0] * far**3 / 6))
        if far[best] < SHORTEST_BACK:
            return None
        count = 2 if bends[best] == 0 else math.ceil(far[best]) + 1
        way: FloatArray = here + places[best, np.linspace(0, steps[best] - 1, count).astype(int)]
        return way

    def _lift(self, along: FloatArray, points: FloatArray, direction: FloatArray) -> float:
        """Where the lap has come into the swath of the next side, so that the implement may be lifted."""
        aside = np.abs(points @ np.array([-direction[1], direction[0]]))
        return float(along[int(np.argmax(aside <= LIFT * self._half_width))])


def _backed(
    bends: FloatArray, metres: FloatArray, direction: FloatArray, inward: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Where a machine is that backed up on circles, which way it points, and what is inward of it; (B, M, 2) each."""
    turned = (bends * metres)[..., None]
    behind = metres[:, None] * np.sinc(turned / np.pi)
    beside = metres[:, None] * turned / 2 * np.sinc(turned / 2 / np.pi) ** 2
    ahead = np.cos(turned) * direction - np.sin(turned) * inward
    across = np.sin(turned) * direction + np.cos(turned) * inward
    return beside * inward - behind * direction, ahead, across


def _straight_from(ring: Ring, place: int) -> int | None:
    """The point from which the lap runs straight after a corner, or as near to straight as it comes."""
    following = np.append(ring.along[1:], ring.length)
    for number in range(place, len(following)):
        if following[number] - ring.along[number] > LONG or ring.along[number] - ring.along[place] > RUN_OUT:
            return number
    return None


def _apart(corners: Sequence[Corner]) -> Iterator[Corner]:
    """The corners without those that begin before the one before is passed."""
    passed = 0.0
    for corner in corners:
        if corner.lift > passed:
            yield corner
            passed = corner.end
