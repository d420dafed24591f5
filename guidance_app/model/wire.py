"""From the wire: bytes with their time, and what a receiver said of one epoch."""

from dataclasses import dataclass
from enum import IntEnum

from guidance_app.model.making import made_quickly

__all__ = [
    "ATTITUDE",
    "CORRECTIONS",
    "RECEIVER",
    "Attitude",
    "Chunk",
    "Fix",
    "FixQuality",
    "NoFix",
    "Observation",
    "Rejected",
    "Satellite",
]

RECEIVER = "receiver"
ATTITUDE = "attitude"
CORRECTIONS = "corrections"
"""The links of a session: the receiver, an attitude sensor on a port of its own, and the caster of corrections."""


@made_quickly
@dataclass(frozen=True, slots=True)
class Chunk:
    """Bytes as they came in. Empty bytes only tell the time, so that a half-received epoch can close."""

    arrival: float
    data: bytes
    link: str = RECEIVER


class FixQuality(IntEnum):
    """GGA field 6. The numbers are those of the sentence."""

    NONE = 0
    AUTONOMOUS = 1
    DGPS = 2
    PPS = 3
    RTK_FIXED = 4
    RTK_FLOAT = 5
    DEAD_RECKONING = 6
    MANUAL = 7
    SIMULATED = 8


@made_quickly
@dataclass(frozen=True, slots=True)
class Fix:
    """One position of one epoch, with everything else the receiver said about that instant.

    ``cell`` is the receiver's rounding (north, east) in metres, from the number of decimals in the sentence;
    ``sigma`` the receiver's own estimate (north, east) from GST. ``course`` and ``speed`` are over ground, ``speed``
    never negative. ``heading`` is where the body points (dual antenna or compass), ``height`` is above the ellipsoid.
    ``utc`` is POSIX time, None until the stream has told its date.
    """

    t: float
    arrival: float
    latitude_deg: float
    longitude_deg: float
    quality: FixQuality
    utc: float | None = None
    cell: tuple[float, float] | None = None
    altitude: float | None = None
    geoid_separation: float | None = None
    satellites: int | None = None
    hdop: float | None = None
    sigma: tuple[float, float] | None = None
    speed: float | None = None
    course: float | None = None
    heading: float | None = None
    roll: float | None = None
    pitch: float | None = None
    yaw_rate: float | None = None
    correction_age: float | None = None
    second_antenna_deg: tuple[float, float] | None = None
    implement_down: bool | None = None

    @property
    def height(self) -> float | None:
        """Above the ellipsoid; None when altitude or geoid separation is unknown."""
        if self.altitude is None or self.geoid_separation is None:
            return None
        return self.altitude + self.geoid_separation


@made_quickly
@dataclass(frozen=True, slots=True)
class Attitude:
    """One reading of an attitude sensor. ``t`` is the sensor's own UTC second of the day where it gives one."""

    arrival: float
    t: float | None = None
    heading: float | None = None
    roll: float | None = None
    pitch: float | None = None
    roll_rate: float | None = None
    pitch_rate: float | None = None
    yaw_rate: float | None = None
    link: str = RECEIVER


@dataclass(frozen=True, slots=True)
class Satellite:
    """A satellite in view. ``system`` is the talker's two letters (GP, GL, GA, GB, GQ), ``number`` the receiver's own.

    ``azimuth`` is clockwise from true north, ``elevation`` above the horizon; ``signal`` in dB-Hz, None when the
    receiver does not track it.
    """

    system: str
    number: int
    elevation: float | None = None
    azimuth: float | None = None
    signal: float | None = None


@dataclass(frozen=True, slots=True)
class NoFix:
    """An epoch in which the receiver said that it has no position."""

    arrival: float
    t: float | None
    reason: str


@dataclass(frozen=True, slots=True)
class Rejected:
    """A line or an epoch that was not believed, and why. ``reason`` is one of few phrases, to be counted."""

    arrival: float
    line: str
    reason: str


Observation = Fix | Attitude | NoFix | Rejected
