"""Strict reading of a sentence's fields. Empty is None; what is not exactly the promised form is a ``DecodeError``.

Python's own ``float`` takes ``1_0``, ``1e5``, `` 7`` and ``nan``, all of which a corrupted sentence can hold, so each
number is matched against its form first.
"""

import math
import re
from collections.abc import Mapping, Sequence
from datetime import date
from functools import lru_cache

from guidance_app.decode.sentence import DecodeError
from guidance_app.geodesy import grid_cell

__all__ = ["KNOT", "Fields", "days_since_1970", "second_of_day"]

KNOT = 1852.0 / 3600.0
"""One knot in metres a second."""

SECONDS_PER_HOUR = 3600
_FOUR = {"a": 0, "b": 1, "c": 2, "d": 3}
_EPOCH = date(1970, 1, 1).toordinal()

_match_number = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)").fullmatch
REMEMBERED = 4096
"""Numbers as text that are remembered: most fields of a sentence change seldom, and some are said twice an epoch."""

_match_count = re.compile(r"[0-9]{1,4}").fullmatch
_match_time = re.compile(r"([01][0-9]|2[0-3])([0-5][0-9])([0-5][0-9]|60)(\.[0-9]*)?").fullmatch
_match_minutes = re.compile(r"([0-9]{1,3})([0-5][0-9])(?:\.([0-9]*))?").fullmatch


class Fields:
    """The texts of a sentence by the names that its layout gives them."""

    __slots__ = ("_index", "_texts", "kind", "talker")

    def __init__(self, kind: str, index: Mapping[str, int], texts: Sequence[str], talker: str = "") -> None:
        self.kind = kind
        self.talker = talker
        self._index = index
        self._texts = texts

    def text(self, name: str) -> str:
        """The field as it stands, empty where the sentence is too short for it."""
        try:
            return self._texts[self._index[name]]
        except IndexError:
            return ""

    def has(self, name: str) -> bool:
        """Whether the sentence is long enough to hold the field, empty or not."""
        return self._index[name] < len(self._texts)

    def behind(self, name: str) -> "tuple[Fields, ...]":
        """The fields behind this one, four at a time as ``a`` to ``d``; the last may be shorter."""
        first = self._index[name] + 1
        texts = self._texts[first:]
        return tuple(Fields(self.kind, _FOUR, texts[at : at + 4]) for at in range(0, len(texts), 4))

    def number(self, name: str) -> float | None:
        """A decimal number, no exponent."""
        text = self.text(name)
        if not text:
            return None
        value = _number(text)
        if value is None:
            raise DecodeError(_bad(self.kind))
        return value

    def between(self, name: str, low: float, high: float) -> float | None:
        """A number that must lie within [low, high]."""
        value = self.number(name)
        if value is not None and not low <= value <= high:
            raise DecodeError(_bad(self.kind))
        return value

    def count(self, name: str) -> int | None:
        """A whole number of at most four digits without sign."""
        text = self.text(name)
        if not text:
            return None
        if _match_count(text) is None:
            raise DecodeError(_bad(self.kind))
        return int(text)

    def letter(self, name: str, allowed: str) -> str | None:
        """One letter out of ``allowed``."""
        text = self.text(name)
        if not text:
            return None
        if len(text) != 1 or text not in allowed:
            raise DecodeError(_bad(self.kind))
        return text

    def angle(self, name: str, low: float = 0.0, high: float = 360.0) -> float | None:
        """Radians, from degrees within [low, high]; for a direction in [0, 2 pi)."""
        value = self.between(name, low, high)
        return None if value is None else math.radians(value)

    def direction(self, name: str, low: float = 0.0, high: float = 360.0) -> float | None:
        """A direction in [0, 2 pi), from degrees within [low, high]."""
        value = self.between(name, low, high)
        return None if value is None else math.radians(value % 360.0)

    def signed_angle(self, name: str, side: str) -> float | None:
        """Radians, positive east, of an angle whose sign is the letter E or W in the field ``side``."""
        value = self.angle(name, 0.0, 180.0)
        letter = self.letter(side, "EW")
        if value is None or letter is None:
            return None
        return value if letter == "E" else -value

    def time(self, name: str) -> float | None:
        """The second of the day, from ``hhmmss`` with or without decimals; 60 seconds stand for a leap second."""
        text = self.text(name)
        return None if not text else second_of_day(text, self.kind)

    def date(self, name: str) -> int | None:
        """Days since 1970, from ``ddmmyy``; years 80 to 99 are of the last century."""
        text = self.text(name)
        if not text:
            return None
        if len(text) != 6 or not text.isdecimal():
            raise DecodeError(_bad(self.kind))
        year = int(text[4:])
        return days_since_1970(year + (1900 if year >= 80 else 2000), int(text[2:4]), int(text[:2]), self.kind)

    def position(self) -> tuple[float, float, tuple[float, float]] | None:
        """Latitude and longitude in degrees and the cell (north, east) in metres; None when all four are empty.

        A latitude may carry a leading zero as a third digit of its degrees: receivers do that.
        """
        latitude, south = self.text("lat"), self.text("lat_dir")
        longitude, west = self.text("lon"), self.text("lon_dir")
        if not (latitude or longitude):
            return None
        place = _place(latitude, south, longitude, west)
        if place is None:
            raise DecodeError(_bad(self.kind))
        return place


@lru_cache(maxsize=REMEMBERED)
def _number(text: str) -> float | None:
    """None for what is no decimal number."""
    return None if _match_number(text) is None else float(text)


@lru_cache(maxsize=4)
def _place(latitude: str, south: str, longitude: str, west: str) -> tuple[float, float, tuple[float, float]] | None:
    """Degrees and cell; None for what is no place. An epoch says the same place in two or three sentences."""
    north, east = _match_minutes(latitude), _match_minutes(longitude)
    if north is None or east is None or south not in ("N", "S") or west not in ("E", "W"):
        return None
    latitude_deg = _degrees(latitude, len(north[1]))
    longitude_deg = _degrees(longitude, len(east[1]))
    if latitude_deg > 90.0 or longitude_deg > 180.0:
        return None
    cell = grid_cell(latitude_deg, len(east[3] or ""))
    if len(north[3] or "") != len(east[3] or ""):
        cell = (grid_cell(latitude_deg, len(north[3] or ""))[0], cell[1])
    return (-latitude_deg if south == "S" else latitude_deg, -longitude_deg if west == "W" else longitude_deg, cell)


def second_of_day(text: str, kind: str) -> float:
    """The second of the day of ``hhmmss[.sss]``."""
    second = _second(text)
    if second is None:
        raise DecodeError(_bad(kind))
    return second


@lru_cache(maxsize=4)
def _second(text: str) -> float | None:
    match = _match_time(text)
    if match is None:
        return None
    hours, minutes, seconds, decimals = match.groups()
    fraction = float(decimals) if decimals and len(decimals) > 1 else 0.0
    return int(hours) * SECONDS_PER_HOUR + int(minutes) * 60 + int(seconds) + fraction


def days_since_1970(year: int, month: int, day: int, kind: str) -> int:
    """Days since 1970-01-01; ``DecodeError`` for a date that the calendar does not have."""
    try:
        return date(year, month, day).toordinal() - _EPOCH
    except ValueError:
        raise DecodeError(_bad(kind)) from None


def _degrees(text: str, degree_digits: int) -> float:
    return int(text[:degree_digits]) + float(text[degree_digits:]) / 60.0


def _bad(kind: str) -> str:
    return f"bad field in {kind}"
