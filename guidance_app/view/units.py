"""Numbers as a driver reads them, in the units and the language that the settings name. What comes in is SI.

A unit's symbol is the same in all languages, but for the Japanese tan and chō.
Rounding is as coarse as a glance can use: whole centimetres or inches beside the lamps, two decimals of an area.
"""

from typing import assert_never

from guidance_app.documents import Units
from guidance_app.language import Words

__all__ = ["area_text", "distance_text", "length_text", "offset_text", "small_area_text", "speed_text", "speed_unit"]

INCH = 0.0254
FOOT = 0.3048
MILE = 1609.344
ACRE = 4046.8564224
ARE = 100.0
HECTARE = 10_000.0
SMALL_AREA = 1000.0
"""Square metres; less is not told in hectares."""
TAN = 300 * 400 / 121
"""300 tsubo, each 400/121 m2 by the Japanese law on measures of 1891; ten are a chō."""


def offset_text(metres: float, units: Units, words: Words) -> str:
    """``12 cm``, ``1.24 m``, ``5 in``: a sideways distance without its sign, for which there is an arrow."""
    size = abs(metres)
    if units is Units.IMPERIAL:
        inches = round(size / INCH)
        return f"{inches} in" if inches < 36 else f"{_short(size / FOOT, 1, words)} ft"
    centimetres = round(size * 100)
    return f"{centimetres} cm" if centimetres < 100 else f"{_short(size, 2, words)} m"


def distance_text(metres: float, units: Units, words: Words) -> str:
    """``42 m``, ``1.2 km``, ``140 ft``: a distance along the way, never negative."""
    size = max(0.0, metres)
    if units is Units.IMPERIAL:
        return f"{size / FOOT:.0f} ft" if size < MILE / 4 else f"{words.number(size / MILE, 1)} mi"
    return f"{size:.0f} m" if size < 999.5 else f"{words.number(size / 1000, 1)} km"


def speed_text(speed: float, units: Units, words: Words) -> str:
    """``8.4``, and ``R 2.1`` in reverse; the unit is ``speed_unit``."""
    size = abs(speed) * (3600.0 / MILE if units is Units.IMPERIAL else 3.6)
    shown = words.number(size, 1)
    return words.within("in reverse", "R {speed}", speed=shown) if speed < 0 and round(size, 1) > 0 else shown


def speed_unit(units: Units) -> str:
    """The unit of ``speed_text``."""
    return "mph" if units is Units.IMPERIAL else "km/h"


def area_text(square_metres: float, units: Units, words: Words) -> str:
    """``3.42 ha``, ``8.45 ac``; Japanese fields are counted in ares, ``342 a``, or in tan and chō, ``3.45 chō``."""
    match units:
        case Units.IMPERIAL:
            return f"{_short(square_metres / ACRE, 2, words)} ac"
        case Units.JAPANESE:
            return f"{_short(square_metres / ARE, 1, words)} a"
        case Units.TAN:
            few = round(square_metres / TAN, 2) < 10
            number = _short(square_metres / (TAN if few else 10 * TAN), 2, words)
            return f"{number} {words('tan') if few else words('chō')}"
        case Units.METRIC:
            return f"{_short(square_metres / HECTARE, 2, words)} ha"
        case _:
            assert_never(units)


def small_area_text(square_metres: float, units: Units, words: Words) -> str:
    """``320 m²``, ``3,440 ft²``; from 1,000 m² on as ``area_text`` has it."""
    if square_metres >= SMALL_AREA:
        return area_text(square_metres, units, words)
    if units is Units.IMPERIAL:
        return f"{words.number(square_metres / FOOT**2)} ft²"
    return f"{words.number(square_metres)} m²"


def _short(number: float, decimals: int, words: Words) -> str:
    """At most three digits and so many decimals: 1.24, 12.4, 124."""
    for places in range(decimals, 0, -1):
        if round(number, places) < 10 ** (3 - places):
            return words.number(number, places)
    return words.number(number)


def length_text(metres: float, units: Units, words: Words) -> str:
    """``2.45 m``, ``8.04 ft``: a length of a machine, to the centimetre."""
    return f"{words.number(metres / FOOT, 2)} ft" if units is Units.IMPERIAL else f"{words.number(metres, 2)} m"
