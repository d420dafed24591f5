"""Coordinates as people type and read them: degrees, degrees and minutes, DMS, or metres of a plane, to WGS 84 degrees.

Read are the usual spellings of a coordinate: ``54.5807``, ``54,5807``, ``N 54° 34.842'``, ``54-34-50.5 N``,
``北緯38度32分48.4秒``, full-width digits too. A pair may stand in either order; what was taken for what is said in
words, and may be asked for the other way round. Nothing is guessed about a zone or a datum: those come as a
``CoordinateSystem``.
"""

import math
import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from guidance_app.geodesy import CoordinateSystem, DatumError, Projection, lonlat_from, lonlat_to
from guidance_app.language import message, sentence

__all__ = [
    "Corner",
    "CornerError",
    "Order",
    "Spelled",
    "corner_from_pair",
    "corner_text",
    "parse_corner",
    "read_coordinate",
    "two_coordinates",
]

Order = Literal["north first", "east first"]
Axis = Literal["north", "east"]


class CornerError(ValueError):
    """A text that is no coordinate; the message is one sentence for who typed it. ``inexact`` asks for consent."""

    def __init__(self, sentence: str, *, inexact: bool = False) -> None:
        super().__init__(sentence)
        self.inexact = inexact


@dataclass(frozen=True, slots=True)
class Spelled:
    """One number as it was written. ``axis`` is None where the text does not tell it."""

    value: float
    axis: Axis | None = None
    parts: int = 1
    decimal_comma: bool = False


@dataclass(frozen=True, slots=True)
class Corner:
    """A position in WGS 84 degrees, and how the text was read, in words."""

    latitude_deg: float
    longitude_deg: float
    said: str


SPELLINGS = {
    "′": "'", "’": "'", "‘": "'", "´": "'", "`": "'", "″": '"', "”": '"', "“": '"', "''": '"', "º": "°", "˚": "°",
    "−": "-", "–": "-", "度": "°", "分": "'", "秒": '"', "北緯": "N", "南緯": "S", "東経": "E", "西経": "W", "、": ",",
    "北": "N", "南": "S", "東": "E", "西": "W",
}  # fmt: skip
"""Signs that mean the same."""
AXES: dict[str, tuple[Axis, int]] = {"N": ("north", 1), "S": ("north", -1), "E": ("east", 1), "W": ("east", -1)}
LABELS: dict[str, Axis] = {
    "lat": "north", "latitude": "north", "lon": "east", "lng": "east", "long": "east", "longitude": "east",
    "x": "north", "y": "east",
}  # fmt: skip
"""Words before a number; ``x`` and ``y`` as surveyors of Japan mean them, so only in plane rectangular coordinates."""

_one_number = r"\d+(?:[.,]\d+)?"
_match_angle = re.compile(
    rf"([NSEW])?\s*([+-])?\s*({_one_number})\s*°?"
    rf"(?:[\s:\-]*({_one_number})\s*'?(?:[\s:\-]*({_one_number})\s*\"?)?)?\s*([NSEW])?"
).fullmatch
_match_metres = re.compile(
    r"(?:([NEXY])\s*[=:]?\s*)?([+-]?)(\d{1,3}(?:,\d{3})+\.\d+|\d+(?:[.,]\d+)?)\s*m?\s*([NE])?", re.IGNORECASE
).fullmatch
_match_label = re.compile(r"(latitude|longitude|lat|long|lng|lon)\.?\s*[=:]?\s*", re.IGNORECASE).match
_split_hard = re.compile(r"\s*[;\t\n|]\s*").split
_find_lettered = re.compile(r"[NSEW][^NSEW]+|[^NSEW]+[NSEW]").findall
_match_four_commas = re.compile(r"([+-]?\d+,\d+)\s*,\s*([+-]?\d+,\d+)").fullmatch

EASTINGS = (100_000.0, 900_000.0)
"""Metres; UTM coordinates of a zone lie between."""
NORTHINGS = (0.0, 10_000_000.0)
SIDES: Mapping[Axis | None, str] = {"north": message("north"), "east": message("east"), None: message("open")}
ORDERS: Mapping[Order, str] = {"north first": message("north first"), "east first": message("east first")}
FARTHEST_X, FARTHEST_Y = 1_000_000.0, 400_000.0
"""Metres from the origin of a plane rectangular zone: Japan's zones stay well within."""


def read_coordinate(text: str, *, plane: bool = False) -> Spelled:
    """One latitude, longitude, northing or easting. Raises ``CornerError``."""
    plain = _plain(text)
    if plane:
        return _metres(plain, text)
    axis: Axis | None = None
    label = _match_label(plain)
    if label is not None:
        axis = LABELS[label[1].lower()]
        plain = plain[label.end() :]
    match = _match_angle(plain.upper())
    if match is None:
        raise CornerError(_not_a_coordinate(text))
    before, sign, degrees, minutes, seconds, after = match.groups()
    if before and after:
        msg = sentence(
            "'{text}' names its side twice, {before} and {after}", text=text.strip(), before=before, after=after
        )
        raise CornerError(msg)
    value = _angle([degrees, minutes, seconds], text)
    letter = before or after
    if letter is not None:
        if sign == "-":
            msg = sentence("'{text}' has both a minus and a letter: use one of them", text=text.strip())
            raise CornerError(msg)
        axis, side = AXES[letter]
        value *= side
    value = -value if sign == "-" else value
    return Spelled(value, axis, 1 + (minutes is not None) + (seconds is not None), "," in plain)


def parse_corner(text: str, system: CoordinateSystem, *, order: Order | None = None, inexact: bool = False) -> Corner:
    """The position that a line of text means in a system. Raises ``CornerError`` for the person who typed it."""
    first, second = two_coordinates(text, plane=system.plane)
    return corner_from_pair(
        read_coordinate(first, plane=system.plane),
        read_coordinate(second, plane=system.plane),
        system,
        order=order,
        inexact=inexact,
    )


def corner_from_pair(
    first: Spelled, second: Spelled, system: CoordinateSystem, *, order: Order | None = None, inexact: bool = False
) -> Corner:
    """The position of two coordinates that were typed in two boxes. Raises ``CornerError``."""
    taken = order or _order_of(first, second, system)
    _check_axes(first, second, taken)
    north, east = (first.value, second.value) if taken == "north first" else (second.value, first.value)
    _check_range(north, east, system)
    try:
        longitude, latitude = lonlat_from(system, inexact=inexact)(np.array([[east, north]]))[0].tolist()
    except DatumError as error:
        raise CornerError(
            sentence("{reason}; confirm to take it so", reason=str(error)), inexact=error.accuracy is not None
        ) from error
    if not (math.isfinite(latitude) and math.isfinite(longitude)):
        msg = sentence(
            "{north:g} north, {east:g} east is nowhere in {system}", north=north, east=east, system=system.words
        )
        raise CornerError(msg)
    if system.plane:
        x, y = ("X ", "Y ") if system.projection is Projection.PLANE_RECTANGULAR else ("", "")
        said = sentence(
            "{x}{north:.3f} m north, {y}{east:.3f} m east in {system}",
            x=x,
            north=north,
            y=y,
            east=east,
            system=system.words,
        )
    else:
        said = sentence(
            "latitude {north:.9g}, longitude {east:.9g} in {system}", north=north, east=east, system=system.words
        )
    return Corner(latitude, longitude, said)


def corner_text(
    latitude_deg: float, longitude_deg: float, system: CoordinateSystem, *, dms: bool = False, inexact: bool = False
) -> str:
    """A WGS 84 position as the system writes it: ``54.580684068, 10.209195754`` or ``X -36258.123, Y 12034.567``.

    Raises ``CornerError`` where the datum can only be changed within metres and ``inexact`` is not.
    """
    try:
        east, north = lonlat_to(system, inexact=inexact)(np.array([[longitude_deg, latitude_deg]]))[0].tolist()
    except DatumError as error:
        raise CornerError(
            sentence("{reason}; confirm to see it so", reason=str(error)), inexact=error.accuracy is not None
        ) from error
    match system.projection:
        case Projection.PLANE_RECTANGULAR:
            return f"X {north:.3f}, Y {east:.3f}"
        case Projection.UTM:
            return f"{east:.3f} E, {north:.3f} N"
        case _:
            if dms:
                return f"{_dms(north, 'NS')}, {_dms(east, 'EW')}"
            return f"{north:.9f}, {east:.9f}"


# --- one number ------------------------------------------------------------------------------------------------------


def _plain(text: str) -> str:
    """The text with one sign for each meaning and half-width digits. Raises ``CornerError``."""
    for sign, meaning in SPELLINGS.items():
        text = text.replace(sign, meaning)
    text = unicodedata.normalize("NFKC", text).replace("−", "-").strip()
    if re.search(r"(?:^|[\d\s°'\"])O(?:[\d\s]|$)", text):
        msg = sentence("in '{text}' O means east in German and west in Spanish: write E or W", text=text[:60])
        raise CornerError(msg)
    return text


def _not_a_coordinate(text: str) -> str:
    if not text.strip():
        return sentence("a coordinate is missing")
    return sentence(
        "'{text}' is not a coordinate; write for example 38.546789, 38° 32' 48.4\" or N38 32.807",
        text=text.strip()[:60],
    )


def _number(text: str) -> float:
    return float(text.replace(",", "."))


def _angle(parts: list[str | None], text: str) -> float:
    """Degrees of degrees, minutes and seconds; only the last of them may have decimals."""
    given = [part for part in parts if part is not None]
    for part in given[:-1]:
        if not part.isdigit():
            msg = sentence(
                "'{text}' has decimals before its last part: is a separator missing?", text=text.strip()[:60]
            )
            raise CornerError(msg)
    for part, name in zip(given[1:], (sentence("minutes"), sentence("seconds")), strict=False):
        if _number(part) >= 60:
            msg = sentence("'{text}' has {part} {name}; they go up to 59", text=text.strip()[:60], part=part, name=name)
            raise CornerError(msg)
    return sum(_number(part) / 60.0**place for place, part in enumerate(given))


def _metres(plain: str, text: str) -> Spelled:
    match = _match_metres(plain)
    if match is None:
        raise CornerError(_not_a_coordinate(text).replace("38.546789, 38° 32' 48.4\" or N38 32.807", "-36258.123"))
    before, sign, digits, after = match.groups()
    thousands = "," in digits and "." in digits
    value = float(digits.replace(",", "" if thousands else "."))
    letter = (before or after or "").upper()
    axis = {"N": "north", "E": "east"}.get(letter) or LABELS.get(letter.lower())
    named: Axis | None = "north" if axis == "north" else "east" if axis == "east" else None
    return Spelled(-value if sign == "-" else value, named, 1, "," in digits and not thousands)


# --- two numbers -----------------------------------------------------------------------------------------------------


def two_coordinates(text: str, *, plane: bool = False) -> tuple[str, str]:
    """The two coordinates in a text. Raises ``CornerError``."""
    plain = _plain(text)
    for parts in (_split_hard(plain), *(() if plane else (_find_lettered(plain.upper()),)), re.split(r",\s+", plain)):
        if len(parts) == 2:
            return parts[0].strip(" ,"), parts[1].strip(" ,")
    commas = _match_four_commas(plain)
    if commas is not None:
        return commas[1], commas[2]
    parts = plain.split(",")
    if len(parts) == 2 and not re.search(r"\d\s+[+-]?\d", plain):
        return parts[0], parts[1]
    if plain.count("°") == 2:
        degrees = re.fullmatch(r"(.*?°.*?)[\s,]+([+-]?[\d.,]+\s*°.*)", plain)
        if degrees is not None:
            return degrees[1], degrees[2]
    words = re.sub(r"\s*([°'=:])\s*", r"\1", plain).split()
    if len(words) in {2, 4, 6}:
        half = len(words) // 2
        return " ".join(words[:half]), " ".join(words[half:])
    msg = sentence(
        "'{text}' is not two coordinates; write them with a comma and a space, or ; between", text=text.strip()[:60]
    )
    raise CornerError(msg)


def _order_of(first: Spelled, second: Spelled, system: CoordinateSystem) -> Order:
    """By letters, else by size where only one order is possible, else as the system is usually written."""
    if "north" in {first.axis} or "east" in {second.axis}:
        return "north first"
    if "east" in {first.axis} or "north" in {second.axis}:
        return "east first"
    match system.projection:
        case Projection.GEOGRAPHIC:
            return "east first" if abs(first.value) > 90 >= abs(second.value) else "north first"
        case Projection.UTM:
            low, high = EASTINGS
            return "north first" if not low <= first.value <= high and low <= second.value <= high else "east first"
        case _:
            return "north first"


def _check_axes(first: Spelled, second: Spelled, taken: Order) -> None:
    axes: tuple[Axis, Axis] = ("north", "east") if taken == "north first" else ("east", "north")
    if (first.axis or axes[0]) != axes[0] or (second.axis or axes[1]) != axes[1]:
        msg = sentence(
            "the letters say that the first is {first} and the second {second}",
            first=sentence(SIDES[first.axis]),
            second=sentence(SIDES[second.axis]),
        )
        raise CornerError(sentence("{reason}, which is not '{taken}'", reason=msg, taken=sentence(ORDERS[taken])))


def _check_range(north: float, east: float, system: CoordinateSystem) -> None:
    match system.projection:
        case Projection.GEOGRAPHIC if abs(north) > 90 or abs(east) > 180:
            msg = sentence("latitude {north:g}, longitude {east:g} is not on earth", north=north, east=east)
            if abs(north) <= 180 and abs(east) <= 90:
                msg = sentence("{reason}: the two look swapped", reason=msg)
            elif max(abs(north), abs(east)) > 1000:
                msg = sentence("{reason}: these look like metres, so choose UTM or plane rectangular", reason=msg)
        case Projection.UTM if not (
            EASTINGS[0] <= east <= EASTINGS[1] and NORTHINGS[0] <= north <= NORTHINGS[1] and abs(north) + east > 1000
        ):
            msg = sentence(
                "easting {east:g} m, northing {north:g} m is outside of every UTM zone", east=east, north=north
            )
            if abs(north) <= 180 and abs(east) <= 180:
                msg = sentence("{reason}: these look like degrees", reason=msg)
        case Projection.PLANE_RECTANGULAR if abs(north) > FARTHEST_X or abs(east) > FARTHEST_Y:
            msg = sentence(
                "X {north:g} m (north), Y {east:g} m (east) is outside of every plane rectangular zone",
                north=north,
                east=east,
            )
        case _:
            return
    raise CornerError(msg)


def _dms(degrees: float, sides: str) -> str:
    """To 1e-5 of a second, 0.3 mm."""
    units = round(abs(degrees) * 3600 * 100_000)
    whole, rest = divmod(units, 3600 * 100_000)
    minutes, seconds = divmod(rest, 60 * 100_000)
    return f"{whole}° {minutes:02d}' {seconds / 100_000:08.5f}\" {sides[degrees < 0]}"
