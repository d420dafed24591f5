"""A field folder of AgOpenGPS: Field.txt (where it lies), Boundary.txt, and guidance lines of both generations.

Its metres are those of its own flat earth at the start fix, which is undone by the formula it was made with. Points
and commas as decimal marks both occur. Folders of the old UTM days have no start fix and are refused.
"""

import math
import re
from collections.abc import Iterator

from pydantic import ValidationError

from guidance_app.boundary import BoundaryError, FieldDraft
from guidance_app.documents import GuidanceLineDocument, LineGeometry, Position
from guidance_app.exchange.asking import ReadOptions
from guidance_app.exchange.files import Files
from guidance_app.exchange.rings import closed
from guidance_app.language import sentence

__all__ = ["MARKS", "read"]

MARKS = ("Field.txt", "Boundary.txt", "TrackLines.txt", "ABLines.txt", "CurveLines.txt")
AB_LENGTH = 100.0
"""Metres of the line that stands for a point and a heading."""
AB_MODE, PIVOT_MODE = "2", "64"
_find_dotted = re.compile(r"[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?").findall
_find_commas = re.compile(r"[+-]?\d+,\d+|[+-]?\d+(?=,[+-]|$)").findall
Start = tuple[float, float]


def read(files: Files, options: ReadOptions) -> tuple[FieldDraft, ...]:  # noqa: ARG001 - the folder says it all
    """The field of the folder. Raises ``BoundaryError``."""
    about = files.called("Field.txt")
    if about is None:
        msg = sentence(
            "there is no Field.txt beside the boundary: choose the whole folder of the field, or pack it into a .zip"
        )
        raise BoundaryError(msg)
    start, name = _about(_lines_of(files, about))
    boundary = files.called("Boundary.txt")
    rings = [] if boundary is None else _rings(_lines_of(files, boundary), start)
    if not rings:
        msg = sentence("its Boundary.txt holds no boundary: the field was never bounded")
        raise BoundaryError(msg)
    lines: list[GuidanceLineDocument] = []
    for file, reader in (("TrackLines.txt", _tracks), ("ABLines.txt", _ab_lines), ("CurveLines.txt", _curves)):
        found = files.called(file)
        if found is not None and not (lines and file != "TrackLines.txt"):
            lines += reader(_lines_of(files, found), start)
    return (FieldDraft(name=name or files.title or None, parts=(rings,), lines=tuple(lines)),)


def _lines_of(files: Files, name: str) -> list[str]:
    text = files.content(name).decode("utf-8-sig", errors="replace")
    return [line.strip() for line in text.splitlines()]


def _about(lines: list[str]) -> tuple[Start, str]:
    """The start fix (latitude, longitude) and the field's name."""
    after = {line.lower(): lines[number + 1] for number, line in enumerate(lines[:-1])}
    if "startfix" not in after:
        msg = sentence(
            "its Field.txt has no start fix, as in the old versions that computed in UTM: save it with a newer one"
        )
        raise BoundaryError(msg)
    offsets = _numbers(after.get("$offsets", "0,0"))
    if any(offsets):
        msg = sentence(
            "its Field.txt has UTM offsets, as in the old versions that computed in UTM: save it with a newer one"
        )
        raise BoundaryError(msg)
    numbers = _numbers(after["startfix"])
    if len(numbers) != 2 or abs(numbers[0]) > 89 or abs(numbers[1]) > 180:
        msg = sentence("its start fix '{text}' is not a latitude and longitude", text=after["startfix"][:40])
        raise BoundaryError(msg)
    name = "".join(letter if letter.isprintable() else " " for letter in after.get("$fielddir", ""))
    return (numbers[0], numbers[1]), " ".join(name.split())[:120]


def _numbers(line: str) -> list[float]:
    """The numbers of a line, whether its decimals are points or commas."""
    if "." not in line and line.count(",") > 2:
        return [float(text.replace(",", ".")) for text in _find_commas(line)]
    return [float(text) for text in _find_dotted(line)]


def _rings(lines: list[str], start: Start) -> list[list[Position]]:
    """The outer ring, then the inner ones, each behind one or two lines of True or False and its count."""
    rings = []
    place = 0
    while place < len(lines):
        if not lines[place].isdigit():
            place += 1
            continue
        count = int(lines[place])
        rows = lines[place + 1 : place + 1 + count]
        if len(rows) < count:
            msg = sentence(
                "its Boundary.txt ends after {given} of {count} corners: it was cut off", given=len(rows), count=count
            )
            raise BoundaryError(msg)
        if count >= 3:
            rings.append(closed([_position(row, start) for row in rows]))
        place += 1 + count
    return rings


def _position(row: str, start: Start) -> Position:
    numbers = _numbers(row)
    if len(numbers) < 2:
        msg = sentence("the corner '{row}' is not easting and northing", row=row[:40])
        raise BoundaryError(msg)
    return _degrees(numbers[0], numbers[1], start)


def _degrees(easting: float, northing: float, start: Start) -> Position:
    """Longitude and latitude; metres of a degree as AgOpenGPS takes them, at the start and at the point's latitude."""
    origin = math.radians(start[0])
    per_latitude = (
        111132.92 - 559.82 * math.cos(2 * origin) + 1.175 * math.cos(4 * origin) - 0.0023 * math.cos(6 * origin)
    )
    latitude = start[0] + northing / per_latitude
    here = math.radians(latitude)
    per_longitude = 111412.84 * math.cos(here) - 93.5 * math.cos(3 * here) + 0.118 * math.cos(5 * here)
    return start[1] + easting / per_longitude, latitude


# --- guidance lines --------------------------------------------------------------------------------------------------


def _tracks(lines: list[str], start: Start) -> Iterator[GuidanceLineDocument]:
    """TrackLines.txt: name, heading, A, B, nudge, mode, visible, count and as many points of a curve."""
    rest = [line for line in lines if line and not line.startswith("$")]
    while len(rest) >= 8:
        name, _, point_a, point_b, _, mode, _, count = rest[:8]
        many = int(count) if count.isdigit() else 0
        points = [_position(row, start) for row in rest[8 : 8 + many]]
        rest = rest[8 + many :]
        if mode == PIVOT_MODE:
            continue
        if mode == AB_MODE or len(points) < 2:
            yield _line(name, "ab", [_position(point_a, start), _position(point_b, start)])
        else:
            yield _line(name, "curve", points)


def _ab_lines(lines: list[str], start: Start) -> Iterator[GuidanceLineDocument]:
    """ABLines.txt: name, heading in degrees, easting, northing; the name may hold commas."""
    for line in lines:
        match = re.fullmatch(r"(.*?),([+-]?\d+,\d+),([+-]?\d+,\d+),([+-]?\d+,\d+)", line) or re.fullmatch(
            r"(.*?),([+-]?[\d.]+),([+-]?[\d.]+),([+-]?[\d.]+)", line
        )
        if match is None:
            continue
        heading, east, north = (float(text.replace(",", ".")) for text in match.groups()[1:])
        turned = math.radians(heading)
        end = east + AB_LENGTH * math.sin(turned), north + AB_LENGTH * math.cos(turned)
        yield _line(match[1], "ab", [_degrees(east, north, start), _degrees(*end, start)])


def _curves(lines: list[str], start: Start) -> Iterator[GuidanceLineDocument]:
    """CurveLines.txt: name, heading, count and as many points."""
    rest = [line for line in lines if line and not line.startswith("$")]
    while len(rest) >= 3:
        name, _, count = rest[:3]
        many = int(count) if count.isdigit() else 0
        points = [_position(row, start) for row in rest[3 : 3 + many]]
        rest = rest[3 + many :]
        if len(points) >= 2:
            yield _line(name, "curve", points)


def _line(name: str, kind: str, points: list[Position]) -> GuidanceLineDocument:
    cleaned = " ".join("".join(letter if letter.isprintable() else " " for letter in name).split())[:120]
    try:
        return GuidanceLineDocument.model_validate(
            {"name": cleaned or "Line", "type": kind, "geometry": LineGeometry(coordinates=points)}
        )
    except ValidationError as error:
        msg = sentence(
            "its guidance line '{name}' cannot be read: {reason}", name=cleaned, reason=error.errors()[0]["msg"]
        )
        raise BoundaryError(msg) from error
