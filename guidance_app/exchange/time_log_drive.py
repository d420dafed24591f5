"""A time log of ISOXML as a drive: rows for a person, NMEA for any program, events for a recording to look at again.

The work state is that of DDI 141, else of the condensed states of the sections (DDI 161 to 176); the width is DDI 67.
A log holds no speed of its own: it is computed from the positions, and never written into NMEA as if it had been
measured. Times are taken as UTC, which programs do not always keep to.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import reduce
from operator import xor
from pathlib import Path
from typing import TypeVar

from pyproj import Geod

from guidance_app.boundary import BoundaryError
from guidance_app.exchange.asking import ExchangeError
from guidance_app.exchange.files import Files, files_at, files_in
from guidance_app.exchange.isoxml import root_of
from guidance_app.exchange.time_log import Instant, LoggedValue, TimeLogFile, log_names, read_instants
from guidance_app.exchange.xml_tree import Element, children
from guidance_app.model import Chunk, Commanded, Event, FixQuality, SetWork, SetWorkMode, SourceDown, SourceUp, WorkMode

__all__ = ["TimeLog", "TimeLogRow", "events_of", "nmea_of", "read_time_log", "time_log_names"]

WORK_STATE, ACTUAL_WIDTH = 141, 67
CONDENSED = range(161, 177)
"""Sixteen sections each, two bits a section; 1 is on."""
SECTIONS_IN_ONE = 16
ON = 1
UNKNOWN_STATUS = FixQuality.AUTONOMOUS
SPEED_OVER = 2.0
"""Seconds at most on either side of a row over which its speed is taken."""
T = TypeVar("T")
_EARTH = Geod(ellps="WGS84")


@dataclass(frozen=True, slots=True)
class TimeLogRow:
    """One instant with a position. ``speed`` in m/s from the positions around; ``width`` in metres; None is unknown."""

    utc: float
    latitude_deg: float
    longitude_deg: float
    up: float | None
    quality: FixQuality
    satellites: int | None
    hdop: float | None
    speed: float | None
    working: bool | None
    width: float | None


@dataclass(frozen=True, slots=True)
class TimeLog:
    """A drive from a time log. ``field`` is the name of the task's field; ``warnings`` are for the person who asked."""

    name: str
    task: str
    field: str | None
    rows: tuple[TimeLogRow, ...]
    warnings: tuple[str, ...]

    @property
    def widest(self) -> float | None:
        """The largest working width in metres; None where the log tells none."""
        return max((row.width for row in self.rows if row.width), default=None)


def time_log_names(source: Path | bytes, name: str = "") -> tuple[str, ...]:
    """The time logs of an ISOXML folder or archive whose files are there. Raises ``ExchangeError``."""
    return _told(source, name, log_names)


def read_time_log(source: Path | bytes, log: str | None = None, name: str = "") -> TimeLog:
    """The drive of one time log, of the only one without ``log``. Raises ``ExchangeError``."""
    return _told(source, name, lambda files: _drive(files, log))


def nmea_of(log: TimeLog) -> bytes:
    """GGA and RMC of every row, without speed and course, which the log does not hold."""
    return b"".join(_epoch(row) for row in log.rows)


def events_of(log: TimeLog) -> tuple[Event, ...]:
    """The drive as an engine takes it: the work state by the button, at the rows where it changes."""
    start = log.rows[0].utc
    events: list[Event] = [SourceUp(0.0, f"the time log {log.name}"), Commanded(0.0, SetWorkMode(WorkMode.BUTTON))]
    working: bool | None = None
    for row in log.rows:
        arrival = row.utc - start
        if row.working is not None and row.working != working:
            working = row.working
            events.append(Commanded(arrival, SetWork(down=working)))
        events.append(Chunk(arrival, _epoch(row)))
    return (*events, SourceDown(log.rows[-1].utc - start, f"the end of the time log {log.name}", ended=True))


# --- reading ---------------------------------------------------------------------------------------------------------


def _told(source: Path | bytes, name: str, read: Callable[[Files], T]) -> T:
    said = str(source) if isinstance(source, Path) else (name or "the archive")
    try:
        return read(files_at(source) if isinstance(source, Path) else files_in(source, name))
    except BoundaryError as error:
        raise ExchangeError(f"{said}: {error}") from error
    except OSError as error:
        raise ExchangeError(f"{said} cannot be read: {error.strerror or error}") from error


def _drive(files: Files, log: str | None) -> TimeLog:
    names = log_names(files)
    if log is None and len(names) != 1:
        msg = f"it has {len(names)} time logs ({', '.join(names)}): name one" if names else "it has no time log"
        raise BoundaryError(msg)
    wanted = log or names[0]
    root, _ = root_of(files)
    task = _task_of(root, wanted)
    if task is None:
        msg = f"no task in it has the time log {wanted}; there are {', '.join(names) or 'none'}"
        raise BoundaryError(msg)
    read = read_instants(files, wanted)
    rows, warnings = _rows(read)
    fields = {field.get("A"): field.get("C") or field.get("B") for field in children(root, "PFD")}
    return TimeLog(wanted, task.get("B") or task.get("A") or wanted, fields.get(task.get("E")), rows, warnings)


def _task_of(root: Element, log: str) -> Element | None:
    tasks = children(root, "TSK")
    return next((task for task in tasks if any(one.get("A") == log for one in children(task, "TLG"))), None)


def _rows(log: TimeLogFile) -> tuple[tuple[TimeLogRow, ...], tuple[str, ...]]:
    warnings = ["the log's times are taken as UTC"]
    if log.cut_off:
        warnings.append(f"{log.cut_off} bytes at the end of the log make no record and are left out")
    placed: list[Instant] = []
    for instant in log.instants:
        if instant.position is not None and (not placed or instant.utc > placed[-1].utc):
            placed.append(instant)
    if not placed:
        msg = f"the time log {log.name} holds no position"
        raise BoundaryError(msg)
    if len(placed) < len(log.instants):
        warnings.append(
            f"{len(log.instants) - len(placed)} of {len(log.instants)} records have no position or step back in time"
            " and are left out"
        )
    speeds = _speeds(placed)
    rows = tuple(_row(instant, log.layout, speed) for instant, speed in zip(placed, speeds, strict=True))
    if not any(_told_status(instant) for instant in placed):
        warnings.append("the log does not tell the fix quality, which is taken as autonomous")
    if all(row.working is None for row in rows):
        warnings.append("the log tells no work state")
    return rows, tuple(warnings)


def _row(instant: Instant, layout: Sequence[LoggedValue], speed: float | None) -> TimeLogRow:
    latitude, longitude = instant.position or (math.nan, math.nan)
    satellites, hdop = instant.members.get("G"), instant.members.get("F")
    width = _in_force(instant, layout, ACTUAL_WIDTH)
    return TimeLogRow(
        utc=instant.utc,
        latitude_deg=latitude,
        longitude_deg=longitude,
        up=instant.up,
        quality=_told_status(instant) or UNKNOWN_STATUS,
        satellites=None if satellites is None or satellites > 254 else int(satellites),
        hdop=None if hdop is None or hdop >= 6553 else hdop / 10,
        speed=speed,
        working=_working(instant, layout),
        width=None if width is None or width < 0 else width / 1000,
    )


def _told_status(instant: Instant) -> FixQuality | None:
    """The quality of the fix; None for no fix, an error or not known, as the standard has them above 8."""
    status = int(instant.members.get("D", 15))
    return FixQuality(status) if 0 < status <= FixQuality.SIMULATED else None


def _in_force(instant: Instant, layout: Sequence[LoggedValue], ddi: int) -> int | None:
    """The largest value of this identifier that is in force; several elements may log the same."""
    found = [instant.values[n] for n, value in enumerate(layout) if value.ddi == ddi and n in instant.values]
    return max(found, default=None)


def _working(instant: Instant, layout: Sequence[LoggedValue]) -> bool | None:
    states = [instant.values[n] for n, value in enumerate(layout) if value.ddi == WORK_STATE and n in instant.values]
    if any(state in {0, ON} for state in states):
        return ON in states
    condensed = [
        (instant.values[n] >> (2 * place)) & 3
        for n, value in enumerate(layout)
        if value.ddi in CONDENSED and n in instant.values
        for place in range(SECTIONS_IN_ONE)
    ]
    return ON in condensed if any(state in {0, ON} for state in condensed) else None


def _speeds(instants: Sequence[Instant]) -> list[float | None]:
    """Way over time between the neighbours of each row that are near in time."""
    speeds: list[float | None] = []
    for number, here in enumerate(instants):
        before, after = instants[max(0, number - 1)], instants[min(len(instants) - 1, number + 1)]
        first = before if here.utc - before.utc <= SPEED_OVER else here
        last = after if after.utc - here.utc <= SPEED_OVER else here
        seconds = last.utc - first.utc
        if seconds <= 0 or first.position is None or last.position is None:
            speeds.append(None)
            continue
        _, _, metres = _EARTH.inv(first.position[1], first.position[0], last.position[1], last.position[0])
        speeds.append(float(metres) / seconds)
    return speeds


# --- NMEA ------------------------------------------------------------------------------------------------------------


def _epoch(row: TimeLogRow) -> bytes:
    moment = datetime.fromtimestamp(round(row.utc, 2), UTC)
    clock = f"{moment:%H%M%S}.{moment.microsecond // 10_000:02d}"
    place = f"{_minutes(row.latitude_deg, 2, 'NS')},{_minutes(row.longitude_deg, 3, 'EW')}"
    satellites = "" if row.satellites is None else f"{row.satellites:02d}"
    hdop = "" if row.hdop is None else f"{row.hdop:.1f}"
    up = "" if row.up is None else f"{row.up:.3f}"
    return b"".join(
        _sentence(body)
        for body in (
            f"GPGGA,{clock},{place},{row.quality.value},{satellites},{hdop},{up},M,,M,,",
            f"GPRMC,{clock},A,{place},,,{moment:%d%m%y},,",
        )
    )


def _minutes(degrees: float, width: int, sides: str) -> str:
    """Degrees and minutes to 7 decimals, rounded in one go so that no minute ever reads 60."""
    whole, rest = divmod(round(abs(degrees) * 60 * 10**7), 60 * 10**7)
    minutes, part = divmod(rest, 10**7)
    return f"{whole:0{width}d}{minutes:02d}.{part:07d},{sides[degrees < 0]}"


def _sentence(body: str) -> bytes:
    return f"${body}*{reduce(xor, body.encode('ascii'), 0):02X}\r\n".encode("ascii")
