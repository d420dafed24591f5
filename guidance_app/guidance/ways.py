"""Transfers: from one place of the field to another along the headland, on the lines that the laps use.

A transfer leaves its pass, joins a lap's line in either direction, follows it, and leaves it for the next pass. The
straight way over the mainland is taken only where it is much shorter, since it runs over the crop. Where no lap leads
there, a taut string does: through the gap that a lap is too wide for. A dead end is left, or reached, backward along
the pass. Where nothing fits, the transfer is drawn as the shortest path inside and flagged.
"""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely import MultiLineString, Polygon

from guidance_app.guidance.blunting import eased_stroke
from guidance_app.guidance.clearance import free_ground, parts_of
from guidance_app.guidance.corridor import Corridor
from guidance_app.guidance.manoeuvres import WORDS, IntArray, Manoeuvres
from guidance_app.guidance.ring import Ring, Stroke
from guidance_app.guidance.room import BoolArray
from guidance_app.guidance.turn import Leg, Turn, leg_of, turns_along
from guidance_app.guidance.turns import Turner, ahead
from guidance_app.model import FloatArray

__all__ = ["Ways"]

TRACK_STEP = 2.0
"""Metres between the places where a transfer may join or leave a lap's line."""

REACH = 8.0
"""Turning radii within which a lap's line is looked for around a pass's end."""

CROP = 1.0
"""A metre over the mainland counts as much more than a metre on the headland."""

EASE = 1.05
"""Turning radii of the circles round which a taut string bends."""

SIMPLE = 0.03
"""Metres to which the ground of taut strings is smoothed: fewer corners, fewer triangles."""

MARGIN = 0.25
"""Metres from the boundary at which a way that does not fit is drawn."""

BATCH = 40
"""Ways of joining and of leaving that are checked at a time, those that promise most first."""

ROUNDS = 8
"""Batches after which a transfer counts as one that does not fit."""


LOOKS = 3
"""Batches after which a place is one that no lap can be joined or left from."""

BACK_OUT = (0.0, 3.0, 8.0, 20.0)
"""Turning radii that a tractor backs up along a pass out of a dead end, or into one."""


FAR_OUT = (1.5, 3.0, 5.0, 8.0, 14.0, 24.0)
"""Turning radii that a tractor backs up to where it can turn, if no lap is near."""

SAME = 1e-3
"""Metres; nearer places are one."""


class Ways:
    """Finds the way between any two poses of one field."""

    def __init__(self, turner: Turner, lines: Sequence[Ring | Stroke], mainland: Sequence[Polygon]) -> None:
        self._turner = turner
        self._tracks = _Tracks(turner, [way for line in lines for way in (line, line.reversed())])
        self._mainland = shapely.multipolygons(list(mainland)) if mainland else None
        self._corridors: tuple[list[Corridor], Corridor] | None = None
        if self._mainland is not None:
            shapely.prepare(self._mainland)

    def way(self, start: FloatArray, end: FloatArray) -> Turn:
        """The cheapest way from pose to pose; one that does not fit is drawn inside and says how much is missing."""
        pair = (start[None], end[None])
        direct = self._turner.plain(*pair)[0]
        cost = np.inf if direct is None else self._cost(direct)
        if direct is not None and cost <= direct.length + 2 * self._turner.radius:
            return direct
        return (
            self._along(self._tracks, start, end, cost)
            or direct
            or self._pulled(start, end)
            or self._turner.awkward(*pair)[0]
            or self._backed(start, end)
            or self._turned_outside(start, end)
            or self._flagged(start, end)
        )

    def _cost(self, turn: Turn) -> float:
        if self._mainland is None:
            return turn.length
        lines = MultiLineString([leg.points for leg in turn.legs])
        return turn.length + CROP * float(shapely.length(shapely.intersection(lines, self._mainland)))

    def _pulled(self, start: FloatArray, end: FloatArray) -> Turn | None:
        """A way along a taut string that bends on circles only."""
        for corridor in self._prepared()[0]:
            string = corridor.path(start[:2], end[:2])
            if string is not None and len(string) > 1:
                eased = eased_stroke(string, self._turner.radius)
                if eased is None:
                    continue
                turn = self._along(_Tracks(self._turner, [Stroke(eased)]), start, end, np.inf)
                if turn is not None:
                    return turn
        return None

    def _backed(self, start: FloatArray, end: FloatArray) -> Turn | None:
        """A way out of a dead end, into one, or both, backward along the pass to where a lap can be joined or left."""
        if not self._turner.reverse:
            return None
        out, over = self._tracks.backing_out(start), self._tracks.backing_in(end)
        if out is None or over is None:
            return None
        some = BACK_OUT[1] * self._turner.radius
        pairs = [(out, over)] if out or over else [(0.0, some), (some, 0.0)]
        turns = (self._along(self._tracks, start, end, np.inf, pair) for pair in pairs)
        return next((turn for turn in turns if turn is not None), None)

    def _turned_outside(self, start: FloatArray, end: FloatArray) -> Turn | None:
        """A turn after backing out of a dead end, or before backing into one, where no lap is near."""
        if not self._turner.reverse:
            return None
        metres = [part * self._turner.radius for part in FAR_OUT]
        out = metres[: self._turner.straight(start, [-each for each in metres])]
        over = metres[: self._turner.straight(end, metres)]
        for back, beyond in [*((0.0, each) for each in over), *((each, 0.0) for each in out)]:
            begin, goal = ahead(start[None], -back), ahead(end[None], beyond)
            turn = self._turner.plain(begin, goal)[0]
            if turn is not None:
                return _framed(start, turn, end, self._turner.out)
        return None

    def _flagged(self, start: FloatArray, end: FloatArray) -> Turn:
        string = self._prepared()[1].path(start[:2], end[:2])
        assert string is not None, "the field is in one piece"
        on_the_spot = len(string) == 1
        leg = leg_of(np.stack([start[:2], end[:2]]) if on_the_spot else string, reverse=False)
        return Turn((leg,), leg.length, self._turner.missing(start, end), transfer=True)

    def _prepared(self) -> tuple[list[Corridor], Corridor]:
        """Corridors that the machine can follow, and the whole ground; made when first needed."""
        if self._corridors is None:
            ground, radius = self._turner.room.polygon, self._turner.radius
            free = free_ground(ground, self._turner.room.half_width, EASE * radius)
            inner = parts_of(ground.buffer(-MARGIN))
            whole = inner[0] if len(inner) == 1 else ground
            simple = shapely.simplify(free, SIMPLE)
            self._corridors = ([Corridor(part) for part in parts_of(simple)], Corridor(whole))
        return self._corridors

    def _along(
        self,
        tracks: "_Tracks",
        start: FloatArray,
        end: FloatArray,
        limit: float,
        back: tuple[float, float] = (0.0, 0.0),
    ) -> Turn | None:
        """The shortest way on one of these lines that fits and costs less than ``limit``.

        The tractor first backs up along its pass, or overruns the next pass's start and backs up to it, so far.
        """
        joins, onto = tracks.joining(start, back[0])
        leaves, off = tracks.leaving(end, back[1])
        if not len(joins) or not len(leaves):
            return None
        between = tracks.between(joins, leaves)
        for _ in range(ROUNDS):
            onto.check(between + off.promised[None, :], limit)
            off.check(between.T + onto.promised[None, :], limit)
            sums = onto.certain[:, None] + between + off.certain[None, :]
            row, column = np.unravel_index(int(sums.argmin()), sums.shape)
            promised = (onto.promised[:, None] + between + off.promised[None, :]).min()
            if min(promised, float(sums[row, column])) >= limit:
                return None
            if sums[row, column] <= promised + 1e-9:
                ridden = tracks.stretch(int(joins[row]), int(leaves[column]))
                return _chained(onto.turn(int(row)), ridden, off.turn(int(column)))
        return None


class _Side:
    """The candidates for joining, or for leaving, some places of the laps' lines.

    ``promised`` (P,) is the length of the best candidate at each place that is not known to be out, ``certain`` that of
    the best one known to fit.
    """

    def __init__(self, turner: Turner, moves: Manoeuvres, places: int) -> None:
        self._turner = turner
        self._moves = moves
        self._open = moves.total.reshape(places, WORDS)
        self._fitting = np.zeros(places, dtype=int)
        self.certain = np.full(places, np.inf)
        self._promise()

    def check(self, beyond: FloatArray, limit: float) -> None:
        """Checks the most promising candidates, ``beyond`` (P, Q) metres being driven after each at least."""
        rest = beyond.min(axis=1, initial=np.inf)
        worth = np.where(self.promised < self.certain, self.promised + rest, np.inf)
        places = np.argsort(worth)[:BATCH]
        places = places[worth[places] < limit]
        if not len(places):
            return
        words = self._open[places].argmin(axis=1)
        rows = places * WORDS + words
        fits = self._turner.room.fits(self._moves.take(rows))
        good = places[fits]
        self.certain[good] = self._open[good, words[fits]]
        self._fitting[good] = rows[fits]
        self._open[places, words] = np.inf
        self._promise()

    def leads_on(self) -> bool:
        """Whether anything fits at any place."""
        for _ in range(LOOKS):
            if np.isfinite(self.certain).any():
                return True
            self.check(np.zeros((len(self.certain), 1)), np.inf)
        return bool(np.isfinite(self.certain).any())

    def turn(self, place: int) -> Turn:
        """The turn of the best candidate that fits there."""
        return turns_along(self._moves.take(self._fitting[place : place + 1]))[0]

    def _promise(self) -> None:
        self.promised = np.minimum(self._open.min(axis=1), self.certain)


class _Tracks:
    """Lines to follow, each in one direction, as one table of poses (M, 3)."""

    def __init__(self, turner: Turner, lines: Sequence[Ring | Stroke]) -> None:
        self._turner = turner
        self._joining: dict[tuple[bytes, float], tuple[IntArray, _Side]] = {}
        self._leaving: dict[tuple[bytes, float], tuple[IntArray, _Side]] = {}
        self._backings = [part * turner.radius for part in BACK_OUT]
        self._rings = lines
        along = [ring.places(TRACK_STEP) for ring in self._rings]
        self._along = np.concatenate([*along, np.zeros(0)])
        self._track = np.repeat(np.arange(len(along)), [len(each) for each in along])
        poses = [ring.poses(each) for ring, each in zip(self._rings, along, strict=True)]
        self.poses: FloatArray = np.concatenate([*poses, np.zeros((0, 3))])
        self._free = turner.room.fits_each(self.poses)
        self._blocked = np.concatenate([[0], np.cumsum(~self._free)])
        self._period = np.array([ring.period for ring in self._rings])

    def joining(self, start: FloatArray, back: float = 0.0) -> tuple[IntArray, _Side]:
        """Rows of poses within reach of a worked pass's end, and the candidates that lead there; kept between calls."""
        key = start.tobytes(), back
        if key not in self._joining:
            rows = self._near(ahead(start[None], -back)[0])
            moves = self._turner.onto(start, self.poses[rows], back)
            self._joining[key] = rows, _Side(self._turner, moves, len(rows))
        return self._joining[key]

    def leaving(self, end: FloatArray, over: float = 0.0) -> tuple[IntArray, _Side]:
        """The same towards the start of a pass."""
        key = end.tobytes(), over
        if key not in self._leaving:
            rows = self._near(ahead(end[None], over)[0])
            moves = self._turner.off(self.poses[rows], end, over)
            self._leaving[key] = rows, _Side(self._turner, moves, len(rows))
        return self._leaving[key]

    def backing_out(self, start: FloatArray) -> float | None:
        """The least metres to back up from a pass's end so that a lap can be joined; None where that never helps."""
        free = self._turner.straight(start, [-back for back in self._backings])
        return next((back for back in self._backings[:free] if self.joining(start, back)[1].leads_on()), None)

    def backing_in(self, end: FloatArray) -> float | None:
        """The least metres to overrun a pass's start, and back up to it, after leaving a lap."""
        free = self._turner.straight(end, self._backings)
        return next((over for over in self._backings[:free] if self.leaving(end, over)[1].leads_on()), None)

    def _near(self, pose: FloatArray) -> IntArray:
        """Rows of poses within reach at which the machine fits."""
        apart = np.hypot(*(self.poses[:, :2] - pose[:2]).T)
        return np.flatnonzero((apart < REACH * self._turner.radius) & self._free)

    def between(self, joins: IntArray, leaves: IntArray) -> FloatArray:
        """Metres along the line (J, L) from each row to each; infinite on another line or where the way is blocked."""
        track = self._track[joins][:, None]
        metres = np.mod(self._along[leaves][None] - self._along[joins][:, None], self._period[track])
        same = track == self._track[leaves][None]
        return np.where(same & ~self._blocked_between(joins, leaves), metres, np.inf)

    def _blocked_between(self, joins: IntArray, leaves: IntArray) -> BoolArray:
        low, high = self._blocked[joins][:, None], self._blocked[leaves][None]
        ends = np.searchsorted(self._track, np.arange(len(self._rings) + 1))
        track = self._track[joins][:, None]
        whole = self._blocked[ends[track + 1]] - self._blocked[ends[track]]
        forward = self._along[leaves][None] >= self._along[joins][:, None]
        blocked: BoolArray = np.where(forward, high - low, whole + high - low) > 0
        return blocked

    def stretch(self, join: int, leave: int) -> FloatArray:
        """Points of the line from one row to another in its direction; a single point when they are the same."""
        ring = self._rings[self._track[join]]
        if join == leave:
            return self.poses[join : join + 1, :2]
        points: FloatArray = ring.stretch(float(self._along[join]), float(self._along[leave]))
        return points


def _framed(start: FloatArray, turn: Turn, end: FloatArray, out: float) -> Turn:
    """The turn with straight legs before and after it where it does not begin at ``start`` or end at ``end``."""
    legs = list(turn.legs)
    if math.dist(start[:2], legs[0].points[0]) > SAME:
        run_out = ahead(start[None], out)[0, :2]
        before = [leg_of(np.stack([start[:2], run_out]), reverse=False)] if out else []
        legs[:0] = [*before, leg_of(np.stack([run_out, legs[0].points[0]]), reverse=True)]
    if math.dist(end[:2], legs[-1].points[-1]) > SAME:
        legs.append(leg_of(np.stack([legs[-1].points[-1], end[:2]]), reverse=True))
    return Turn(tuple(legs), sum(leg.length for leg in legs), transfer=True)


def _chained(onto: Turn, ridden: FloatArray, off: Turn) -> Turn:
    """The parts as one turn; neighbouring legs in the same gear become one."""
    middle = [leg_of(ridden, reverse=False)] if len(ridden) > 1 else []
    legs: list[Leg] = []
    for leg in (*onto.legs, *middle, *off.legs):
        if legs and legs[-1].reverse == leg.reverse:
            legs[-1] = leg_of(np.vstack([legs[-1].points, leg.points[1:]]), reverse=leg.reverse)
        else:
            legs.append(leg)
    return Turn(tuple(legs), sum(leg.length for leg in legs), transfer=True)
