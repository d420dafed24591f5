"""Which recordings there are, and which one was cut off and can be gone on with, from their summaries alone."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from guidance_app.recording import RecordedDrive
from guidance_app.store.files import FolderLock, StoreError, write_atomically
from guidance_app.store.recordings import (
    EVENTS,
    RECORDINGS,
    SUMMARY,
    RecordingSummary,
    is_recording,
    open_recording,
    read_summary,
)
from guidance_app.store.recordings_writing import RecordingFolder, is_being_written

__all__ = ["ListedRecording", "Resumable", "finish_recording", "list_recordings", "resumable", "summary_of"]

LEAST_DURATION = 5.0
"""A drive that was cut off sooner (s) is not worth going on with."""


@dataclass(frozen=True, slots=True)
class ListedRecording:
    """A recording in a list. ``summary`` is None where it cannot be opened, and ``problem`` says why then."""

    path: Path
    summary: RecordingSummary | None
    problem: str | None = None
    being_written: bool = False


@dataclass(frozen=True, slots=True)
class Resumable:
    """A drive that was cut off: "go on: 6 of 24 passes done, 14:32". ``stopped_utc`` is when it was last heard of.

    ``pass_number`` is the target's, ``passes_done`` of ``passes_planned`` were driven; None without a plan.
    """

    path: Path
    field: str | None
    operation: str | None
    duration_s: float
    started_utc: str
    stopped_utc: str | None
    pass_number: int | None
    passes_done: int | None
    passes_planned: int | None
    worked_m2: float | None


def list_recordings(data: Path) -> tuple[ListedRecording, ...]:
    """Every recording of the data folder, the newest first. Reads events only where a summary is missing."""
    return tuple(_listed(folder) for folder in _folders(data))


def resumable(data: Path) -> Resumable | None:
    """The newest recording when it was cut off and no program writes it; None otherwise."""
    newest = next(_folders(data), None)
    if newest is None:
        return None
    found = _listed(newest)
    summary = found.summary
    if summary is None or summary.ended or found.being_written or summary.duration_s < LEAST_DURATION:
        return None
    return Resumable(
        found.path,
        summary.field,
        summary.operation,
        summary.duration_s,
        summary.started_utc,
        summary.written_utc,
        summary.pass_number,
        summary.passes_done,
        summary.passes_planned,
        summary.worked_m2,
    )


def finish_recording(folder: Path) -> None:
    """Ends a recording that was cut off: packed, and not offered again. Raises ``StoreError``."""
    writing, drive = RecordingFolder.go_on(folder)
    try:
        before = read_summary(folder)
        writing.pack()
        writing.write_summary(_known_of(drive, before).model_copy(update={"ended": True}))
    finally:
        writing.close()


def summary_of(drive: RecordedDrive) -> RecordingSummary:
    """What the events alone tell of a drive."""
    job = drive.job
    return RecordingSummary(
        started_utc=drive.meta.started_utc,
        duration_s=drive.duration,
        events=len(drive.events),
        ended=False,
        source=drive.meta.source,
        filter=drive.filter_name,
        field=None if job.field is None else job.field.name,
        operation=None if job.operation is None else job.operation.name,
        truncated=drive.truncated,
    )


def _folders(data: Path) -> Iterator[Path]:
    """Newest first: their names begin with the time."""
    try:
        found = [path for path in (data / RECORDINGS).iterdir() if path.is_dir() and is_recording(path)]
    except OSError:
        return iter(())
    return iter(sorted(found, key=lambda path: path.name, reverse=True))


def _listed(folder: Path) -> ListedRecording:
    writing = is_being_written(folder)
    before = read_summary(folder)
    if before is not None and (before.ended or writing or not _has_grown(folder)):
        return ListedRecording(folder, before, being_written=writing)
    try:
        drive = open_recording(folder)
    except StoreError as error:
        return ListedRecording(folder, None, str(error), writing)
    summary = _known_of(drive, before)
    if not writing:
        _remember(folder, summary)
    return ListedRecording(folder, summary, being_written=writing)


def _has_grown(folder: Path) -> bool:
    """Whether a drive went on after its last summary, as one that was cut off has."""
    try:
        return (folder / EVENTS).stat().st_mtime_ns > (folder / SUMMARY).stat().st_mtime_ns
    except OSError:
        return False


def _known_of(drive: RecordedDrive, before: RecordingSummary | None) -> RecordingSummary:
    """What the events tell, and what only the last summary knows."""
    summary = summary_of(drive)
    if before is None:
        return summary
    told = {"duration_s": summary.duration_s, "events": summary.events, "truncated": summary.truncated}
    return before.model_copy(update=told)


def _remember(folder: Path, summary: RecordingSummary) -> None:
    """Writes a summary that was made on demand; on a read-only disk it is made anew each time."""
    try:
        with FolderLock(folder.parent.parent).writing():
            write_atomically(folder / SUMMARY, summary.model_dump_json(indent=1).encode() + b"\n")
    except StoreError:
        return
