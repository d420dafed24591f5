"""The columns of a drive from its snapshots, one row a fix, whether it is driven now or taken once more.

Rows are gathered as plain numbers, 248 bytes each, and become arrays at the end: an eight-hour drive at 10 Hz has a few
hundred thousand.
"""

import math
from array import array

import numpy as np

from guidance_app.model import NO_PASS, CoverageTotals, DriveLog, Snapshot

__all__ = ["DriveGathering", "columns_of"]

UNKNOWN = math.nan
Row = tuple[float, ...]
_WHOLE = frozenset({"quality", "satellites", "pass_number"})
_TRUTH = frozenset({"on_pass", "working", "standing"})


class DriveGathering:
    """Takes snapshots as they come and keeps a row for each new fix."""

    def __init__(self, last: Snapshot | None = None) -> None:
        """``last`` is the snapshot whose row was taken already, where a drive is gone on with."""
        self._rows = array("d")
        self._seen: object = None if last is None else last.fix
        self._last = last

    def take(self, snapshot: Snapshot) -> None:
        """One more snapshot; one without a new fix gives no row."""
        self._last = snapshot
        if snapshot.fix is self._seen or snapshot.fix is None:
            return
        self._seen = snapshot.fix
        self._rows.extend(_row(snapshot))

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
        return columns_of(self._rows.tobytes(), None if self._last is None else self._last.origin_deg)

    def hand_over(self) -> bytes:
        """The rows since the last time as ``columns_of`` reads them; they are forgotten here."""
        rows, self._rows = self._rows.tobytes(), array("d")
        return rows


def columns_of(rows: bytes, origin_deg: tuple[float, float] | None) -> DriveLog:
    """The columns of rows that ``hand_over`` gave, one after the other."""
    names = DriveLog.columns()
    table = np.frombuffer(rows, dtype=float).reshape(-1, len(names))
    columns = {name: _typed(name, table[:, place]) for place, name in enumerate(names)}
    return DriveLog(**columns, origin_deg=origin_deg)


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
