"""Readers of the sentences that a satellite receiver sends of itself: position, motion, time, accuracy, satellites.

Each takes the fields and gives a ``Sentence``, or raises ``DecodeError``. NMEA 0183 version 4.11 names the fields.
"""

from guidance_app.decode.fields import KNOT, Fields, days_since_1970
from guidance_app.decode.sentence import DecodeError, InView, Sentence
from guidance_app.model import FixQuality, Satellite

__all__ = ["read_gga", "read_gll", "read_gns", "read_gsa", "read_gst", "read_gsv", "read_rmc", "read_vtg", "read_zda"]

KMH = 1.0 / 3.6
"""One kilometre an hour in metres a second."""

MAX_SPEED = 2000.0
"""In the sentence's own unit: more is not a number that a receiver on the ground has measured."""

QUALITY_OF_DIGIT = {str(int(quality)): quality for quality in FixQuality} | {"9": FixQuality.DGPS}
"""GGA field 6. NovAtel's 9 is a position corrected by SBAS (OEM7 manual, GPGGA)."""

QUALITY_OF_MODE = {
    "N": FixQuality.NONE,
    "S": FixQuality.SIMULATED,
    "M": FixQuality.MANUAL,
    "E": FixQuality.DEAD_RECKONING,
    "A": FixQuality.AUTONOMOUS,
    "D": FixQuality.DGPS,
    "P": FixQuality.PPS,
    "F": FixQuality.RTK_FLOAT,
    "R": FixQuality.RTK_FIXED,
}
"""Mode indicator of RMC, GLL, VTG and GNS, worst first: GNS has a letter a constellation and the best one counts."""

_RANK_OF_MODE = {letter: rank for rank, letter in enumerate(QUALITY_OF_MODE)}


def read_gga(fields: Fields) -> Sentence:
    """Position, quality, satellites, HDOP, altitude. An empty quality stays None: somebody else must vouch for it."""
    return _fix(fields, quality_of_digit(fields, "gps_qual"), "horizontal_dil")


def read_gns(fields: Fields) -> Sentence:
    """As GGA, with one mode letter for each constellation."""
    letters = fields.text("mode_indicator")
    if any(letter not in _RANK_OF_MODE for letter in letters):
        raise DecodeError(f"bad field in {fields.kind}")
    return _fix(fields, QUALITY_OF_MODE[max(letters, key=_RANK_OF_MODE.__getitem__)] if letters else None, "hdop")


def _fix(fields: Fields, quality: FixQuality | None, hdop: str) -> Sentence:
    position = fields.position()
    return Sentence(
        kind=fields.kind,
        time=fields.time("timestamp"),
        valid=None if quality is None else quality is not FixQuality.NONE,
        latitude_deg=position and position[0],
        longitude_deg=position and position[1],
        cell=position and position[2],
        quality=quality,
        satellites=fields.count("num_sats"),
        hdop=fields.between(hdop, 0.0, 9999.99),
        altitude=fields.number("altitude"),
        geoid_separation=fields.number("geo_sep"),
        correction_age=fields.between("age_gps_data", 0.0, 1e6),
    )


def read_rmc(fields: Fields) -> Sentence:
    """Position, speed, course, date and declination. Field 2 alone says whether it is valid.

    The navigational status in field 13 is V on receivers that do not supply one (u-blox), on good sentences too.
    """
    position = fields.position()
    quality = _quality_of_mode(fields, "mode_indicator")
    valid = _status(fields)
    return Sentence(
        kind=fields.kind,
        time=fields.time("timestamp"),
        date=fields.date("datestamp"),
        valid=valid and quality is not FixQuality.NONE,
        latitude_deg=position and position[0],
        longitude_deg=position and position[1],
        cell=position and position[2],
        quality=quality,
        speed=_scaled(fields, "spd_over_grnd", KNOT) if valid else None,
        course=fields.direction("true_course") if valid else None,
        declination=fields.signed_angle("mag_variation", "mag_var_dir"),
    )


def read_gll(fields: Fields) -> Sentence:
    """Position and its time. The oldest form has neither time nor status."""
    position = fields.position()
    quality = _quality_of_mode(fields, "faa_mode")
    valid = _status(fields) if fields.has("status") else None
    return Sentence(
        kind=fields.kind,
        time=fields.time("timestamp"),
        valid=valid if valid is None else valid and quality is not FixQuality.NONE,
        latitude_deg=position and position[0],
        longitude_deg=position and position[1],
        cell=position and position[2],
        quality=quality,
    )


def read_vtg(fields: Fields) -> Sentence:
    """Course and speed; in knots, or from km/h where the knots are missing."""
    if fields.text("true_track_sym") not in ("", "T"):
        raise DecodeError(f"bad field in {fields.kind}")
    valid = _quality_of_mode(fields, "faa_mode") is not FixQuality.NONE
    knots = _scaled(fields, "spd_over_grnd_kts", KNOT)
    kmh = _scaled(fields, "spd_over_grnd_kmph", KMH)
    course = fields.direction("true_track")
    if not valid:
        return Sentence(kind=fields.kind, valid=False)
    return Sentence(kind=fields.kind, speed=kmh if knots is None else knots, course=course)


def read_gst(fields: Fields) -> Sentence:
    """The receiver's own estimate of its error, north and east."""
    north = fields.between("std_dev_latitude", 0.0, 1e6)
    east = fields.between("std_dev_longitude", 0.0, 1e6)
    sigma = None if north is None or east is None else (north, east)
    return Sentence(kind=fields.kind, time=fields.time("timestamp"), sigma=sigma)


def read_gsa(fields: Fields) -> Sentence:
    """HDOP; whether there is a fix at all."""
    fix_type = fields.letter("mode_fix_type", "123")
    return Sentence(
        kind=fields.kind,
        valid=None if fix_type is None else fix_type != "1",
        hdop=fields.between("hdop", 0.0, 9999.99),
    )


def read_gsv(fields: Fields) -> Sentence:
    """Satellites in view, four a sentence at most: number, elevation, azimuth, signal. Nothing that a fix is made of.

    Since version 4.10 the last field, alone behind the fours, is the signal's identifier.
    """
    count, number = fields.count("num_messages"), fields.count("msg_num")
    fields.count("num_sv_in_view")
    fours = fields.behind("num_sv_in_view")
    signal = fours[-1].text("a") if fours and not fours[-1].has("b") else ""
    satellites = tuple(_satellite(four, fields.talker) for four in fours if four.has("b") and four.text("a"))
    if count is None or number is None:
        return Sentence(kind=fields.kind)
    return Sentence(kind=fields.kind, in_view=InView(fields.talker, signal, number, count, satellites))


def _satellite(four: Fields, system: str) -> Satellite:
    number = four.count("a")
    assert number is not None
    return Satellite(
        system,
        number,
        elevation=four.angle("b", -90.0, 90.0),
        azimuth=four.direction("c") if four.has("c") else None,
        signal=four.between("d", 0.0, 99.0) if four.has("d") else None,
    )


def read_zda(fields: Fields) -> Sentence:
    """Time and date."""
    day, month, year = fields.count("day"), fields.count("month"), fields.count("year")
    date = None
    if day is not None and month is not None and year is not None:
        date = days_since_1970(year, month, day, fields.kind)
    return Sentence(kind=fields.kind, time=fields.time("timestamp"), date=date)


def quality_of_digit(fields: Fields, name: str) -> FixQuality | None:
    """The fix quality of GGA's field 6 and of the sentences that copy it."""
    text = fields.text(name)
    if not text:
        return None
    quality = QUALITY_OF_DIGIT.get(text)
    if quality is None:
        raise DecodeError(f"bad field in {fields.kind}")
    return quality


def _quality_of_mode(fields: Fields, name: str) -> FixQuality | None:
    letter = fields.letter(name, "NSMEADPFR")
    return None if letter is None else QUALITY_OF_MODE[letter]


def _status(fields: Fields) -> bool:
    return fields.letter("status", "AV") == "A"


def _scaled(fields: Fields, name: str, unit: float) -> float | None:
    value = fields.between(name, 0.0, MAX_SPEED)
    return None if value is None else value * unit
