"""A drive somewhere else on earth, so that it can be given away without saying where it was.

Everything moves east by whole degrees of longitude and keeps its latitude: the earth is round that way, so lengths,
angles and areas stay what they were, and the digits behind the degree are the receiver's own. In sentences that are
understood the longitude is changed and the checksum made right again. In all other bytes (unknown or damaged
sentences, comments, binary frames) a position could hide, so their digits become 0 and what is no text is blanked.

What this is not: a secret. Latitude, time and the shape of the field stay, and names are kept.
"""

import bisect
import re
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from decimal import Decimal, InvalidOperation
from functools import reduce
from itertools import accumulate
from operator import xor
from typing import Any, TypeVar

from guidance_app.decode.nmea import SENTENCES, read_line
from guidance_app.decode.sentence import DecodeError
from guidance_app.documents import FieldDocument, Job, Operation
from guidance_app.model import Chunk, Command, Commanded, Event

__all__ = ["MovedEvents", "longitudes_of", "moved_events", "moved_job", "possible_moves"]

LEAST_MOVE = 10
HALF_CIRCLE = 180
MINUTES = 60
LONGITUDE = "longitude_deg"
PLACES = frozenset({"coordinates", "entrance", "origin", "edge_at", "passable"})
"""Members of documents that hold positions."""

D = TypeVar("D", FieldDocument, Operation)

_find_sentences = re.compile(rb"[$#][^\r\n$]*").finditer
_digits = bytes.maketrans(b"123456789", b"000000000")
_to_blank = bytes(
    byte if 32 <= byte < 127 or byte in b"\r\n\t" else 0x80 for byte in bytes(range(256)).translate(_digits)
)
_match_place = re.compile(r"(\d{1,3})(\d\d(?:\.\d*)?)").fullmatch


@dataclass(frozen=True, slots=True)
class MovedEvents:
    """The events elsewhere; ``blanked`` counts the sentences that were not understood and lost their digits."""

    events: tuple[Event, ...]
    blanked: int


def possible_moves(job: Job) -> tuple[int, ...]:
    """The whole degrees that a drive can be moved by, so that its field stays clear of the date line."""
    longitudes = longitudes_of(job) or (0.0,)
    low, high = min(longitudes), max(longitudes)
    limit = HALF_CIRCLE - 1
    moves = range(-2 * HALF_CIRCLE, 2 * HALF_CIRCLE)
    return tuple(one for one in moves if abs(one) >= LEAST_MOVE and -limit < low + one and high + one < limit)


def longitudes_of(job: Job) -> tuple[float, ...]:
    """Of the field's corners."""
    if job.field is None:
        return ()
    return tuple(point[0] for ring in job.field.boundary.coordinates for point in ring)


def moved_job(job: Job, degrees: int) -> Job:
    """The documents with their field moved, and what an operation says of places on it."""
    if job.field is None:
        return job
    changes: dict[str, Any] = {"field": _moved_document(job.field, degrees)}
    if job.operation is not None:
        changes["operation"] = _moved_document(job.operation, degrees)
    return job.model_copy(update=changes)


def moved_events(events: Iterable[Event], degrees: int) -> MovedEvents:
    """Every event with its places moved."""
    held = list(events)
    links: dict[str, list[tuple[int, Chunk]]] = {}
    for place, event in enumerate(held):
        match event:
            case Chunk():
                links.setdefault(event.link, []).append((place, event))
            case Commanded():
                held[place] = replace(event, command=_moved_command(event.command, degrees))
    blanked = 0
    for chunks in links.values():
        parts, lost = _moved_stream([chunk.data for _, chunk in chunks], degrees)
        blanked += lost
        for (place, chunk), data in zip(chunks, parts, strict=True):
            held[place] = replace(chunk, data=data)
    return MovedEvents(tuple(held), blanked)


# --- documents and commands ------------------------------------------------------------------------------------------


def _moved_document(document: D, degrees: int) -> D:
    return type(document).model_validate(_moved_members(document.model_dump(mode="json"), degrees))


def _moved_members(members: Any, degrees: int) -> Any:
    """JSON members with every position moved: GeoJSON coordinates, and whatever is called a longitude."""
    if isinstance(members, dict):
        return {name: _moved_member(name, value, degrees) for name, value in members.items()}
    if isinstance(members, list):
        return [_moved_members(one, degrees) for one in members]
    return members


def _moved_member(name: str, value: Any, degrees: int) -> Any:
    if name in PLACES:
        return _moved_places(value, degrees)
    if name == LONGITUDE and isinstance(value, (int, float)):
        return _moved_degrees(value, degrees)
    return _moved_members(value, degrees)


def _moved_places(places: Any, degrees: int) -> Any:
    """Positions at any depth of nesting."""
    if not isinstance(places, (list, tuple)):
        return places
    if places and isinstance(places[0], (int, float)):
        return [_moved_degrees(places[0], degrees), *places[1:]]
    return [_moved_places(one, degrees) for one in places]


def _moved_command(command: Command, degrees: int) -> Command:
    for one in fields(command):
        value = getattr(command, one.name)
        if one.name == LONGITUDE and value is not None:
            changes: Mapping[str, Any] = {LONGITUDE: _moved_degrees(value, degrees)}
            return replace(command, **changes)
    return command


def _moved_degrees(longitude: float, degrees: int) -> float:
    """By the digits, so that nothing is rounded but once."""
    return float(_wrapped(Decimal(repr(longitude)) + degrees, HALF_CIRCLE))


# --- the receiver's bytes --------------------------------------------------------------------------------------------


def _moved_stream(parts: list[bytes], degrees: int) -> tuple[list[bytes], int]:
    """The bytes of one link, cut where they were cut; a cut inside a sentence stays as far from its beginning."""
    whole = b"".join(parts)
    pieces: list[tuple[int, bytes]] = []
    blanked = end = 0
    for match in _find_sentences(whole):
        between = whole[end : match.start()]
        moved, understood = _moved_sentence(match[0], degrees)
        blanked += not understood
        pieces += [(len(between), between.translate(_to_blank)), (len(match[0]), moved)]
        end = match.end()
    pieces.append((len(whole) - end, whole[end:].translate(_to_blank)))
    cuts = _places_of(accumulate(len(part) for part in parts), pieces)
    result = b"".join(piece for _, piece in pieces)
    return [result[low:high] for low, high in zip([0, *cuts[:-1]], cuts, strict=True)], blanked


def _places_of(cuts: Iterable[int], pieces: list[tuple[int, bytes]]) -> list[int]:
    """Where cuts of the old bytes lie in the new ones; a piece has its old length and its new bytes."""
    old_ends = list(accumulate(length for length, _ in pieces))
    new_ends = list(accumulate(len(piece) for _, piece in pieces))
    found = []
    for cut in cuts:
        number = bisect.bisect_left(old_ends, cut)
        from_end = old_ends[number] - cut
        length, piece = pieces[number]
        inside = len(piece) if from_end == 0 else min(length - from_end, len(piece))
        found.append(new_ends[number] - len(piece) + inside)
    return found


def _moved_sentence(sentence: bytes, degrees: int) -> tuple[bytes, bool]:
    """The sentence elsewhere, and whether it was understood."""
    text = sentence.decode("latin-1")
    try:
        read_line(text.rstrip(" \t"))
        return _with_longitude(text, degrees).encode("latin-1"), True
    except (DecodeError, InvalidOperation):
        return _blanked(sentence), False


def _with_longitude(text: str, degrees: int) -> str:
    body, star, checksum = text[1:].partition("*")
    texts = body.split(",")
    name = texts[0]
    reader = SENTENCES.get(name if name in SENTENCES else name[2:])
    if reader is None or "lon" not in reader.index or text[0] == "#":
        return text
    place = reader.index["lon"] + 1
    side = reader.index.get("lon_dir")
    if not texts[place]:
        return text
    if side is None:
        texts[place] = _moved_plain(texts[place], degrees)
    else:
        texts[place], texts[side + 1] = _moved_minutes(texts[place], texts[side + 1], degrees)
    return _sealed(text[0] + ",".join(texts), star, checksum)


def _moved_minutes(place: str, side: str, degrees: int) -> tuple[str, str]:
    """Degrees and minutes as NMEA writes them, with as many decimals."""
    match = _match_place(place)
    if match is None or side not in {"E", "W"}:
        msg = f"{place},{side} is no longitude"
        raise DecodeError(msg)
    minutes = Decimal(match[1]) * MINUTES + Decimal(match[2])
    whole = _wrapped((minutes if side == "E" else -minutes) + degrees * MINUTES, HALF_CIRCLE * MINUTES)
    full, rest = divmod(abs(whole), MINUTES)
    decimals = len(match[2].partition(".")[2])
    dot = "." if "." in match[2] and not decimals else ""
    width = 3 + decimals if decimals else 2
    return f"{int(full):03d}{rest:0{width}.{decimals}f}{dot}", "E" if whole >= 0 else "W"


def _moved_plain(place: str, degrees: int) -> str:
    return f"{_wrapped(Decimal(place) + degrees, HALF_CIRCLE):f}"


def _wrapped(value: Decimal, half: int) -> Decimal:
    if abs(value) <= half:
        return value
    return value - 2 * half if value > 0 else value + 2 * half


def _blanked(sentence: bytes) -> bytes:
    """Without digits; a checksum that was right is right again, one that was wrong stays wrong."""
    text = sentence.decode("latin-1")
    body, star, checksum = text.partition("*")
    empty = body.encode("latin-1").translate(_to_blank).decode("latin-1")
    if not star:
        return empty.encode("latin-1")
    was_right = checksum.strip().upper() == _checksum_of(body, checksum)
    right = _sealed(empty, star, checksum)
    if was_right:
        return right.encode("latin-1")
    other = "".join("0" if letter.upper() in "123456789ABCDEF" else letter for letter in checksum)
    wrong = f"{empty}*{other}"
    if wrong == right:
        wrong = f"{empty}*{'F' * len(checksum)}"
    return wrong.encode("latin-1").translate(_to_blank)


def _sealed(begun: str, star: str, checksum: str) -> str:
    """The sentence with the checksum that belongs to it, of the same kind; without one where it had none."""
    if not star:
        return begun
    digits = checksum.rstrip(" \t")
    made = _checksum_of(begun, checksum)
    return f"{begun}*{made if digits.upper() == digits else made.lower()}{checksum[len(digits) :]}"


def _checksum_of(begun: str, checksum: str) -> str:
    body = begun[1:].encode("latin-1")
    if len(checksum.strip()) == 8:
        return f"{zlib.crc32(body, 0xFFFFFFFF) ^ 0xFFFFFFFF:08X}"
    return f"{reduce(xor, body, 0):02X}"
