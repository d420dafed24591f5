"""Guidance along a plan or a family of passes: cross-track and heading error, which pass, what comes next.

One step costs the same for 3 passes and for 300, for lines of 2 points and of 10,000: the foot point is searched near
the last one, other passes are looked up in a tree, and only while the implement does not work on the target.
"""

import copy
import math
from collections.abc import Iterable

import shapely

from guidance_app.guidance.choice import ENDLESS_DONE, Choice
from guidance_app.guidance.continuity import Continuity, is_place
from guidance_app.guidance.family import Learner, PassFamily
from guidance_app.guidance.itinerary import FamilyItinerary, GuideLine, Itinerary, Path, PlanItinerary
from guidance_app.guidance.learning import DrivenPass
from guidance_app.guidance.offsets import LineOffsets
from guidance_app.guidance.polyline import Foot, Polyline
from guidance_app.guidance.progress import SHORTEST, Progress, driven_stretches, enough
from guidance_app.guidance.reading import ALIGNED, COME, STAY, Reader, Reading, Seen
from guidance_app.guidance.replanning import First, Standing
from guidance_app.guidance.resuming import carried_over, keys_of, rest_of
from guidance_app.guidance.travel import TravelDirection, drives_against
from guidance_app.model import FloatArray, Guidance, OffsetKind, OffsetRecord, Pass, Plan, Pose, TurnGuide

__all__ = ["Tracker", "cross_track"]

WINDOW = 10.0
"""The foot point is searched so far along the pass, and twice the distance moved, from the last one."""

SLOWEST_FORECAST = 0.3
"""Below this speed (m/s) nobody says in how many seconds a turn comes."""


def cross_track(
    points: FloatArray, closed: bool, endless: bool, east: float, north: float, heading: float
) -> tuple[float, float]:
    """Cross-track and heading error of a pose against a line of shape (N, 2), driven the way ``heading`` points."""
    foot = Polyline.through(points, closed=closed, endless=endless).foot(east, north)
    against = drives_against(heading, foot.direction, None)
    return _errors(foot, heading, against=against)


def _errors(foot: Foot, heading: float, *, against: bool) -> tuple[float, float]:
    direction = foot.direction + math.pi if against else foot.direction
    error = (heading - direction + math.pi) % math.tau - math.pi
    return (-foot.cross if against else foot.cross), error


class Tracker:
    """Follows a plan in its order, or a family by its neighbours; every step tells the target and the errors to it.

    ``done`` holds the numbers of passes worked before (a job that goes on after a pause). With ``field`` the passes of
    an endless family have a length there, so that they can be done, and neighbours outside are not offered.
    ``behind`` is how far the implement works behind the guided point: ``on_pass`` lasts until it has come to the end.
    """

    def __init__(
        self,
        family: PassFamily | Plan,
        spacing: float,
        *,
        field: shapely.Polygon | None = None,
        done: frozenset[int] = frozenset(),
        behind: float = 0.0,
    ) -> None:
        self._itinerary: Itinerary
        self._itinerary = PlanItinerary.of(family) if isinstance(family, Plan) else FamilyItinerary(family, field)
        self._spacing = spacing
        self._behind = behind
        self._reader = Reader(spacing, behind)
        self._travel = TravelDirection()
        self._driven = DrivenPass() if isinstance(family, Learner) else None
        finished = [each.number for each in family.finished] if isinstance(family, Plan) else []
        self._progress = Progress(keys_of(self._itinerary, (*done, *finished)))
        self._choice = Choice(self._itinerary, spacing)
        self._continuity = Continuity()
        self._offsets = LineOffsets()
        self._line: GuideLine | None = None
        self._on = self._reached = False
        self._foot: Foot | None = None
        self._work_from: float | None = None
        self._side = 0
        self._next: tuple[int, frozenset[int], int | None] | None = None
        self._done: tuple[frozenset[int], frozenset[int]] | None = None

    def fork(self) -> "Tracker":
        """An independent copy; lines and search trees are shared."""
        other = copy.copy(self)
        other._progress = self._progress.fork()  # noqa: SLF001 - its own class, as in the lines below
        other._choice = self._choice.fork()  # noqa: SLF001
        other._continuity = copy.copy(self._continuity)  # noqa: SLF001
        other._travel = copy.copy(self._travel)  # noqa: SLF001
        other._driven = None if self._driven is None else self._driven.fork()  # noqa: SLF001
        return other

    @property
    def offsets(self) -> tuple[OffsetRecord, ...]:
        """The line offsets in force; metres to the right of the guidance line or of the plan's direction."""
        return self._offsets.records

    @property
    def done(self) -> frozenset[int]:
        """Numbers of the passes that are done, all pieces of them."""
        keys = self._progress.done
        if self._done is None or self._done[0] is not keys:
            numbers = {line.target.number for key in keys if (line := self._itinerary.line(key)) is not None}
            whole = frozenset(number for number in numbers if keys.issuperset(self._itinerary.keys(number)))
            self._done = (keys, whole)
        return self._done[1]

    @property
    def family(self) -> PassFamily | None:
        """What the passes are made of now, without offsets; None on a plan."""
        return self._itinerary.family if isinstance(self._itinerary, FamilyItinerary) else None

    def moved(self, shown: Iterable[Pass]) -> tuple[Pass, ...]:
        """The same passes where the offsets in force put them; one that vanishes there is left out."""
        keys = (one.number if one.order is None else one.order for one in shown)
        lines = (self._itinerary.line(key) for key in keys)
        return tuple(line.target for line in lines if line is not None)

    # --- one epoch --------------------------------------------------------------------------------------------------

    def step(self, pose: Pose, point: tuple[float, float], working: bool) -> Guidance | None:
        """Guidance of the guided point (east, north) at this pose; None without a pass there, or at no place."""
        seen = Seen(pose.t, *point, pose.heading, pose.heading_known, working)
        if not is_place(seen.east, seen.north, seen.t, seen.heading):
            return None
        moved = math.hypot(seen.east - self._continuity.east, seen.north - self._continuity.north)
        continuous = self._continuity.step(seen.t, seen.east, seen.north)
        self._learn(seen)
        line = self._line or self._begin(seen)
        if line is None:
            return None
        reading = self._read(line, seen, moved)
        self._count_work(seen, reading, continuous=continuous)
        key = self._choice.step(seen, reading, self._progress, self._side)
        if key != line.key:
            reading = self._read(self._go_to(key), seen, moved)
        self._on = reading.on_pass
        self._reached = self._reached or reading.on_pass
        return self._guidance(pose, seen, reading)

    def errors_at(self, east: float, north: float, heading: float) -> tuple[float, float] | None:
        """Cross-track and heading error there against the present target, in the present direction of travel.

        For a predicted pose; nothing is remembered. None while there is no target.
        """
        if self._line is None or self._foot is None:
            return None
        foot = self._line.polyline.foot(east, north, self._foot.along, 4.0 * WINDOW)
        return _errors(foot, heading, against=bool(self._travel.against))

    def _read(self, line: GuideLine, seen: Seen, moved: float) -> Reading:
        foot = self._find_foot(line, seen, moved)
        self._foot = foot
        against = self._travel.step(seen, foot, COME * self._spacing)
        reading = self._reader.read(line, foot, seen, against=against, was_on=self._on)
        return reading._replace(on_pass=False) if self._comes_along(reading, seen) else reading

    def _comes_along(self, reading: Reading, seen: Seen) -> bool:
        """Whether the planned way to the target's entry runs back along the target, and the tractor on it."""
        if self._reached or not reading.on_pass or not reading.against:
            return False
        way = self._itinerary.way_to(reading.line.key)
        return way is not None and way.leads_along(seen.east, seen.north, seen.heading, COME * self._spacing)

    def _find_foot(self, line: GuideLine, seen: Seen, moved: float) -> Foot:
        if self._foot is None:
            return line.polyline.foot(seen.east, seen.north)
        reach = WINDOW + 2.0 * moved
        foot = line.polyline.foot(seen.east, seen.north, self._foot.along, reach)
        strayed = abs(foot.along - self._foot.along)
        if line.target.closed:
            strayed = min(strayed, line.polyline.length - strayed)
        if strayed < 0.9 * reach and foot.distance <= self._spacing:
            return foot
        return line.polyline.foot(seen.east, seen.north)

    def _count_work(self, seen: Seen, reading: Reading, *, continuous: bool) -> None:
        line, along = reading.line, reading.foot.along
        beside = abs(reading.foot.cross) <= (STAY if self._on else COME) * self._spacing and reading.off_axis <= ALIGNED
        if self._work_from is not None and continuous and beside:
            for start, end in driven_stretches(self._work_from, along, line.polyline.length, closed=line.target.closed):
                self._progress.add(line.key, start, end)
            wanted = line.work_length
            if wanted is not None and 0 < enough(wanted) <= self._progress.worked(line.key):
                self._progress.finish(line.key)
        short = not line.target.endless and line.polyline.length < SHORTEST
        if short and beside and reading.foot.distance <= self._spacing and reading.to_end <= reading.along:
            self._progress.finish(line.key)
        self._work_from = along if seen.working and beside else None

    # --- the pass ---------------------------------------------------------------------------------------------------

    def _begin(self, seen: Seen) -> GuideLine | None:
        key = self._itinerary.start(seen.east, seen.north, self._progress.done)
        return None if key is None else self._go_to(key)

    def _go_to(self, key: int, *, held: bool = False) -> GuideLine:
        line = self._itinerary.line(key)
        if line is None:
            msg = f"an itinerary offered pass {key}, which it does not have"
            raise LookupError(msg)
        old = self._line
        if old is not None:
            if old.work_length is None and self._progress.worked(old.key) >= ENDLESS_DONE:
                self._progress.finish(old.key)
            self._side = (key > old.key) - (key < old.key)
        self._line = line
        self._on = self._reached = False
        self._foot = self._work_from = None
        self._travel.begin(planned=self._itinerary.planned_direction)
        self._choice.begin(held=held)
        return line

    def _learn(self, seen: Seen) -> None:
        """Where passes follow those driven: takes up the pass that has just ended."""
        if self._driven is None:
            return
        points = self._driven.step(seen, None if self._line is None else self._line.key)
        if points is not None:
            number = self._driven.key or 0
            self._replace_itinerary(self._itinerary.learned(number, points))
            self._progress.finish(number)

    def take(self, number: int) -> bool:
        """Guides along this pass until the tractor has been on it; False when there is none of this number."""
        keys = self._itinerary.keys(number)
        if not keys:
            return False
        open_keys = [key for key in keys if key not in self._progress.done] or list(keys)
        self._go_to(min(open_keys, key=self._away), held=True)
        return True

    def _away(self, key: int) -> float:
        line = self._itinerary.line(key)
        here = self._continuity
        return math.inf if line is None else line.polyline.foot(here.east, here.north).distance

    def skip(self) -> bool:
        """Leaves the target for later and guides along the next; False when there is no next."""
        following = None if self._line is None else self._following(self._line.key)
        if following is None:
            return False
        self._go_to(following, held=True)
        return True

    def reverse(self) -> bool:
        """The target is to be driven the other way round; False while there is no target."""
        if self._line is None:
            return False
        self._travel.turn_round()
        return True

    # --- the rest planned again -------------------------------------------------------------------------------------

    def standing(self, pose: Pose, point: tuple[float, float]) -> Standing:
        """Where the guided point is at this pose, and the pass that is begun or taken: what ``replan`` begins with."""
        heading = pose.heading if pose.heading_known else None
        return Standing(*point, heading, first=self._first())

    def _first(self) -> First | None:
        line, against = self._line, bool(self._travel.against)
        if line is None or line.key in self._progress.done:
            return None
        if spans := self._progress.spans(line.key):
            return rest_of(line, spans, against=against, turned=self._travel.wished, behind=self._behind)
        if self._on or self._travel.wished:
            return First(line.target.number, against)
        return First(line.target.number) if self._choice.held else None

    def follow(self, plan: Plan) -> None:
        """Goes on along a plan of the rest of the same field, as ``replan`` makes it.

        Offsets and all that is done stay. The pass on which the implement works stays the target, in the direction in
        which it is driven, unless the driver has turned it round: then the plan leads to its other end.
        Otherwise the plan's first one becomes it. ``ValueError`` for a plan without a pass.
        """
        itinerary = PlanItinerary.of(plan).shifted(self._offsets.total)
        old, number = self._line, None if self._line is None else self._line.target.number
        done = (*self.done, *(each.number for each in plan.finished))
        self._progress = carried_over(self._progress, self._itinerary, itinerary, done)
        self._itinerary = self._choice.itinerary = itinerary
        self._next = self._done = self._line = None
        here = next(iter(keys_of(itinerary, [] if number is None else [number])), None)
        first = itinerary.start(0.0, 0.0, self._progress.done)
        turned = self._travel.wished and here == first
        if old is not None and here is not None and not turned and (self._choice.engaged or here == first):
            self._stay(old, itinerary, here)
        elif first is not None:
            self._go_to(first, held=turned)

    def _stay(self, old: GuideLine, itinerary: Itinerary, key: int) -> None:
        """On along the same pass, which may be shorter now, or planned the other way round."""
        line = itinerary.line(key)
        assert line is not None, "the key is the itinerary's own"
        before = old.polyline.foot(self._continuity.east, self._continuity.north)
        foot = line.polyline.foot(self._continuity.east, self._continuity.north)
        if drives_against(foot.direction, before.direction, None):
            self._travel.flip()
        self._line, self._foot = line, foot
        self._work_from = None if self._work_from is None else foot.along

    # --- offsets ----------------------------------------------------------------------------------------------------

    def shift(self, metres: float, kind: OffsetKind = OffsetKind.NUDGE, arrival: float = 0.0) -> bool:
        """Moves all lines, positive to the right in the direction of travel; False when that is out of bounds."""
        rightward = metres * self._sense()
        if not self._offsets.allows(rightward):
            return False
        return self._move(self._offsets.plus(kind, rightward, arrival))

    def line_here(self, point: tuple[float, float], arrival: float = 0.0) -> bool:
        """Moves all lines so that the target runs through ``point``; False without a target or out of bounds."""
        errors = self.errors_at(*point, 0.0)
        return errors is not None and self.shift(errors[0], OffsetKind.LINE_HERE, arrival)

    def drop(self, kind: OffsetKind) -> bool:
        """Takes all offsets of one kind back."""
        return self._move(self._offsets.without(kind))

    def _sense(self) -> float:
        if self._line is None:
            return 1.0
        sense = self._itinerary.sense(self._line.key)
        return -sense if self._travel.against else sense

    def _move(self, offsets: LineOffsets) -> bool:
        if not self._replace_itinerary(self._itinerary.shifted(offsets.total)):
            return False
        self._offsets = offsets
        return True

    def _replace_itinerary(self, itinerary: Itinerary) -> bool:
        """False, and nothing changed, when the target has no place in it."""
        line = None if self._line is None else itinerary.line(self._line.key)
        if self._line is not None and line is None:
            return False
        self._itinerary, self._line = itinerary, line
        self._choice.itinerary = itinerary
        self._next = None
        return True

    # --- what is handed out -----------------------------------------------------------------------------------------

    def _following(self, key: int) -> int | None:
        done = self._progress.done
        if self._next is None or self._next[0] != key or self._next[1] is not done:
            self._next = (key, done, self._itinerary.following(key, done, self._side))
        return self._next[2]

    def _guidance(self, pose: Pose, seen: Seen, reading: Reading) -> Guidance:
        line = reading.line
        following = self._following(line.key)
        next_line = None if following is None else self._itinerary.line(following)
        remaining = self._remaining(reading)
        return Guidance(
            target=line.target,
            cross_track=reading.cross_track,
            heading_error=reading.heading_error,
            along_track=reading.along,
            against=reading.against,
            remaining=remaining,
            next_number=None if next_line is None else next_line.target.number,
            turn=self._turn(pose, seen, reading, remaining),
            on_pass=reading.on_pass,
            done=self.done,
            count=self._itinerary.count,
            mirrored=self._sense() < 0,
        )

    def _remaining(self, reading: Reading) -> float | None:
        target, length = reading.line.target, reading.line.polyline.length
        if target.endless:
            return None
        if target.closed and reading.to_end < enough(length) - self._progress.worked(reading.line.key):
            return reading.to_end + length
        return max(reading.to_end, 0.0)

    def _turn(self, pose: Pose, seen: Seen, reading: Reading, remaining: float | None) -> TurnGuide | None:
        """The turn being driven, at distance 0, until the target is reached; then the turn that follows the target."""
        key = reading.line.key
        coming = self._itinerary.way_to(key)
        if not self._reached and coming is not None and coming.passes_by(seen.east, seen.north, self._spacing):
            return TurnGuide(0.0, 0.0, coming.polyline.vertices, fits=coming.fits, driven=True)
        leaving = self._itinerary.way_from(key)
        if leaving is None or remaining is None or reading.against or self._following(key) != key + 1:
            return None
        speed = abs(pose.speed)
        return _guide(leaving, remaining, remaining / speed if speed > SLOWEST_FORECAST else None)


def _guide(way: Path, distance: float, seconds: float | None) -> TurnGuide:
    return TurnGuide(distance, seconds, way.polyline.vertices, fits=way.fits)
