"""A line of text -> ``Sentence``, strictly. The table ``SENTENCES`` says which sentences are known.

pynmea2 says which field is where; nothing else of it is used and nothing of it leaves this file. Its own ``parse``
forgives too much to steer by: a position without a fix reads as 0, 0; a wrong HDOP comes back as text; a hemisphere
``X`` gives 0; a missing checksum passes. So the line is checked and cut here, and each field is read again from its
text by one function a sentence (``gnss.py``, ``attitude.py``, ``combined.py``).

A new sentence is one function there and one line here. THS, TRA, HPR, PANDA, PAOGI and PGATT, which pynmea2 does not
know, are declared to it; KSXT and ``#UNIHEADINGA`` are not of its form and have layouts of their own.
"""

import re
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import pynmea2

from guidance_app.decode import attitude, combined, gnss
from guidance_app.decode.fields import Fields
from guidance_app.decode.sentence import DecodeError, Sentence

__all__ = ["SENTENCES", "has_checksum", "read_line", "xor_of"]


class THS(pynmea2.TalkerSentence):  # type: ignore[misc]  # pynmea2 is untyped
    """Heading, true, with its mode."""

    fields = (("Heading", "heading"), ("Mode", "mode"))


class TRA(pynmea2.TalkerSentence):  # type: ignore[misc]  # pynmea2 is untyped
    """Heading, pitch and roll of two antennas."""

    fields = (
        ("Timestamp", "timestamp"),
        ("Heading", "heading"),
        ("Pitch", "pitch"),
        ("Roll", "roll"),
        ("Quality", "quality"),
    )


class HPR(pynmea2.TalkerSentence):  # type: ignore[misc]  # pynmea2 is untyped
    """Heading, pitch and roll of two antennas."""

    fields = TRA.fields


class PANDA(pynmea2.ProprietarySentence):  # type: ignore[misc]  # pynmea2 is untyped
    """Position and an inertial sensor."""

    fields = (
        ("Timestamp", "timestamp"),
        ("Latitude", "lat"),
        ("Latitude Direction", "lat_dir"),
        ("Longitude", "lon"),
        ("Longitude Direction", "lon_dir"),
        ("Quality", "gps_qual"),
        ("Satellites in use", "num_sats"),
        ("Horizontal Dilution of Precision", "horizontal_dil"),
        ("Altitude", "altitude"),
        ("Age of corrections", "age_gps_data"),
        ("Speed, knots", "spd_over_grnd"),
        ("Heading", "heading"),
        ("Roll", "roll"),
        ("Pitch", "pitch"),
        ("Yaw rate", "yaw_rate"),
    )


class PAOGI(pynmea2.ProprietarySentence):  # type: ignore[misc]  # pynmea2 is untyped
    """Position and a dual antenna."""

    fields = PANDA.fields


class PGATT(pynmea2.ProprietarySentence):  # type: ignore[misc]  # pynmea2 is untyped
    """A home-made attitude sensor."""

    fields = (
        ("Timestamp", "timestamp"),
        ("Roll", "roll"),
        ("Pitch", "pitch"),
        ("Heading", "heading"),
        ("Roll rate", "roll_rate"),
        ("Pitch rate", "pitch_rate"),
        ("Yaw rate", "yaw_rate"),
    )


@dataclass(frozen=True, slots=True)
class Reader:
    """How one sentence is read: the function, which field is where, and how many there must be at least."""

    read: Callable[[Fields], Sentence]
    index: Mapping[str, int]
    least: int


def _talker(read: Callable[[Fields], Sentence], formatter: str, least: int) -> Reader:
    return Reader(read, pynmea2.TalkerSentence.sentence_types[formatter].name_to_idx, least)


def _proprietary(
    read: Callable[[Fields], Sentence],
    layout: type[pynmea2.ProprietarySentence],
    least: int,
    renamed: Mapping[str, str] | None = None,
    shift: int = 0,
) -> Reader:
    """``renamed`` gives our names to fields of pynmea2; ``shift`` is how many texts it counts before ours."""
    index = {name: place - shift for name, place in layout.name_to_idx.items() if place >= shift}
    index |= {ours: index[theirs] for theirs, ours in (renamed or {}).items()}
    return Reader(read, index, least)


_PROPRIETARY = pynmea2.types.proprietary

SENTENCES: Mapping[str, Reader] = {
    "GGA": _talker(gnss.read_gga, "GGA", 14),
    "RMC": _talker(gnss.read_rmc, "RMC", 11),
    "VTG": _talker(gnss.read_vtg, "VTG", 8),
    "GLL": _talker(gnss.read_gll, "GLL", 4),
    "GNS": _talker(gnss.read_gns, "GNS", 12),
    "GSA": _talker(gnss.read_gsa, "GSA", 17),
    "GSV": _talker(gnss.read_gsv, "GSV", 3),
    "GST": _talker(gnss.read_gst, "GST", 8),
    "ZDA": _talker(gnss.read_zda, "ZDA", 4),
    "HDT": _talker(attitude.read_hdt, "HDT", 2),
    "HDG": _talker(attitude.read_hdg, "HDG", 5),
    "HDM": _talker(attitude.read_hdm, "HDM", 2),
    "ROT": _talker(attitude.read_rot, "ROT", 2),
    "THS": _talker(attitude.read_ths, "THS", 2),
    "TRA": _talker(attitude.read_tra, "TRA", 5),
    "HPR": _talker(attitude.read_hpr, "HPR", 5),
    "PASHR": _proprietary(attitude.read_pashr, _PROPRIETARY.ash.ASHRATT, 5, {"true_heading": "heading"}, shift=1),
    "PTNL,AVR": _proprietary(
        attitude.read_avr,
        _PROPRIETARY.tnl.TNLAVR,
        9,
        {"yaw_angle": "heading", "tilt_angle": "pitch", "roll_angle": "roll", "gps_quality": "quality"},
        shift=2,
    ),
    "PSXN,20": _proprietary(attitude.read_psxn_quality, _PROPRIETARY.sxn.SXN20, 4, shift=2),
    "PSXN,23": _proprietary(attitude.read_psxn_attitude, _PROPRIETARY.sxn.SXN23, 4, {"head": "heading"}, shift=2),
    "PSXN,24": _proprietary(attitude.read_psxn_rates, _PROPRIETARY.sxn.SXN24, 4, shift=2),
    "PANDA": _proprietary(combined.read_panda, PANDA, 15),
    "PAOGI": _proprietary(combined.read_paogi, PAOGI, 15),
    "PGATT": _proprietary(attitude.read_pgatt, PGATT, 7),
    "KSXT": Reader(combined.read_ksxt, {name: place for place, name in enumerate(combined.KSXT_LAYOUT)}, 13),
}
"""Sentence -> how it is read. Keys are the formatter behind any talker (``GGA``), else the whole name, with its first
field where one name carries several sentences (``PSXN,23``)."""

_UNIHEADING_INDEX = {name: place for place, name in enumerate(attitude.UNIHEADING_LAYOUT)}
_SEVERAL_IN_ONE = ("PTNL", "PSXN")
_match_name = re.compile(r"[A-Z0-9]{4,}").fullmatch
_match_checksum = re.compile(r"[0-9A-Fa-f]{2}|[0-9A-Fa-f]{8}").fullmatch
_match_subtype = re.compile(r"[A-Z]{3}").fullmatch


def has_checksum(line: str) -> bool:
    """Whether the line carries a checksum, right or wrong."""
    return "*" in line


def read_line(line: str) -> Sentence:
    """What a line from ``$`` or ``#`` to its end says. Raises ``DecodeError`` with the reason.

    A line without a checksum is read all the same: whether that is allowed depends on the stream.
    """
    if not (line.isascii() and line.isprintable()):
        raise DecodeError("unprintable characters")
    body = _checked_body(line)
    if line[0] == "#":
        return _read_uniheading(body)
    texts = body.split(",")
    name = texts[0]
    if _match_name(name) is None:
        raise DecodeError("malformed")
    key, first = _key_of(name, texts)
    reader = SENTENCES.get(key)
    if reader is None:
        raise DecodeError("unknown sentence")
    if len(texts) - first < reader.least:
        raise DecodeError("too short")
    return reader.read(Fields(key, reader.index, texts[first:], name[:2]))


def xor_of(body: str) -> int:
    """The NMEA checksum: exclusive or of all between ``$`` and ``*``."""
    folded = int.from_bytes(body.encode("ascii"))
    half = 4 << len(body).bit_length()
    while half >= 8:
        folded ^= folded >> half
        half >>= 1
    return folded & 0xFF


def _checked_body(line: str) -> str:
    """What stands between the line's first character and its checksum, which must be right where there is one."""
    body, star, checksum = line[1:].partition("*")
    if not star:
        return body
    checksum = checksum.rstrip(" ")
    if _match_checksum(checksum) is None:
        raise DecodeError("malformed")
    right = xor_of(body) if len(checksum) == 2 else _crc32(body)
    if right != int(checksum, 16):
        raise DecodeError("checksum wrong")
    return body


def _crc32(body: str) -> int:
    """The 32-bit checksum of NovAtel and Unicore: the usual polynomial, begun with 0 and not inverted at the end."""
    return zlib.crc32(body.encode("ascii"), 0xFFFFFFFF) ^ 0xFFFFFFFF


def _key_of(name: str, texts: Sequence[str]) -> tuple[str, int]:
    """The key in ``SENTENCES`` and how many texts in front belong to it."""
    if name[0] == "P":
        if name in _SEVERAL_IN_ONE and len(texts) > 1:
            return f"{name},{texts[1]}", 2
        if name == "PASHR" and len(texts) > 1 and _match_subtype(texts[1]):
            return f"{name},{texts[1]}", 2
        return name, 1
    return (name[2:], 1) if len(name) == 5 else (name, 1)


def _read_uniheading(body: str) -> Sentence:
    header, semicolon, rest = body.partition(";")
    texts = header.split(",")
    if texts[0] != "UNIHEADINGA":
        raise DecodeError("unknown sentence")
    values = rest.split(",")
    if not semicolon or len(values) < len(attitude.UNIHEADING_LAYOUT):
        raise DecodeError("too short")
    return attitude.read_uniheading(Fields("UNIHEADINGA", _UNIHEADING_INDEX, values), texts)
