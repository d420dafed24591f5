"""Lists of corners as text: CSV with any separator, decimal points or commas; and fields as CSV.

Written are latitude and longitude in degrees, one row a corner, with the ring it belongs to: 0 is the boundary.
"""

import csv
import io
import re

from pydantic import ValidationError

from guidance_app.boundary import BoundaryError, FieldDraft
from guidance_app.coordinates import CornerError, two_coordinates
from guidance_app.documents import FieldDocument, GuidanceLineDocument, Position
from guidance_app.exchange.asking import ReadOptions, briefly
from guidance_app.exchange.corner_table import Cell, draft_corners
from guidance_app.exchange.files import Files
from guidance_app.exchange.rings import closed
from guidance_app.language import sentence

__all__ = ["read", "written"]

COLUMNS = ("field", "part", "ring", "latitude_deg", "longitude_deg")
ENCODINGS = ("utf-8-sig", "cp932", "cp1252")
SEPARATORS = (";", "\t", "|", ",")
_is_decimal_comma = re.compile(r"[+-]?\d+,\d+").fullmatch
_is_whole = re.compile(r"[+-]?\d+").fullmatch


def read(files: Files, options: ReadOptions) -> tuple[FieldDraft, ...]:
    """The fields of a list of corners. Raises ``BoundaryError``."""
    text = _decoded(files.content(), options)
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if lines and lines[0].split(",") == list(COLUMNS):
        return _own(lines)
    rows, said = _rows(lines)
    return draft_corners(rows, options, files.title, said)


def written(document: FieldDocument) -> bytes:
    """The field's rings and its guidance lines, a corner a row."""
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(COLUMNS)
    for number, ring in enumerate(document.boundary.coordinates):
        for longitude, latitude in ring[:-1]:
            writer.writerow((document.name, "boundary", number, f"{latitude:.9f}", f"{longitude:.9f}"))
    for number, line in enumerate(document.lines):
        for longitude, latitude in line.geometry.coordinates:
            part = f"{line.type} {line.name}"
            writer.writerow((document.name, part, number, f"{latitude:.9f}", f"{longitude:.9f}"))
    return table.getvalue().encode()


def _decoded(content: bytes, options: ReadOptions) -> str:
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return content.decode("utf-16", errors="replace")
    for encoding in (options.encoding,) if options.encoding else ENCODINGS:
        try:
            return content.decode(encoding)
        except UnicodeDecodeError:
            continue
        except LookupError as error:
            msg = sentence("the encoding '{encoding}' is not known", encoding=encoding)
            raise BoundaryError(msg) from error
    msg = sentence("it is not text in any usual encoding")
    raise BoundaryError(msg)


def _rows(lines: list[str]) -> tuple[list[list[Cell]], list[str]]:
    """The cells of each row, and what was assumed to cut them."""
    if len(lines) > 1 and all(_is_spaced_commas(line) for line in lines[1:]):
        return [_spaced(line) for line in lines], []
    for separator in SEPARATORS:
        rows = _cut(lines, separator)
        body = rows[1:] or rows
        if body and all(len(row) >= 2 for row in body):
            if separator != ",":
                return _as_cells(rows), []
            joined = [_joined(row) for row in rows]
            if all(row is not None for row in joined[1:]) and joined[1:]:
                kept = [row if row is not None else cells for row, cells in zip(joined, rows, strict=True)]
                return _as_cells(kept), ["commas inside the numbers are taken as decimal commas"]
            if not all(_is_decimal_comma(",".join(row).strip()) for row in body):
                return _as_cells(rows), []
    return [_spaced(line) for line in lines], []


def _is_spaced_commas(line: str) -> bool:
    """Whether a line is numbers with decimal commas and spaces between them."""
    words = line.split()
    commas = sum(_is_decimal_comma(word) is not None for word in words)
    return commas >= 2 and all(_is_decimal_comma(word) or _is_whole(word) for word in words)


def _cut(lines: list[str], separator: str) -> list[list[str]]:
    try:
        return [list(row) for row in csv.reader(lines, delimiter=separator)]
    except csv.Error as error:
        msg = sentence("it is not a list of corners ({reason})", reason=briefly(error))
        raise BoundaryError(msg) from error


def _joined(row: list[str]) -> list[str] | None:
    """Two numbers whose decimal commas were taken for separators, a running number before them kept."""
    cells = [cell.strip() for cell in row]
    if not all(_is_whole(cell) for cell in cells) or len(cells) not in {4, 5}:
        return None
    number, rest = cells[: len(cells) - 4], cells[len(cells) - 4 :]
    return [*number, f"{rest[0]},{rest[1]}", f"{rest[2]},{rest[3]}"]


def _as_cells(rows: list[list[str]]) -> list[list[Cell]]:
    return [[cell.strip() for cell in row] for row in rows]


def _spaced(line: str) -> list[Cell]:
    """A line without separators: its two coordinates, or else its words (a heading, or a running number before)."""
    words = line.split()
    if len(words) == 3:
        return list(words)
    try:
        return list(two_coordinates(line))
    except CornerError:
        return list(words)


def _own(lines: list[str]) -> tuple[FieldDraft, ...]:
    """What ``written`` wrote."""
    rings: dict[str, dict[str, list[Position]]] = {}
    lines_of: dict[str, dict[tuple[str, str], list[Position]]] = {}
    for number, row in enumerate(_cut(lines[1:], ","), start=2):
        try:
            field, part, place, latitude, longitude = row
            corner = float(longitude), float(latitude)
        except ValueError as error:
            msg = sentence("row {number} has not the five columns {names}", number=number, names=", ".join(COLUMNS))
            raise BoundaryError(msg) from error
        if part == "boundary":
            rings.setdefault(field, {}).setdefault(place, []).append(corner)
        else:
            lines_of.setdefault(field, {}).setdefault((part, place), []).append(corner)
    return tuple(
        FieldDraft(
            name=field or None,
            parts=([closed(ring) for ring in of_field.values()],),
            lines=tuple(_line(part, corners) for (part, _), corners in lines_of.get(field, {}).items()),
        )
        for field, of_field in rings.items()
    )


def _line(part: str, corners: list[Position]) -> GuidanceLineDocument:
    kind, _, name = part.partition(" ")
    try:
        return GuidanceLineDocument.model_validate({"name": name, "type": kind, "geometry": {"coordinates": corners}})
    except ValidationError as error:
        msg = sentence(
            "the guidance line '{part}' in it cannot be read: {reason}", part=part, reason=error.errors()[0]["msg"]
        )
        raise BoundaryError(msg) from error
