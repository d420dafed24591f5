"""What a log says of its receiver: how much of it is sound, how often and how finely it speaks, how far it went.

The record, and its JSON keys:

- ``sentences``: lines that are or were a sentence; each is ``decoded`` (read into values, also when it says that there
  is no fix), or counted in ``rejected`` by its reason. ``rejected`` also counts whole epochs that were not believed
  (reasons that begin with "implausible", and "position without time", "fix quality missing", "finer position missing").
- ``fixes``, ``no_fixes``: epochs with a position, and epochs in which the receiver said that it has none.
  ``attitudes``: readings of an attitude sensor apart from the fixes. ``without_checksum``: decoded all the same.
- ``interval_s``: median time between fixes, null with fewer than two. ``duration_s``: from the log's first epoch to its
  last. ``length_m``: the way through the fixes on the ellipsoid, in steps of at least a metre, so that a receiver that
  stands does not seem to wander.
- ``grid_m``: [north, east] of the receiver's rounding, as most fixes have it; null without a fix.
- ``quality``: how many fixes of each quality. ``kinds``: how many sentences of each kind were decoded.
"""

import math
import statistics
from array import array
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta

from pyproj import Geod

from guidance_app.decode.decoder import Decoder
from guidance_app.model import Attitude, Fix, NoFix, Observation
from guidance_app.sources.file import FileLog

__all__ = ["FIX_COLUMNS", "Inspection", "fix_row", "inspect", "json_of", "time_text"]

FIX_COLUMNS = (
    "time_utc",
    "latitude_deg",
    "longitude_deg",
    "quality",
    "hdop",
    "satellites",
    "speed_mps",
    "course_deg",
    "heading_deg",
)
"""Columns of the table of fixes; ``quality`` is the number of GGA's field 6, and what is unknown is empty."""

LEAST_STEP = 1.0
"""Metres: shorter steps are added up until they reach it."""
MILLISECONDS = 1000
_EARTH = Geod(ellps="WGS84")


@dataclass(frozen=True, slots=True)
class Inspection:
    """What was found in a log; the top of this file tells each number's meaning. Seconds and metres."""

    sentences: int
    decoded: int
    rejected: Mapping[str, int]
    without_checksum: int
    kinds: Mapping[str, int]
    fixes: int
    no_fixes: int
    attitudes: int
    interval: float | None
    duration: float
    length: float
    cell: tuple[float, float] | None
    quality: Mapping[str, int]


def inspect(log: FileLog, hear: Callable[[Fix], None] | None = None) -> Inspection:
    """Decodes the whole log once; ``hear`` is given each fix as it comes."""
    decoder = Decoder()
    found = _Found()
    for observation in _observations(log, decoder):
        match observation:
            case Fix():
                found.add(observation)
                if hear is not None:
                    hear(observation)
            case NoFix():
                found.no_fixes += 1
            case Attitude():
                found.attitudes += 1
    return Inspection(
        sentences=decoder.sentences,
        decoded=sum(decoder.kinds.values()),
        rejected=dict(decoder.rejected.most_common()),
        without_checksum=decoder.unchecked,
        kinds=dict(decoder.kinds.most_common()),
        fixes=found.fixes,
        no_fixes=found.no_fixes,
        attitudes=found.attitudes,
        interval=statistics.median(found.intervals) if found.intervals else None,
        duration=log.duration,
        length=found.length,
        cell=found.usual_cell(),
        quality=dict(found.quality.most_common()),
    )


def json_of(inspection: Inspection) -> dict[str, object]:
    """The record with its units in its names, ready for ``json.dumps``."""
    return {
        "sentences": inspection.sentences,
        "decoded": inspection.decoded,
        "rejected": dict(inspection.rejected),
        "without_checksum": inspection.without_checksum,
        "kinds": dict(inspection.kinds),
        "fixes": inspection.fixes,
        "no_fixes": inspection.no_fixes,
        "attitudes": inspection.attitudes,
        "interval_s": None if inspection.interval is None else round(inspection.interval, 6),
        "duration_s": round(inspection.duration, 6),
        "length_m": round(inspection.length, 3),
        "grid_m": None if inspection.cell is None else [round(metres, 9) for metres in inspection.cell],
        "quality": dict(inspection.quality),
    }


def fix_row(fix: Fix) -> tuple[str, ...]:
    """The cells of ``FIX_COLUMNS``."""
    return (
        time_text(fix),
        f"{fix.latitude_deg:.9f}",
        f"{fix.longitude_deg:.9f}",
        str(int(fix.quality)),
        "" if fix.hdop is None else f"{fix.hdop:g}",
        "" if fix.satellites is None else str(fix.satellites),
        "" if fix.speed is None else f"{fix.speed:.4f}",
        "" if fix.course is None else f"{math.degrees(fix.course):.3f}",
        "" if fix.heading is None else f"{math.degrees(fix.heading):.3f}",
    )


def time_text(fix: Fix) -> str:
    """ISO 8601 with Z and milliseconds; only the time of day while the stream has not told its date."""
    seconds = fix.t if fix.utc is None else fix.utc
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(milliseconds=round(seconds * MILLISECONDS))
    text = moment.isoformat(timespec="milliseconds")[: -len("+00:00")]
    return text.partition("T")[2] if fix.utc is None else text + "Z"


def _observations(log: FileLog, decoder: Decoder) -> Iterator[Observation]:
    for chunk in log.chunks:
        yield from decoder.feed(chunk)
    yield from decoder.finish(log.duration)


@dataclass(slots=True)
class _Found:
    """What adds up over a log."""

    fixes: int = 0
    no_fixes: int = 0
    attitudes: int = 0
    length: float = 0.0
    quality: Counter[str] = field(default_factory=Counter)
    intervals: "array[float]" = field(default_factory=lambda: array("d"))
    cells: Counter[float] = field(default_factory=Counter)
    east_of: dict[float, float] = field(default_factory=dict)
    last_t: float | None = None
    last_place: tuple[float, float] | None = None

    def add(self, fix: Fix) -> None:
        self.fixes += 1
        self.quality[fix.quality.name.lower()] += 1
        if self.last_t is not None and fix.t > self.last_t:
            self.intervals.append(fix.t - self.last_t)
        self.last_t = fix.t
        if fix.cell is not None:
            north, east = fix.cell
            self.cells[north] += 1
            self.east_of.setdefault(north, east)
        self._go_to(fix)

    def _go_to(self, fix: Fix) -> None:
        here = (fix.longitude_deg, fix.latitude_deg)
        if self.last_place is None:
            self.last_place = here
            return
        step = float(_EARTH.inv(*self.last_place, *here)[2])
        if step >= LEAST_STEP:
            self.length += step
            self.last_place = here

    def usual_cell(self) -> tuple[float, float] | None:
        """The commonest rounding, its east part as at the first fix that had it."""
        if not self.cells:
            return None
        north = self.cells.most_common(1)[0][0]
        return north, self.east_of[north]
