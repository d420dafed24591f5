"""Rows of cells to fields: which columns hold the corners, in which order, what the numbers are; all said in words.

What is looked for: a heading (in English, German, French, Spanish or Japanese) that names the columns; else the two
columns of numbers, a running number before them left out. Degrees and DMS are told from metres by their size. Metres
need a coordinate system: none is guessed. A column that is headed "field" tells the fields of a list apart.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from guidance_app.boundary import BoundaryError, FieldDraft
from guidance_app.coordinates import CornerError, Order, Spelled, corner_from_pair, read_coordinate
from guidance_app.documents import Position
from guidance_app.exchange.asking import OpenQuestionError, ReadOptions, changed_from
from guidance_app.exchange.rings import closed
from guidance_app.geodesy import CoordinateSystem, Projection
from guidance_app.language import sentence

__all__ = ["Cell", "draft_corners"]

Cell = str | float | None
Role = Literal["north", "east", "x", "y", "field", "other"]

HEADINGS: dict[str, Role] = {
    **dict.fromkeys(
        ("lat", "latitude", "latitud", "breite", "breitengrad", "geogr. breite", "緯度", "北緯", "north", "northing",
         "n", "nord", "norte", "hochwert", "point_y"), "north"
    ),
    **dict.fromkeys(
        ("lon", "lng", "long", "longitude", "longitud", "länge", "laenge", "längengrad", "経度", "東経", "east",
         "easting", "e", "est", "ost", "este", "rechtswert", "point_x"), "east"
    ),
    **dict.fromkeys(("x", "x座標", "x coord", "xcoord", "x-coordinate"), "x"),
    **dict.fromkeys(("y", "y座標", "y coord", "ycoord", "y-coordinate"), "y"),
    **dict.fromkeys(
        ("field", "feld", "schlag", "champ", "parcelle", "parcela", "campo", "圃場", "圃場名", "ほ場"), "field"
    ),
}  # fmt: skip
_is_plain = re.compile(r"[+-]?\d{1,15}(?:\.\d+)?(?:[eE][+-]?\d{1,2})?").fullmatch
LARGEST_DEGREES = 180.0
MOST_ROWS = 200_000


@dataclass(frozen=True, slots=True)
class _Columns:
    """Which column is which. ``named`` tells whether a heading said so."""

    first: int
    second: int
    field: int | None
    roles: tuple[Role, Role] | None


@dataclass(slots=True)
class _Reading:
    """What is known of a list while it is read."""

    options: ReadOptions
    assumptions: list[str]


def draft_corners(
    rows: Sequence[Sequence[Cell]], options: ReadOptions, name: str, said: Sequence[str] = ()
) -> tuple[FieldDraft, ...]:
    """A draft for each field of a table. Raises ``BoundaryError`` or its question."""
    filled = [list(row) for row in rows if any(_is_filled(cell) for cell in row)]
    if len(filled) > MOST_ROWS:
        msg = sentence("it has {count:,} rows; {most:,} are the most", count=len(filled), most=MOST_ROWS)
        raise BoundaryError(msg)
    heading, body = _heading(filled)
    if len(body) < 3:
        msg = sentence("it has {count} rows with coordinates; a field needs three corners", count=len(body))
        raise BoundaryError(msg)
    columns = _columns(heading, body)
    reading = _Reading(options, list(said))
    groups: dict[str, list[tuple[int, list[Cell]]]] = {}
    for number, row in enumerate(body, start=len(filled) - len(body) + 1):
        key = "" if columns.field is None else _text(_at(row, columns.field))
        groups.setdefault(key, []).append((number, row))
    pairs = {key: _pairs(group, columns) for key, group in groups.items()}
    everything = [pair for each in pairs.values() for pair in each]
    system = _system(everything, options)
    order = _order(everything, columns, system, reading)
    return tuple(
        FieldDraft(
            name=key or name,
            parts=([closed(_positions(each, system, order, options))],),
            assumptions=tuple(reading.assumptions),
        )
        for key, each in pairs.items()
    )


# --- the columns -----------------------------------------------------------------------------------------------------


def _is_filled(cell: Cell) -> bool:
    return cell is not None and (not isinstance(cell, str) or bool(cell.strip()))


def _text(cell: Cell) -> str:
    if isinstance(cell, float) and cell.is_integer():
        return str(int(cell))
    return "" if cell is None else " ".join(str(cell).split())


def _at(row: Sequence[Cell], column: int) -> Cell:
    return row[column] if column < len(row) else None


def _role(cell: Cell) -> Role:
    plain = _text(cell).strip(" :").lower().replace("（", "(").split("(")[0].split("[")[0].strip(" _")
    return HEADINGS.get(plain, "other")


def _heading(rows: list[list[Cell]]) -> tuple[list[Role] | None, list[list[Cell]]]:
    """The roles of the columns, if a row before the first coordinates names them, and the rows with coordinates."""
    for index, row in enumerate(rows[:20]):
        roles = [_role(cell) for cell in row]
        if {"north", "east"} <= set(roles) or {"x", "y"} <= set(roles):
            return roles, rows[index + 1 :]
        if sum(_is_number(cell) for cell in row) >= 2:
            return None, rows[index:]
    return None, rows


def _is_number(cell: Cell) -> bool:
    if isinstance(cell, float):
        return math.isfinite(cell)
    try:
        return _is_filled(cell) and _spelled(cell) is not None
    except CornerError:
        return False


def _spelled(cell: Cell) -> Spelled:
    """A cell as one coordinate: of degrees in any spelling, or metres with thousands. Raises ``CornerError``."""
    if isinstance(cell, float | int):
        return Spelled(float(cell))
    text = _text(cell)
    if _is_plain(text):
        return Spelled(float(text))
    try:
        return read_coordinate(text)
    except CornerError:
        return read_coordinate(text, plane=True)


def _columns(heading: list[Role] | None, body: list[list[Cell]]) -> _Columns:
    if heading is not None:
        roles: tuple[Role, Role] = ("north", "east") if {"north", "east"} <= set(heading) else ("x", "y")
        first, second = sorted(heading.index(role) for role in roles)
        field = heading.index("field") if "field" in heading else None
        return _Columns(first, second, field, (heading[first], heading[second]))
    width = max(len(row) for row in body)
    numeric = [column for column in range(width) if all(_is_number(_at(row, column)) for row in body)]
    if len(numeric) > 2 and _is_running(body, numeric[0]):
        numeric = numeric[1:]
    if len(numeric) < 2:
        msg = sentence("no two columns of coordinates are in it: head them latitude and longitude, or X and Y")
        raise BoundaryError(msg)
    return _Columns(numeric[0], numeric[1], None, None)


def _is_running(body: list[list[Cell]], column: int) -> bool:
    values = [_spelled(_at(row, column)).value for row in body]
    return all(float(value).is_integer() for value in values) and bool(np.all(np.diff(values) == 1))


def _pairs(group: list[tuple[int, list[Cell]]], columns: _Columns) -> list[tuple[int, Spelled, Spelled]]:
    found = []
    for number, row in group:
        try:
            pair = _spelled(_at(row, columns.first)), _spelled(_at(row, columns.second))
        except CornerError as error:
            msg = sentence("row {number}: {reason}", number=number, reason=str(error))
            raise BoundaryError(msg) from error
        found.append((number, *pair))
    return found


# --- what the numbers mean -------------------------------------------------------------------------------------------

Pairs = list[tuple[int, Spelled, Spelled]]


def _system(pairs: Pairs, options: ReadOptions) -> CoordinateSystem:
    if options.system is not None:
        return options.system
    largest = max(max(abs(first.value), abs(second.value)) for _, first, second in pairs)
    if not math.isfinite(largest):
        msg = sentence("a corner in it is not a number")
        raise BoundaryError(msg)
    if largest > LARGEST_DEGREES:
        msg = sentence(
            "its coordinates go up to {largest:,.0f}, so they are metres: say in which system (UTM with "
            "its zone, or Japanese plane rectangular with its zone)",
            largest=largest,
        )
        raise OpenQuestionError(msg, "system")
    return CoordinateSystem()


def _order(pairs: Pairs, columns: _Columns, system: CoordinateSystem, reading: _Reading) -> Order:
    """Which column is north: as told, by letters, by the heading, by size, else as is usual; said in words."""
    if reading.options.order is not None:
        return reading.options.order
    lettered = {first.axis for _, first, _ in pairs if first.axis}
    if len(lettered) == 1:
        return "north first" if lettered == {"north"} else "east first"
    headed = _headed(columns, system)
    fits = {order: _fits(pairs, order, system) for order in ("north first", "east first")}
    if headed is not None:
        other: Order = "east first" if headed == "north first" else "north first"
        if not fits[headed] and fits[other]:
            reading.assumptions.append(
                sentence("the columns are headed the wrong way round and are taken as {order}", order=_words(other))
            )
            return other
        if columns.roles is not None and columns.roles[0] in {"x", "y"}:
            reading.assumptions.append(
                sentence("X and Y are taken as {order} ({system})", order=_words(headed), system=system.words)
            )
        return headed
    usual: Order = "east first" if system.projection is Projection.UTM else "north first"
    if not fits[usual] and any(fits.values()):
        usual = "east first" if usual == "north first" else "north first"
    reading.assumptions.append(
        sentence("the columns are taken as {order} ({system})", order=_words(usual), system=system.words)
    )
    return usual


def _words(order: Order) -> str:
    return (
        sentence("north (latitude) first, then east")
        if order == "north first"
        else sentence("east (longitude) first, then north")
    )


def _headed(columns: _Columns, system: CoordinateSystem) -> Order | None:
    if columns.roles is None:
        return None
    north = "x" if system.projection is Projection.PLANE_RECTANGULAR else "y"
    return "north first" if columns.roles[0] in {"north", north} else "east first"


def _fits(pairs: Pairs, order: Order, system: CoordinateSystem) -> bool:
    first = [one.value for _, one, _ in pairs]
    second = [one.value for _, _, one in pairs]
    north, east = (first, second) if order == "north first" else (second, first)
    match system.projection:
        case Projection.GEOGRAPHIC:
            return max(map(abs, north)) <= 90 and max(map(abs, east)) <= 180
        case Projection.UTM:
            return all(100_000 <= one <= 900_000 for one in east) and all(0 <= one <= 1e7 for one in north)
        case _:
            return True


def _positions(pairs: Pairs, system: CoordinateSystem, order: Order, options: ReadOptions) -> list[Position]:
    """The corners in WGS 84 degrees. The first is read with all checks, so that a wrong system is one sentence."""
    for number, first, second in (pairs[0], pairs[-1]):
        try:
            corner_from_pair(first, second, system, order=order, inexact=options.inexact)
        except CornerError as error:
            msg = sentence("row {number}: {reason}", number=number, reason=str(error))
            if error.inexact:
                raise OpenQuestionError(msg, "inexact") from error
            raise BoundaryError(msg) from error
    pairs_of_values = [(first.value, second.value) for _, first, second in pairs]
    if order == "north first":
        pairs_of_values = [(second, first) for first, second in pairs_of_values]
    return changed_from(system, options)(pairs_of_values)
