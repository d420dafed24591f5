"""A receiver of the ordinary kind: its errors, its rounding, and the NMEA sentences it speaks.

The error is a slow drift (first-order Gauss-Markov, as of a corrected but not carrier-phase receiver) and a small
noise from epoch to epoch; then the position is rounded to ``decimals`` of a minute, which at 4 decimals is a grid of
about 18 by 14 cm. Speed and course come from the Doppler shift, with a noise of their own, and no course is given at
standstill. Without a fix the sentences go on, empty, as receivers do it.
"""

import math
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from functools import reduce
from operator import xor

import numpy as np

from guidance_app.angles import wrap_2pi
from guidance_app.geodesy import FieldFrame
from guidance_app.model import FixQuality

__all__ = ["SENTENCES", "Antenna", "ReceiverSettings", "SimulatedReceiver"]

KNOT = 1852.0 / 3600.0
SENTENCES = ("GGA", "RMC", "VTG", "GST", "HDT", "ROT")
NO_COURSE_BELOW = 0.1
"""Metres per second; slower than this the course is left empty."""
CENTISECONDS = 100


@dataclass(frozen=True, slots=True)
class ReceiverSettings:
    """What the receiver is like. Metres, seconds, m/s, Hz; ``rate`` must divide 100 so that times have two decimals.

    ``noise`` and ``drift`` are standard deviations of each axis, ``drift_s`` the time in which the drift changes.
    """

    rate: int = 5
    decimals: int = 4
    quality: FixQuality = FixQuality.DGPS
    noise: float = 0.015
    drift: float = 0.06
    drift_s: float = 300.0
    doppler: float = 0.03
    heading_noise: float = math.radians(0.3)
    sentences: tuple[str, ...] = ("GGA", "RMC", "VTG")
    altitude: float = 748.0
    geoid_separation: float = 51.8

    def __post_init__(self) -> None:
        """Raises ``ValueError`` for what no receiver does."""
        if self.rate < 1 or CENTISECONDS % self.rate:
            msg = f"a rate of {self.rate} Hz is not possible; 1, 2, 4, 5, 10, 20, 25, 50 and 100 are"
            raise ValueError(msg)
        if not 2 <= self.decimals <= 9:
            msg = f"{self.decimals} decimals of a minute are not possible; 2 to 9 are"
            raise ValueError(msg)
        unknown = [name for name in self.sentences if name not in SENTENCES]
        if unknown or "GGA" not in self.sentences:
            msg = f"the sentences are GGA and any of {', '.join(SENTENCES[1:])}, not {', '.join(self.sentences)}"
            raise ValueError(msg)


@dataclass(frozen=True, slots=True)
class Antenna:
    """How the antenna stands and moves in truth: field frame, m/s towards east and north, heading of the body."""

    east: float
    north: float
    speed_east: float
    speed_north: float
    heading: float
    yaw_rate: float


@dataclass(slots=True)
class SimulatedReceiver:
    """Renders one epoch after the other. ``drift`` is its slow error now (east, north), the same until the next."""

    frame: FieldFrame
    settings: ReceiverSettings
    start: datetime
    generator: np.random.Generator
    drift: tuple[float, float] = field(init=False)

    def __post_init__(self) -> None:
        """Begins with some drift, as a receiver that has run for a while."""
        first = self.settings.drift * self.generator.standard_normal(2)
        self.drift = float(first[0]), float(first[1])

    def epoch(self, number: int, antenna: Antenna) -> bytes:
        """The sentences of epoch ``number`` (from 0), each with its line end."""
        settings = self.settings
        noise = self.generator.standard_normal(6)
        self._drift_on(float(noise[0]), float(noise[1]))
        latitude, longitude = self.frame.degrees_from_east_north(
            antenna.east + self.drift[0] + settings.noise * float(noise[2]),
            antenna.north + self.drift[1] + settings.noise * float(noise[3]),
        )
        east = antenna.speed_east + settings.doppler * float(noise[4])
        north = antenna.speed_north + settings.doppler * float(noise[5])
        moving = math.hypot(antenna.speed_east, antenna.speed_north) >= NO_COURSE_BELOW
        place = f"{_minutes(latitude, settings.decimals, 2, 'NS')},{_minutes(longitude, settings.decimals, 3, 'EW')}"
        motion = _Motion(
            knots=math.hypot(east, north) / KNOT if moving else 0.0,
            course=f"{math.degrees(wrap_2pi(math.atan2(east, north))):.1f}" if moving else "",
        )
        return self._rendered(number, place, motion, antenna)

    def no_fix(self, number: int) -> bytes:
        """The sentences of an epoch without a position."""
        clock, date = self._clock(number)
        bodies = {
            "GGA": f"GPGGA,{clock},,,,,0,03,9.9,,M,,M,,",
            "RMC": f"GPRMC,{clock},V,,,,,,,{date},,,N",
            "VTG": "GPVTG,,T,,M,,N,,K,N",
            "GST": f"GPGST,{clock},,,,,,,",
            "HDT": "GPHDT,,T",
            "ROT": "GPROT,,V",
        }
        return b"".join(_sentence(bodies[name]) for name in self.settings.sentences)

    def _rendered(self, number: int, place: str, motion: "_Motion", antenna: Antenna) -> bytes:
        settings = self.settings
        clock, date = self._clock(number)
        height_noise = 0.05 * math.sin(number / (40.0 * settings.rate))
        # Eight to eleven satellites, changing every minute or so: nobody needs a random number for this.
        satellites = 8 + (number // (70 * settings.rate)) % 4
        hdop = 1.3 - 0.1 * (satellites - 8)
        sigma = math.hypot(settings.noise, settings.drift)
        heading = math.degrees(wrap_2pi(antenna.heading + self._heading_error()))
        bodies = {
            "GGA": f"GPGGA,{clock},{place},{settings.quality.value},{satellites:02d},{hdop:.1f},"
            f"{settings.altitude + height_noise:.2f},M,{settings.geoid_separation:.1f},M,3.0,0120",
            "RMC": f"GPRMC,{clock},A,{place},{motion.knots:.2f},{motion.course},{date},,,D",
            "VTG": f"GPVTG,{motion.course},T,,M,{motion.knots:.2f},N,{motion.knots * 1.852:.2f},K,D",
            "GST": f"GPGST,{clock},{sigma:.3f},{sigma:.3f},{sigma:.3f},0.0,{sigma:.3f},{sigma:.3f},{2 * sigma:.3f}",
            "HDT": f"GPHDT,{heading:.2f},T",
            "ROT": f"GPROT,{math.degrees(antenna.yaw_rate) * 60:.1f},A",
        }
        return b"".join(_sentence(bodies[name]) for name in settings.sentences)

    def _heading_error(self) -> float:
        """Drawn only for a receiver that tells its heading."""
        if "HDT" not in self.settings.sentences:
            return 0.0
        return self.settings.heading_noise * float(self.generator.standard_normal())

    def _drift_on(self, east: float, north: float) -> None:
        keep = math.exp(-1 / (self.settings.rate * self.settings.drift_s))
        shake = self.settings.drift * math.sqrt(1 - keep**2)
        self.drift = keep * self.drift[0] + shake * east, keep * self.drift[1] + shake * north

    def _clock(self, number: int) -> tuple[str, str]:
        """UTC as hhmmss.ss and ddmmyy."""
        instant = self.start + timedelta(milliseconds=10 * number * CENTISECONDS // self.settings.rate)
        return f"{instant:%H%M%S}.{instant.microsecond // 10_000:02d}", f"{instant:%d%m%y}"


@dataclass(frozen=True, slots=True)
class _Motion:
    knots: float
    course: str


def _minutes(degrees: float, decimals: int, width: int, hemispheres: str) -> str:
    """Degrees and minutes as NMEA writes them, rounded in one go so that no minute ever reads 60."""
    scale: int = 10**decimals
    units = round(abs(degrees) * 60 * scale)
    whole, rest = divmod(units, 60 * scale)
    minutes, part = divmod(rest, scale)
    return f"{whole:0{width}d}{minutes:02d}.{part:0{decimals}d},{hemispheres[degrees < 0]}"


def _sentence(body: str) -> bytes:
    checksum = reduce(xor, body.encode("ascii"), 0)
    return f"${body}*{checksum:02X}\r\n".encode("ascii")
