"""Which way the tractor travels, from the fixes alone: a heading over a baseline of at least one metre.

Used by the filters that have no model of their own for the heading. A baseline that turns by more than 110 degrees
between two looks is a tractor that backs up, not one that turns: at the tightest radius of 0.5 m a metre turns it by
115 degrees only if it never straightens. Backing for more than 30 m is not believed; the tractor then goes forward.
Places are medians of three fixes, so that one outlier is neither a baseline nor a reversal.
"""

import math
from dataclasses import dataclass

from guidance_app.angles import heading_between, wrap_2pi, wrap_pi

__all__ = ["Travel"]

BASELINE = 1.0
"""A heading is read over at least this many metres."""
SPACING = 0.1
"""Fixes nearer to the last kept one than this tell nothing new about the direction."""
REVERSAL = math.radians(110)
LONGEST_BACKING = 30.0


@dataclass(frozen=True, slots=True)
class Travel:
    """The last metre driven, the heading it gives, and whether the tractor backs up. ``heading`` is the body's.

    ``fixes`` are the last two, ``points`` the medians kept.
    """

    points: tuple[tuple[float, float], ...] = ()
    heading: float | None = None
    reverse: bool = False
    backed: float = 0.0
    fixes: tuple[tuple[float, float], ...] = ()

    def to(self, east: float, north: float, compass: float | None = None) -> "Travel":
        """After one more fix. ``compass`` is a measured heading of the body; it decides which way is forward."""
        three = (*self.fixes, (east, north))
        fixes = three[-2:]
        if len(three) < 3:
            return self._with(fixes, compass)
        here = (sorted(e for e, _ in three)[1], sorted(n for _, n in three)[1])
        if self.points and math.dist(self.points[-1], here) < SPACING:
            return self._with(fixes, compass)
        step = math.dist(self.points[-1], here) if self.points else 0.0
        backed = self.backed + step if self.reverse else 0.0
        far = next(
            (i for i in range(len(self.points) - 1, -1, -1) if math.dist(self.points[i], here) >= BASELINE), None
        )
        kept = (*self.points, here) if far is None else (*self.points[far:], here)
        if far is None:
            heading = compass if compass is not None else self.heading
            return Travel(kept[-64:], heading, self.reverse, backed, fixes)
        course = heading_between(self.points[far], here)
        heading, reverse, backed = self._turned(course, compass, backed)
        return Travel(kept, heading, reverse, backed, fixes)

    def _with(self, fixes: tuple[tuple[float, float], ...], compass: float | None) -> "Travel":
        """The same way with newer fixes."""
        heading = self.heading if compass is None else compass
        return Travel(self.points, heading, self.reverse, self.backed, fixes)

    def _turned(self, course: float, compass: float | None, backed: float) -> tuple[float, bool, float]:
        """Heading, reverse and metres backed with a new baseline's direction."""
        if compass is not None:
            return compass, abs(wrap_pi(course - compass)) > math.pi / 2, 0.0
        if backed > LONGEST_BACKING:
            return course, False, 0.0
        reverse = self.reverse
        body = wrap_2pi(course + math.pi) if reverse else course
        if self.heading is not None and abs(wrap_pi(body - self.heading)) > REVERSAL:
            reverse = not reverse
            body = wrap_2pi(body + math.pi)
        return body, reverse, backed if reverse else 0.0
