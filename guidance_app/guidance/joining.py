"""From tasks in driving order to the segments of a plan: what joins one task to the next, and where laps begin."""

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from guidance_app.guidance.lap import Lap
from guidance_app.guidance.task import Task, side_tasks
from guidance_app.guidance.turn import Turn
from guidance_app.guidance.turns import Turner
from guidance_app.guidance.ways import Ways
from guidance_app.model import FloatArray, Segment, SegmentKind

__all__ = ["Joiner"]

LAP_STEP = 2.0
"""Metres between the places at which a lap may be begun."""

LAP_PLACES = 60
"""Nearest places of a lap that are looked at."""

FAR = 6.0
"""Turning radii between two passes beyond which the way along the headland is compared with the direct turn."""


class Joiner:
    """Joins tasks in one field."""

    def __init__(self, turner: Turner, ways: Ways) -> None:
        self._turner = turner
        self._ways = ways

    def segments(self, tasks: Sequence[Task]) -> Iterator[Segment]:
        """The whole of it in driving order."""
        turns = self._turns(tasks)
        for place, task in enumerate(tasks):
            if place:
                yield from _joining(turns[place - 1], task.number)
            yield _worked(task)

    def round_tasks(self, laps: Sequence[Lap], last: FloatArray | None, number: int, *, inward: bool) -> list[Task]:
        """All laps, those about one ring of the boundary after each other, the nearest such nest next."""
        nests: dict[int, list[Lap]] = {}
        for lap in sorted(laps, key=lambda lap: lap.place, reverse=not inward):
            nests.setdefault(lap.nest, []).append(lap)
        tasks: list[Task] = []
        while nests:
            nest = min(nests, key=lambda each: _apart(nests[each][0], last))
            for lap in nests.pop(nest):
                tasks.extend(self.lap_tasks(lap, last, number + len(tasks)))
                last = tasks[-1].last
        return tasks

    def lap_tasks(self, lap: Lap, last: FloatArray | None, number: int) -> list[Task]:
        """The sides of a lap, begun where it is reached soonest from the pose ``last``."""
        poses, along = lap.poses(LAP_STEP)
        if last is None:
            return side_tasks(lap, 0.0, number, None)
        order = np.argsort(np.hypot(*(poses[:, :2] - last[:2]).T))[:LAP_PLACES]
        found = self._turner.nearest(last, poses[order], np.zeros(len(order)))
        if found is not None:
            return side_tasks(lap, float(along[order[found[0]]]), number, found[1])
        nearest = int(order[0])
        return side_tasks(lap, float(along[nearest]), number, self._ways.way(last, poses[nearest]))

    def _turns(self, tasks: Sequence[Task]) -> list[Turn]:
        pairs = list(itertools.pairwise(tasks))
        known: list[Turn | None] = [after.approach for _, after in pairs]
        near = [
            place
            for place, (before, after) in enumerate(pairs)
            if known[place] is None and np.hypot(*(after.first - before.last)[:2]) < FAR * self._turner.radius
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


def _apart(lap: Lap, last: FloatArray | None) -> float:
    if last is None:
        return float(lap.nest)
    return float(np.hypot(*(lap.points - last[:2]).T).min())


def _worked(task: Task) -> Segment:
    line = shapely.linearrings(task.points) if task.closed else shapely.linestrings(task.points)
    return Segment(
        task.kind, task.number, task.points, implement_down=True, length=float(shapely.length(line)), closed=task.closed
    )


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
