"""Sentences for tests, with right checksums."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from operator import xor

from guidance_app.decode.decoder import Decoder
from guidance_app.model import Chunk, Fix, Observation, Rejected

__all__ = [
    "clock_text",
    "epoch",
    "fixes_of",
    "gga",
    "gst",
    "hdt",
    "metres_apart",
    "observations_of",
    "rejections_of",
    "rmc",
    "sentence",
    "vtg",
    "without_arrival",
]

LATITUDE_DEG, LONGITUDE_DEG = 52.0, 8.0
METRES_PER_DEGREE = 111_120.0


def sentence(body: str) -> bytes:
    """``$body*hh`` and its line end."""
    return f"${body}*{reduce(xor, body.encode(), 0):02X}\r\n".encode()


def clock_text(seconds: float, decimals: int = 2) -> str:
    """``hhmmss.ss`` of a second of the day."""
    whole = round(seconds * 10**decimals)
    minutes, rest = divmod(whole, 60 * 10**decimals)
    hours, minutes = divmod(minutes, 60)
    second = f"{rest / 10**decimals:0{3 + decimals if decimals else 2}.{decimals}f}"
    return f"{hours % 24:02d}{minutes:02d}{second}"


def _place(north: float, east: float, decimals: int) -> str:
    latitude = LATITUDE_DEG + north / METRES_PER_DEGREE
    longitude = LONGITUDE_DEG + east / (METRES_PER_DEGREE * math.cos(math.radians(LATITUDE_DEG)))
    return (
        f"{int(latitude):02d}{latitude % 1 * 60:0{3 + decimals}.{decimals}f},N,"
        f"{int(longitude):03d}{longitude % 1 * 60:0{3 + decimals}.{decimals}f},E"
    )


def gga(seconds: float, north: float = 0.0, east: float = 0.0, quality: str = "4", decimals: int = 7) -> bytes:
    """A GGA, metres from 52 N 8 E."""
    place = _place(north, east, decimals)
    return sentence(f"GNGGA,{clock_text(seconds)},{place},{quality},12,0.8,50.0,M,45.0,M,1.0,0001")


def rmc(
    seconds: float, north: float = 0.0, east: float = 0.0, *, knots: str = "5.0", course: str = "90.0",
    date: str = "020120", status: str = "A", decimals: int = 7, tail: str = ",,,A",
) -> bytes:  # fmt: skip
    """An RMC, metres from 52 N 8 E."""
    place = _place(north, east, decimals)
    return sentence(f"GNRMC,{clock_text(seconds)},{status},{place},{knots},{course},{date}{tail}")


def vtg(course: str = "90.0", knots: str = "5.0") -> bytes:
    """A VTG."""
    return sentence(f"GNVTG,{course},T,,M,{knots},N,,K,A")


def gst(seconds: float, north: float = 0.02, east: float = 0.03) -> bytes:
    """A GST."""
    return sentence(f"GNGST,{clock_text(seconds)},1.0,,,,{north},{east},0.05")


def hdt(heading_deg: float) -> bytes:
    """An HDT."""
    return sentence(f"GNHDT,{heading_deg:.2f},T")


def epoch(seconds: float, north: float = 0.0, east: float = 0.0) -> bytes:
    """GGA and RMC of one epoch."""
    return gga(seconds, north, east) + rmc(seconds, north, east)


def fixes_of(observations: Sequence[Observation]) -> list[Fix]:
    """The fixes among observations."""
    return [one for one in observations if isinstance(one, Fix)]


def rejections_of(observations: Sequence[Observation]) -> list[str]:
    """The reasons of what was rejected."""
    return [one.reason for one in observations if isinstance(one, Rejected)]


def observations_of(chunks: Sequence[Chunk]) -> list[Observation]:
    """Everything that a new decoder makes of these chunks and their end."""
    decoder = Decoder()
    found = [one for chunk in chunks for one in decoder.feed(chunk)]
    return [*found, *decoder.finish(chunks[-1].arrival if chunks else 0.0)]


def without_arrival(observations: Sequence[Observation]) -> list[Observation]:
    """The same observations, as if all had come at once."""
    return [replace(one, arrival=0.0) for one in observations]


def metres_apart(a: Fix, b: Fix) -> float:
    """How far two fixes are apart."""
    north = (a.latitude_deg - b.latitude_deg) * METRES_PER_DEGREE
    east = (a.longitude_deg - b.longitude_deg) * METRES_PER_DEGREE * math.cos(math.radians(a.latitude_deg))
    return math.hypot(north, east)
