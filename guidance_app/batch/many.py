"""Any number of logs and recordings through the engine, each one a task that may be done here, beside, or far away.

A task that goes far brings its bytes along, so the workers of a cluster need no common disk; what comes back is the
table. What is bad about one input is said in its outcome and stops no other.
"""

import csv
import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from guidance_app.batch.processing import COLUMNS, processed, rows_of
from guidance_app.batch.smoothing import smoothed_poses
from guidance_app.documents import Job
from guidance_app.estimation.filter import FilterSettings
from guidance_app.model import Event, Snapshot
from guidance_app.sources import SourceError
from guidance_app.sources.file import FileLog, load_log
from guidance_app.store import StoreError
from guidance_app.store.recordings import RecordingFiles, is_recording, opened, read_recording

__all__ = ["Outcome", "Task", "Way", "brought_along", "drive_of", "outcome_of", "table_of"]


@dataclass(frozen=True, slots=True)
class Way:
    """How inputs are processed. ``job`` is for logs; a recording has its own. ``filter_name`` goes before any other."""

    job: Job
    filter_name: str | None = None
    settings: FilterSettings | None = None
    smooth: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """One input: its path, or its content brought along; ``name`` is that of its table."""

    name: str
    source: Path | FileLog | RecordingFiles
    way: Way


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a task: a table, or the ``problem`` in a sentence. ``truncated`` says where a recording ends."""

    name: str
    table: str = ""
    fixes: int = 0
    duration: float = 0.0
    worked_m2: float = 0.0
    truncated: str | None = None
    problem: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """What an engine is made of and given."""

    events: Sequence[Event]
    job: Job
    filter_name: str | None
    settings: FilterSettings | None
    duration: float
    truncated: str | None = None


def drive_of(source: Path | FileLog | RecordingFiles, way: Way) -> Drive:
    """The drive in an input. Raises ``SourceError`` or ``StoreError``."""
    source = _content(source)
    if isinstance(source, FileLog):
        return Drive(source.chunks, way.job, way.filter_name, way.settings, source.duration)
    drive = opened(source)
    return Drive(
        drive.events,
        drive.job,
        way.filter_name or drive.filter_name,
        way.settings or drive.settings,
        drive.duration,
        drive.truncated,
    )


def brought_along(task: Task) -> Task:
    """The task with its content, to be done where its path means nothing. Raises ``SourceError`` or ``StoreError``."""
    return replace(task, source=_content(task.source))


def outcome_of(task: Task) -> Outcome:
    """Does one task. Never raises."""
    try:
        drive = drive_of(task.source, task.way)
        estimator = smoothed_poses(drive.events, drive.job, drive.settings) if task.way.smooth else None
        last: list[Snapshot] = []
        snapshots = _remembered(processed(drive.events, drive.job, drive.filter_name, drive.settings, estimator), last)
        table, fixes = table_of(snapshots)
    except (SourceError, StoreError) as error:
        return Outcome(task.name, problem=str(error))
    except Exception as error:  # noqa: BLE001 - one input that breaks the program must not stop the others
        return Outcome(task.name, problem=f"{task.name} cannot be processed: {type(error).__name__}: {error}")
    worked = last[-1].totals.worked if last else 0.0
    return Outcome(task.name, table, fixes, drive.duration, worked, drive.truncated)


def table_of(snapshots: Iterable[Snapshot]) -> tuple[str, int]:
    """The rows as CSV, and how many there are."""
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(COLUMNS)
    count = 0
    for row in rows_of(snapshots):
        writer.writerow(row)
        count += 1
    return table.getvalue(), count


def _remembered(snapshots: Iterable[Snapshot], last: list[Snapshot]) -> Iterable[Snapshot]:
    for snapshot in snapshots:
        last[:] = [snapshot]
        yield snapshot


def _content(source: Path | FileLog | RecordingFiles) -> FileLog | RecordingFiles:
    if not isinstance(source, Path):
        return source
    reading: Callable[[Path], FileLog | RecordingFiles] = read_recording if is_recording(source) else load_log
    return reading(source)
