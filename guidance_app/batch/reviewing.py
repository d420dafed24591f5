"""Recordings opened for looking back: their columns, kept beside the data so that the second time takes a moment.

A drive that is recorded keeps them while it is driven; other recordings go through the engine when they are opened
first.
"""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import shapely

from guidance_app.batch.drive_log import gathered
from guidance_app.boundary import frame_of, polygon_in
from guidance_app.documents import Job
from guidance_app.geodesy import FieldFrame
from guidance_app.model import CoverageTotals, DriveLog, FloatArray
from guidance_app.recording import RecordedDrive
from guidance_app.reports.ledger import Additions, LedgerEntry, ledger_entry
from guidance_app.store.files import StoreError, write_atomically
from guidance_app.store.recordings import job_in, opened, read_recording
from guidance_app.store.reviews import KeptColumns, keep_columns, kept_columns, place_of

__all__ = ["Review", "additions_of", "entry_of", "keep_additions", "opened_review"]

ADDITIONS = "ledger.json"


@dataclass(frozen=True, slots=True, eq=False)
class Review:
    """A recording with its columns and what was worked in all."""

    name: str
    job: Job
    log: DriveLog
    totals: CoverageTotals
    truncated: str | None

    @property
    def boundary(self) -> tuple[FloatArray, ...]:
        """The field's rings in the frame of the log; empty without a field."""
        if self.job.field is None:
            return ()
        frame = frame_of(self.job.field.boundary)
        if self.log.origin_deg is not None:
            frame = FieldFrame(*self.log.origin_deg)
        polygon = polygon_in(frame, self.job.field.boundary)
        return tuple(shapely.get_coordinates(ring) for ring in (polygon.exterior, *polygon.interiors))


def opened_review(path: Path, data: Path, progress: Callable[[float], None] | None = None) -> Review:
    """The review of a recording's folder or zip. Raises ``StoreError``; ``progress`` hears from 0 to 1."""
    files = read_recording(path)
    place = place_of(data, files)
    kept = kept_columns(place)
    if kept is not None and kept.whole:
        if progress is not None:
            progress(1.0)
        return Review(files.name, job_in(files), kept.log, kept.totals, None)
    drive = opened(files)
    if kept is None:
        log, totals = _made(drive, progress)
        kept = KeptColumns(log, totals, whole=drive.truncated is None)
        keep_columns(place, kept)
    return Review(drive.name, drive.job, kept.log, kept.totals, drive.truncated)


def _made(drive: RecordedDrive, progress: Callable[[float], None] | None) -> tuple[DriveLog, CoverageTotals]:
    gathering = gathered(drive.job, drive.events, drive.filter_name, drive.settings, progress)
    return gathering.log(), gathering.totals or CoverageTotals()


# --- what the driver adds --------------------------------------------------------------------------------------------


def additions_of(folder: Path) -> Additions:
    """What was written beside a recording; empty where nothing was. Raises ``StoreError`` for a broken file."""
    path = folder / ADDITIONS
    if not path.is_file():
        return Additions()
    try:
        return Additions(**json.loads(path.read_bytes()))
    except (OSError, ValueError, TypeError) as error:
        msg = f"{path} cannot be read as additions to the ledger: {error}"
        raise StoreError(msg) from error


def keep_additions(folder: Path, additions: Additions) -> None:
    """Writes them beside the recording. Raises ``StoreError``."""
    content = json.dumps(asdict(additions), ensure_ascii=False, indent=1).encode() + b"\n"
    write_atomically(folder / ADDITIONS, content)


def entry_of(review: Review, additions: Additions | None = None) -> LedgerEntry:
    """The ledger's entry of a review, with the field's boundary for its map."""
    entry = ledger_entry(review.name, review.job, review.log, review.totals, additions)
    return replace(entry, boundary=review.boundary)
