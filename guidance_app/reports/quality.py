"""How well the passes were driven: the cross-track error of each, its spread, and the spacing to its neighbours.

Counted is what was driven on the pass with the implement down, without the first metres of each pass, where the
tractor comes out of its turn.
"""

import math
from dataclasses import dataclass

import numpy as np

from guidance_app.model import NO_PASS, DriveLog, FloatArray

__all__ = ["Histogram", "PassQuality", "Spacing", "counted", "histogram", "overall", "pass_qualities", "spacings"]

ENTRY = 5.0
"""Metres at the start of a pass that are the turn's, not the pass's."""
FEWEST = 10
CENTIMETRE = 0.01


@dataclass(frozen=True, slots=True)
class PassQuality:
    """The cross-track error along one pass, in metres, or of all passes together with ``number`` None.

    ``mean`` is positive right of the pass; ``rms``, ``p95`` and ``largest`` are sizes. ``length`` is what was driven.
    """

    number: int | None
    fixes: int
    length: float
    mean: float
    rms: float
    p95: float
    largest: float
    speed: float


@dataclass(frozen=True, slots=True, eq=False)
class Histogram:
    """``share`` of the counted fixes in each bin; ``edges`` in metres, one more than shares."""

    edges: FloatArray
    share: FloatArray


@dataclass(frozen=True, slots=True)
class Spacing:
    """How far two passes that lie beside each other were driven apart, in metres, against ``wanted``."""

    first: int
    second: int
    mean: float
    deviation: float
    wanted: float


def counted(log: DriveLog) -> np.ndarray:
    """Which rows count, shape (N,)."""
    on = log.on_pass & log.working & np.isfinite(log.cross_track) & (log.pass_number != NO_PASS)
    chosen: np.ndarray = on & (np.nan_to_num(log.along, nan=0.0) >= ENTRY)
    return chosen


def pass_qualities(log: DriveLog) -> tuple[PassQuality, ...]:
    """Each pass that was driven with enough fixes, by number."""
    chosen = counted(log)
    found = []
    for number in np.unique(log.pass_number[chosen]).tolist():
        mine = chosen & (log.pass_number == number)
        if int(mine.sum()) >= FEWEST:
            found.append(_quality(log, mine, int(number)))
    return tuple(found)


def overall(log: DriveLog) -> PassQuality | None:
    """All passes together; None when hardly anything was driven on one."""
    chosen = counted(log)
    return _quality(log, chosen, None) if int(chosen.sum()) >= FEWEST else None


def histogram(log: DriveLog, bin_width: float = 2 * CENTIMETRE, reach: float = 0.3) -> Histogram:
    """How often each cross-track error was driven; what lies beyond ``reach`` is in the outermost bins."""
    errors = np.clip(log.cross_track[counted(log)], -reach, reach)
    count = round(2 * reach / bin_width)
    edges = np.linspace(-reach, reach, count + 1)
    shares, _ = np.histogram(errors, edges)
    total = max(int(shares.sum()), 1)
    return Histogram(edges, shares / total)


def spacings(log: DriveLog, wanted: float) -> tuple[Spacing, ...]:
    """For each two passes with neighbouring numbers, how far apart they were driven."""
    chosen = counted(log) & np.isfinite(log.east)
    numbers = sorted(int(one) for one in np.unique(log.pass_number[chosen]))
    found = []
    for first in numbers:
        if first + 1 in numbers:
            apart = _apart(log, chosen & (log.pass_number == first), chosen & (log.pass_number == first + 1))
            if len(apart) >= FEWEST:
                found.append(Spacing(first, first + 1, float(apart.mean()), float(apart.std()), wanted))
    return tuple(found)


def _apart(log: DriveLog, one: np.ndarray, other: np.ndarray) -> FloatArray:
    """Distances across the way of ``one`` to ``other``, metre by metre where both were driven."""
    heading = log.heading[one]
    heading = heading[np.isfinite(heading)]
    if not len(heading):
        return np.zeros(0)
    # headings of a straight pass differ little; doubling them makes both ways of driving it the same
    direction = 0.5 * math.atan2(float(np.sin(2 * heading).mean()), float(np.cos(2 * heading).mean()))
    along = np.array([math.sin(direction), math.cos(direction)])
    right = np.array([math.cos(direction), -math.sin(direction)])

    def binned(mine: np.ndarray) -> dict[int, float]:
        points = np.column_stack([log.east[mine], log.north[mine]])
        places, sides = np.floor(points @ along).astype(int), points @ right
        return {int(place): float(sides[places == place].mean()) for place in np.unique(places)}

    first, second = binned(one), binned(other)
    return np.array([abs(second[place] - first[place]) for place in sorted(first.keys() & second.keys())])


def _quality(log: DriveLog, mine: np.ndarray, number: int | None) -> PassQuality:
    errors = log.cross_track[mine]
    sizes = np.abs(errors)
    steps = np.hypot(np.diff(log.east), np.diff(log.north))
    both = mine[1:] & mine[:-1]
    return PassQuality(
        number=number,
        fixes=int(mine.sum()),
        length=float(np.nansum(steps[both])),
        mean=float(errors.mean()),
        rms=float(np.sqrt((errors**2).mean())),
        p95=float(np.percentile(sizes, 95)),
        largest=float(sizes.max()),
        speed=float(np.nanmean(np.abs(log.speed[mine]))),
    )
