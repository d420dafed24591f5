"""A log through the whole engine without a screen: one row a fix, as a table for a spreadsheet or a script.

The columns: ``time_utc`` (ISO 8601 with Z, or the time of day while the stream has not told its date);
``latitude_deg``, ``longitude_deg``, ``east_m``, ``north_m`` of the reference point as filtered; ``heading_deg`` of the
body, clockwise from true north; ``speed_mps``, negative in reverse; ``pass`` and ``cross_track_m`` (positive right of
the pass in the direction of travel), ``predicted_cross_track_m`` after the look-ahead; ``worked_ha`` so far;
``heading_sigma_deg`` and ``position_sigma_m`` (the longer half axis of the one-sigma ellipse); ``standing`` and
``reverse`` as 0 or 1. What is unknown is empty.
"""

import math
from collections.abc import Iterable, Iterator

from guidance_app.batch.inspection import time_text
from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.estimation.filter import Filter, FilterSettings
from guidance_app.geodesy import FieldFrame
from guidance_app.model import Event, Fix, Pose, Snapshot, SourceDown

__all__ = ["COLUMNS", "longest_sigma", "processed", "rows_of"]

COLUMNS = (
    "time_utc",
    "latitude_deg",
    "longitude_deg",
    "east_m",
    "north_m",
    "heading_deg",
    "speed_mps",
    "pass",
    "cross_track_m",
    "predicted_cross_track_m",
    "worked_ha",
    "heading_sigma_deg",
    "position_sigma_m",
    "standing",
    "reverse",
    "quality",
)


def processed(
    events: Iterable[Event],
    job: Job,
    filter_name: str | None = None,
    settings: FilterSettings | None = None,
    estimator: Filter | None = None,
) -> Iterator[Snapshot]:
    """The snapshot after each fix of a log's chunks or a recording's events. ``estimator`` goes before the filter."""
    engine = Engine(job, filter_name=filter_name, settings=settings, estimator=estimator)
    seen: Fix | None = None
    for event in _with_end(events):
        for snapshot in engine.steps(event):
            if snapshot.fix is not seen:
                seen = snapshot.fix
                yield snapshot


def _with_end(events: Iterable[Event]) -> Iterator[Event]:
    arrival = 0.0
    for event in events:
        arrival = event.arrival
        yield event
    yield SourceDown(arrival, "the log has ended", ended=True)


def rows_of(snapshots: Iterable[Snapshot]) -> Iterator[tuple[str, ...]]:
    """One row of text a fix, in the order of ``COLUMNS``."""
    frame: FieldFrame | None = None
    for snapshot in snapshots:
        if frame is None and snapshot.origin_deg is not None:
            frame = FieldFrame(*snapshot.origin_deg)
        yield tuple(_cells(snapshot, frame))


def _cells(snapshot: Snapshot, frame: FieldFrame | None) -> Iterator[str]:
    fix, pose, guidance, prediction = snapshot.fix, snapshot.pose, snapshot.guidance, snapshot.prediction
    yield "" if fix is None else time_text(fix)
    yield from _place_cells(pose, frame)
    yield "" if guidance is None else str(guidance.target.number)
    yield "" if guidance is None else f"{guidance.cross_track:.4f}"
    yield "" if prediction is None or prediction.cross_track is None else f"{prediction.cross_track:.4f}"
    yield f"{snapshot.totals.worked / 1e4:.5f}"
    yield from _sigma_cells(pose)
    yield "" if fix is None else str(int(fix.quality))


def _place_cells(pose: Pose | None, frame: FieldFrame | None) -> Iterator[str]:
    if pose is None or frame is None:
        yield from [""] * 6
        return
    latitude, longitude = frame.degrees_from_east_north(pose.east, pose.north)
    yield f"{latitude:.9f}"
    yield f"{longitude:.9f}"
    yield f"{pose.east:.4f}"
    yield f"{pose.north:.4f}"
    yield f"{math.degrees(pose.heading):.3f}" if pose.heading_known else ""
    yield f"{pose.speed:.4f}"


def _sigma_cells(pose: Pose | None) -> Iterator[str]:
    if pose is None:
        yield from [""] * 4
        return
    known = pose.heading_sigma is not None and pose.heading_known
    yield f"{math.degrees(pose.heading_sigma):.3f}" if known and pose.heading_sigma is not None else ""
    yield "" if pose.covariance is None else f"{longest_sigma(pose.covariance):.4f}"
    yield str(int(pose.standing))
    yield str(int(pose.reverse))


def longest_sigma(covariance: tuple[float, float, float]) -> float:
    """The longer half axis of the one-sigma ellipse of (var east, cov, var north), in metres."""
    east, both, north = covariance
    middle = 0.5 * (east + north)
    return math.sqrt(max(middle + math.hypot(0.5 * (east - north), both), 0.0))
