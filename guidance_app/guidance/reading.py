"""The guided point against one pass, in the direction of travel.

The direction of travel is where the tractor points, not where the gear moves it: backing up a few metres turns
neither the sides nor the along-track distance round, and the heading error stays small.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from guidance_app.angles import wrap_pi
from guidance_app.guidance.itinerary import GuideLine
from guidance_app.guidance.polyline import Foot

__all__ = ["ALIGNED", "Reader", "Reading", "Seen", "off_axis"]

ALIGNED = math.radians(45)
"""A tractor turned less than this from a pass, either way round, is driving along it."""

COME, STAY = 0.5, 0.8
"""In swath spacings: so near beside a pass the tractor comes on it, and so near it stays on it."""


CALM = 1.0
"""Metres (on a short pass a quarter of it): nearer to its exit nobody comes on a pass, and so far before its entry
nobody leaves it again."""


class Seen(NamedTuple):
    """One epoch as the choice of the pass needs it."""

    t: float
    east: float
    north: float
    heading: float
    heading_known: bool
    working: bool


class Reading(NamedTuple):
    """Signed as in ``model.Guidance``; ``along`` is negative before the entry, ``to_end`` beyond the exit.

    ``off_axis`` is the angle to the pass, either way round. ``on_pass`` is beside it by at most half a spacing (to come
    there) or by 0.8 of it (to stay), aligned, and with the implement between both ends.
    """

    line: GuideLine
    foot: Foot
    against: bool
    cross_track: float
    heading_error: float
    along: float
    to_end: float
    off_axis: float
    on_pass: bool


def off_axis(heading: float, direction: float) -> float:
    """Angle between a heading and a line without direction, 0 to pi/2."""
    return abs((heading - direction + math.pi / 2) % math.pi - math.pi / 2)


@dataclass(frozen=True, slots=True)
class Reader:
    """``behind`` is how far the implement works behind the guided point."""

    spacing: float
    behind: float = 0.0

    def read(self, line: GuideLine, foot: Foot, seen: Seen, *, against: bool, was_on: bool) -> Reading:
        """All signs turned into the direction of travel."""
        direction = foot.direction + math.pi if against else foot.direction
        rest = line.polyline.length - foot.along
        along, to_end = (rest, foot.along) if against else (foot.along, rest)
        axis = off_axis(seen.heading, foot.direction)
        calm = min(CALM, 0.25 * line.polyline.length)
        after_entry = along - self.behind >= (-calm if was_on else 0.0)
        before_exit = to_end + self.behind >= (0.0 if was_on else calm)
        between = line.target.closed or line.target.endless or (after_entry and before_exit)
        near = abs(foot.cross) <= (STAY if was_on else COME) * self.spacing
        return Reading(
            line=line,
            foot=foot,
            against=against,
            cross_track=-foot.cross if against else foot.cross,
            heading_error=wrap_pi(seen.heading - direction),
            along=along,
            to_end=to_end,
            off_axis=axis,
            on_pass=near and between and seen.heading_known and axis <= ALIGNED,
        )
