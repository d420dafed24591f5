"""The columns of a drive: every input of it through the engine, one row a fix, as fast as the machine can."""

from collections.abc import Callable, Sequence

from guidance_app.decoding_beside import DecodedEvents
from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.estimation.filter import FilterSettings
from guidance_app.model import DriveLog, Event
from guidance_app.recording import RecordedDrive
from guidance_app.recording.columns import DriveGathering

__all__ = ["drive_log", "gathered"]

TELL_EVERY = 2000


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
    """Every row of these events, and the last snapshot. ``progress`` hears from 0 to 1.

    Those of a long drive are decoded by a process beside.
    """
    engine = Engine(job, filter_name=filter_name, settings=settings)
    gathering = DriveGathering()
    for number, (event, heard) in enumerate(DecodedEvents(events)):
        if progress is not None and number % TELL_EVERY == 0:
            progress(number / len(events))
        for snapshot in engine.steps(event, heard):
            gathering.take(snapshot)
    if progress is not None:
        progress(1.0)
    return gathering
