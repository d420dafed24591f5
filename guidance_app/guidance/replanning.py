"""What is left of a plan, planned again: after a pause, a crash, or a driver who drives another pass than planned.

Passes keep their lines and numbers, the method is kept, and what is done stays done; the parts of the field follow each
other as in the plan. The rest of each bundle goes on in the plan's order, or backward through it, or anew in the
method's order, whichever takes less driving from where the tractor stands. Nothing is searched for that the plan knows
already, so that it takes milliseconds.
"""

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely import Polygon

from guidance_app.angles import wrap_pi, yaw_from_heading
from guidance_app.guidance.bundle import Bundle, Run, runs_in_sequence, runs_of
from guidance_app.guidance.costs import driven_costs
from guidance_app.guidance.ground import ground_of
from guidance_app.guidance.joining import Joiner
from guidance_app.guidance.patterns import METHODS
from guidance_app.guidance.request import PlanError, PlanRequest
from guidance_app.guidance.ring import Ring, Stroke
from guidance_app.guidance.room import Room
from guidance_app.guidance.route import route
from guidance_app.guidance.task import Task
from guidance_app.guidance.turn import Turn, leg_of
from guidance_app.guidance.turns import Turner
from guidance_app.guidance.ways import Ways
from guidance_app.language import sentence
from guidance_app.model import FloatArray, Plan, Segment, SegmentKind

__all__ = ["First", "Standing", "replan"]

BESIDE = 1.6
"""Spacings between two passes that are still neighbours."""

SHORTEST = 0.5
"""Metres; a shorter rest of a pass is done."""

ON_IT = math.radians(45)
"""A tractor within half a spacing of where the first pass begins that points along it like this is on it already."""


@dataclass(frozen=True, slots=True)
class First:
    """The pass or lap that comes first: the one being driven, or one that the driver takes.

    ``backward`` says whether it is driven against the order of its points in the plan; None leaves that open.
    ``worked_to`` is the place (east, north) up to which it has been worked in that direction: only what lies beyond
    is planned. ``worked_from`` is that from where on it has been worked, by a driver who now comes the other way: only
    what lies before is planned. Without either the whole of it is.
    """

    number: int
    backward: bool | None = None
    worked_to: tuple[float, float] | None = None
    worked_from: tuple[float, float] | None = None

    @property
    def worked_at(self) -> tuple[float, float] | None:
        """Where the worked part meets the rest; None where nothing is worked."""
        return self.worked_to or self.worked_from


@dataclass(frozen=True, slots=True)
class Standing:
    """Where the tractor is, in the plan's frame, and what the driver has decided.

    ``heading`` is None while nobody knows it; the plan then has no way to its first pass. ``later`` are numbers of
    passes that the driver leaves for the end.
    """

    east: float
    north: float
    heading: float | None = None
    first: First | None = None
    later: frozenset[int] = frozenset()


def replan(plan: Plan, done: Collection[int], standing: Standing, polygon: Polygon, request: PlanRequest) -> Plan:
    """The plan of what is left; ``polygon`` and ``request`` are those that ``plan`` was made from.

    Use it so: ``rest = replan(plan, tracker.done, tracker.standing(pose), polygon, request)`` and then
    ``tracker.follow(rest)``, which keeps offsets, what is done, and the pass being worked. After a crash without a
    tracker, ``Tracker(rest, rest.spacing)`` knows what is done by ``rest.finished``. A plan made by this function may
    be given again; ``done`` may name passes that are in its ``finished`` or not.

    Of the result, ``segments`` is what is left in driving order, each pass and lap under its number and on its line
    (the first one from where it was worked to), ``finished`` all that is done; worked and missed area are those of the
    whole plan, distances, turns and minutes those of the rest. Raises ``PlanError`` when every pass is done.
    """
    ground = ground_of(polygon, request)
    turner = Turner(Room(ground, request.body), request)
    works = [each for each in plan.segments if each.implement_down]
    everything = [*plan.finished, *works]
    mainland = [Polygon(part[0], part[1:]) for part in plan.mainland]
    joiner = Joiner(turner, Ways(turner, _lines(everything), mainland), request)
    rest = _Rest(plan, set(done), standing, request)
    tasks = rest.tasks()
    if not tasks:
        msg = sentence("every pass of the plan is done")
        raise PlanError(msg)
    segments = tuple(joiner.segments(tasks, _start(tasks[0], standing, plan.spacing)))
    left = {task.number for task in tasks}
    finished = tuple(each for each in everything if each.number not in left)
    return replace(plan, segments=segments, finished=finished, costs=driven_costs(segments, plan.costs, request))


def _start(first: Task, standing: Standing, spacing: float) -> FloatArray | None:
    """The pose (3,) from which the way to the first task begins; None where there is none to drive."""
    if standing.heading is None:
        return None
    start = np.array([standing.east, standing.north, yaw_from_heading(standing.heading)])
    on_it = math.dist(start[:2], first.first[:2]) <= spacing / 2 and abs(wrap_pi(start[2] - first.first[2])) <= ON_IT
    return None if on_it else start


def _lines(works: Sequence[Segment]) -> list[Ring | Stroke]:
    """The lines that transfers may use: those of the laps, done or not."""
    laps = (each for each in works if each.kind is SegmentKind.LAP)
    return [Ring(lap.points) if lap.closed else Stroke(lap.points) for lap in laps]


class _Rest:
    """What is left of a plan for a tractor that stands somewhere."""

    def __init__(self, plan: Plan, done: set[int], standing: Standing, request: PlanRequest) -> None:
        self._plan = plan
        self._works = [each for each in plan.segments if each.implement_down]
        self._standing = standing
        self._request = request
        self._driven_at = {each.number: place for place, each in enumerate(self._works)}
        self._first = self._begun(done)
        self._left = set(self._driven_at) - done - ({standing.first.number} if standing.first else set())

    def tasks(self) -> list[Task]:
        """In driving order: what is begun or taken, the rest, and what the driver leaves for the end."""
        standing = self._standing
        here = np.array([standing.east, standing.north]) if self._first is None else self._first.last[:2]
        tasks = [] if self._first is None else [self._first]
        for numbers in (self._left - standing.later, self._left & standing.later):
            for part in _parts_of(self._works):
                tasks.extend(self._ordered(numbers & part, (float(here[0]), float(here[1]))))
                here = tasks[-1].last[:2] if tasks else here
        return tasks

    def _ordered(self, numbers: set[int], here: tuple[float, float]) -> list[Task]:
        """Passes and laps of these numbers; laps come first if the plan goes on with one."""
        groups = ([each for each in group if each.number in numbers] for group in self._groups())
        choices = [list(self._runs(group)) for group in groups if group]
        runs = route(choices, replace(self._request, start_corner="nearest"), here)
        passes = [task for run in runs for task in run.tasks(0)]
        laps = list(self._laps(numbers))
        following = next((each.kind for each in self._works if each.number in numbers), None)
        return laps + passes if following is SegmentKind.LAP else passes + laps

    def _begun(self, done: set[int]) -> Task | None:
        """The rest of the first pass, from where it was worked to; from its nearer end where the way is open."""
        first = self._standing.first
        segment = next((each for each in self._works if first and each.number == first.number), None)
        if first is None or segment is None or segment.number in done:
            return None
        if segment.closed and first.worked_at is None:
            return Task(segment.kind, segment.number, segment.points[:: -1 if first.backward else 1], closed=True)
        points = np.vstack([segment.points, segment.points[:1]]) if segment.closed else segment.points
        if self._backward(points, first):
            points = points[::-1]
        if first.worked_at is None:
            return Task(segment.kind, segment.number, points)
        stroke = Stroke(points)
        along = float(shapely.line_locate_point(shapely.linestrings(points), shapely.Point(first.worked_at)))
        start, end = (0.0, along) if first.worked_to is None else (along, stroke.length)
        return None if end - start < SHORTEST else Task(segment.kind, segment.number, stroke.stretch(start, end))

    def _backward(self, points: FloatArray, first: First) -> bool:
        if first.backward is not None:
            return first.backward
        here = (self._standing.east, self._standing.north)
        return first.worked_at is None and math.dist(points[-1], here) < math.dist(points[0], here)

    def _groups(self) -> Iterator[list[Segment]]:
        """Passes by number, done or not, cut where the next one is not the neighbour of the one before."""
        passes = (each for each in (*self._plan.finished, *self._works) if each.kind is SegmentKind.PASS)
        group: list[Segment] = []
        for each in sorted(passes, key=lambda one: one.number):
            if group and not _beside(group[-1].points, each.points, self._plan.spacing):
                yield group
                group = []
            group.append(each)
        if group:
            yield group

    def _runs(self, left: Sequence[Segment]) -> Iterator[Run]:
        """The ways to drive what is left of a group: on in the plan's order, back through it, or in the method's.

        From a pass that comes first both also go on from there, and come back to what they left out.
        """
        method = METHODS[self._request.method.value]
        order = method.pass_order(len(left), method.options_from(self._request.options))
        lines = tuple(_one_direction(each.points, left[0].points) for each in left)
        bundle = Bundle(lines, numbers=tuple(each.number for each in left))
        planned = sorted(range(len(left)), key=lambda place: self._driven_at[left[place].number])
        for sequence in _turned(planned, [self._driven_at[left[place].number] for place in planned], self._at()):
            yield from runs_in_sequence(bundle, sequence, one_way=order.one_way)
        yield from runs_of(bundle, order)

    def _at(self) -> int | None:
        """The first pass's place in the driving order."""
        return None if self._first is None else self._driven_at.get(self._first.number)

    def _laps(self, numbers: set[int]) -> Iterator[Task]:
        """Laps and their sides in the plan's order, with the turns round their corners."""
        before: int | None = None
        turn: list[Segment] = []
        for each in self._plan.segments:
            if not each.implement_down:
                turn.append(each)
                continue
            if each.kind is SegmentKind.LAP and each.number in numbers:
                follows = before in numbers and before == each.number - 1
                yield Task(each.kind, each.number, each.points, each.closed, _as_turn(turn) if follows else None)
            before = each.number if each.kind is SegmentKind.LAP else None
            turn = []


def _parts_of(works: Sequence[Segment]) -> list[set[int]]:
    """The numbers of each part of the field, in the plan's order: its passes and then its laps, or the other way."""
    parts: list[set[int]] = []
    before: SegmentKind | None = None
    for each in works:
        if not parts or (each.kind is works[0].kind and before is not each.kind):
            parts.append(set())
        parts[-1].add(each.number)
        before = each.kind
    return parts


def _turned(planned: Sequence[int], driven_at: Sequence[int], at: int | None) -> Iterator[Sequence[int]]:
    """A sequence, and backward; with ``at`` the place of a pass that was taken out of it, also from there on."""
    yield planned
    yield planned[::-1]
    split = 0 if at is None else sum(each < at for each in driven_at)
    if 0 < split < len(planned):
        yield [*planned[split:], *planned[:split]]
        yield [*planned[split:], *planned[:split][::-1]]
        yield [*planned[:split][::-1], *planned[split:]]


def _beside(one: FloatArray, other: FloatArray, spacing: float) -> bool:
    """Whether two straight passes lie side by side."""
    (east, north), (to_east, to_north) = one[[0, -1]].tolist()
    length = math.hypot(to_east - east, to_north - north)
    along = (to_east - east) / length, (to_north - north) / length
    away = [(end[0] - east, end[1] - north) for end in other[[0, -1]].tolist()]
    across = [abs(x * along[1] - y * along[0]) for x, y in away]
    reach = sorted(x * along[0] + y * along[1] for x, y in away)
    near = max(across) < BESIDE * spacing and abs(across[0] - across[1]) < spacing / 10
    return bool(near and reach[1] > 0 and reach[0] < length)


def _one_direction(points: FloatArray, first: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A pass driven the way the group's first one was, and the other way."""
    ends = points[[0, -1]]
    same = float((ends[1] - ends[0]) @ (first[-1] - first[0])) > 0
    return (ends, ends[::-1]) if same else (ends[::-1], ends)


def _as_turn(segments: Sequence[Segment]) -> Turn | None:
    if not segments:
        return None
    legs = tuple(leg_of(each.points, reverse=each.reverse) for each in segments)
    transfer = segments[0].kind is SegmentKind.TRANSFER
    return Turn(legs, sum(leg.length for leg in legs), segments[0].missing, transfer)
