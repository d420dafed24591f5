"""Recordings as folders: which there are, what is in one, and which was cut off and can be gone on with.

``recordings/<start>-<field>/`` holds ``session.json`` (all documents in use), ``events.jsonl`` while it grows and
``events.jsonl.gz`` once it has ended, and ``summary.json``, written every few seconds and at the end, so that a list
of recordings reads no events. A recording also opens from a zip of such a folder.
"""

import gzip
import hashlib
import io
import json
import zipfile
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePath
from types import MappingProxyType
from typing import Any, BinaryIO

from pydantic import BaseModel, ConfigDict, ValidationError

from guidance_app.documents import Document, FieldDocument, Implement, Job, Operation, Receiver, Settings, Tractor
from guidance_app.language import sentence
from guidance_app.recording import FORMAT, Lines, RecordedDrive, RecordingError, RecordingMeta, read_lines
from guidance_app.store.files import StoreError, read_bounded, why
from guidance_app.store.migrations import BrokenDocumentError, NewerDocumentError, decoded

__all__ = [
    "EVENTS",
    "PACKED",
    "RECORDINGS",
    "SESSION",
    "SUMMARY",
    "RecordingFiles",
    "RecordingSummary",
    "is_recording",
    "is_recording_zip",
    "job_in",
    "job_of_recording",
    "open_recording",
    "opened",
    "packed",
    "read_recording",
    "read_summary",
    "recording_in",
]

RECORDINGS = "recordings"
SESSION = "session.json"
EVENTS = "events.jsonl"
PACKED = "events.jsonl.gz"
SUMMARY = "summary.json"
MOST_BYTES = 1 << 30
"""Eight hours at 10 Hz have about 70 million bytes of events."""

_JOB: Mapping[str, type[Document]] = MappingProxyType(
    {
        "tractor": Tractor,
        "implement": Implement,
        "receiver": Receiver,
        "field": FieldDocument,
        "operation": Operation,
        "settings": Settings,
    }
)
_NEEDED = ("tractor", "implement", "receiver", "settings")


class RecordingSummary(BaseModel):
    """What a list shows of a recording without opening it. ``ended`` is False while it is driven or was cut off.

    Times are ISO 8601 with Z by the machine's clock; ``pass_number`` is the target at the end and ``passes_done`` of
    ``passes_planned`` were driven, all None where there is no plan or it was not written in time.
    """

    model_config = ConfigDict(frozen=True, extra="ignore")

    started_utc: str
    written_utc: str | None = None
    duration_s: float
    events: int
    ended: bool
    source: str
    filter: str
    field: str | None = None
    operation: str | None = None
    pass_number: int | None = None
    passes_done: int | None = None
    passes_planned: int | None = None
    worked_m2: float | None = None
    truncated: str | None = None


@dataclass(frozen=True, slots=True)
class RecordingFiles:
    """The contents of a recording's files, wherever they lie. ``events`` as they lie there, packed or not."""

    name: str
    session: bytes
    events: bytes


def is_recording(path: Path) -> bool:
    """Whether this folder or zip is one of a drive's recording (whole or damaged), by its names alone."""
    try:
        if path.is_dir():
            return (path / SESSION).is_file() and any((path / name).is_file() for name in (EVENTS, PACKED))
        with path.open("rb") as file:
            return _holds_recording(file)
    except (OSError, zipfile.BadZipFile):
        return False


def is_recording_zip(content: bytes) -> bool:
    """Whether these bytes are a zip of a recording, by its names alone."""
    try:
        return _holds_recording(io.BytesIO(content))
    except (OSError, zipfile.BadZipFile):
        return False


def _holds_recording(file: BinaryIO) -> bool:
    with zipfile.ZipFile(file) as archive:
        names = set(archive.namelist())
        return _home_in(names) + SESSION in names


def job_of_recording(folder: Path) -> Job:
    """The documents that a recorded drive began with, without reading the drive. Raises ``StoreError``."""
    try:
        return _meta_of(read_bounded(folder / SESSION)).job
    except OSError as error:
        msg = sentence("{folder} cannot be read: {reason}", folder=folder, reason=why(error))
        raise StoreError(msg) from error
    except RecordingError as error:
        msg = sentence("{folder} cannot be read: {reason}", folder=folder, reason=str(error))
        raise StoreError(msg) from error


def job_in(files: RecordingFiles) -> Job:
    """The documents that a recorded drive began with, out of its contents. Raises ``StoreError``."""
    try:
        return _meta_of(files.session).job
    except RecordingError as error:
        msg = sentence("{folder} cannot be read: {reason}", folder=files.name, reason=error.args[0])
        raise StoreError(msg) from error


def open_recording(path: Path, progress: Callable[[float], None] | None = None) -> RecordedDrive:
    """The recorded drive in a folder, or in a zip of one, up to where it breaks off. Raises ``StoreError``.

    ``progress`` hears how much of it has been read, in parts of 1.
    """
    return opened(read_recording(path), progress)


def read_recording(path: Path) -> RecordingFiles:
    """The contents of a recording's files, not looked into. Raises ``StoreError``."""
    try:
        if path.is_dir():
            return _from_folder(path)
        if path.is_file():
            with path.open("rb") as file:
                return _from_zip(file, path.name)
    except (OSError, EOFError, NotImplementedError, RuntimeError, zlib.error, zipfile.BadZipFile) as error:
        reason = why(error) if isinstance(error, OSError) else str(error) or "it is damaged"
        msg = sentence("the recording {path} cannot be read: {reason}", path=path, reason=reason)
        raise StoreError(msg) from error
    msg = sentence("there is no recording {path}: check the spelling and the folder", path=path)
    raise StoreError(msg)


def recording_in(content: bytes, name: str) -> RecordingFiles:
    """The contents of a recording that came as a zip; ``name`` is that of the zip. Raises ``StoreError``."""
    try:
        return _from_zip(io.BytesIO(content), name)
    except (OSError, EOFError, NotImplementedError, RuntimeError, zlib.error, zipfile.BadZipFile) as error:
        msg = sentence("the recording {path} cannot be read: {reason}", path=name, reason=str(error) or "it is damaged")
        raise StoreError(msg) from error


def opened(files: RecordingFiles, progress: Callable[[float], None] | None = None) -> RecordedDrive:
    """The recorded drive in these contents. Raises ``StoreError``."""
    try:
        meta = _meta_of(files.session)
        text, damage = _unpacked(files.events)
        lines = read_lines(text, progress)
    except (RecordingError, BrokenDocumentError, NewerDocumentError) as error:
        msg = sentence("the recording {name} cannot be opened: {reason}", name=files.name, reason=str(error))
        raise StoreError(msg) from error
    digest = hashlib.sha256(files.session + b"\0" + lines.text[: lines.size]).hexdigest()
    return RecordedDrive(files.name, meta, lines, _truncation(lines, damage), digest)


def packed(text: bytes) -> bytes:
    """The events as they lie in a recording that has ended."""
    return gzip.compress(text, mtime=0)


def read_summary(folder: Path) -> RecordingSummary | None:
    """The summary that lies in a recording's folder; None without one that can be read."""
    try:
        return RecordingSummary.model_validate_json(read_bounded(folder / SUMMARY))
    except (OSError, StoreError, ValidationError):
        return None  # it is made from the recording then


# --- files -----------------------------------------------------------------------------------------------------------


def _from_folder(folder: Path) -> RecordingFiles:
    if not (folder / SESSION).is_file():
        msg = sentence("{folder} is no recording: there is no {file} in it", folder=folder, file=SESSION)
        raise StoreError(msg)
    session = read_bounded(folder / SESSION)
    for name in (PACKED, EVENTS):
        if (folder / name).is_file():
            if (folder / name).stat().st_size > MOST_BYTES:
                msg = sentence("the recording {folder} cannot be read: its events are larger than 1 GB", folder=folder)
                raise StoreError(msg)
            return RecordingFiles(folder.name, session, (folder / name).read_bytes())
    return RecordingFiles(folder.name, session, b"")


def _from_zip(file: BinaryIO, name: str) -> RecordingFiles:
    if not zipfile.is_zipfile(file):
        msg = sentence("{path} is no recording: it is neither a recording's folder nor a zip of one", path=name)
        raise StoreError(msg)
    with zipfile.ZipFile(file) as archive:
        names = set(archive.namelist())
        home = _home_in(names)
        events = next((home + each for each in (PACKED, EVENTS) if home + each in names), None)
        session = home + SESSION
        if session not in names or events is None:
            missing = SESSION if session not in names else EVENTS
            msg = sentence("{path} is no recording: there is no {file} in it", path=name, file=missing)
            raise StoreError(msg)
        if sum(archive.getinfo(each).file_size for each in (session, events)) > MOST_BYTES:
            msg = sentence("the recording {path} cannot be read: it unpacks to more than 1 GB", path=name)
            raise StoreError(msg)
        return RecordingFiles(PurePath(name).stem, archive.read(session), archive.read(events))


def _home_in(names: set[str]) -> str:
    """Where in a zip the recording lies: at its top, or in the one folder that was zipped."""
    homes = {name.removesuffix(SESSION) for name in names if name.count("/") == 1 and name.endswith(f"/{SESSION}")}
    return homes.pop() if SESSION not in names and len(homes) == 1 else ""


def _unpacked(events: bytes) -> tuple[bytes, str | None]:
    """The text of the events, and what is wrong with its packing. What a damaged archive still gives is taken."""
    if not events.startswith(b"\x1f\x8b"):
        return events, None
    unpacker = zlib.decompressobj(wbits=zlib.MAX_WBITS | 16)
    parts: list[bytes] = []
    size = 0
    with io.BytesIO(events) as packed:
        while block := packed.read(1 << 16):
            try:
                parts.append(unpacker.decompress(block))
            except zlib.error:
                return b"".join(parts), sentence("its archive is damaged")
            size += len(parts[-1])
            if size > MOST_BYTES:
                msg = sentence("its events unpack to more than 1 GB")
                raise RecordingError(msg)
    return b"".join(parts), None if unpacker.eof else sentence("its archive is cut off")


def _truncation(lines: Lines, damage: str | None) -> str | None:
    if not (lines.left_over or damage):
        return None
    where = float(lines.arrivals[-1]) if len(lines) else 0.0
    clock = f"{int(where // 3600)}:{int(where // 60) % 60:02}:{int(where % 60):02}"
    left = sentence("{count} bytes that follow are left out", count=lines.left_over)
    return sentence(
        "the recording breaks off at {clock}, after {count} events: {reason}",
        clock=clock,
        count=len(lines),
        reason=left if lines.left_over else damage,
    )


# --- session.json ----------------------------------------------------------------------------------------------------


def _meta_of(content: bytes) -> RecordingMeta:
    members = _members(content)
    version = members.get("schema_version")
    if isinstance(version, int) and version > FORMAT:
        msg = sentence(
            "its {file} has schema version {version} and this program knows up to {known}: it was "
            "recorded by a newer version of the program; update this one",
            file=SESSION,
            version=version,
            known=FORMAT,
        )
        raise NewerDocumentError(msg, None)
    if members.get("kind") != "recording":
        msg = sentence(
            "its {file} is not that of a recorded drive (its kind is {kind!r})", file=SESSION, kind=members.get("kind")
        )
        raise RecordingError(msg)
    documents = members.pop("job", None)
    if not isinstance(documents, dict):
        msg = sentence("its {file} holds no documents", file=SESSION)
        raise RecordingError(msg)
    job = _job_of(documents)
    try:
        return RecordingMeta.model_validate({**members, "job": job})
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        msg = sentence("its {file} is refused: {where}: {reason}", file=SESSION, where=where, reason=first["msg"])
        raise RecordingError(msg) from error


def _members(content: bytes) -> dict[str, Any]:
    try:
        members = json.loads(content)
    except (ValueError, RecursionError) as error:
        msg = sentence("its {file} is not JSON ({reason})", file=SESSION, reason=str(error))
        raise RecordingError(msg) from error
    if not isinstance(members, dict):
        msg = sentence("its {file} is JSON, but does not describe a recording", file=SESSION)
        raise RecordingError(msg)
    return members


def _job_of(documents: dict[str, Any]) -> Job:
    """The documents, older ones lifted; every one that another names must be there."""
    missing = [name for name in _NEEDED if documents.get(name) is None]
    operation = documents.get("operation")
    if isinstance(operation, dict) and operation.get("method") != "line" and documents.get("field") is None:
        missing.append(f"field '{operation.get('field')}', which its operation names,")
    if missing:
        msg = sentence("its {file} lacks a document: the {missing} is not there", file=SESSION, missing=missing[0])
        raise RecordingError(msg)
    made: dict[str, Document] = {}
    for name, kind in _JOB.items():
        if documents.get(name) is None:
            continue
        try:
            made[name] = decoded(json.dumps(documents[name]).encode(), kind)
        except BrokenDocumentError as error:
            msg = sentence("its {name} is broken: {reason}", name=name, reason=str(error))
            raise RecordingError(msg) from error
    return Job.model_validate(made)
