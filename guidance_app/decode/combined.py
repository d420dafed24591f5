"""Readers of the sentences that hold everything at once: PANDA and PAOGI of the home-made boards, KSXT of Unicore."""

import re
from collections.abc import Sequence
from math import radians

from guidance_app.decode.fields import KNOT, Fields, days_since_1970, second_of_day
from guidance_app.decode.gnss import KMH, MAX_SPEED, quality_of_digit
from guidance_app.decode.sentence import DecodeError, Sentence
from guidance_app.geodesy import grid_cell
from guidance_app.model import FixQuality

__all__ = ["KSXT_LAYOUT", "read_ksxt", "read_panda", "read_paogi"]

NO_IMU = 65535
"""What PANDA's heading says when the board has found no inertial sensor."""

MINUTES_PER_DEGREE = 60.0

KSXT_LAYOUT: Sequence[str] = (
    "timestamp", "lon", "lat", "height", "heading", "pitch", "course", "speed", "roll", "position_quality",
    "heading_quality", "heading_satellites", "num_sats",
)  # fmt: skip
"""The fields of ``$KSXT`` that are read here; vectors to the base station follow."""

QUALITY_OF_KSXT = {
    "0": FixQuality.NONE,
    "1": FixQuality.AUTONOMOUS,
    "2": FixQuality.RTK_FLOAT,
    "3": FixQuality.RTK_FIXED,
}

_match_degrees = re.compile(r"-?([0-9]{1,3})\.([0-9]+)").fullmatch


def read_panda(fields: Fields) -> Sentence:
    """Position, speed in knots, and an inertial sensor's heading, roll and pitch in whole tenths of a degree.

    The sensors that these boards carry measure heading from an arbitrary zero, so it is not a heading for us: it is
    kept as ``imu_heading``. The scale of PANDA's yaw rate differs between boards and it is not read.
    """
    heading = fields.between("heading", -1800.0, NO_IMU)
    has_imu = heading is not None and heading != NO_IMU
    return _board(
        fields,
        imu_heading=radians(heading / 10.0 % 360.0) if has_imu and heading is not None else None,
        roll=_tenths(fields, "roll") if has_imu else None,
        pitch=_tenths(fields, "pitch") if has_imu else None,
    )


def read_paogi(fields: Fields) -> Sentence:
    """Position, speed in knots, and a dual antenna's heading, roll, pitch and yaw rate in degrees."""
    heading = fields.between("heading", -180.0, NO_IMU)
    return _board(
        fields,
        heading=None if heading is None or heading > 360.0 else radians(heading % 360.0),
        roll=fields.angle("roll", -180.0, 180.0),
        pitch=fields.angle("pitch", -90.0, 90.0),
        yaw_rate=fields.angle("yaw_rate", -1000.0, 1000.0),
    )


def read_ksxt(fields: Fields) -> Sentence:
    """Position in degrees, heading and pitch of two antennas, course, speed in km/h.

    Unicore's manuals disagree whether its height is above the sea or the ellipsoid, so it is not read.
    """
    date, time = _date_and_time(fields)
    quality = QUALITY_OF_KSXT.get(fields.text("position_quality"))
    if quality is None:
        raise DecodeError("bad field in KSXT")
    valid = quality is not FixQuality.NONE
    position = _position_in_degrees(fields)
    has_heading = fields.letter("heading_quality", "0123") not in (None, "0")
    speed = fields.between("speed", 0.0, MAX_SPEED)
    heading, pitch = fields.direction("heading"), fields.angle("pitch", -90.0, 90.0)
    course, roll = fields.direction("course"), fields.angle("roll", -180.0, 180.0)
    return Sentence(
        kind=fields.kind,
        time=time,
        date=date,
        valid=valid,
        latitude_deg=position and position[0],
        longitude_deg=position and position[1],
        cell=position and position[2],
        quality=quality,
        satellites=fields.count("num_sats"),
        speed=speed * KMH if speed is not None and valid else None,
        course=course if valid else None,
        heading=heading if has_heading else None,
        pitch=pitch if has_heading else None,
        roll=roll,
    )


def _board(
    fields: Fields,
    *,
    roll: float | None,
    pitch: float | None,
    heading: float | None = None,
    imu_heading: float | None = None,
    yaw_rate: float | None = None,
) -> Sentence:
    position = fields.position()
    quality = quality_of_digit(fields, "gps_qual")
    knots = fields.between("spd_over_grnd", 0.0, MAX_SPEED)
    return Sentence(
        kind=fields.kind,
        time=fields.time("timestamp"),
        valid=None if quality is None else quality is not FixQuality.NONE,
        latitude_deg=position and position[0],
        longitude_deg=position and position[1],
        cell=position and position[2],
        quality=quality,
        satellites=fields.count("num_sats"),
        hdop=fields.between("horizontal_dil", 0.0, 9999.99),
        altitude=fields.number("altitude"),
        correction_age=fields.between("age_gps_data", 0.0, 1e6),
        speed=None if knots is None else knots * KNOT,
        heading=heading,
        imu_heading=imu_heading,
        roll=roll,
        pitch=pitch,
        yaw_rate=yaw_rate,
    )


def _tenths(fields: Fields, name: str) -> float | None:
    value = fields.between(name, -1800.0, 1800.0)
    return None if value is None else radians(value / 10.0)


def _date_and_time(fields: Fields) -> tuple[int | None, float | None]:
    """Days since 1970 and second of the day, from ``yyyymmddhhmmss.ss``."""
    text = fields.text("timestamp")
    if not text:
        return None, None
    if not text[:8].isdecimal() or len(text) < 14:
        raise DecodeError("bad field in KSXT")
    date = days_since_1970(int(text[:4]), int(text[4:6]), int(text[6:8]), "KSXT")
    return date, second_of_day(text[8:], "KSXT")


def _position_in_degrees(fields: Fields) -> tuple[float, float, tuple[float, float]] | None:
    latitude, longitude = fields.text("lat"), fields.text("lon")
    if not (latitude or longitude):
        return None
    north, east = _match_degrees(latitude), _match_degrees(longitude)
    if north is None or east is None or not (abs(float(latitude)) <= 90.0 and abs(float(longitude)) <= 180.0):
        raise DecodeError("bad field in KSXT")
    cell = (
        grid_cell(float(latitude), len(north[2]))[0] * MINUTES_PER_DEGREE,
        grid_cell(float(latitude), len(east[2]))[1] * MINUTES_PER_DEGREE,
    )
    return float(latitude), float(longitude), cell
