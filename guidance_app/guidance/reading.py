"""The guided point against one pass, in the direction of travel.

The direction of travel is where the tractor points, not where the gear moves it: backing up a few metres turns
neither the sides nor the along-track distance round, and the heading error stays small.
"""

import math
from typing import NamedTuple

from guidance_app.angles import wrap_pi
from guidance_app.guidance.itinerary import GuideLine
from guidance_app.guidance.polyline import Foot

__all__ = ["ALIGNED", "Reading", "Seen", "drives_against", "off_axis", "read_off"]

ALIGNED = math.radians(45)
"""A tractor turned less than this from a pass, either way round, is driving along it."""

HYSTERESIS = math.radians(20)
"""So far past square to the pass the heading has to turn before the direction of travel is the other one."""


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

    ``lateral`` is the cross-track seen in the order of the points, ``off_axis`` the angle to the pass, either way
    round. ``on_pass`` is within half a spacing, between both ends, and aligned.
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


def drives_against(heading: float, direction: float, before: bool | None) -> bool:
    """Whether a line is driven against its direction; near square to it, what was so before stays."""
    turned = abs(wrap_pi(heading - direction))
    if before is None:
        return turned > math.pi / 2
    return turned > (math.pi / 2 - HYSTERESIS if before else math.pi / 2 + HYSTERESIS)


def read_off(line: GuideLine, foot: Foot, seen: Seen, spacing: float, *, against: bool) -> Reading:
    """All signs turned into the direction of travel."""
    direction = foot.direction + math.pi if against else foot.direction
    rest = line.polyline.length - foot.along
    along, to_end = (rest, foot.along) if against else (foot.along, rest)
    axis = off_axis(seen.heading, foot.direction)
    between_ends = line.target.endless or (along >= 0 and to_end >= 0)
    near = abs(foot.cross) <= 0.5 * spacing and foot.distance <= 0.5 * spacing + 1e-9
    return Reading(
        line=line,
        foot=foot,
        against=against,
        cross_track=-foot.cross if against else foot.cross,
        heading_error=wrap_pi(seen.heading - direction),
        along=along,
        to_end=to_end,
        off_axis=axis,
        on_pass=near and between_ends and seen.heading_known and axis <= ALIGNED,
    )
