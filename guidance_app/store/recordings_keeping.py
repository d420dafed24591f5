"""Recordings put away and taken in: to the trash with a way back, and out of a zip that came from elsewhere."""

from pathlib import Path

from guidance_app.language import sentence
from guidance_app.recording import RecordedDrive
from guidance_app.store.documents_folder import TRASH, Removed
from guidance_app.store.files import FolderLock, StoreError, free_path, move, safe_stem, write_atomically
from guidance_app.store.recordings import (
    EVENTS,
    PACKED,
    RECORDINGS,
    SESSION,
    SUMMARY,
    RecordingFiles,
    opened,
    packed,
    recording_in,
)
from guidance_app.store.recordings_list import summary_of
from guidance_app.store.recordings_writing import is_being_written

__all__ = ["bring_back", "name_of_folder", "remove_recording", "take_in_recording"]

GZIP = b"\x1f\x8b"


def remove_recording(data: Path, folder: Path) -> Removed:
    """Takes a recording away; ``bring_back`` undoes it. Raises ``StoreError``, also for one that is being written."""
    with FolderLock(data).writing():
        if is_being_written(folder):
            msg = sentence("This drive is being recorded now: end it, then it can be deleted.")
            raise StoreError(msg)
        kept = free_path(data / TRASH / RECORDINGS, folder.name)
        move(folder, kept)
        return Removed(folder.name, folder, kept)


def bring_back(data: Path, removed: Removed) -> None:
    """Puts a removed recording back in its place. Raises ``StoreError`` when that has been taken."""
    with FolderLock(data).writing():
        move(removed.kept, removed.path)


def take_in_recording(data: Path, content: bytes, name: str) -> Path:
    """Keeps the recording in a zip and gives its folder. Nothing is kept of one that cannot be opened.

    It counts as ended: nobody is asked to go on with a drive from elsewhere. Raises ``StoreError``.
    """
    files = recording_in(content, name)
    drive = opened(files)
    if not len(drive.events):
        msg = sentence("The recording {name} holds no event, so it was not kept.", name=name)
        raise StoreError(msg)
    events = files.events if files.events.startswith(GZIP) else packed(files.events)
    with FolderLock(data).writing():
        stem = name_of_folder(drive)
        _refuse_twice(data, stem, files, events)
        folder = free_path(data / RECORDINGS, stem)
        summary = summary_of(drive).model_copy(update={"ended": True})
        write_atomically(folder / PACKED, events)
        write_atomically(folder / SUMMARY, summary.model_dump_json(indent=1).encode() + b"\n")
        write_atomically(folder / SESSION, files.session)  # last: without it the folder is no recording
    return folder


def name_of_folder(drive: RecordedDrive) -> str:
    """What the folder of a drive is called: its start, then its field."""
    start = "".join(letter for letter in drive.meta.started_utc if letter.isascii() and letter.isalnum()).lower()
    field = drive.job.field
    return f"{start[:20] or 'undated'}-{safe_stem('no field' if field is None else field.name)}"


def _refuse_twice(data: Path, stem: str, files: RecordingFiles, events: bytes) -> None:
    """Raises ``StoreError`` when the very same recording is there."""
    for folder in (data / RECORDINGS).glob(f"{stem}*"):
        there = {name: folder / name for name in (SESSION, PACKED, EVENTS)}
        same_session = there[SESSION].is_file() and there[SESSION].read_bytes() == files.session
        if same_session and there[PACKED].is_file() and there[PACKED].read_bytes() == events:
            msg = sentence("This recording is in the list already: {name}.", name=folder.name)
            raise StoreError(msg)
