"""Readers of what compasses, dual antennas and inertial sensors send: heading, roll, pitch and their rates.

Signs are ours on the way out: roll positive right side down, pitch positive nose up, yaw rate positive clockwise.

For a home-made sensor there is a plain line of our own, at 1 to 100 Hz::

    $PGATT,time,roll,pitch,heading,rollrate,pitchrate,yawrate*hh

``time`` is UTC as ``hhmmss.sss``; angles are in degrees, rates in degrees a second, with the signs above, heading
clockwise from true north; any field may be left empty; ``hh`` is the exclusive or of all between ``$`` and ``*``.
"""

from collections.abc import Sequence
from math import radians

from guidance_app.decode.fields import Fields
from guidance_app.decode.sentence import DecodeError, Sentence

__all__ = [
    "UNIHEADING_LAYOUT",
    "read_avr",
    "read_hdg",
    "read_hdm",
    "read_hdt",
    "read_hpr",
    "read_pashr",
    "read_pgatt",
    "read_psxn_attitude",
    "read_psxn_quality",
    "read_psxn_rates",
    "read_rot",
    "read_ths",
    "read_tra",
    "read_uniheading",
]

SECONDS_PER_DAY = 86400
MAX_RATE = 1000.0
"""Degrees a second: more is not the turning of a machine."""

UNIHEADING_LAYOUT: Sequence[str] = ("status", "type", "length", "heading", "pitch")
"""The fields of ``#UNIHEADINGA`` behind the semicolon that are read here."""


def read_hdt(fields: Fields) -> Sentence:
    """Heading, true."""
    return Sentence(kind=fields.kind, heading=fields.direction("heading"))


def read_hdm(fields: Fields) -> Sentence:
    """Heading, magnetic."""
    return Sentence(kind=fields.kind, magnetic_heading=fields.direction("heading"))


def read_hdg(fields: Fields) -> Sentence:
    """Heading of a magnetic sensor, with its deviation added, and the declination ("variation") where it is known."""
    heading = fields.angle("heading")
    deviation = fields.signed_angle("deviation", "dev_dir")
    return Sentence(
        kind=fields.kind,
        magnetic_heading=None if heading is None else heading + (deviation or 0.0),
        declination=fields.signed_angle("variation", "var_dir"),
    )


def read_rot(fields: Fields) -> Sentence:
    """Yaw rate, from degrees a minute."""
    rate = fields.between("rate_of_turn", -60.0 * MAX_RATE, 60.0 * MAX_RATE)
    valid = fields.letter("status", "AV") == "A"
    return Sentence(
        kind=fields.kind, valid=valid, yaw_rate=radians(rate) / 60.0 if rate is not None and valid else None
    )


def read_ths(fields: Fields) -> Sentence:
    """Heading, true, with a mode letter; V is invalid."""
    heading = fields.direction("heading")
    valid = fields.letter("mode", "AEMSV") != "V"
    return Sentence(kind=fields.kind, valid=valid, heading=heading if valid else None)


def read_tra(fields: Fields) -> Sentence:
    """Heading, pitch and roll of a dual antenna (Unicore TRA and HPR have the same fields)."""
    return _timed_attitude(fields, valid=fields.text("quality") not in ("", "0"))


def read_hpr(fields: Fields) -> Sentence:
    """Heading, pitch and roll of a dual antenna."""
    return _timed_attitude(fields, valid=fields.text("quality") not in ("", "0"))


def read_pashr(fields: Fields) -> Sentence:
    """Attitude of an inertial system. GNSS quality 0 is a system without position, not one without attitude."""
    return _timed_attitude(fields, valid=True)


def read_avr(fields: Fields) -> Sentence:
    """Attitude of a Trimble dual antenna; quality 0 is invalid. Yaw is the heading, tilt the pitch."""
    return _timed_attitude(fields, valid=fields.text("quality") not in ("", "0"))


def read_psxn_quality(fields: Fields) -> Sentence:
    """What the Seapath says of the attitude that follows: 2 is invalid."""
    heading, tilt = fields.letter("head_qual", "012"), fields.letter("rp_qual", "012")
    return Sentence(kind=fields.kind, heading_valid=heading != "2", attitude_valid=tilt != "2")


def read_psxn_attitude(fields: Fields) -> Sentence:
    """Roll (port side up is positive: our sign), pitch and heading of a Seapath."""
    return Sentence(
        kind=fields.kind,
        roll=fields.angle("roll", -180.0, 180.0),
        pitch=fields.angle("pitch", -90.0, 90.0),
        heading=fields.direction("heading"),
    )


def read_psxn_rates(fields: Fields) -> Sentence:
    """Rates of a Seapath, in degrees a second with our signs."""
    return Sentence(
        kind=fields.kind,
        roll_rate=fields.angle("roll_rate", -MAX_RATE, MAX_RATE),
        pitch_rate=fields.angle("pitch_rate", -MAX_RATE, MAX_RATE),
        yaw_rate=fields.angle("yaw_rate", -MAX_RATE, MAX_RATE),
    )


def read_pgatt(fields: Fields) -> Sentence:
    """The plain line for home-made sensors; see the top of this file."""
    return Sentence(
        kind=fields.kind,
        time=fields.time("timestamp"),
        roll=fields.angle("roll", -180.0, 180.0),
        pitch=fields.angle("pitch", -90.0, 90.0),
        heading=fields.direction("heading", -180.0, 360.0),
        roll_rate=fields.angle("roll_rate", -MAX_RATE, MAX_RATE),
        pitch_rate=fields.angle("pitch_rate", -MAX_RATE, MAX_RATE),
        yaw_rate=fields.angle("yaw_rate", -MAX_RATE, MAX_RATE),
    )


def read_uniheading(fields: Fields, header: Sequence[str]) -> Sentence:
    """Heading and pitch of the line between two antennas (Unicore); the header gives GPS time and the leap seconds."""
    valid = fields.text("status") == "SOL_COMPUTED" and fields.text("type") != "NONE"
    heading = fields.direction("heading")
    pitch = fields.angle("pitch", -90.0, 90.0)
    return Sentence(
        kind=fields.kind,
        time=_utc_of_header(header),
        valid=valid,
        heading=heading if valid else None,
        pitch=pitch if valid else None,
    )


def _utc_of_header(header: Sequence[str]) -> float | None:
    """UTC second of the day of a Unicore header; None when its clock is not set."""
    if len(header) < 9 or header[3] not in ("FINE", "FINESTEERING", "COARSE"):
        return None
    milliseconds, leap_seconds = header[5], header[8]
    if not (milliseconds.isdecimal() and leap_seconds.isdecimal()):
        raise DecodeError("bad field in UNIHEADINGA")
    return (int(milliseconds) / 1000.0 - int(leap_seconds)) % SECONDS_PER_DAY


def _timed_attitude(fields: Fields, *, valid: bool) -> Sentence:
    time = fields.time("timestamp")
    heading = fields.direction("heading", -180.0, 360.0)
    roll = fields.angle("roll", -180.0, 180.0)
    pitch = fields.angle("pitch", -90.0, 90.0)
    if not valid:
        return Sentence(kind=fields.kind, time=time, valid=False)
    return Sentence(kind=fields.kind, time=time, heading=heading, roll=roll, pitch=pitch)
