"""Which way round a pass is driven: as the plan or the driver says until the tractor is on it, then by the heading."""

import math
from dataclasses import dataclass

from guidance_app.angles import wrap_pi
from guidance_app.guidance.polyline import Foot
from guidance_app.guidance.reading import ALIGNED, Seen, off_axis

__all__ = ["TravelDirection", "drives_against"]

HYSTERESIS = math.radians(20)
"""So far past square to the pass the heading has to turn before the direction of travel is the other one."""


def drives_against(heading: float, direction: float, before: bool | None) -> bool:
    """Whether a line is driven against its direction; near square to it, what was so before stays."""
    turned = abs(wrap_pi(heading - direction))
    if before is None:
        return turned > math.pi / 2
    return turned > (math.pi / 2 - HYSTERESIS if before else math.pi / 2 + HYSTERESIS)


@dataclass(slots=True)
class TravelDirection:
    """The direction of travel on the present pass. A plain copy of it is independent.

    ``meant`` is the way round that holds although the heading may say otherwise: the plan's, until the tractor drives
    along the pass either way; the driver's wish, until it drives along the pass that way.
    """

    against: bool | None = None
    meant: bool | None = None
    wished: bool = False

    def begin(self, *, planned: bool) -> None:
        """On to another pass, planned in the order of its points or not at all."""
        self.against, self.meant, self.wished = None, False if planned else None, False

    def turn_round(self) -> None:
        """The driver wants it the other way round."""
        self.against = self.meant = not self.against
        self.wished = True

    def flip(self) -> None:
        """The same direction of travel on a line whose points come in the opposite order."""
        self.against = None if self.against is None else not self.against
        self.meant = None if self.meant is None else not self.meant

    def step(self, seen: Seen, foot: Foot, within: float) -> bool:
        """Whether the pass is driven against the order of its points; on it means within so many metres."""
        if self.meant is None:
            self.against = drives_against(seen.heading, foot.direction, self.against)
            return self.against
        by_heading = drives_against(seen.heading, foot.direction, None)
        along = seen.heading_known and off_axis(seen.heading, foot.direction) <= ALIGNED
        if along and foot.distance <= within and (by_heading == self.meant or not self.wished):
            self.against, self.meant, self.wished = by_heading, None, False
        else:
            self.against = self.meant
        return self.against
