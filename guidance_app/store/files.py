"""Files that are whole or not there: atomic writing, one writer at a time, names of any script as safe file names.

A document is written to a temporary file beside its place, flushed to the disk, renamed over the old one, and the
folder is flushed: after a power cut either the old or the new document is there. Writers hold the folder's lock, so
the temporary name can be fixed and a left-over one is written over by the next writer.
"""

import contextlib
import errno
import hashlib
import itertools
import os
import sys
import threading
import unicodedata
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from guidance_app.language import message, sentence

__all__ = [
    "FolderLock",
    "StoreError",
    "free_path",
    "move",
    "read_bounded",
    "revision_of",
    "safe_stem",
    "sync_file",
    "sync_folder",
    "try_lock",
    "why",
    "write_atomically",
    "write_file",
]

LOCK_NAME = ".lock"
MAX_STEM = 60
"""Letters of a name that a file name takes over; with a suffix it stays below the 143 bytes of encrypted folders."""
MAX_DOCUMENT_BYTES = 50_000_000

_REASONS = {
    errno.ENOSPC: message("the disk is full"),
    errno.EDQUOT: message("the disk quota is used up"),
    errno.EROFS: message("it is on a read-only disk"),
    errno.EACCES: message("this user may not write there"),
    errno.EPERM: message("this user may not write there"),
    errno.ENOTDIR: message("a part of its path is a file, not a folder"),
    errno.EEXIST: message("a file of that name is in the way"),
    errno.ENAMETOOLONG: message("its path is too long"),
    errno.EIO: message("the disk reports an error"),
}
_RESERVED = frozenset(
    {"con", "prn", "aux", "nul", *(f"com{n}" for n in range(1, 10)), *(f"lpt{n}" for n in range(1, 10))}
)
"""Names that Windows keeps for devices."""


_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)


class StoreError(Exception):
    """Something could not be stored, found or read; the message is one sentence with what to do."""


def why(error: OSError) -> str:
    """The reason of a system error in words a driver understands."""
    known = _REASONS.get(error.errno or 0)
    return error.strerror or str(error) if known is None else sentence(known)


def revision_of(content: bytes) -> str:
    """What tells two contents of a file apart."""
    return hashlib.sha256(content).hexdigest()[:24]


def safe_stem(name: str, *, distinct: bool = False) -> str:
    """A file name (without ending) for any name: lower-case ASCII letters, digits and hyphens only.

    A name that is more than that, or ``distinct``, gets a hash of the exact name at its end, so that two names never
    share a file by accident and a name of another script still has one.
    """
    folded = unicodedata.normalize("NFKD", name.strip()).encode("ascii", "ignore").decode().lower()
    words = "".join(letter if letter.isalnum() else " " for letter in folded).split()
    stem = "-".join(words)
    plain = "-".join(name.lower().split())
    if stem == plain and len(stem) <= MAX_STEM and stem not in _RESERVED and not distinct:
        return stem
    exact = unicodedata.normalize("NFC", name)
    digest = hashlib.sha256(exact.encode()).hexdigest()[:10]
    return f"{stem[:MAX_STEM].rstrip('-')}-{digest}".lstrip("-")


def free_path(folder: Path, stem: str, suffix: str = "") -> Path:
    """A path in the folder where nothing lies: the plain one, else with a number."""
    numbered = (folder / f"{stem}{'' if number == 1 else f'-{number}'}{suffix}" for number in itertools.count(1))
    return next(path for path in numbered if not path.exists())


def write_atomically(path: Path, content: bytes, mode: int = 0o666) -> str:
    """Replaces the file by this content, whole or not at all, and gives its revision. Raises ``StoreError``.

    ``mode`` says who may read it, less what the system takes away; from its first byte on.

    Only under ``FolderLock.writing``.
    """
    temporary = path.with_name(f".{path.name}.tmp")
    try:
        _make_folders(path.parent)
        try:
            temporary.unlink(missing_ok=True)  # it may be somebody else's to read
            with os.fdopen(os.open(temporary, _NEW, mode), "wb") as file:
                file.write(content)
                sync_file(file)
            temporary.replace(path)
        except OSError:
            with contextlib.suppress(OSError):
                temporary.unlink()
            raise
        sync_folder(path.parent)
    except OSError as error:
        msg = sentence("{path} cannot be written: {reason}", path=path, reason=why(error))
        raise StoreError(msg) from error
    return revision_of(content)


def write_file(root: Path, path: Path, content: bytes) -> str:
    """Writes a file below the data folder ``root``, whole or not at all, and gives its revision."""
    with FolderLock(root).writing():
        return write_atomically(path, content)


def move(source: Path, target: Path) -> None:
    """Moves a file or folder to a place that is free. Only under ``FolderLock.writing``. Raises ``StoreError``."""
    try:
        _make_folders(target.parent)
        if target.exists():
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST))
        source.rename(target)
        sync_folder(target.parent)
        sync_folder(source.parent)
    except OSError as error:
        msg = sentence(
            "{source} cannot be moved to {target}: {reason}", source=source, target=target, reason=why(error)
        )
        raise StoreError(msg) from error


def read_bounded(path: Path) -> bytes:
    """The file's content. Raises ``OSError``, or ``StoreError`` for a file that is larger than any document."""
    with path.open("rb") as file:
        content = file.read(MAX_DOCUMENT_BYTES + 1)
    if len(content) > MAX_DOCUMENT_BYTES:
        msg = sentence(
            "{path} is larger than {max_document_bytes} MB, which no document is",
            path=path,
            max_document_bytes=MAX_DOCUMENT_BYTES // 1_000_000,
        )
        raise StoreError(msg)
    return content


class FolderLock:
    """Who may read and write a data folder now. Re-entrant; one object for all that use the folder in a program.

    ``reading`` keeps the other threads of this program out, ``writing`` the other programs too.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self._threads = threading.RLock()
        self._depth = 0

    @contextlib.contextmanager
    def reading(self) -> Iterator[None]:
        """Waits for the other threads."""
        with self._threads:
            yield

    @contextlib.contextmanager
    def writing(self) -> Iterator[None]:
        """Waits for the other threads and programs. Raises ``StoreError`` where nobody may write."""
        with self._threads:
            descriptor = self._locked_file() if self._depth == 0 else None
            self._depth += 1
            try:
                yield
            finally:
                self._depth -= 1
                if descriptor is not None:
                    os.close(descriptor)  # which also gives the lock back

    def _locked_file(self) -> int:
        try:
            self.root.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(self.root / LOCK_NAME, os.O_RDWR | os.O_CREAT, 0o644)
        except OSError as error:
            msg = sentence(
                "the data folder {root} cannot be written: {reason}; choose another folder",
                root=self.root,
                reason=why(error),
            )
            raise StoreError(msg) from error
        try:
            _lock(descriptor)
        except OSError as error:
            os.close(descriptor)
            msg = sentence(
                "the data folder {root} cannot be locked: {reason}; choose another folder",
                root=self.root,
                reason=why(error),
            )
            raise StoreError(msg) from error
        return descriptor


def sync_file(file: BinaryIO) -> None:
    """Returns when what was written is on the disk."""
    file.flush()
    os.fsync(file.fileno())


def _make_folders(folder: Path) -> None:
    missing = [each for each in (folder, *folder.parents) if not each.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    for made in reversed(missing):
        sync_folder(made.parent)


if sys.platform == "win32":
    import msvcrt

    def _lock(descriptor: int) -> None:
        msvcrt.locking(descriptor, msvcrt.LK_LOCK, 1)

    def try_lock(descriptor: int) -> bool:
        """Locks the file unless somebody has it; does not wait. The lock goes with the descriptor."""
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

    def sync_folder(folder: Path) -> None:
        """Windows has no such call; NTFS journals the rename itself."""

else:
    import fcntl

    def _lock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX)

    def try_lock(descriptor: int) -> bool:
        """Locks the file unless somebody has it; does not wait. The lock goes with the descriptor."""
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True

    def sync_folder(folder: Path) -> None:
        """Returns when the names in the folder are on the disk."""
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
