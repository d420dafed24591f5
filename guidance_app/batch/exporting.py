"""A recorded drive, or a receiver's log, gathered for other programs: driven once more, then looked at.

The worked area is the union of what the implement swept, step by step; the skips are what of the field lies outside of
it and is wide enough to be seen. Unions are made on a grid of a millimetre, on which they cannot fail.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from guidance_app.boundary import polygon_in
from guidance_app.documents import FieldDocument, Job, Position
from guidance_app.engine import Engine
from guidance_app.estimation.filter import FilterSettings
from guidance_app.exchange.drives import DriveEpoch, DriveExport
from guidance_app.exchange.drives.record import DrivePlace
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.swaths import without_slivers
from guidance_app.model import Attitude, Chunk, Event, Fix, Pose, Snapshot, SourceDown, Strip
from guidance_app.recording import RecordedDrive
from guidance_app.sources.file import FileLog

__all__ = ["drive_export", "log_export", "skipped_ground", "worked_ground"]

GRID = 1e-3
"""Metres."""
NARROWEST_SKIP = 0.1
"""Metres; narrower strips are the union's edge and nobody's skip."""
SMALLEST_SKIP = 1.0
"""m2."""


def drive_export(
    drive: RecordedDrive, filter_name: str | None = None, settings: FilterSettings | None = None
) -> DriveExport:
    """The drive with its own documents, and its own filter unless another is named."""
    engine = Engine(drive.job, filter_name=filter_name or drive.filter_name, settings=settings or drive.settings)
    return _gathered(drive.events, engine, drive.job, drive.name)


def log_export(
    log: FileLog, job: Job, filter_name: str | None = None, settings: FilterSettings | None = None
) -> DriveExport:
    """The drive of a log with these documents."""
    engine = Engine(job, filter_name=filter_name, settings=settings)
    end = SourceDown(log.duration, "the log has ended", ended=True)
    return _gathered(_followed(log.chunks, end), engine, job, log.description)


def worked_ground(strips: Sequence[Strip]) -> BaseGeometry:
    """The union of what the strips cover, in metres of the field frame."""
    parts = [_strip_ground(strip) for strip in strips if len(strip.left) > 1]
    return shapely.union_all(parts, grid_size=GRID)


def skipped_ground(field: shapely.Polygon, worked: BaseGeometry) -> BaseGeometry:
    """What of the field was not worked, without slivers."""
    left = shapely.difference(field, worked, grid_size=GRID)
    wide = without_slivers(left, NARROWEST_SKIP / 2)
    return shapely.union_all([part for part in shapely.get_parts(wide) if part.area >= SMALLEST_SKIP])


# --- one pass through the engine -------------------------------------------------------------------------------------


def _followed(chunks: Iterable[Chunk], end: SourceDown) -> Iterator[Event]:
    yield from chunks
    yield end


@dataclass(slots=True)
class _Gathering:
    """What adds up while the engine runs."""

    epochs: list[DriveEpoch]
    sentences: bytearray
    strips: dict[int, Strip]
    frame: FieldFrame | None = None


def _gathered(events: Iterable[Event], engine: Engine, job: Job, name: str) -> DriveExport:
    gathering = _Gathering([], bytearray(), {})
    seen: Fix | None = None
    for event in events:
        if isinstance(event, Chunk):
            gathering.sentences += event.data
        for snapshot in engine.steps(event):
            if snapshot.fix is not None and snapshot.fix is not seen:
                seen = snapshot.fix
                _take(snapshot, seen, gathering)
    last = engine.snapshot
    if last.worked is not None:
        pieces = [*last.worked.pieces[: last.worked.count], last.worked.open_piece]
        gathering.strips |= {piece.index: piece for piece in pieces if isinstance(piece, Strip)}
    return _export(gathering, last, job, name)


def _take(snapshot: Snapshot, fix: Fix, gathering: _Gathering) -> None:
    if gathering.frame is None and snapshot.origin_deg is not None:
        gathering.frame = FieldFrame(*snapshot.origin_deg)
    frame, guidance, prediction = gathering.frame, snapshot.guidance, snapshot.prediction
    attitude = snapshot.attitude or Attitude(fix.arrival)
    gathering.epochs.append(
        DriveEpoch(
            arrival=snapshot.arrival,
            t=fix.t,
            utc=fix.utc,
            raw=DrivePlace(fix.latitude_deg, fix.longitude_deg, fix.course, fix.speed),
            filtered=_place(snapshot.pose, frame),
            predicted=None if prediction is None else _place(prediction.pose, frame),
            quality=int(fix.quality),
            satellites=fix.satellites,
            hdop=fix.hdop,
            altitude=fix.altitude,
            heading=_first(fix.heading, attitude.heading),
            roll=_first(fix.roll, attitude.roll),
            pitch=_first(fix.pitch, attitude.pitch),
            yaw_rate=_first(fix.yaw_rate, attitude.yaw_rate),
            pass_number=None if guidance is None else guidance.target.number,
            cross_track=None if guidance is None else guidance.cross_track,
            predicted_cross_track=None if prediction is None else prediction.cross_track,
            working=snapshot.working,
        )
    )


def _first(own: float | None, sensor: float | None) -> float | None:
    return sensor if own is None else own


def _place(pose: Pose | None, frame: FieldFrame | None) -> DrivePlace | None:
    if pose is None or frame is None:
        return None
    latitude, longitude = frame.degrees_from_east_north(pose.east, pose.north)
    return DrivePlace(latitude, longitude, pose.heading if pose.heading_known else None, pose.speed)


# --- the ground ------------------------------------------------------------------------------------------------------


def _export(gathering: _Gathering, last: Snapshot, job: Job, name: str) -> DriveExport:
    frame = gathering.frame
    worked: BaseGeometry = worked_ground(list(gathering.strips.values()))
    skips: BaseGeometry | None = None
    field: FieldDocument | None = job.field
    if field is not None and frame is not None:
        skips = skipped_ground(polygon_in(frame, field.boundary), worked)
    return DriveExport(
        name=name,
        epochs=tuple(gathering.epochs),
        sentences=bytes(gathering.sentences),
        field=field,
        worked=_rings(worked, frame),
        skips=() if skips is None else _rings(skips, frame),
        worked_area=float(worked.area),
        skipped_area=None if skips is None else float(skips.area),
        overlap=last.totals.overlap,
        working_width=job.implement.working_width,
        tractor=job.tractor.name,
        implement=job.implement.name,
        look_ahead_s=last.look_ahead_s,
    )


def _strip_ground(strip: Strip) -> BaseGeometry:
    """The union of the strip's steps; a step in a tight turn may cross itself and counts as what it sweeps."""
    left, right = np.asarray(strip.left), np.asarray(strip.right)
    corners = np.stack([left[:-1], left[1:], right[1:], right[:-1], left[:-1]], axis=1)
    steps = np.asarray(shapely.polygons(corners))
    sound = shapely.is_valid(steps)
    crossing = [shapely.MultiPoint(one[:4]).convex_hull for one in corners[~sound]]
    flat = [one for one in (*steps[sound], *crossing) if one.area > 0]
    return shapely.union_all(flat, grid_size=GRID)


def _rings(ground: BaseGeometry, frame: FieldFrame | None) -> tuple[tuple[tuple[Position, ...], ...], ...]:
    """The polygons of a piece of ground in degrees, outer rings counter-clockwise."""
    if frame is None:
        return ()
    polygons = [part for part in shapely.get_parts(ground) if isinstance(part, shapely.Polygon) and part.area > 0]
    return tuple(
        tuple(
            tuple(
                (longitude, latitude)
                for longitude, latitude in frame.lonlat_from_array(np.asarray(ring.coords)).tolist()
            )
            for ring in (one.exterior, *one.interiors)
        )
        for one in (shapely.orient_polygons(polygon) for polygon in polygons)
    )
