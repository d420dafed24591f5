"""Which pass is guided along, with hysteresis: the search must not jump to another line.

A pass on which the implement works is kept, however far the tractor drifts, until the implement is lifted, a lap has
come round, or the tractor has turned away by more than 60 degrees (somebody who turns with the implement down). Then,
in this order:

1. A pass that the driver took stays until the tractor has been on it.
2. A done pass that has been left, over its end or by turning away, gives way to the next of the order.
3. Where the implement is lowered off the target, a pass within half a spacing and along the heading is meant, done or
   not, if it is nearer by a fifth of a spacing.
4. A pass not yet done that is nearer by a fifth of a spacing and within 30 degrees of the heading, for a second and
   two metres, takes over. If it is not the next of a plan's order under way, it has to be so for three seconds and
   ten metres: a lap's square corner or a way along another pass is not a wish to drive that one. On the planned way
   to the target nothing takes over.
5. Without a plan, who drives across the passes with the implement up and has left the target behind is shown the
   nearest one, done or not: where the tractor is, not what it has to do next.
"""

import copy
import math
from collections.abc import Set

from guidance_app.guidance.itinerary import GuideLine, Itinerary
from guidance_app.guidance.progress import Progress
from guidance_app.guidance.reading import COME, Reading, Seen, off_axis

__all__ = ["ENDLESS_DONE", "Choice"]

TURNED_AWAY = math.radians(60)
"""Turned so far from the pass, the tractor has left it even with the implement down."""

LEFT = math.radians(30)
"""Turned so far from a done pass with the implement up, the tractor has left it."""

AT_END = 1.0
"""Metres: so near the end of a done pass, with the implement up, the pass is over."""

ALONG = math.radians(30)
"""Another pass is considered only when the tractor points along it within this."""

CLEARLY_NEARER = 0.2
"""In swath spacings: by so much another pass has to be nearer."""

BEHIND = 1.2
"""In swath spacings: so far away the target has been left behind by who drives across."""

SETTLED = (1.0, 2.0)
SETTLED_AGAINST_PLAN = (3.0, 10.0)
"""For so long (s) and so far (m) another pass has to be the better one."""

ENDLESS_DONE = 20.0
"""An endless pass has no length: it counts as done when it is left after so many metres of work."""

LAP_CLOSED = 2.0
"""Metres of a lap that may be missing when it is finished with the implement down."""


class Choice:
    """Remembers what the driver has taken, whether the pass is engaged, and since when another one is better."""

    def __init__(self, itinerary: Itinerary, spacing: float) -> None:
        self.itinerary = itinerary
        self.spacing = spacing
        self.held = False
        self.engaged = False
        self._engaged_against: bool | None = None
        self._was_working = False
        self._better: int | None = None
        self._better_since = (0.0, 0.0, 0.0)
        self._crossed: int | None = None

    def fork(self) -> "Choice":
        """An independent copy."""
        return copy.copy(self)

    def begin(self, *, held: bool) -> None:
        """On to another target; when it is held (the driver has chosen it), to no other until the tractor was there."""
        self.held, self.engaged = held, False
        self._engaged_against = self._better = None

    def step(self, seen: Seen, reading: Reading, progress: Progress, side: int) -> int:
        """The key to guide along now. ``side`` as in ``Itinerary.following``."""
        key = reading.line.key
        lowered = seen.working and not self._was_working
        self._was_working = seen.working
        self._engage(seen, reading)
        if self.engaged and not _lap_closed(reading.line, progress):
            self._better = None
            return key
        if self._is_over(reading, progress):
            following = self.itinerary.following(key, progress.done, side or _turned_to(reading))
            return key if following is None else following
        if lowered and not reading.on_pass:
            return self._lowered_on(seen, reading)
        if self.held or self._on_the_way(seen, key):
            self._better = None
            return key
        if self._has_crossed_over(seen, reading):
            self._crossed = self._nearest(seen, key)
            return self._crossed
        return self._settled(seen, reading, progress)

    def _engage(self, seen: Seen, reading: Reading) -> None:
        if reading.on_pass:
            self.held = False
        turned_round = self.engaged and reading.against != self._engaged_against
        if not seen.working or reading.off_axis > TURNED_AWAY or turned_round:
            self.engaged = False
        elif reading.on_pass:
            self.engaged, self._engaged_against = True, reading.against

    def _is_over(self, reading: Reading, progress: Progress) -> bool:
        """Whether the target is done and has been left; one that is only driven across has not been driven."""
        if self.held or not _is_done(reading.line, progress):
            return False
        return self.engaged or (reading.line.key != self._crossed and self._has_left(reading))

    def _has_left(self, reading: Reading) -> bool:
        """The done target: at its end, turned away, or turned round on the spot."""
        target = reading.line.target
        at_end = not target.closed and not target.endless and reading.to_end <= AT_END
        turned_round = self._engaged_against is not None and reading.against != self._engaged_against
        return at_end or turned_round or reading.off_axis > LEFT

    def _on_the_way(self, seen: Seen, key: int) -> bool:
        way = self.itinerary.way_to(key)
        return way is not None and way.passes_by(seen.east, seen.north, COME * self.spacing)

    def _lowered_on(self, seen: Seen, reading: Reading) -> int:
        distance, nearest = self._nearest_along(seen, reading.line.key, frozenset())
        if nearest is None or distance > COME * self.spacing or not self._clearly_nearer(distance, reading):
            return reading.line.key
        return nearest

    def _clearly_nearer(self, distance: float, reading: Reading) -> bool:
        return distance <= reading.foot.distance - CLEARLY_NEARER * self.spacing

    def _has_crossed_over(self, seen: Seen, reading: Reading) -> bool:
        across = seen.heading_known and not seen.working and reading.off_axis > LEFT
        return across and not self.itinerary.planned_direction and reading.foot.distance > BEHIND * self.spacing

    def _nearest(self, seen: Seen, key: int) -> int:
        return next(iter(self.itinerary.candidates(seen.east, seen.north)), key)

    def _settled(self, seen: Seen, reading: Reading, progress: Progress) -> int:
        key = reading.line.key
        distance, nearest = self._nearest_along(seen, key, progress.done)
        if nearest is None or not self._clearly_nearer(distance, reading):
            self._better = None
            return key
        if nearest != self._better:
            self._better, self._better_since = nearest, (seen.t, seen.east, seen.north)
            return key
        since, east, north = self._better_since
        seconds, metres = SETTLED_AGAINST_PLAN if self._against_order(nearest, key, progress) else SETTLED
        if seen.t - since < seconds or math.hypot(seen.east - east, seen.north - north) < metres:
            return key
        return nearest

    def _against_order(self, nearest: int, key: int, progress: Progress) -> bool:
        if not (self.itinerary.planned_direction and progress.begun):
            return False
        return nearest != self.itinerary.following(key, progress.done, 0)

    def _nearest_along(self, seen: Seen, key: int, without: Set[int]) -> tuple[float, int | None]:
        """Distance and key of the nearest other pass along the heading, within a spacing."""
        best: tuple[float, int | None] = (self.spacing, None)
        if not seen.heading_known:
            return best
        for other in self.itinerary.candidates(seen.east, seen.north):
            line = self.itinerary.line(other)
            if other == key or other in without or line is None:
                continue
            foot = line.polyline.foot(seen.east, seen.north)
            if foot.distance < best[0] and off_axis(seen.heading, foot.direction) <= ALONG:
                best = (foot.distance, other)
        return best


def _is_done(line: GuideLine, progress: Progress) -> bool:
    if line.key in progress.done:
        return True
    return line.work_length is None and progress.worked(line.key) >= ENDLESS_DONE


def _turned_to(reading: Reading) -> int:
    """+1 when the tractor has turned to the side where numbers grow, -1 to the other."""
    turned = math.sin(reading.heading_error) * (-1.0 if reading.against else 1.0)
    return 1 if turned >= 0 else -1


def _lap_closed(line: GuideLine, progress: Progress) -> bool:
    return line.target.closed and progress.worked(line.key) >= line.polyline.length - LAP_CLOSED
