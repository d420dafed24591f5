"""A recorded log: a file of receiver text, plain, gzipped or UTF-16, cut into one chunk an epoch with its own time.

The log's clock starts at 0 with its first epoch. It comes from the first of these that the file has:

1. the UTC time in GGA, RMC, GNS, GST, PANDA, PAOGI and KSXT; else in GLL; else in PASHR, TRA, HPR, PGATT and ZDA;
2. the time that a logger wrote in front of each line: ISO 8601, or POSIX seconds or milliseconds;
3. nothing: then each line stands for one second.

A time that steps back or ahead by more than an hour counts as one interval (the median one), so logs that were cut
together play on without a hole; a step over ten seconds counts only when the sentence that says so is sound. Only
one bytes object and two arrays are kept, 16 bytes an epoch; chunks are cut out when they are asked for.
"""

import gzip
import re
import threading
import zlib
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import overload
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from guidance_app.decode.decoder import Decoder
from guidance_app.decode.framing import MAX_LENGTH, Framer
from guidance_app.decode.nmea import has_checksum, read_line
from guidance_app.decode.sentence import DecodeError
from guidance_app.language import sentence
from guidance_app.model import Chunk, Fix, FloatArray, SourceDown, SourceUp
from guidance_app.sources import SourceError, SourceEvent

__all__ = ["FileLog", "load_log", "open_file"]

MAX_BYTES = 1 << 30
"""An 8-hour log at 10 Hz has about 90 million bytes."""
SEARCHED_BYTES = 64 << 20
"""A file without one sentence in its first so many bytes is no receiver log."""
SEARCH_STEP = 1 << 16

SECONDS_PER_DAY = 86400.0
LONGEST_STEP = 3600.0
SUSPICIOUS_STEP = 10.0
FIRST_INTERVAL = 1.0
MICROSECONDS = 1e6

Bytes = NDArray[np.uint8]
Places = NDArray[np.int64]

_POSITION_TIMES = (b"GGA", b"RMC", b"GNS", b"GST", b"NDA", b"OGI")
"""What stands at the fourth character of a sentence whose first field is the time; the last two are PANDA, PAOGI."""
_OTHER_TIMES = (b"SHR", b"TRA", b"HPR", b"ATT", b"ZDA")
_find_gll_times = re.compile(rb"\$[A-Z0-9]{2}GLL,[0-9.]*,[NS]?,[0-9.]*,[EW]?,(?=[0-9]{6})").finditer
_find_prefixes = re.compile(
    rb"^[\[(]?(?:[0-9]{4}-[0-9]{2}-[0-9]{2}[T ]([0-9]{2}):([0-9]{2}):([0-9]{2}(?:[.,][0-9]+)?)"
    rb"|([0-9]{10})([0-9]{3}|\.[0-9]*)?(?=[\s,;\])]))[^\r\n$]*\$",
    re.MULTILINE,
).finditer
_match_common_name = re.compile(r"\$[A-Z]{2}(?:GGA|RMC|VTG|GLL|GNS|GSA|GSV|HDT|ZDA),").match
_find_lines = re.compile(rb"[^\r\n]*\$[^\r\n]*").finditer


class _Chunks(Sequence[Chunk]):
    """The chunks of a log, cut out of its bytes when they are asked for."""

    def __init__(self, data: bytes, starts: Places, arrivals: FloatArray) -> None:
        self._data = data
        self._starts = starts
        self._arrivals = arrivals

    def __len__(self) -> int:
        return len(self._starts)

    @overload
    def __getitem__(self, index: int) -> Chunk: ...

    @overload
    def __getitem__(self, index: slice) -> list[Chunk]: ...

    def __getitem__(self, index: int | slice) -> Chunk | list[Chunk]:
        if isinstance(index, slice):
            return [self[place] for place in range(*index.indices(len(self)))]
        place = range(len(self))[index]
        start = 0 if place == 0 else int(self._starts[place])
        end = int(self._starts[place + 1]) if place + 1 < len(self) else len(self._data)
        return Chunk(float(self._arrivals[place]), self._data[start:end])


class FileLog:
    """A log in memory. ``chunks`` hold one epoch each, ``duration`` is the last one's arrival in seconds."""

    live = False

    def __init__(self, description: str, data: bytes) -> None:
        starts, arrivals = _timeline(data)
        self.description = description
        self.size = len(data)
        self.chunks: Sequence[Chunk] = _Chunks(data, starts, arrivals)
        self.duration: float = float(arrivals[-1])

    @cached_property
    def has_fix(self) -> bool:
        """Whether the log holds a position at all. Decodes up to the first."""
        decoder = Decoder()
        for chunk in self.chunks:
            if any(isinstance(one, Fix) for one in decoder.feed(chunk)):
                return True
        return any(isinstance(one, Fix) for one in decoder.finish(self.duration))

    def events(self, stop: threading.Event) -> Iterator[SourceEvent]:
        """The whole log, not paced."""
        yield SourceUp(0.0, self.description)
        for chunk in self.chunks:
            if stop.is_set():
                return
            yield chunk
        yield SourceDown(self.duration, sentence("the end of {description}", description=self.description), ended=True)


def load_log(path: Path) -> FileLog:
    """The log in a file. A log without any fix loads too.

    Raises ``SourceError`` for what is missing, a folder, empty, unreadable, damaged, too large or no receiver log.
    """
    data = _text_of(_unpacked(path, _read(path)))
    _refuse_other_files(path, data)
    return FileLog(path.name, data)


def open_file(uri: str) -> FileLog:
    """The log that ``file:run.nmea`` or ``file:///home/me/run.nmea`` names. Raises ``SourceError``."""
    place = uri.partition(":")[2]
    if place.startswith("//"):
        place = unquote(place[2:])
    if not place:
        msg = sentence("file: names no log: write the file's path behind it, as in file:run.nmea.")
        raise SourceError(msg)
    return load_log(Path(place))


def _read(path: Path) -> bytes:
    try:
        if path.is_dir():
            raise SourceError(sentence("{path} is a folder: name the log inside it.", path=path))
        if not path.exists():
            raise SourceError(sentence("There is no file {path}: check the spelling and the folder.", path=path))
        if not path.is_file():
            raise SourceError(sentence("{path} is not an ordinary file: name a recorded log.", path=path))
        if path.stat().st_size > MAX_BYTES:
            raise SourceError(sentence("{path} is larger than 1 GB: cut it into parts of a day.", path=path))
        return path.read_bytes()
    except PermissionError:
        raise SourceError(
            sentence("{path} may not be read: allow it, or copy it to a folder of your own.", path=path)
        ) from None
    except (OSError, ValueError) as error:
        raise SourceError(sentence("{path} cannot be read: {reason}.", path=path, reason=str(error))) from None


def _unpacked(path: Path, data: bytes) -> bytes:
    if not data:
        raise SourceError(sentence("{path} is empty: record it again, or choose another log.", path=path))
    if not data.startswith(b"\x1f\x8b"):
        return data
    try:
        with gzip.open(path) as archive:
            unpacked = archive.read(MAX_BYTES + 1)
    except (OSError, EOFError, zlib.error):
        raise SourceError(
            sentence("{path} is a damaged gzip archive: fetch it again, or unpack what is left of it.", path=path)
        ) from None
    if len(unpacked) > MAX_BYTES:
        raise SourceError(sentence("{path} unpacks to more than 1 GB: cut it into parts of a day.", path=path))
    if not unpacked:
        raise SourceError(sentence("{path} is an empty archive: record it again, or choose another log.", path=path))
    return unpacked


def _text_of(data: bytes) -> bytes:
    """One byte a character, from UTF-16 with or without its mark; other bytes as they are."""
    head = data[:400]
    if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
        encoding = "utf-16"
    elif head[1::2].count(0) > 0.9 * len(head[1::2]) > 0:
        encoding = "utf-16-le"
    elif head[::2].count(0) > 0.9 * len(head[::2]):
        encoding = "utf-16-be"
    else:
        return data
    return data.decode(encoding, errors="replace").encode("latin-1", errors="replace")


def _refuse_other_files(path: Path, data: bytes) -> None:
    """Raises unless one sound sentence is found near the beginning."""
    framer = Framer()
    damaged = 0
    for start in range(0, min(len(data), SEARCHED_BYTES), SEARCH_STEP):
        step = data[start : start + SEARCH_STEP]
        lines = framer.feed(step)
        if start + SEARCH_STEP >= len(data):
            lines += framer.finish()
        for line in lines:
            if _is_sound(line):
                return
            damaged += _match_common_name(line) is not None
    if damaged:
        raise SourceError(
            sentence(
                "{path} is a receiver's log in which not one sentence is whole: it was damaged on the way; "
                "copy it again.",
                path=path,
            )
        )
    raise SourceError(
        sentence(
            "{path} is not a receiver's log: it holds no NMEA sentence ($GPGGA,... and the like); choose "
            "the file that the receiver's output was saved in.",
            path=path,
        )
    )


def _is_sound(line: str) -> bool:
    try:
        read_line(line)
    except DecodeError as error:
        return str(error) == "unknown sentence" and has_checksum(line)
    return True


def _timeline(data: bytes) -> tuple[Places, FloatArray]:
    """Where each epoch starts in the bytes, and when, in seconds since the first."""
    raw = np.frombuffer(data, dtype=np.uint8)
    sources: tuple[Callable[[], tuple[Places, FloatArray]], ...] = (
        lambda: _times_of_positions(raw),
        lambda: _times_of_gll(data, raw),
        lambda: _times_of_sentences(raw, _OTHER_TIMES),
        lambda: _times_of_prefixes(data),
    )
    for source in sources:
        places, seconds = source()
        if len(places):
            places, seconds = _with_cold_start(raw, places, seconds)
            places, seconds = _without_damaged(data, *_changes(places, seconds))
            return _line_starts(raw, places), _arrivals(seconds)
    lines = np.array([match.start() for match in _find_lines(data)], dtype=np.int64)
    return lines, np.arange(len(lines), dtype=np.float64) * FIRST_INTERVAL


def _times_of_positions(raw: Bytes) -> tuple[Places, FloatArray]:
    """Places and seconds of the day of the sentences that make an epoch."""
    places, seconds = _times_of_sentences(raw, _POSITION_TIMES)
    dollars = _dollars(raw)
    combined = dollars[_reads(raw, dollars + 1, b"KSXT,")]
    more, more_seconds = _clocks_at(raw, combined, combined + 14)
    places, seconds = np.concatenate([places, more]), np.concatenate([seconds, more_seconds])
    order = np.argsort(places, kind="stable")
    return places[order], seconds[order]


def _times_of_sentences(raw: Bytes, names: tuple[bytes, ...]) -> tuple[Places, FloatArray]:
    """Places and seconds of the day of the sentences of these names whose first field is a time."""
    dollars = _dollars(raw)
    named = np.zeros(len(dollars), dtype=bool)
    for name in names:
        named |= _reads(raw, dollars + 3, name + b",")
    found = dollars[named]
    return _clocks_at(raw, found, found + 7)


def _with_cold_start(raw: Bytes, places: Places, seconds: FloatArray) -> tuple[Places, FloatArray]:
    """With the times of ZDA before the first epoch: a receiver without a fix may know the time and nothing else."""
    early, early_seconds = _times_of_sentences(raw, (b"ZDA",))
    before = (early < places[0]) & (early_seconds < seconds[0])
    return np.concatenate([early[before], places]), np.concatenate([early_seconds[before], seconds])


def _dollars(raw: Bytes) -> Places:
    """Where sentences begin, those too near the end to hold a time left out."""
    return np.flatnonzero(raw[: max(0, len(raw) - 32)] == ord("$"))


def _reads(raw: Bytes, places: Places, text: bytes) -> NDArray[np.bool_]:
    """Where the bytes at these places are ``text``."""
    same = np.ones(len(places), dtype=bool)
    for offset, letter in enumerate(text):
        same &= raw[places + offset] == letter
    return same


def _clocks_at(raw: Bytes, places: Places, clocks: Places) -> tuple[Places, FloatArray]:
    """The places whose clock ``hhmmss[.ssss]`` is well formed, and its second of the day."""
    digits = np.stack([raw[clocks + offset].astype(np.int64) - ord("0") for offset in range(6)])
    whole = ((digits >= 0) & (digits <= 9)).all(axis=0)
    hours, minutes, seconds = (digits[2 * part] * 10 + digits[2 * part + 1] for part in range(3))
    total: FloatArray = (hours * 3600 + minutes * 60 + seconds).astype(np.float64)
    decimals = raw[clocks + 6] == ord(".")
    for place in range(1, 5):
        digit = raw[clocks + 6 + place].astype(np.int64) - ord("0")
        decimals &= (digit >= 0) & (digit <= 9)
        total += np.where(decimals, digit * 10.0**-place, 0.0)
    whole &= (hours < 24) & (minutes < 60) & (seconds <= 60)
    return places[whole], total[whole]


def _times_of_gll(data: bytes, raw: Bytes) -> tuple[Places, FloatArray]:
    padded = len(raw) - 12
    matches = [(match.start(), match.end()) for match in _find_gll_times(data) if match.end() < padded]
    pairs = np.array(matches, dtype=np.int64).reshape(-1, 2)
    return _clocks_at(raw, pairs[:, 0], pairs[:, 1])


def _times_of_prefixes(data: bytes) -> tuple[Places, FloatArray]:
    places: list[int] = []
    seconds: list[float] = []
    for match in _find_prefixes(data):
        hours, minutes, second, posix, decimals = match.groups()
        places.append(match.start())
        if posix is None:
            seconds.append(int(hours) * 3600 + int(minutes) * 60 + float(second.replace(b",", b".")))
        else:
            fraction = (
                float(decimals) / (1.0 if decimals[:1] == b"." else 1000.0) if decimals not in (None, b".") else 0
            )
            seconds.append(int(posix) % SECONDS_PER_DAY + fraction)
    return np.array(places, dtype=np.int64), np.array(seconds, dtype=np.float64)


def _changes(places: Places, seconds: FloatArray) -> tuple[Places, FloatArray]:
    """Only where the time differs from the one before."""
    changed = np.ones(len(seconds), dtype=bool)
    changed[1:] = seconds[1:] != seconds[:-1]
    return places[changed], seconds[changed]


def _without_damaged(data: bytes, places: Places, seconds: FloatArray) -> tuple[Places, FloatArray]:
    """Drops epochs that would leap through time because a sentence was damaged."""
    steps = np.diff(seconds)
    leaps = np.flatnonzero((steps <= 0.0) | (steps > SUSPICIOUS_STEP))
    suspects = np.unique(np.concatenate([leaps, leaps + 1]))
    damaged = [index for index in suspects if not _is_sound(_sentence_at(data, int(places[index])))]
    if len(damaged) in (0, len(places)):
        return places, seconds
    return _changes(np.delete(places, damaged), np.delete(seconds, damaged))


def _sentence_at(data: bytes, place: int) -> str:
    start = data.find(b"$", place)
    lines = Framer().feed(data[start : start + MAX_LENGTH] + b"\n") if start >= 0 else []
    return lines[0] if lines else "$"


def _line_starts(raw: Bytes, places: Places) -> Places:
    """The starts of the lines that hold these places, for each place its own."""
    ends = np.flatnonzero((raw == ord("\n")) | (raw == ord("\r")))
    before = np.searchsorted(ends, places) - 1
    starts = np.where(before >= 0, ends[np.maximum(before, 0)] + 1, 0) if len(ends) else np.zeros_like(places)
    twice = np.zeros(len(starts), dtype=bool)
    twice[1:] = starts[1:] == starts[:-1]
    return np.where(twice, places, starts)


def _arrivals(seconds: FloatArray) -> FloatArray:
    """Seconds since the first, in whole microseconds so that no error adds up."""
    steps = np.diff(seconds)
    steps = np.where(steps < -SECONDS_PER_DAY / 2, steps + SECONDS_PER_DAY, steps)
    good = (steps > 0.0) & (steps <= LONGEST_STEP)
    interval = float(np.median(steps[good])) if good.any() else FIRST_INTERVAL
    counted = np.rint(np.where(good, steps, interval) * MICROSECONDS).astype(np.int64)
    arrivals: FloatArray = np.concatenate([[0], np.cumsum(counted)]) / MICROSECONDS
    return arrivals
