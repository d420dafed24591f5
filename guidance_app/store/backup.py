"""The whole data folder as one zip, and back.

A restore first unpacks beside the present data, with every guard that a strange archive calls for, and only then
changes places: what was there moves to ``before-restore-<n>`` and is never deleted. The change of places is finished
by the next call if a power cut stops it.
"""

import shutil
import stat
import struct
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from guidance_app.language import sentence
from guidance_app.store.files import (
    FolderLock,
    StoreError,
    free_path,
    move,
    sync_file,
    sync_folder,
    why,
)

__all__ = ["Limits", "finish_restore", "restore", "write_backup"]

BEFORE = "before-restore"
UNPACKING = ".restore-unpacking"
READY = ".restore-ready"
MOVING = ".restore-moving"
"""The three states of a restore: unpacked in part, unpacked, and the present data out of the way."""
DOCUMENTS = ("fields", "tractors", "implements", "receivers", "settings.json", "archive")
"""Where a backup has its documents; an archive with none of them is something else."""
PRIVATE = (".",)
"""Names that begin so stay out of a backup: lock, trash, temporary files."""
BLOCK = 1 << 20
DAMAGED = (OSError, EOFError, ValueError, RuntimeError, zipfile.BadZipFile, zlib.error, struct.error)
"""What the zip reader raises on damaged archives, flipping every byte of one in turn."""
MEGABYTE = 1_000_000


@dataclass(frozen=True, slots=True)
class Limits:
    """What an archive may hold at most."""

    files: int = 20_000
    total_bytes: int = 4_000 * MEGABYTE
    file_bytes: int = 1_000 * MEGABYTE
    ratio: int = 400
    """Unpacked to packed size of a file above 1 MB; a log packs 10 : 1, a zip bomb 1000 : 1."""


def write_backup(root: Path, target: BinaryIO) -> int:
    """Writes every document and recording of the folder into a zip and gives their number. Raises ``StoreError``.

    Each file is whole in it, as files are only ever replaced whole.
    """
    count = 0
    try:
        with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(root.rglob("*")):
                relative = path.relative_to(root)
                hidden = any(part.startswith(PRIVATE) for part in relative.parts)
                if hidden or relative.parts[0].startswith(BEFORE) or path.is_symlink() or not path.is_file():
                    continue
                archive.write(path, relative.as_posix())
                count += 1
    except OSError as error:
        msg = sentence("the backup of {root} cannot be written: {reason}", root=root, reason=why(error))
        raise StoreError(msg) from error
    return count


def restore(root: Path, source: BinaryIO, limits: Limits | None = None) -> Path | None:
    """Puts the folder into the state of a backup. Gives where the data before it lies now, None if there was none.

    Raises ``StoreError`` for what is no backup, with nothing changed.
    """
    with FolderLock(root).writing():
        _finish(root)
        try:
            _unpack(root, source, limits or Limits())
        except (StoreError, *DAMAGED) as error:
            shutil.rmtree(root / UNPACKING, ignore_errors=True)
            if isinstance(error, StoreError):
                raise
            reason = why(error) if isinstance(error, OSError) else str(error)
            msg = sentence("this is no backup that can be restored: {reason}", reason=reason)
            raise StoreError(msg) from error
        move(root / UNPACKING, root / READY)
        return _finish(root)


def finish_restore(root: Path) -> None:
    """Finishes a restore that a power cut has stopped; call it before a folder is used. Raises ``StoreError``."""
    if (root / READY).exists() or (root / MOVING).exists() or (root / UNPACKING).exists():
        with FolderLock(root).writing():
            _finish(root)


def _finish(root: Path) -> Path | None:
    """From any state to none. What was unpacked only in part is thrown away."""
    before: Path | None = None
    try:
        shutil.rmtree(root / UNPACKING, ignore_errors=True)
        if (root / READY).exists():
            before = _put_aside(root)
            move(root / READY, root / MOVING)
        if (root / MOVING).exists():
            for each in sorted((root / MOVING).iterdir()):
                move(each, root / each.name)
            (root / MOVING).rmdir()
            sync_folder(root)
    except OSError as error:
        msg = sentence(
            "the restore of {root} cannot be finished: {reason}; free some space and open it again",
            root=root,
            reason=why(error),
        )
        raise StoreError(msg) from error
    return before


def _put_aside(root: Path) -> Path | None:
    present = [each for each in sorted(root.iterdir()) if not each.name.startswith((*PRIVATE, BEFORE))]
    if not present:
        return None
    aside = free_path(root, BEFORE)
    for each in present:
        move(each, aside / each.name)
    return aside


# --- unpacking -------------------------------------------------------------------------------------------------------


def _unpack(root: Path, source: BinaryIO, limits: Limits) -> None:
    folder = root / UNPACKING
    folder.mkdir()
    with zipfile.ZipFile(source) as archive:
        members = list(_checked_members(archive, limits))
        if not any(place.suffix == ".json" and place.parts[0] in DOCUMENTS for _, place in members):
            msg = sentence("this archive holds no document of a data folder")
            raise StoreError(msg)
        left = limits.total_bytes
        for member, place in members:
            left -= _unpack_one(archive, member, folder / Path(*place.parts), min(left, limits.file_bytes))
    for path in sorted(folder.rglob("*"), reverse=True):
        if path.is_dir():
            sync_folder(path)
    sync_folder(folder)


def _checked_members(archive: zipfile.ZipFile, limits: Limits) -> Iterator[tuple[zipfile.ZipInfo, PurePosixPath]]:
    """Every file of the archive with a place that lies inside, after a look at all names and sizes."""
    members = [each for each in archive.infolist() if not each.is_dir()]
    if len(members) > limits.files:
        msg = sentence(
            "this archive holds {members} files; {files} are possible", members=len(members), files=limits.files
        )
        raise StoreError(msg)
    if sum(each.file_size for each in members) > limits.total_bytes:
        msg = sentence("this archive unpacks to more than {total_bytes} MB", total_bytes=limits.total_bytes // MEGABYTE)
        raise StoreError(msg)
    seen: set[str] = set()
    for member in members:
        place = _safe_place(member)
        if str(place).casefold() in seen:
            msg = sentence("this archive holds '{filename}' twice", filename=member.filename[:80])
            raise StoreError(msg)
        seen.add(str(place).casefold())
        packed = max(member.compress_size, 1)
        if member.file_size > MEGABYTE and member.file_size > limits.ratio * packed:
            msg = sentence(
                "'{filename}' unpacks to {file_size} times its size; that is no backup",
                filename=member.filename[:80],
                file_size=member.file_size // packed,
            )
            raise StoreError(msg)
        yield member, place


def _safe_place(member: zipfile.ZipInfo) -> PurePosixPath:
    """The member's path if it stays inside the folder. Raises ``StoreError``."""
    name = member.filename
    place = PurePosixPath(name)
    strange = (
        not place.parts
        or place.is_absolute()
        or any(part in {"..", "."} or part.startswith(PRIVATE) for part in place.parts)
        or any(letter in name for letter in '\\:*?"<>|\0')
        or any(ord(letter) < 32 for letter in name)
        or place.parts[0].startswith(BEFORE)
        or any(len(part.encode()) > 200 for part in place.parts)
        or len(place.parts) > 12
    )
    if strange:
        msg = sentence("this archive wants to write to '{name}', which is no place in a data folder", name=name[:80])
        raise StoreError(msg)
    if stat.S_ISLNK(member.external_attr >> 16):
        msg = sentence("'{name}' in this archive is a link; a backup has none", name=name[:80])
        raise StoreError(msg)
    if member.flag_bits & 0x1 or member.compress_type not in {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}:
        msg = sentence("'{name}' in this archive is locked or packed in a way that no backup is", name=name[:80])
        raise StoreError(msg)
    return place


def _unpack_one(archive: zipfile.ZipFile, member: zipfile.ZipInfo, target: Path, limit: int) -> int:
    """Writes one file, stopping where the archive's own word about its size proves to be a lie."""
    target.parent.mkdir(parents=True, exist_ok=True)
    written = 0
    with archive.open(member) as packed, target.open("xb") as file:
        while block := packed.read(BLOCK):
            written += len(block)
            if written > limit:
                msg = sentence("'{filename}' unpacks to more than is possible", filename=member.filename[:80])
                raise StoreError(msg)
            file.write(block)
        sync_file(file)
    return written
