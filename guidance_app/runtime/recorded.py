"""A live session with its recorder, new or gone on with."""

from collections.abc import Callable
from pathlib import Path

from guidance_app.documents import Job
from guidance_app.estimation.filter import FilterSettings
from guidance_app.language import sentence
from guidance_app.runtime.cache import cache_folder
from guidance_app.runtime.live import LiveSession
from guidance_app.runtime.recorder import Recorder, new_recording
from guidance_app.runtime.resume_points import ResumePoints
from guidance_app.sources import Source
from guidance_app.store.files import StoreError
from guidance_app.store.recordings_writing import RecordingFolder

__all__ = ["recorded_session", "resumed_session"]


def recorded_session(
    data: Path,
    job: Job,
    source: Source,
    filter_name: str | None = None,
    settings: FilterSettings | None = None,
    notices: tuple[str, ...] = (),
) -> LiveSession:
    """A session that is recorded into the data folder; where that cannot be it drives all the same and says so."""
    recorder: Recorder | None = None
    try:
        recorder = new_recording(data, job, source.description, filter_name, settings, notices)
    except StoreError as error:
        notices = (*notices, sentence("This drive is not recorded: {reason}.", reason=str(error)))
    return LiveSession(job, source, filter_name, settings, recorder=recorder, notices=notices)


def resumed_session(folder: Path, source: Source, progress: Callable[[float], None] | None = None) -> LiveSession:
    """A session that goes on with the recording in this folder, where it was cut off. Raises ``StoreError``.

    Returns when all inputs have been taken again from the newest resume point on; without one, all of them, some 500
    times faster than they were driven.
    """
    writing, drive = RecordingFolder.go_on(folder)
    points = ResumePoints(cache_folder(), folder, drive)
    return LiveSession.resumed(drive, source, Recorder(writing, drive, points=points), progress, points.found)
