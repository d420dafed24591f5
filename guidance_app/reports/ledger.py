"""The ledger: what was done where, by whom and with what, one entry a drive (the operation report of Inoue et al.).

Product, rate, fuel and notes are what the driver adds; everything else comes out of the recorded inputs.
"""

import datetime
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import field as member

import numpy as np

from guidance_app.documents import Job
from guidance_app.language import Words, message
from guidance_app.model import CoverageTotals, DriveLog, FloatArray
from guidance_app.reports.quality import overall

__all__ = ["Additions", "Cell", "LedgerEntry", "Stop", "columns", "heading_of", "ledger_entry", "row_of", "sums_of"]

HECTARE = 10_000.0
HOUR = 3600.0
SHORTEST_STOP = 30.0
"""A standstill of at least so many seconds is a stop."""
LONGEST_STEP = 5.0
"""A gap between two fixes that is longer (s) is no driving."""
MOST_POINTS = 600
"""Of the map's lines; a sheet needs no more."""


@dataclass(frozen=True, slots=True)
class Additions:
    """What the driver writes beside a drive. Amounts are free text with their unit ("180 kg/ha", "34 l")."""

    product: str = ""
    rate: str = ""
    fuel: str = ""
    driver: str = ""
    notes: str = ""


@dataclass(frozen=True, slots=True)
class Stop:
    """A standstill: when it began, in seconds since the start, and how long it was."""

    at: float
    seconds: float


@dataclass(frozen=True, slots=True, eq=False)
class LedgerEntry:
    """One drive in the ledger. Areas in m2, times in seconds, distances in metres; None where unknown.

    ``working_s`` is the time with the implement down; ``boundary`` and ``track`` are for the map: shape (N, 2) each,
    east and north; ``worked_track`` are the stretches that were worked.
    """

    name: str
    field: str
    operation: str
    tractor: str
    implement: str
    width: float
    additions: Additions
    start: datetime.datetime | None
    end: datetime.datetime | None
    duration_s: float
    working_s: float
    stops: tuple[Stop, ...]
    distance: float
    worked: float
    overlap: float
    missed: float | None
    mean_speed: float | None
    rms: float | None
    p95: float | None
    boundary: tuple[FloatArray, ...] = ()
    track: FloatArray = member(default_factory=lambda: np.zeros((0, 2)))
    worked_track: tuple[FloatArray, ...] = ()

    @property
    def rate_per_hour(self) -> float | None:
        """Worked m2 per second of working time; None without any."""
        return self.worked / self.working_s if self.working_s > 0 else None


def ledger_entry(
    name: str, job: Job, log: DriveLog, totals: CoverageTotals, additions: Additions | None = None
) -> LedgerEntry:
    """The entry of one drive. ``log.utc`` gives the times, where the receiver told its date."""
    known = np.isfinite(log.utc)
    begin = float(log.utc[known][0]) if known.any() else None
    finish = float(log.utc[known][-1]) if known.any() else None
    quality = overall(log)
    moving = np.isfinite(log.speed) & (np.abs(log.speed) > 0.2)
    given = additions or Additions()
    operation = job.operation
    return LedgerEntry(
        name=name,
        field="" if job.field is None else job.field.name,
        operation="" if operation is None else operation.name,
        tractor=job.tractor.name,
        implement=job.implement.name,
        width=job.implement.working_width,
        additions=given if given.driver or operation is None else _with_driver(given, operation.driver),
        start=_moment(begin),
        end=_moment(finish),
        duration_s=float(log.t[-1] - log.t[0]) if len(log) else 0.0,
        working_s=_time_where(log, log.working),
        stops=_stops(log),
        distance=totals.distance or _distance(log),
        worked=totals.worked,
        overlap=totals.overlap,
        missed=totals.left,
        mean_speed=float(np.abs(log.speed[moving]).mean()) if moving.any() else None,
        rms=None if quality is None else quality.rms,
        p95=None if quality is None else quality.p95,
        track=_thinned(np.column_stack([log.east, log.north])),
        worked_track=_worked(log),
    )


def _with_driver(additions: Additions, driver: str) -> Additions:
    return Additions(additions.product, additions.rate, additions.fuel, driver, additions.notes)


def _moment(posix: float | None) -> datetime.datetime | None:
    return None if posix is None else datetime.datetime.fromtimestamp(posix, datetime.UTC)


def _time_where(log: DriveLog, chosen: np.ndarray) -> float:
    steps = np.diff(log.t)
    steps[(steps < 0) | (steps > LONGEST_STEP)] = 0.0
    return float(steps[chosen[1:]].sum())


def _distance(log: DriveLog) -> float:
    return float(np.nansum(np.hypot(np.diff(log.east), np.diff(log.north))))


def _stops(log: DriveLog) -> tuple[Stop, ...]:
    """Every standstill that was long enough."""
    if len(log) < 2:
        return ()
    edges = np.flatnonzero(np.diff(np.concatenate([[False], log.standing, [False]]).astype(int)))
    found = []
    for first, after in zip(edges[::2], edges[1::2], strict=True):
        seconds = float(log.t[min(after, len(log) - 1)] - log.t[first])
        if seconds >= SHORTEST_STOP:
            found.append(Stop(float(log.t[first] - log.t[0]), seconds))
    return tuple(found)


def _worked(log: DriveLog) -> tuple[FloatArray, ...]:
    """The stretches driven with the implement down."""
    places = np.column_stack([log.implement_east, log.implement_north])
    good = log.working & np.isfinite(places).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(int)))
    pieces = [places[first:after] for first, after in zip(edges[::2], edges[1::2], strict=True) if after - first > 1]
    share = max(MOST_POINTS // max(len(pieces), 1), 2)
    return tuple(_thinned(piece, share) for piece in pieces)


def _thinned(points: FloatArray, most: int = MOST_POINTS) -> FloatArray:
    good = points[np.isfinite(points).all(axis=1)]
    every = max(len(good) // most, 1)
    thin: FloatArray = good[::every]
    return thin if not len(good) else np.vstack([thin, good[-1]])


# --- the table -------------------------------------------------------------------------------------------------------


def columns() -> tuple[tuple[str, str], ...]:
    """The heading and the unit of each column of a sheet, in order; headings are keys of the catalogues."""
    return (
        (message("Recording"), ""),
        (message("Field"), ""),
        (message("Operation"), ""),
        (message("Driver"), ""),
        (message("Tractor"), ""),
        (message("Implement"), ""),
        (message("Width"), "m"),
        (message("Start"), "UTC"),
        (message("End"), "UTC"),
        (message("Duration"), "h"),
        (message("Working time"), "h"),
        (message("Stops"), ""),
        (message("Standing"), "h"),
        (message("Distance"), "km"),
        (message("Area worked"), "ha"),
        (message("Overlap"), "ha"),
        (message("Left"), "ha"),
        (message("Speed"), "km/h"),
        (message("Area per hour"), "ha/h"),
        (message("Error rms"), "cm"),
        (message("Error 95 %"), "cm"),
        (message("Product"), ""),
        (message("Application rate"), ""),
        (message("Fuel"), ""),
        (message("Notes"), ""),
    )


Cell = str | int | float | None


def row_of(entry: LedgerEntry) -> tuple[Cell, ...]:
    """The cells of one entry in the order of ``columns``: text, numbers in the columns' units, None where unknown."""
    per_hour = entry.rate_per_hour
    return (
        entry.name,
        entry.field,
        entry.operation,
        entry.additions.driver,
        entry.tractor,
        entry.implement,
        entry.width,
        _when(entry.start),
        _when(entry.end),
        entry.duration_s / HOUR,
        entry.working_s / HOUR,
        len(entry.stops),
        sum(stop.seconds for stop in entry.stops) / HOUR,
        entry.distance / 1000.0,
        entry.worked / HECTARE,
        entry.overlap / HECTARE,
        None if entry.missed is None else entry.missed / HECTARE,
        None if entry.mean_speed is None else entry.mean_speed * 3.6,
        None if per_hour is None else per_hour * HOUR / HECTARE,
        None if entry.rms is None else entry.rms * 100,
        None if entry.p95 is None else entry.p95 * 100,
        entry.additions.product,
        entry.additions.rate,
        entry.additions.fuel,
        entry.additions.notes,
    )


SUMMED = frozenset({"Duration", "Working time", "Stops", "Standing", "Distance", "Area worked", "Overlap"})


def sums_of(entries: Sequence[LedgerEntry]) -> tuple[Cell, ...]:
    """The sums of what can be summed; None elsewhere."""
    rows = [row_of(entry) for entry in entries]
    sums: list[Cell] = []
    for place, (heading, _) in enumerate(columns()):
        values = [row[place] for row in rows]
        sums.append(sum(v for v in values if isinstance(v, int | float)) if heading in SUMMED else None)
    return tuple(sums)


def heading_of(name: str, unit: str, words: Words) -> str:
    """``Area worked (ha)`` in the sheet's language."""
    return f"{words(name)} ({unit})" if unit else words(name)


def _when(moment: datetime.datetime | None) -> str:
    return "" if moment is None else moment.strftime("%Y-%m-%d %H:%M")
