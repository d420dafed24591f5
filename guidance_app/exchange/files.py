"""The files of one import by name, whether they came as a file with its neighbours, a folder, an archive or bytes.

An archive is never unpacked to disk. Refused, each with a sentence: more than 50 MB, an archive that unpacks to more
than 200 MB or holds more than 10,000 files, members that are encrypted, damaged or whose names lead outside.
"""

import io
import os
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePosixPath

from guidance_app.boundary import BoundaryError
from guidance_app.exchange.asking import briefly
from guidance_app.language import sentence

__all__ = ["MAX_BYTES", "MAX_FILES", "MAX_UNPACKED", "Files", "files_at", "files_in"]

MEGABYTE = 1_000_000
MAX_BYTES = 50 * MEGABYTE
"""A field's file is never larger; the largest of a parcel register is below 1 MB."""
MAX_UNPACKED = 200 * MEGABYTE
MAX_FILES = 10_000
DEEPEST = 3
"""Folders inside a folder are looked into this deep."""
COMPANIONS = frozenset({".shp", ".dbf", ".shx", ".prj", ".cpg", ".xml", ".txt"})
"""Endings of files that may only make sense with their neighbours."""
UTF8_NAME = 0x800
"""The flag of an archive's member whose name is UTF-8."""
ENCRYPTED = 0x1


@dataclass(frozen=True, slots=True)
class Files:
    """Files by their path inside, with '/' between folders. ``main`` is the one that was named, '' for all of them."""

    main: str
    title: str
    _read: Mapping[str, Callable[[], bytes]]

    @property
    def names(self) -> tuple[str, ...]:
        """Every file, in order."""
        return tuple(self._read)

    def with_main(self, name: str) -> "Files":
        """The same files, seen from another one."""
        return Files(name, PurePosixPath(name).stem, self._read)

    def content(self, name: str | None = None) -> bytes:
        """The bytes of a file, of the main one without a name. Raises ``BoundaryError`` for one that is unreadable."""
        return self._read[name or self.main]()

    def ending(self, *suffixes: str) -> list[str]:
        """Files with one of these endings, in any case."""
        return [name for name in self._read if PurePosixPath(name).suffix.lower() in suffixes]

    def called(self, name: str) -> str | None:
        """The file of this name in any case and any folder, the highest up; None without one."""
        wanted = name.lower()
        found = [one for one in self._read if PurePosixPath(one).name.lower() == wanted]
        return min(found, key=lambda one: one.count("/"), default=None)

    def beside(self, suffix: str) -> str | None:
        """The main file's neighbour with another ending, in any case."""
        wanted = str(PurePosixPath(self.main).with_suffix(suffix)).lower()
        return next((one for one in self._read if one.lower() == wanted), None)


def files_in(content: bytes, name: str) -> Files:
    """An upload: an archive's members, or the one file. Raises ``BoundaryError``."""
    _check_size(content)
    path = PurePosixPath(name)
    if path.suffix.lower() in {".zip", ".kmz"} or _is_bare_archive(path, content):
        return Files("", path.stem, _members(content))
    return Files(path.name, path.stem, {path.name: lambda: content})


def files_at(path: Path) -> Files:
    """A folder's files, an archive's members, or a file with its neighbours. Raises ``BoundaryError``, ``OSError``."""
    if path.is_dir():
        return Files("", path.name or "folder", dict(_below(path, path, DEEPEST)))
    content = _bounded(path)
    _check_size(content)
    if path.suffix.lower() in COMPANIONS:
        found = dict(_below(path.parent, path.parent, 1))
        found[path.name] = lambda: content
        return Files(path.name, path.stem, found)
    return files_in(content, path.name)


def _check_size(content: bytes) -> None:
    if len(content) > MAX_BYTES:
        msg = sentence("it is larger than {most} MB, which no field is", most=MAX_BYTES // MEGABYTE)
        raise BoundaryError(msg)
    if not content.strip():
        msg = sentence("it is empty")
        raise BoundaryError(msg)


def _is_bare_archive(path: PurePosixPath, content: bytes) -> bool:
    """Whether this is an archive without an ending that says so; spreadsheets are archives with one."""
    return not path.suffix and content.startswith(b"PK\x03\x04")


def _below(folder: Path, root: Path, depth: int) -> Iterator[tuple[str, Callable[[], bytes]]]:
    """Files below a folder by their path there. Links to folders are not followed."""
    number = 0
    for at, folders, names in os.walk(folder):
        here = Path(at)
        if len(here.relative_to(root).parts) >= depth - 1:
            folders.clear()
        folders.sort()
        for name in sorted(names):
            number += 1
            if number > MAX_FILES:
                msg = sentence(
                    "there are more than {most:,} files in it: name the folder that holds the field", most=MAX_FILES
                )
                raise BoundaryError(msg)
            file = here / name
            yield file.relative_to(root).as_posix(), partial(_file_content, file)


def _file_content(path: Path) -> bytes:
    try:
        content = _bounded(path)
    except OSError as error:
        msg = sentence("'{name}' in it cannot be read: {reason}", name=path.name, reason=error.strerror or error)
        raise BoundaryError(msg) from error
    if len(content) > MAX_BYTES:
        msg = sentence(
            "'{name}' in it is larger than {most} MB, which no field is", name=path.name, most=MAX_BYTES // MEGABYTE
        )
        raise BoundaryError(msg)
    return content


def _bounded(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(MAX_BYTES + 1)


# --- archives --------------------------------------------------------------------------------------------------------


def _members(content: bytes) -> dict[str, Callable[[], bytes]]:
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
    except (zipfile.BadZipFile, ValueError, OSError, NotImplementedError) as error:
        msg = sentence("it is not a sound zip archive ({reason})", reason=briefly(error))
        raise BoundaryError(msg) from error
    members = [one for one in archive.infolist() if not one.is_dir()]
    if len(members) > MAX_FILES:
        msg = sentence("the archive holds {count:,} files; {most:,} are the most", count=len(members), most=MAX_FILES)
        raise BoundaryError(msg)
    total = sum(one.file_size for one in members)
    if total > MAX_UNPACKED:
        msg = sentence(
            "the archive unpacks to {size:,.0f} MB; {most} MB are the most",
            size=total / MEGABYTE,
            most=MAX_UNPACKED // MEGABYTE,
        )
        raise BoundaryError(msg)
    return {_safe_name(one): partial(_member_content, archive, one) for one in members}


def _safe_name(member: zipfile.ZipInfo) -> str:
    name = _real_name(member).replace("\\", "/")
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or (path.parts and path.parts[0].endswith(":")):
        msg = sentence(
            "the archive holds '{name}', which leads outside of it: it was not made by an honest program",
            name=name[:60],
        )
        raise BoundaryError(msg)
    return name


def _real_name(member: zipfile.ZipInfo) -> str:
    """Names that are not marked as UTF-8 were read as cp437; Japanese programs mean cp932."""
    if member.flag_bits & UTF8_NAME or member.filename.isascii():
        return member.filename
    try:
        return member.filename.encode("cp437").decode("cp932")
    except UnicodeError:
        return member.filename


def _member_content(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> bytes:
    if member.flag_bits & ENCRYPTED:
        msg = sentence("'{name}' in the archive is encrypted: pack it again without a password", name=member.filename)
        raise BoundaryError(msg)
    try:
        with archive.open(member) as file:
            content = file.read(MAX_BYTES + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, NotImplementedError, RuntimeError) as error:
        msg = sentence(
            "'{name}' in the archive is damaged: pack it again ({reason})", name=member.filename, reason=briefly(error)
        )
        raise BoundaryError(msg) from error
    if len(content) > MAX_BYTES:
        msg = sentence(
            "'{name}' in the archive is larger than {most} MB, which no field is",
            name=member.filename,
            most=MAX_BYTES // MEGABYTE,
        )
        raise BoundaryError(msg)
    return content
