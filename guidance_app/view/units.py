"""Numbers as a driver reads them, in the units that the settings name. Everything that comes in is SI.

Rounding is as coarse as a glance can use: whole centimetres or inches beside the lamps, two decimals of an area.
"""

from guidance_app.documents import Units

__all__ = ["area_text", "distance_text", "offset_text", "speed_text", "speed_unit"]

INCH = 0.0254
FOOT = 0.3048
MILE = 1609.344
ACRE = 4046.8564224
ARE = 100.0
HECTARE = 10_000.0


def offset_text(metres: float, units: Units) -> str:
    """``12 cm``, ``1.24 m``, ``5 in``: a sideways distance without its sign, for which there is an arrow."""
    size = abs(metres)
    if units is Units.IMPERIAL:
        inches = round(size / INCH)
        return f"{inches} in" if inches < 36 else f"{_short(size / FOOT, 1)} ft"
    centimetres = round(size * 100)
    return f"{centimetres} cm" if centimetres < 100 else f"{_short(size, 2)} m"


def distance_text(metres: float, units: Units) -> str:
    """``42 m``, ``1.2 km``, ``140 ft``: a distance along the way, never negative."""
    size = max(0.0, metres)
    if units is Units.IMPERIAL:
        return f"{size / FOOT:.0f} ft" if size < MILE / 4 else f"{size / MILE:.1f} mi"
    return f"{size:.0f} m" if size < 999.5 else f"{size / 1000:.1f} km"


def speed_text(speed: float, units: Units) -> str:
    """``8.4``, and ``R 2.1`` in reverse; the unit is ``speed_unit``."""
    size = abs(speed) * (3600.0 / MILE if units is Units.IMPERIAL else 3.6)
    shown = f"{size:.1f}"
    return f"R {shown}" if speed < 0 and shown != "0.0" else shown


def speed_unit(units: Units) -> str:
    """The unit of ``speed_text``."""
    return "mph" if units is Units.IMPERIAL else "km/h"


def area_text(square_metres: float, units: Units) -> str:
    """``3.42 ha``, ``8.45 ac``; Japanese fields are counted in ares, ``342 a``."""
    match units:
        case Units.IMPERIAL:
            return f"{_short(square_metres / ACRE, 2)} ac"
        case Units.JAPANESE:
            return f"{_short(square_metres / ARE, 1)} a"
        case Units.METRIC:
            return f"{_short(square_metres / HECTARE, 2)} ha"


def _short(number: float, decimals: int) -> str:
    """At most three digits and so many decimals: 1.24, 12.4, 124."""
    for places in range(decimals, 0, -1):
        if round(number, places) < 10 ** (3 - places):
            return f"{number:.{places}f}"
    return f"{number:.0f}"
