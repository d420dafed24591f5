"""From tasks in driving order to the segments of a plan: what joins one task to the next, and where laps begin."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from guidance_app.guidance.lap import Lap
from guidance_app.guidance.parts import next_laps
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.room import TOUCH, Room
from guidance_app.guidance.task import Task, side_tasks
from guidance_app.guidance.turn import Turn
from guidance_app.guidance.turns import Turner
from guidance_app.guidance.ways import Ways
from guidance_app.model import FloatArray, Segment, SegmentKind

__all__ = ["Joiner"]

LAP_STEP = 2.0
"""Metres between the places at which a lap may be begun."""

LAP_SIDE = 3.0
"""Turning radii that a lap's first side has at least: enough to change over to the next lap before the corner."""

LAP_PLACES = 60
"""Nearest places of a lap that are looked at."""

LAP_WAYS = 3
"""Places of a lap to which a transfer is looked for when no turn leads to it, until one fits."""

ARRIVED = 0.5
"""Metres; nearer than this to the first pass's start the tractor stands on it."""

PLACE = 2
"""Numbers in a place; a pose has three."""

FAR = 6.0
"""Turning radii between two passes beyond which the way along the headland is compared with the direct turn."""


class Joiner:
    """Joins tasks in one field.

    On a lap along the boundary the implement's outer end swings out in every corner; from lap to lap, where nothing
    else fits, it may swing out as far.
    """

    def __init__(self, turner: Turner, ways: Ways, request: PlanRequest) -> None:
        self._turner = turner
        self._ways = ways
        self._known: dict[bytes, Turn] = {}
        self._begun: dict[tuple[Lap, bytes], tuple[float, Turn]] = {}
        self._lap_turner = turner.within(Room(turner.room.polygon, request.body, TOUCH + _swing(request)))

    def segments(self, tasks: Sequence[Task], start: FloatArray | None = None) -> Iterator[Segment]:
        """The whole of it in driving order; from the pose ``start`` (3,) if there is one."""
        turns = self.turns(tasks)
        if start is not None and math.dist(start[:2], tasks[0].first[:2]) > ARRIVED:
            yield from _joining(replace(self._ways.way(start, tasks[0].first), transfer=True), tasks[0].number)
        for place, task in enumerate(tasks):
            if place:
                yield from _joining(turns[place - 1], task.number)
            yield _worked(task)

    def round_tasks(self, laps: Sequence[Lap], last: FloatArray, number: int, *, inward: bool) -> list[Task]:
        """All laps, those about one ring of the boundary after each other, the nearest such nest next.

        ``last`` is the pose (3,) from which they are reached, or only the place (2,) near which they begin.
        """
        left = list(laps)
        nest: int | None = None
        tasks: list[Task] = []
        while left:
            able = [lap for lap in left if lap.nest == nest] or left
            nests = [[lap for lap in able if lap.nest == one] for one in dict.fromkeys(lap.nest for lap in able)]
            able = [lap for one in nests for lap in next_laps(one, inward=inward)]
            lap = min(able, key=lambda each: float(np.hypot(*(each.points - last[:2]).T).min()))
            left.remove(lap)
            nest = lap.nest
            tasks.extend(self._lap_tasks(lap, last, number + len(tasks)))
            last = tasks[-1].last
        return tasks

    def _lap_tasks(self, lap: Lap, last: FloatArray, number: int) -> list[Task]:
        """The sides of a lap, begun where it is reached soonest."""
        poses, along = lap.poses(LAP_STEP, LAP_SIDE * self._turner.radius, self._turner.out)
        if not len(along):
            return side_tasks(lap, 0.0, number, None)
        fits = self._turner.room.fits_each(poses)
        if fits.any():
            poses, along = poses[fits], along[fits]
        order = np.argsort(np.hypot(*(poses[:, :2] - last[:2]).T))[:LAP_PLACES]
        if len(last) == PLACE:
            return side_tasks(lap, float(along[order[0]]), number, None)
        key = (lap, last.tobytes())
        if key not in self._begun:
            place, way = self._way_onto(poses[order], last)
            self._begun[key] = float(along[order[place]]), way
        begin, way = self._begun[key]
        return side_tasks(lap, begin, number, way)

    def _way_onto(self, poses: FloatArray, last: FloatArray) -> tuple[int, Turn]:
        """Which of the poses (M, 3), the nearest first, is reached soonest, and how."""
        near = math.dist(poses[0, :2], last[:2]) < FAR * self._turner.radius
        for turner in (self._turner, self._lap_turner) if near else ():
            found = turner.nearest(last, poses)
            if found is not None:
                return found
        tried: list[tuple[int, Turn]] = []
        for place in range(0, len(poses), -(-len(poses) // LAP_WAYS)):
            tried.append((place, self._ways.way(last, poses[place])))
            if tried[-1][1].fits:
                return tried[-1]
        return min(tried, key=lambda each: each[1].missing)

    def turns(self, tasks: Sequence[Task]) -> list[Turn]:
        """The ways from each task to the next; what was found once is known."""
        pairs = list(itertools.pairwise(tasks))
        keys = [before.last.tobytes() + after.first.tobytes() for before, after in pairs]
        new = [
            place for place, (_, after) in enumerate(pairs) if after.approach is None and keys[place] not in self._known
        ]
        for place, turn in zip(new, self._found([pairs[place] for place in new]), strict=True):
            self._known[keys[place]] = turn
        return [after.approach or self._known[key] for key, (_, after) in zip(keys, pairs, strict=True)]

    def _found(self, pairs: Sequence[tuple[Task, Task]]) -> list[Turn]:
        known: list[Turn | None] = [None] * len(pairs)
        near = [
            place
            for place, (before, after) in enumerate(pairs)
            if np.hypot(*(after.first - before.last)[:2]) < FAR * self._turner.radius
        ]
        if near:
            starts = np.array([pairs[place][0].last for place in near])
            ends = np.array([pairs[place][1].first for place in near])
            for place, turn in zip(near, self._turner.turns(starts, ends), strict=True):
                known[place] = turn
        return [
            self._ways.way(before.last, after.first) if turn is None else turn
            for turn, (before, after) in zip(known, pairs, strict=True)
        ]


def _swing(request: PlanRequest) -> float:
    """Metres by which the implement's outer rear end leaves its straight edge when the tractor turns away from it."""
    outer = request.path_radius + request.width / 2
    return math.hypot(outer, min(request.body.implement_rear, 0.0)) - outer


def _worked(task: Task) -> Segment:
    points = np.vstack([task.points, task.points[:1]]) if task.closed else task.points
    length = float(np.hypot(*np.diff(points, axis=0).T).sum())
    return Segment(task.kind, task.number, task.points, implement_down=True, length=length, closed=task.closed)


def _joining(turn: Turn, number: int) -> Iterator[Segment]:
    for leg in turn.legs:
        yield Segment(
            SegmentKind.TRANSFER if turn.transfer else SegmentKind.TURN,
            number,
            leg.points,
            implement_down=False,
            length=leg.length,
            fits=turn.fits,
            missing=turn.missing,
            reverse=leg.reverse,
        )
