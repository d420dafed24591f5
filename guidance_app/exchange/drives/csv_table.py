"""A drive as a table: every epoch with its raw, filtered and predicted position, direction and attitude.

These are what Inoue et al. record of a drive. Degrees here, as spreadsheets want them; what is unknown is empty.
"""

import csv
import io
import math
from collections.abc import Iterator

from guidance_app.exchange.drives.record import DriveEpoch, DriveExport, DrivePlace, time_text

__all__ = ["COLUMNS", "cells_of", "written"]

PLACE = ("latitude_deg", "longitude_deg", "heading_deg", "speed_mps")
COLUMNS = (
    "time_utc",
    "arrival_s",
    "quality",
    "satellites",
    "hdop",
    "altitude_m",
    "raw_latitude_deg",
    "raw_longitude_deg",
    "raw_course_deg",
    "raw_speed_mps",
    "sensor_heading_deg",
    "roll_deg",
    "pitch_deg",
    "yaw_rate_degps",
    *(f"filtered_{name}" for name in PLACE),
    *(f"predicted_{name}" for name in PLACE),
    "pass",
    "cross_track_m",
    "predicted_cross_track_m",
    "working",
)


def written(drive: DriveExport) -> bytes:
    """The table, a row an epoch."""
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(cells_of(epoch) for epoch in drive.epochs)
    return table.getvalue().encode()


def cells_of(epoch: DriveEpoch) -> tuple[str, ...]:
    """The epoch's row, in the order of ``COLUMNS``."""
    return (
        time_text(epoch),
        f"{epoch.arrival:.3f}",
        str(epoch.quality),
        "" if epoch.satellites is None else str(epoch.satellites),
        _number(epoch.hdop, 2),
        _number(epoch.altitude, 3),
        *_place(epoch.raw),
        _degrees(epoch.heading),
        _degrees(epoch.roll),
        _degrees(epoch.pitch),
        _degrees(epoch.yaw_rate),
        *_place(epoch.filtered),
        *_place(epoch.predicted),
        "" if epoch.pass_number is None else str(epoch.pass_number),
        _number(epoch.cross_track, 4),
        _number(epoch.predicted_cross_track, 4),
        str(int(epoch.working)),
    )


def _place(place: DrivePlace | None) -> Iterator[str]:
    if place is None:
        yield from [""] * len(PLACE)
        return
    yield f"{place.latitude_deg:.9f}"
    yield f"{place.longitude_deg:.9f}"
    yield _degrees(place.heading)
    yield _number(place.speed, 4)


def _degrees(radians: float | None) -> str:
    return "" if radians is None else f"{math.degrees(radians):.4f}"


def _number(value: float | None, decimals: int) -> str:
    return "" if value is None else f"{value:.{decimals}f}"
