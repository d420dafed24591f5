"""The folder of a recording that is being made: created, appended to, locked, and packed at the end.

Only the program that holds the folder's lock writes in it, so temporary names can be fixed. The lock goes with the
program, also when that is killed.
"""

import contextlib
import os
import time
from pathlib import Path

from guidance_app.language import sentence
from guidance_app.recording import RecordedDrive, RecordingMeta
from guidance_app.store.files import (
    FolderLock,
    StoreError,
    free_path,
    safe_stem,
    sync_folder,
    try_lock,
    why,
    write_atomically,
)
from guidance_app.store.recordings import (
    EVENTS,
    PACKED,
    RECORDINGS,
    SESSION,
    SUMMARY,
    RecordingSummary,
    opened,
    packed,
    read_recording,
)

__all__ = ["RecordingFolder", "is_being_written"]

LOCK = ".writing"
TRIES, TRY_AGAIN_S = 50, 0.01
"""Whoever asks whether a recording is being written holds its lock for an instant; a writer waits that long."""


class RecordingFolder:
    """Where a recorder writes. Made by ``create`` or ``go_on``; raises ``OSError`` from its writing, for a retry."""

    def __init__(self, folder: Path) -> None:
        self.path = folder
        self._lock: int | None = _locked(folder)
        self._events: int | None = None

    @classmethod
    def create(cls, data: Path, meta: RecordingMeta) -> "RecordingFolder":
        """A new folder under ``recordings/`` of the data folder, with its ``session.json``. Raises ``StoreError``."""
        what = meta.job.field.name if meta.job.field is not None else "no field"
        start = "".join(letter for letter in meta.started_utc if letter.isalnum())
        with FolderLock(data).writing():
            folder = free_path(data / RECORDINGS, f"{start.lower()}-{safe_stem(what)}")
            try:
                folder.mkdir(parents=True)
                sync_folder(folder.parent)
            except OSError as error:
                msg = sentence("the recording {folder} cannot be made: {reason}", folder=folder, reason=why(error))
                raise StoreError(msg) from error
            made = cls(folder)
        try:
            write_atomically(folder / SESSION, meta.model_dump_json(indent=1).encode() + b"\n")
        except StoreError:
            made.close()
            with contextlib.suppress(OSError):
                (folder / LOCK).unlink(missing_ok=True)
                folder.rmdir()
            raise
        return made

    @classmethod
    def go_on(cls, folder: Path) -> tuple["RecordingFolder", RecordedDrive]:
        """A recording that was cut off, with what it holds; a damaged end is taken off. Raises ``StoreError``."""
        made = cls(folder)
        try:
            drive = opened(read_recording(folder))
            _unpack_events(folder, drive)
        except StoreError:
            made.close()
            raise
        except OSError as error:
            made.close()
            msg = sentence("the recording {folder} cannot be gone on with: {reason}", folder=folder, reason=why(error))
            raise StoreError(msg) from error
        return made, drive

    def append(self, text: bytes) -> int:
        """Hands bytes to the system, which keeps them when this program is killed; how many it took."""
        if self._events is None:
            flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND | getattr(os, "O_BINARY", 0)
            self._events = os.open(self.path / EVENTS, flags, 0o644)
            sync_folder(self.path)
        return os.write(self._events, text)

    def sync(self) -> None:
        """Returns when what was appended is on the disk."""
        if self._events is not None:
            os.fsync(self._events)

    def write_summary(self, summary: RecordingSummary) -> None:
        """Replaces the summary. Raises ``StoreError``."""
        write_atomically(self.path / SUMMARY, summary.model_dump_json(indent=1).encode() + b"\n")

    def pack(self) -> None:
        """Compresses the events of a recording that has ended. Raises ``StoreError``."""
        self._close_events()
        try:
            text = (self.path / EVENTS).read_bytes()
        except FileNotFoundError:
            return
        except OSError as error:
            msg = sentence("{path} cannot be read: {reason}", path=self.path / EVENTS, reason=why(error))
            raise StoreError(msg) from error
        write_atomically(self.path / PACKED, packed(text))
        with contextlib.suppress(OSError):  # both are there then, and the packed one is read
            (self.path / EVENTS).unlink()

    def discard(self) -> None:
        """Takes a recording away in which there is nothing. Raises ``StoreError``."""
        self._close_events()
        try:
            for name in (EVENTS, SESSION, SUMMARY, LOCK):
                (self.path / name).unlink(missing_ok=True)
            self.path.rmdir()
        except OSError as error:
            msg = sentence(
                "the empty recording {path} cannot be taken away: {reason}", path=self.path, reason=why(error)
            )
            raise StoreError(msg) from error

    def close(self) -> None:
        """Gives the folder free for other programs."""
        self._close_events()
        if self._lock is not None:
            with contextlib.suppress(OSError):
                (self.path / LOCK).unlink()
            os.close(self._lock)
            self._lock = None

    def _close_events(self) -> None:
        if self._events is not None:
            os.close(self._events)
            self._events = None


def is_being_written(folder: Path) -> bool:
    """Whether a program is writing this recording now."""
    try:
        descriptor = os.open(folder / LOCK, os.O_RDWR)
    except OSError:
        return False
    try:
        return not try_lock(descriptor)
    finally:
        os.close(descriptor)


def _locked(folder: Path) -> int:
    for _ in range(TRIES):
        descriptor = _locked_now(folder)
        if descriptor is not None:
            return descriptor
        time.sleep(TRY_AGAIN_S)
    msg = sentence("the recording {folder} is being written by another program: close that first", folder=folder)
    raise StoreError(msg)


def _locked_now(folder: Path) -> int | None:
    """The locked file; None while another has it, or has taken it away as it left."""
    path = folder / LOCK
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        msg = sentence("the recording {folder} cannot be written: {reason}", folder=folder, reason=why(error))
        raise StoreError(msg) from error
    with contextlib.suppress(FileNotFoundError):
        if try_lock(descriptor) and os.path.samestat(os.fstat(descriptor), path.stat()):
            return descriptor
    os.close(descriptor)
    return None


def _unpack_events(folder: Path, drive: RecordedDrive) -> None:
    """Leaves a plain file that ends with the last whole line."""
    plain = folder / EVENTS
    if (folder / PACKED).is_file():
        write_atomically(plain, drive.lines.text[: drive.lines.size])
        (folder / PACKED).unlink()
    elif drive.lines.left_over:
        os.truncate(plain, drive.lines.size)
