"""Field files of other programs: one format a file here, found by the ending in ``READERS`` and ``WRITERS``.

A reader takes bytes and gives at least one draft, or raises ``BoundaryError``; whatever the format, a draft becomes a
field in ``boundary`` alone. A reader therefore neither repairs nor judges, and a writer gets only what was checked.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from guidance_app.boundary import BoundaryError, CheckedField, FieldDraft, checked_field
from guidance_app.documents import FieldDocument
from guidance_app.exchange import geojson

__all__ = ["READERS", "WRITERS", "ExchangeError", "checked_fields", "read_field", "write_field"]

Reader = Callable[[bytes], tuple[FieldDraft, ...]]
Writer = Callable[[FieldDocument], bytes]

READERS: Mapping[str, Reader] = MappingProxyType({".geojson": geojson.read_drafts, ".json": geojson.read_drafts})
WRITERS: Mapping[str, Writer] = MappingProxyType({".geojson": geojson.written_field})

MEGABYTE = 1_000_000
MAX_BYTES = 50 * MEGABYTE
"""A field's file is never larger; the largest of a parcel register is below 1 MB."""


class ExchangeError(Exception):
    """A file that cannot be read or written as a field; the message is one sentence with the file's name."""


def checked_fields(path: Path) -> tuple[CheckedField, ...]:
    """Every field in the file, with area, perimeter and remarks for the preview. Raises ``ExchangeError``."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        msg = f"{path}: fields are read from {', '.join(sorted(READERS))}, not from '{path.suffix}'"
        raise ExchangeError(msg)
    try:
        drafts = reader(_bytes_of(path))
        many = len(drafts) > 1
        fields = tuple(
            checked_field(draft, f"{path.stem} {number}" if many else path.stem)
            for number, draft in enumerate(drafts, start=1)
        )
    except BoundaryError as error:
        msg = f"{path}: {error}"
        raise ExchangeError(msg) from error
    return fields


def read_field(path: Path, name: str | None = None) -> FieldDocument:
    """The field in the file; with ``name`` the one called so. Raises ``ExchangeError`` where there is a choice."""
    fields = checked_fields(path)
    called = [each.document for each in fields if name is None or each.document.name == name]
    if len(called) == 1:
        return called[0]
    names = ", ".join(each.document.name for each in fields[:5]) + (", ..." if len(fields) > 5 else "")
    if not called:
        msg = f"{path}: no field is called '{name}'; there are {names}"
    else:
        msg = f"{path}: {len(called)} fields are in it ({names}); give a file with one"
    raise ExchangeError(msg)


def write_field(document: FieldDocument, path: Path) -> None:
    """Writes the field in the format of the file's ending. Raises ``ExchangeError``."""
    writer = WRITERS.get(path.suffix.lower())
    if writer is None:
        msg = f"{path}: fields are written as {', '.join(sorted(WRITERS))}, not as '{path.suffix}'"
        raise ExchangeError(msg)
    try:
        path.write_bytes(writer(document))
    except OSError as error:
        msg = f"{path} cannot be written: {error.strerror or error}"
        raise ExchangeError(msg) from error


def _bytes_of(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        msg = f"{path} cannot be read: {error.strerror or error}"
        raise ExchangeError(msg) from error
    if len(content) > MAX_BYTES:
        msg = f"{path} is larger than {MAX_BYTES // MEGABYTE} MB, which no field is"
        raise ExchangeError(msg)
    if not content.strip():
        msg = f"{path} is empty"
        raise ExchangeError(msg)
    return content
