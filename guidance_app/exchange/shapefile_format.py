"""Shapefiles to drafts and fields to shapefiles, by pyshp; the files lie side by side or in one archive.

A .prj names the coordinate system; without one the file is only read when a person says which it is. Names are read
in the encoding of the .cpg or the .dbf, else in the one that is usual where the field lies, which is said.
"""

import io
import struct
import warnings
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath

import shapefile
from pydantic import ValidationError
from pyproj import CRS

from guidance_app.boundary import BoundaryError, FieldDraft
from guidance_app.documents import FieldDocument, GuidanceLineDocument, Position
from guidance_app.exchange.asking import OpenQuestionError, ReadOptions, briefly, changed_from
from guidance_app.exchange.files import Files
from guidance_app.exchange.rings import polygons_of
from guidance_app.geodesy import crs_named
from guidance_app.language import sentence

__all__ = ["WGS84_PRJ", "archive_of", "layer", "read", "turned", "written"]

NAMES = ("name", "field_name", "fieldname", "feld", "schlag", "nom", "nombre", "label", "title", "圃場名", "名称", "id")
"""Columns that may hold the field's name, first come first served."""
POLYGONS = {shapefile.POLYGON, shapefile.POLYGONZ, shapefile.POLYGONM}
CODE_PAGES = {0x13: "cp932", 0x7B: "cp932", 0x03: "cp1252", 0x57: "cp1252", 0x58: "cp1252", 0x02: "cp850"}
"""Byte 29 of a .dbf."""
JAPAN = (122.0, 154.0, 20.0, 46.0)
"""West, east, south, north in degrees: where names without an encoding are taken as cp932."""
WGS84_PRJ = (
    'GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],'
    'PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]]'
)
DAMAGED = (shapefile.ShapefileException, struct.error, ValueError, LookupError, EOFError, TypeError, OverflowError)
"""What pyshp raises at bytes that are no shapefile."""
LINES = "lines"
"""The layer with the guidance lines."""
LONGEST_NAME = 120
"""Bytes in a text column of a .dbf that this program writes; 254 are possible."""

Record = dict[str, str]
Cells = Mapping[str, str | float | None]
Ring = list[Position]


def read(files: Files, options: ReadOptions) -> tuple[FieldDraft, ...]:
    """A draft for each polygon shape. Raises ``BoundaryError`` or its question."""
    names = [files.main] if PurePosixPath(files.main).suffix.lower() == ".shp" else files.ending(".shp")
    if not names:
        msg = sentence("there is no .shp file beside it: choose the .shp, or put .shp, .dbf and .prj into one .zip")
        raise BoundaryError(msg)
    layers = [files.with_main(name) for name in names]
    polygons = [one for one in layers if _kind(one) in POLYGONS]
    if not polygons:
        msg = sentence("its shapes are points or lines, not polygons")
        raise BoundaryError(msg)
    drafts = [draft for one in polygons for draft in _drafts(one, options)]
    for other in layers:
        if other in polygons:
            continue
        lines = _own_lines(other, options) if len(drafts) == 1 else []
        if lines:
            drafts = [drafts[0].with_extras(lines, None)]
        else:
            drafts = [each.remarked(f"'{other.title}' holds points or lines and is left out") for each in drafts]
    return tuple(drafts)


def written(document: FieldDocument) -> bytes:
    """An archive with the boundary as one layer and, if there are any, the guidance lines as another."""
    rings = [turned(ring, clockwise=number == 0) for number, ring in enumerate(document.boundary.coordinates)]
    files = layer("field", shapefile.POLYGON, [(rings, {"name": document.name, "notes": document.notes})])
    if document.lines:
        lines = [([line.geometry.coordinates], {"name": line.name, "type": line.type}) for line in document.lines]
        files |= layer(LINES, shapefile.POLYLINE, lines)
    return archive_of(files)


def archive_of(files: dict[str, bytes]) -> bytes:
    """The files in one zip archive, the same bytes for the same content."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return target.getvalue()


def layer(name: str, kind: int, shapes: Sequence[tuple[Sequence[Ring], Cells]]) -> dict[str, bytes]:
    """The five files of a layer in WGS 84 degrees. ``shapes`` holds rings, lines or single points with their columns.

    Columns of numbers stay numbers, None is an empty cell. Points are rings of one position.
    """
    shp, shx, dbf = io.BytesIO(), io.BytesIO(), io.BytesIO()
    columns = list(shapes[0][1]) if shapes else ["name"]
    with shapefile.Writer(shp=shp, shx=shx, dbf=dbf, shapeType=kind, encoding="utf-8") as writer:
        for column in columns:
            if shapes and not any(isinstance(record[column], str) for _, record in shapes):
                writer.field(column[:10], "N", size=19, decimal=9)
            else:
                writer.field(column[:10], "C", size=LONGEST_NAME)
        for rings, record in shapes:
            if kind == shapefile.POINT:
                writer.point(*rings[0][0])
            elif kind == shapefile.POLYGON:
                writer.poly([list(ring) for ring in rings])
            else:
                writer.line([list(ring) for ring in rings])
            writer.record(*(_stored(record[column]) for column in columns))
    parts = {"shp": shp, "shx": shx, "dbf": dbf}
    files = {f"{name}.{ending}": part.getvalue() for ending, part in parts.items()}
    return files | {f"{name}.prj": WGS84_PRJ.encode(), f"{name}.cpg": b"UTF-8"}


def _stored(value: str | float | None) -> str | float | None:
    """A text is cut to the column's bytes, not within a letter."""
    if isinstance(value, str):
        return value.encode()[:LONGEST_NAME].decode(errors="ignore") or None
    return value


def turned(ring: Ring, *, clockwise: bool) -> Ring:
    """The ring in the orientation of a shapefile: the outer one clockwise."""
    return ring if (shapefile.signed_area(ring) < 0) == clockwise else ring[::-1]


# --- reading ---------------------------------------------------------------------------------------------------------


def _drafts(files: Files, options: ReadOptions) -> list[FieldDraft]:
    change = changed_from(_system(files, options), options)
    shapes = [[change(ring) for ring in rings if len(ring) >= 3] for rings in _shapes(files)]
    where = next((ring[0] for rings in shapes for ring in rings), None)
    records, said = _records(files, options, where)
    title = files.title
    drafts = []
    for number, placed in enumerate(shapes):
        record = records[number] if number < len(records) else {}
        if placed:
            name = _name(record) or (f"{title} {number + 1}" if len(shapes) > 1 else title)
            drafts.append(FieldDraft(name, polygons_of(placed), notes=record.get("notes", ""), assumptions=said))
    if not drafts:
        msg = sentence("its shapes are empty")
        raise BoundaryError(msg)
    return drafts


def _system(files: Files, options: ReadOptions) -> "CRS":
    beside = files.beside(".prj")
    if beside is None:
        if options.system is not None:
            return CRS.from_epsg(options.system.epsg)
        msg = sentence(
            "the .prj file is missing, so its coordinate system is not known: choose the .prj too, or say the system"
        )
        raise OpenQuestionError(msg, "system")
    text = files.content(beside).decode("utf-8-sig", errors="replace")
    try:
        return crs_named(text)
    except ValueError as error:
        msg = sentence("its .prj cannot be understood: {reason}", reason=briefly(error))
        raise BoundaryError(msg) from error


def _shapes(files: Files) -> list[list[Ring]]:
    """The rings or lines of each shape in the file's own numbers."""
    try:
        with _reader(files) as reader:
            return [_rings(shape) for shape in reader.iterShapes()]
    except DAMAGED as error:
        msg = sentence("it is not a sound shapefile ({reason})", reason=briefly(error))
        raise BoundaryError(msg) from error


def _reader(files: Files) -> shapefile.Reader:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", shapefile.PossiblyCorruptFileHeader)  # what matters is whether it reads
        return shapefile.Reader(shp=io.BytesIO(files.content()))


def _kind(files: Files) -> int:
    try:
        with _reader(files) as reader:
            return int(reader.shapeType)
    except DAMAGED as error:
        msg = sentence("it is not a sound shapefile ({reason})", reason=briefly(error))
        raise BoundaryError(msg) from error


def _own_lines(files: Files, options: ReadOptions) -> list[GuidanceLineDocument]:
    """The guidance lines of a layer that this program wrote; none of any other."""
    if PurePosixPath(files.main).stem != LINES or _kind(files) != shapefile.POLYLINE:
        return []
    change = changed_from(_system(files, options), options)
    records, _ = _records(files, options, None)
    found = []
    for rings, record in zip(_shapes(files), records, strict=False):
        members = {
            "name": record.get("name"),
            "type": record.get("type"),
            "geometry": {"coordinates": change(rings[0])},
        }
        try:
            found.append(GuidanceLineDocument.model_validate(members))
        except ValidationError:
            return []
    return found


def _rings(shape: shapefile.Shape) -> list[Ring]:
    if shape.shapeType == shapefile.NULL:
        return []
    ends = [*list(shape.parts)[1:], len(shape.points)]
    return [
        [(float(point[0]), float(point[1])) for point in shape.points[start:end]]
        for start, end in zip(shape.parts, ends, strict=True)
    ]


def _records(files: Files, options: ReadOptions, where: Position | None) -> tuple[list[Record], tuple[str, ...]]:
    """The columns of each shape as text, and in which encoding they were taken to be."""
    beside = files.beside(".dbf")
    if beside is None:
        return [], (sentence("the .dbf file is missing, so the fields have no names"),)
    content = files.content(beside)
    named = options.encoding or _named_encoding(files, content)
    japanese = where is not None and JAPAN[0] < where[0] < JAPAN[1] and JAPAN[2] < where[1] < JAPAN[3]
    records = _raw_records(content)
    guesses = ("utf-8", "cp932", "cp1252") if japanese else ("utf-8", "cp1252", "cp932")
    for encoding in (named,) if named else guesses:
        try:
            decoded = [{key: _recoded(text, encoding) for key, text in record.items()} for record in records]
        except UnicodeDecodeError:
            continue
        except LookupError as error:
            msg = sentence("the encoding '{encoding}' of its names is not known", encoding=encoding)
            raise BoundaryError(msg) from error
        plain = all(text.isascii() for record in decoded for text in record.values())
        return decoded, () if named or plain else (
            sentence("the names are taken as {encoding}, as the file does not say it", encoding=encoding),
        )
    msg = sentence(
        "its names cannot be read as {encoding}: say which encoding they have", encoding=named or "any usual encoding"
    )
    raise OpenQuestionError(msg, "encoding")


def _recoded(text: str, encoding: str) -> str:
    return text.encode("latin-1").decode(encoding).strip()


def _raw_records(content: bytes) -> list[Record]:
    """The columns of each shape, each byte of a text one letter."""
    try:
        with shapefile.Reader(dbf=io.BytesIO(content), encoding="latin-1") as reader:
            return [
                {key: "" if value is None else str(value) for key, value in record.as_dict().items()}
                for record in reader.iterRecords()
            ]
    except DAMAGED as error:
        msg = sentence("its .dbf file is not sound ({reason})", reason=briefly(error))
        raise BoundaryError(msg) from error


def _named_encoding(files: Files, dbf: bytes) -> str | None:
    beside = files.beside(".cpg")
    if beside is not None:
        text = files.content(beside).decode("ascii", errors="replace").strip().lower()
        known = {"65001": "utf-8", "932": "cp932", "sjis": "cp932", "shift_jis": "cp932", "ansi 932": "cp932"}
        return known.get(text, f"cp{text}" if text.isdigit() else text) or None
    return CODE_PAGES.get(dbf[29]) if len(dbf) > 29 else None


def _name(record: Record) -> str | None:
    lowered = {key.lower(): value for key, value in record.items()}
    for key in NAMES:
        text = "".join(letter if letter.isprintable() else " " for letter in lowered.get(key, ""))
        if text.strip():
            return " ".join(text.split())[:120]
    return None
