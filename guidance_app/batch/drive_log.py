"""The columns of a drive: every input of it through the engine, one row a fix, as fast as the machine can.

Rows are gathered in plain lists of floats, one a column, and become arrays at the end: an eight-hour drive is a few
hundred thousand rows.
"""

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.estimation.filter import FilterSettings
from guidance_app.model import NO_PASS, CoverageTotals, DriveLog, Event, Snapshot
from guidance_app.recording import RecordedDrive

__all__ = ["DriveGathering", "drive_log", "gathered"]

UNKNOWN = math.nan
TELL_EVERY = 2000
Row = tuple[float, ...]
_WHOLE = frozenset({"quality", "satellites", "pass_number"})
_TRUTH = frozenset({"on_pass", "working", "standing"})


class DriveGathering:
    """Takes snapshots as they come and keeps a row for each new fix."""

    def __init__(self) -> None:
        self._rows: list[Row] = []
        self._seen: object = None
        self._last: Snapshot | None = None

    def take(self, snapshot: Snapshot) -> None:
        """One more snapshot; one without a new fix gives no row."""
        self._last = snapshot
        if snapshot.fix is self._seen or snapshot.fix is None:
            return
        self._seen = snapshot.fix
        self._rows.append(_row(snapshot))

    @property
    def totals(self) -> CoverageTotals | None:
        """What was worked in all; None before the first snapshot."""
        return None if self._last is None else self._last.totals

    @property
    def last(self) -> Snapshot | None:
        """The newest snapshot."""
        return self._last

    def log(self) -> DriveLog:
        """The columns so far."""
        names = DriveLog.columns()
        table = np.array(self._rows, dtype=float).reshape(-1, len(names))
        columns = {name: _typed(name, table[:, place]) for place, name in enumerate(names)}
        return DriveLog(**columns, origin_deg=None if self._last is None else self._last.origin_deg)


def drive_log(drive: RecordedDrive, progress: Callable[[float], None] | None = None) -> DriveLog:
    """The columns of a recording, as it was driven. ``progress`` hears from 0 to 1."""
    return gathered(drive.job, drive.events, drive.filter_name, drive.settings, progress).log()


def gathered(
    job: Job,
    events: Sequence[Event],
    filter_name: str | None = None,
    settings: FilterSettings | None = None,
    progress: Callable[[float], None] | None = None,
) -> DriveGathering:
    """Every row of these events, and the last snapshot. ``progress`` hears from 0 to 1."""
    engine = Engine(job, filter_name=filter_name, settings=settings)
    gathering = DriveGathering()
    for number, event in enumerate(_told(events, progress)):
        del number
        for snapshot in engine.steps(event):
            gathering.take(snapshot)
    return gathering


def _told(events: Sequence[Event], progress: Callable[[float], None] | None) -> Iterable[Event]:
    count = max(len(events), 1)
    for number, event in enumerate(events):
        if progress is not None and number % TELL_EVERY == 0:
            progress(number / count)
        yield event
    if progress is not None:
        progress(1.0)


def _typed(name: str, column: np.ndarray) -> np.ndarray:
    if name in _WHOLE:
        return column.astype(np.int32)
    return column.astype(np.bool_) if name in _TRUTH else np.ascontiguousarray(column)


def _row(snapshot: Snapshot) -> Row:
    return (*_received(snapshot), *_estimated(snapshot), *_guided(snapshot))


def _received(snapshot: Snapshot) -> Row:
    fix = snapshot.fix
    assert fix is not None
    return (snapshot.arrival, fix.t, _or(fix.utc), fix.latitude_deg, fix.longitude_deg)


def _estimated(snapshot: Snapshot) -> Row:
    pose, attitude, place = snapshot.pose, snapshot.attitude, snapshot.implement
    tilt = (UNKNOWN, UNKNOWN) if attitude is None else (_or(attitude.roll), _or(attitude.pitch))
    if pose is None:
        return (*[UNKNOWN] * 5, *tilt, *[UNKNOWN] * 3)
    heading = pose.heading if pose.heading_known else UNKNOWN
    sigma = UNKNOWN if pose.covariance is None else math.sqrt(max(pose.covariance[0] + pose.covariance[2], 0.0) / 2)
    return (pose.east, pose.north, heading, pose.speed, sigma, *tilt, *(place or [UNKNOWN] * 3))


def _guided(snapshot: Snapshot) -> Row:
    ahead, guidance, totals, fix = snapshot.prediction, snapshot.guidance, snapshot.totals, snapshot.fix
    assert fix is not None
    later = [UNKNOWN] * 4
    if ahead is not None:
        later = [ahead.pose.east, ahead.pose.north, ahead.pose.heading, _or(ahead.cross_track)]
    errors = [UNKNOWN] * 3
    if guidance is not None:
        errors = [guidance.cross_track, guidance.heading_error, guidance.along_track]
    standing = snapshot.pose is not None and snapshot.pose.standing
    return (
        *later,
        *errors,
        _or(fix.hdop),
        totals.worked,
        totals.overlap,
        float(fix.quality),
        -1.0 if fix.satellites is None else float(fix.satellites),
        float(NO_PASS if guidance is None else guidance.target.number),
        float(guidance is not None and guidance.on_pass),
        float(snapshot.working),
        float(standing),
    )


def _or(value: float | None) -> float:
    return UNKNOWN if value is None else value
