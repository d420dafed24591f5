"""Files of other programs: one format a file here, found by the ending in ``READERS`` and ``WRITERS``.

A reader takes files and gives at least one draft, or raises ``BoundaryError``; whatever the format, a draft becomes a
field in ``boundary`` alone. A reader therefore neither repairs nor judges, and a writer gets only what was checked.
What a reader had to guess it says; what it cannot guess it asks (``QuestionError`` names the option that answers).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path, PurePosixPath
from types import MappingProxyType

from guidance_app.boundary import BoundaryError, CheckedField, FieldDraft, checked_field
from guidance_app.documents import FieldDocument
from guidance_app.exchange import (
    agopengps,
    corner_csv,
    geojson,
    gpx,
    isoxml,
    kml,
    nmea_track,
    shapefile_format,
    spreadsheet,
)
from guidance_app.exchange.asking import ExchangeError, ImportedField, OpenQuestionError, QuestionError, ReadOptions
from guidance_app.exchange.files import MAX_BYTES, Files, files_at, files_in
from guidance_app.language import sentence

__all__ = [
    "MAX_BYTES",
    "READERS",
    "WRITERS",
    "ExchangeError",
    "ImportedField",
    "QuestionError",
    "ReadOptions",
    "checked_fields",
    "read_field",
    "read_fields",
    "write_field",
    "written_as",
]

Reader = Callable[[Files, ReadOptions], tuple[FieldDraft, ...]]
Writer = Callable[[FieldDocument], bytes]

READERS: Mapping[str, Reader] = MappingProxyType(
    {
        ".geojson": geojson.read,
        ".json": geojson.read,
        ".csv": corner_csv.read,
        ".txt": corner_csv.read,
        ".tsv": corner_csv.read,
        ".xlsx": spreadsheet.read,
        ".xls": spreadsheet.read,
        ".ods": spreadsheet.read,
        ".shp": shapefile_format.read,
        ".kml": kml.read,
        ".kmz": kml.read,
        ".gpx": gpx.read,
        ".xml": isoxml.read,
        ".nmea": nmea_track.read,
        ".log": nmea_track.read,
        ".gga": nmea_track.read,
    }
)
"""By the ending of the file that was named."""

WRITERS: Mapping[str, Writer] = MappingProxyType(
    {
        ".geojson": geojson.written,
        ".csv": corner_csv.written,
        ".zip": shapefile_format.written,
        ".kml": kml.written,
        ".xml": isoxml.written,
    }
)
"""By the ending of the file to write; ``.zip`` is a shapefile with all its parts, ``.xml`` ISOXML task data."""

NAMED: Mapping[str, Reader] = MappingProxyType({name.lower(): agopengps.read for name in agopengps.MARKS})
"""Files whose name says more than their ending."""
IN_FOLDERS: Sequence[tuple[str, Reader]] = (
    (isoxml.TASKDATA, isoxml.read),
    ("Field.txt", agopengps.read),
    ("Boundary.txt", agopengps.read),
)
"""The file that tells what a folder or an archive is; else each file with a known ending is read by itself."""
ALONE = (".kml", ".kmz", ".geojson", ".json", ".gpx", ".xlsx", ".ods", ".xls", ".csv", ".txt")
"""Endings in a folder or archive, the most telling first: only files of the first that occurs are read."""


def read_fields(
    source: Path | bytes, name: str | None = None, options: ReadOptions | None = None
) -> tuple[ImportedField, ...]:
    """Every field in a file, a folder, an archive or an upload's bytes, each with all its preview must say.

    ``name`` is the upload's file name, whose ending tells the format. Fields that cannot be used are told in the
    warnings of the others. Raises ``ExchangeError`` when there is none that can, ``QuestionError`` for what the file
    leaves open.
    """
    said = str(source) if isinstance(source, Path) else (name or sentence("the file"))
    try:
        files = files_at(source) if isinstance(source, Path) else files_in(source, name or "")
        drafts = _reader_for(files)(files, options or ReadOptions())
        return _checked(drafts, files.title)
    except OpenQuestionError as question:
        raise QuestionError(sentence("{said}: {question}", said=said, question=question), question.option) from question
    except BoundaryError as error:
        msg = sentence("{said}: {reason}", said=said, reason=str(error))
        raise ExchangeError(msg) from error
    except OSError as error:
        msg = sentence("{said} cannot be read: {reason}", said=said, reason=error.strerror or error)
        raise ExchangeError(msg) from error


def checked_fields(path: Path) -> tuple[CheckedField, ...]:
    """Every field in the file, with area, perimeter and remarks for the preview. Raises ``ExchangeError``."""
    return tuple(CheckedField(one.document, one.area, one.perimeter, one.remarks) for one in read_fields(path))


def read_field(path: Path, name: str | None = None) -> FieldDocument:
    """The field in the file; with ``name`` the one called so. Raises ``ExchangeError`` where there is a choice."""
    fields = read_fields(path)
    called = [each.document for each in fields if name is None or each.document.name == name]
    if len(called) == 1:
        return called[0]
    names = ", ".join(each.document.name for each in fields[:5]) + (", ..." if len(fields) > 5 else "")
    if not called:
        msg = sentence("{path}: no field is called '{name}'; there are {names}", path=path, name=name, names=names)
    else:
        msg = sentence(
            "{path}: {count} fields are in it ({names}); give a file with one",
            path=path,
            count=len(called),
            names=names,
        )
    raise ExchangeError(msg)


def written_as(ending: str, document: FieldDocument) -> bytes:
    """The field in the format of an ending, for a download. Raises ``ExchangeError``."""
    writer = WRITERS.get(ending.lower())
    if writer is None:
        msg = sentence(
            "fields are written as {names}, not as '{ending}'", names=", ".join(sorted(WRITERS)), ending=ending
        )
        raise ExchangeError(msg)
    return writer(document)


def write_field(document: FieldDocument, path: Path) -> None:
    """Writes the field in the format of the file's ending. Raises ``ExchangeError``."""
    try:
        content = written_as(path.suffix, document)
    except ExchangeError as error:
        msg = sentence("{path}: {reason}", path=path, reason=str(error))
        raise ExchangeError(msg) from error
    try:
        path.write_bytes(content)
    except OSError as error:
        msg = sentence("{path} cannot be written: {reason}", path=path, reason=error.strerror or error)
        raise ExchangeError(msg) from error


def _reader_for(files: Files) -> Reader:
    """What reads this file, folder or archive. Raises ``BoundaryError``."""
    if files.main:
        suffix = PurePosixPath(files.main).suffix.lower()
        reader = NAMED.get(files.main.lower()) or READERS.get(suffix)
        if suffix in {".dbf", ".shx", ".prj", ".cpg"}:
            msg = sentence("this is only a part of a shapefile: choose {name}.shp", name=PurePosixPath(files.main).stem)
            raise BoundaryError(msg)
        if reader is None:
            msg = sentence(
                "fields are read from {names}, .zip and folders, not from '{suffix}'",
                names=", ".join(sorted(READERS)),
                suffix=suffix,
            )
            raise BoundaryError(msg)
        return reader
    for mark, reader in IN_FOLDERS:
        if files.called(mark) is not None:
            return reader
    if files.ending(".shp"):
        return shapefile_format.read
    for ending in ALONE:
        if files.ending(ending):
            return _each_of(ending)
    kinds = sorted({PurePosixPath(one).suffix.lower() or "files without an ending" for one in files.names})
    if not kinds:
        raise BoundaryError(sentence("it holds no file at all"))
    raise BoundaryError(sentence("no file that holds fields is in it, only {names}", names=", ".join(kinds[:6])))


def _each_of(ending: str) -> Reader:
    """Reads each file of an ending by itself."""

    def read(files: Files, options: ReadOptions) -> tuple[FieldDraft, ...]:
        return tuple(
            draft if draft.name else replace(draft, name=one.title)
            for one in (files.with_main(name) for name in files.ending(ending))
            for draft in READERS[ending](_opened(one), options)
        )

    return read


def _opened(files: Files) -> Files:
    """A KMZ inside an archive is opened; any other file stays as it is."""
    if PurePosixPath(files.main).suffix.lower() == ".kmz":
        return files_in(files.content(), files.main)
    return files


def _checked(drafts: Sequence[FieldDraft], title: str) -> tuple[ImportedField, ...]:
    """Each part of each draft as a field of its own. Raises ``BoundaryError`` when none can be used."""
    single = [one for draft in drafts for one in _parts(draft)]
    fields: list[ImportedField] = []
    refused: list[BoundaryError] = []
    reasons: list[str] = []
    for number, draft in enumerate(single, start=1):
        fallback = f"{title} {number}" if len(single) > 1 else title
        try:
            checked = checked_field(draft, fallback or "Field")
        except BoundaryError as error:
            refused.append(error)
            reasons.append(f"'{draft.name or fallback}' in it is refused: {error}")
            continue
        fields.append(
            ImportedField(checked.document, checked.area, checked.perimeter, checked.remarks, draft.assumptions)
        )
    if not fields:
        raise refused[0]
    return tuple(replace(one, warnings=(*one.warnings, *reasons)) for one in fields)


def _parts(draft: FieldDraft) -> list[FieldDraft]:
    if len(draft.parts) < 2:
        return [draft]
    many = len(draft.parts)
    return [
        replace(
            draft,
            name=None if draft.name is None else f"{draft.name[:100]} ({number})",
            parts=(part,),
            remarks=(
                *draft.remarks,
                sentence("the field has {count} parts, each of which becomes a field of its own", count=many),
            ),
        )
        for number, part in enumerate(draft.parts, start=1)
    ]
