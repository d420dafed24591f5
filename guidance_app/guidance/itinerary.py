"""What may be driven, and in which order: a plan's passes and laps, or the numbered passes of a family.

Both are addressed by keys: the place in the driving order for a plan (a pass that an obstacle cuts in two has one
number and two keys), the number for a family. Everything is made once or on first use and kept, so asking costs the
same for 3 passes and for 300.
"""

import math
from collections.abc import Sequence, Set
from dataclasses import dataclass, replace
from itertools import chain
from typing import Protocol

import numpy as np
import shapely

from guidance_app.angles import wrap_pi
from guidance_app.guidance.family import Learner, PassFamily, drawn_line, offset_line
from guidance_app.guidance.polyline import Polyline
from guidance_app.language import sentence
from guidance_app.model import FloatArray, Pass, Plan, Segment, SegmentKind

__all__ = ["FamilyItinerary", "GuideLine", "Itinerary", "Path", "PlanItinerary", "PlanOrder", "passes_of"]


@dataclass(frozen=True, slots=True, eq=False)
class GuideLine:
    """A pass ready to be followed. ``work_length`` is what has to be worked; None where nobody can say."""

    key: int
    target: Pass
    polyline: Polyline
    work_length: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """The way between two passes."""

    polyline: Polyline
    fits: bool

    def passes_by(self, east: float, north: float, within: float) -> bool:
        """Whether the position is on this way, within so many metres."""
        return self.polyline.foot(east, north).distance <= within

    def leads_along(self, east: float, north: float, heading: float, within: float) -> bool:
        """Whether the position is on this way and the heading along it."""
        foot = self.polyline.foot(east, north)
        return foot.distance <= within and abs(wrap_pi(heading - foot.direction)) <= ALONG


class Itinerary(Protocol):
    """What the tracker needs to know of a plan or a family."""

    planned_direction: bool
    """Whether a pass is meant to be driven in the order of its points."""

    @property
    def count(self) -> int | None:
        """How many passes there are."""

    def line(self, key: int) -> GuideLine | None:
        """The pass of this key."""

    def keys(self, number: int) -> Sequence[int]:
        """The keys of the passes of this number, empty for an unknown one."""

    def candidates(self, east: float, north: float) -> Sequence[int]:
        """Keys of passes that may be the nearest; none is missing that lies within half a spacing."""

    def start(self, east: float, north: float, done: Set[int]) -> int | None:
        """Where to begin."""

    def following(self, key: int, done: Set[int], side: int) -> int | None:
        """What comes after ``key``; ``side`` is the side to which numbers went lately (+1, -1, or 0)."""

    def way_to(self, key: int) -> Path | None:
        """The planned way that leads to ``key`` from the one before it in the order."""

    def way_from(self, key: int) -> Path | None:
        """The planned way that leads on from ``key``."""

    def shifted(self, metres: float) -> "Itinerary":
        """The same with all lines moved by ``metres`` in all (not in addition), to the right of the reference."""

    def learned(self, number: int, points: FloatArray) -> "Itinerary":
        """After pass ``number`` was driven along ``points``; the same where passes do not follow those driven."""

    def sense(self, key: int) -> float:
        """+1 where the pass runs along the reference direction of shifts, -1 where it runs against it."""


class FamilyItinerary:
    """The numbered passes of a family; work is counted inside ``field`` when there is one."""

    planned_direction = False

    def __init__(self, family: PassFamily, field: shapely.Polygon | None = None, metres: float = 0.0) -> None:
        self._unmoved = family
        self._family = family.shifted(metres) if metres else family
        self._field = field
        self._metres = metres
        self._lines: dict[int, GuideLine | None] = {}

    @property
    def family(self) -> PassFamily:
        """The family as it was given, not moved."""
        return self._unmoved

    @property
    def count(self) -> int | None:
        """The family's."""
        return self._family.count

    def line(self, key: int) -> GuideLine | None:
        """Made on first use."""
        if key not in self._lines:
            self._lines[key] = self._made(key)
        return self._lines[key]

    def _made(self, key: int) -> GuideLine | None:
        target = self._family.pass_numbered(key)
        if target is None:
            return None
        polyline = Polyline.of(target)
        return GuideLine(key, target, polyline, self._work_length(target, polyline))

    def _work_length(self, target: Pass, polyline: Polyline) -> float | None:
        if self._field is None:
            return None if target.endless else polyline.length
        inside = drawn_line(target, self._field).intersection(self._field).length
        return float(inside)

    def keys(self, number: int) -> Sequence[int]:
        """The number itself."""
        return () if self.line(number) is None else (number,)

    def candidates(self, east: float, north: float) -> Sequence[int]:
        """The nearest by the family's arithmetic."""
        return self.keys(self._family.nearest_number(east, north))

    def start(self, east: float, north: float, done: Set[int]) -> int | None:  # noqa: ARG002 - of the protocol
        """The nearest."""
        return next(iter(self.candidates(east, north)), None)

    def following(self, key: int, done: Set[int], side: int) -> int | None:
        """The neighbour on the unworked side; on the side lately gone to when both are unworked."""
        sides = (side, -side) if side else (1, -1)
        for step in sides:
            if key + step not in done and self._worth_driving(key + step):
                return key + step
        return None

    def _worth_driving(self, key: int) -> bool:
        line = self.line(key)
        return line is not None and (line.work_length is None or line.work_length > 0)

    def way_to(self, key: int) -> None:
        """Nobody has planned one."""

    def way_from(self, key: int) -> None:
        """Nobody has planned one."""

    def shifted(self, metres: float) -> "FamilyItinerary":
        """The family moved sideways."""
        return FamilyItinerary(self._unmoved, self._field, metres)

    def learned(self, number: int, points: FloatArray) -> "FamilyItinerary":
        """A learning family's next state, moved as this one is."""
        if not isinstance(self._family, Learner):
            return self
        return FamilyItinerary(self._family.driven(number, points).shifted(-self._metres), self._field, self._metres)

    def sense(self, key: int) -> float:  # noqa: ARG002 - of the protocol
        """All passes of a family run along its guidance line."""
        return 1.0


ALONG = math.radians(45)
"""A tractor that points within this of a way follows it."""

WORKED = frozenset((SegmentKind.PASS, SegmentKind.LAP))

POINTS_A_PIECE = 32
"""The search tree holds pieces of passes of at most so many points."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanOrder:
    """What a plan's itineraries share, however far they are moved."""

    lines: tuple[GuideLine, ...]
    ways: tuple[Path | None, ...]
    tree: shapely.STRtree
    piece_keys: tuple[int, ...]
    by_number: dict[int, tuple[int, ...]]
    direction: float
    spacing: float


class PlanItinerary:
    """The passes and laps of a plan, in its driving order, all moved sideways by so many metres."""

    planned_direction = True

    def __init__(self, order: PlanOrder, metres: float = 0.0) -> None:
        self._order = order
        self._metres = metres
        self._lines: dict[int, GuideLine] = {}

    @staticmethod
    def of(plan: Plan) -> "PlanItinerary":
        """``ValueError`` for a plan without a pass, or with one that has no length."""
        return PlanItinerary(_order_of(plan))

    @property
    def count(self) -> int:
        """How many passes and laps the plan has, a cut pass counted once a piece."""
        return len(self._order.lines)

    def line(self, key: int) -> GuideLine | None:
        """Made on first use."""
        if not 0 <= key < self.count:
            return None
        if self._metres == 0:
            return self._order.lines[key]
        if key not in self._lines:
            self._lines[key] = self._moved(self._order.lines[key])
        return self._lines[key]

    def _moved(self, line: GuideLine) -> GuideLine:
        """A lap that vanishes when it is moved so far stays where it is."""
        metres = self._metres * self.sense(line.key)
        points = offset_line(line.target.points, metres, closed=line.target.closed)
        return line if points is None else _guide_line(line.key, replace(line.target, points=points))

    def keys(self, number: int) -> Sequence[int]:
        """In driving order."""
        return self._order.by_number.get(number, ())

    def candidates(self, east: float, north: float) -> Sequence[int]:
        """By a search tree over all passes."""
        reach = 0.6 * self._order.spacing + abs(self._metres)
        found = self._order.tree.query(shapely.box(east - reach, north - reach, east + reach, north + reach))
        return sorted({self._order.piece_keys[i] for i in found})

    def start(self, east: float, north: float, done: Set[int]) -> int | None:  # noqa: ARG002 - of the protocol
        """The first of the order that is not done; when all are done, the last."""
        return next((key for key in range(self.count) if key not in done), self.count - 1)

    def following(self, key: int, done: Set[int], side: int) -> int | None:  # noqa: ARG002 - of the protocol
        """The next of the order that is not done, then those that were left out."""
        later = chain(range(key + 1, self.count), range(key))
        return next((other for other in later if other not in done), None)

    def way_to(self, key: int) -> Path | None:
        """None for the first pass unless the plan leads there."""
        return self._order.ways[key]

    def way_from(self, key: int) -> Path | None:
        """None after the last pass unless the plan leads away."""
        return self._order.ways[key + 1]

    def shifted(self, metres: float) -> "PlanItinerary":
        """The same order on moved lines; right is meant as seen along the plan's direction, on laps along the lap."""
        return PlanItinerary(self._order, metres)

    def learned(self, number: int, points: FloatArray) -> "PlanItinerary":  # noqa: ARG002 - of the protocol
        """A plan stays as it is."""
        return self

    def sense(self, key: int) -> float:
        """By the way from the pass's first to its last point."""
        target = self._order.lines[key].target
        if target.closed:
            return 1.0
        east, north = target.points[-1] - target.points[0]
        return 1.0 if abs(wrap_pi(math.atan2(east, north) - self._order.direction)) <= math.pi / 2 else -1.0


def _guide_line(key: int, target: Pass) -> GuideLine:
    polyline = Polyline.of(target)
    return GuideLine(key, target, polyline, polyline.length)


def passes_of(plan: Plan) -> tuple[Pass, ...]:
    """Passes and laps in their order: those finished before the plan was made, then its own as they are driven."""
    works = [*plan.finished, *(each for each in plan.segments if each.kind in WORKED)]
    return tuple(
        Pass(each.number, each.points, each.closed, order=order, lap=each.kind is SegmentKind.LAP)
        for order, each in enumerate(works)
    )


def _order_of(plan: Plan) -> PlanOrder:
    lines = [_guide_line(key, target) for key, target in enumerate(passes_of(plan))]
    ways: list[Path | None] = [None] * len(plan.finished)
    between: list[Segment] = []
    for segment in plan.segments:
        if segment.kind not in WORKED:
            between.append(segment)
            continue
        ways.append(_path(between))
        between = []
    if not lines:
        msg = sentence("the plan has no pass to drive")
        raise ValueError(msg)
    ways.append(_path(between))
    by_number: dict[int, tuple[int, ...]] = {}
    for line in lines:
        by_number[line.target.number] = (*by_number.get(line.target.number, ()), line.key)
    pieces = [(line.key, piece) for line in lines for piece in _pieces(line.polyline)]
    tree = shapely.STRtree([shapely.LineString(piece) for _, piece in pieces])
    keys = tuple(key for key, _ in pieces)
    return PlanOrder(tuple(lines), tuple(ways), tree, keys, by_number, plan.direction, plan.spacing)


def _path(segments: Sequence[Segment]) -> Path | None:
    if not segments:
        return None
    points = np.vstack([segment.points for segment in segments])
    if not np.ptp(points, axis=0).any():
        return None
    return Path(Polyline.through(points), all(segment.fits for segment in segments))


def _pieces(line: Polyline) -> list[FloatArray]:
    points = line.vertices
    return [points[start : start + POINTS_A_PIECE] for start in range(0, len(points) - 1, POINTS_A_PIECE - 1)]
