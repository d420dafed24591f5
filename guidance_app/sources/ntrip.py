"""Corrections from a caster (NTRIP 1 and 2), sent on to the receiver over the port that it is read from.

``ntrip://user:password@host:port/MOUNT``. The receiver's own position goes back to the caster as GGA, at once and every
10 s, for those casters that make their corrections for a place; before the receiver has one, nothing is sent. What the
caster gives is passed on unread and never recorded. The password is in no description, error or log.
"""

import base64
import re
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from urllib.parse import quote, unquote, urlsplit

from guidance_app.decode.nmea import xor_of
from guidance_app.language import sentence
from guidance_app.model import CORRECTIONS, RECEIVER, Chunk
from guidance_app.sources import Source, SourceError, SourceEvent
from guidance_app.sources.addresses import SocketConnection, dial
from guidance_app.sources.kept import Kept, LinkError, Pauses

__all__ = [
    "Caster",
    "Corrections",
    "Overheard",
    "Traffic",
    "caster_from_uri",
    "corrected",
    "first_corrections",
    "mount_points",
]

PORT = 2101
GGA_EVERY_S = 10.0
ANSWER_S = 10.0
TRY_S = 10.0
SILENT_S = 60.0
"""A caster that waits for a position sends nothing until it has one."""

PAUSES = Pauses(first=2.0, longest=30.0)
"""Casters shut out those who come too often."""

LONGEST_HEADER = 8192
LONGEST_TABLE = 4_000_000
"""Bytes; the world's largest casters name some thousand streams."""
SHOWN = 80
RULE = (
    "a caster is written as ntrip://user:password@host:2101/MOUNT, with %40 for @ and %3A for : in user and password."
)

_find_streams = re.compile(rb"(?m)^STR;([^;\r\n]{1,100});").findall
_find_gga = re.compile(rb"\$([A-Z]{2})(GGA,[^*\r\n$]{20,100})\*([0-9A-Fa-f]{2})").findall


@dataclass(frozen=True, slots=True)
class Caster:
    """Where corrections come from. Its text form does not hold the password."""

    host: str
    port: int
    mount: str
    user: str = ""
    password: str = field(default="", repr=False)

    @property
    def what(self) -> str:
        """For the driver."""
        return f"{self.mount} of {self.host}"


def caster_from_uri(uri: str, password: str | None = None) -> Caster:
    """The caster that ``ntrip://user:password@host:port/MOUNT`` names; ``password`` stands in for a missing one.

    Raises ``SourceError``, whose text does not repeat the address: it may hold a password.
    """
    try:
        parts = urlsplit(uri)
        port = parts.port or PORT
    except ValueError:
        raise SourceError(f"The caster's address is not understood: {RULE}") from None
    mount = unquote(parts.path.strip("/"))
    if parts.scheme.lower() != "ntrip" or not parts.hostname:
        raise SourceError(f"The caster's address is not understood: {RULE}")
    if not mount or "/" in mount or parts.query or parts.fragment or not mount.isprintable():
        raise SourceError(f"The caster's address names no mount point: {RULE}")
    secret = unquote(parts.password) if parts.password is not None else password or ""
    return Caster(parts.hostname, port, mount, unquote(parts.username or ""), secret)


class Traffic:
    """How many bytes of corrections have come, and when the newest did (monotonic seconds). Any thread may read it."""

    def __init__(self) -> None:
        self.received = 0
        self.newest: float | None = None

    def note(self, count: int) -> None:
        """So many more, now."""
        self.received += count
        self.newest = time.monotonic()


class Corrections:
    """A source that gives no bytes to decode: it says whether the caster is there, and hands on what it sends."""

    live = True
    duration: float | None = None

    def __init__(
        self,
        caster: Caster,
        send: Callable[[bytes], bool],
        pauses: Pauses = PAUSES,
        gga_every_s: float = GGA_EVERY_S,
        traffic: Traffic | None = None,
    ) -> None:
        self.description = caster.what
        self._caster = caster
        self._send = send
        self._gga_every_s = gga_every_s
        self._traffic = traffic or Traffic()
        self._position = b""
        self._rest = b""
        self._kept = Kept(caster.what, self.connect, pauses, CORRECTIONS)

    def hear(self, data: bytes) -> None:
        """Bytes of the receiver, on its own thread: the newest whole GGA with a position is kept."""
        seen = self._rest + data
        for talker, body, checksum in reversed(_find_gga(seen)):
            position = _gga_of(talker, body, checksum)
            if position:
                self._position = position
                break
        self._rest = seen[-128:]

    @property
    def position(self) -> bytes:
        """The receiver's newest GGA, as casters want it; empty before there is one."""
        return self._position

    def events(self, stop: threading.Event) -> Iterator[SourceEvent]:
        """``SourceUp`` when the caster gives corrections, ``SourceDown`` when it does not, until ``stop`` is set."""
        yield from self._kept.events(stop)

    def connect(self, stop: threading.Event) -> "_Stream":
        """The caster's stream, when it has accepted the request. Raises ``LinkError``."""
        caster = self._caster
        connection = SocketConnection(dial(caster.host, caster.port, stop), caster.what, SILENT_S)
        try:
            connection.write(_request(caster, self._position))
            return _Stream(connection, self, _answer(connection, caster, stop))
        except BaseException:
            connection.close()
            raise

    def pass_on(self, data: bytes) -> None:
        """Sends corrections to the receiver; while its port is closed they are lost, like those of that time."""
        self._traffic.note(len(data))
        self._send(data)

    @property
    def gga_every_s(self) -> float:
        """Seconds between two positions sent back."""
        return self._gga_every_s


def _gga_of(talker: bytes, body: bytes, checksum: bytes) -> bytes:
    """The sentence as a GPS talker's, which every caster knows; nothing when it is damaged or has no position."""
    fields = body.split(b",")
    if len(fields) < 11 or fields[6] in (b"", b"0") or not fields[2] or not fields[4]:
        return b""
    said = (talker + body).decode("latin-1")
    if not said.isascii() or xor_of(said) != int(checksum, 16):
        return b""
    text = f"GP{said[2:]}"
    return f"${text}*{xor_of(text):02X}\r\n".encode("ascii")


def _request(caster: Caster, position: bytes) -> bytes:
    host = f"[{caster.host}]" if ":" in caster.host else caster.host
    lines = [
        f"GET /{quote(caster.mount)} HTTP/1.1",
        f"Host: {host}:{caster.port}",
        "Ntrip-Version: Ntrip/2.0",
        "User-Agent: NTRIP guidance-app",
        "Connection: close",
    ]
    if caster.user:
        secret = base64.b64encode(f"{caster.user}:{caster.password}".encode()).decode("ascii")
        lines.append(f"Authorization: Basic {secret}")
    if position:
        lines.append(f"Ntrip-GGA: {position.decode('ascii').strip()}")
    return ("\r\n".join(lines) + "\r\n\r\n").encode("ascii")


@dataclass(frozen=True, slots=True)
class _Answer:
    """What has come behind the answer's header, and whether the rest comes in HTTP's chunks."""

    data: bytes
    chunked: bool


def _answer(connection: SocketConnection, caster: Caster, stop: threading.Event) -> _Answer:
    """Reads the caster's answer. Raises ``LinkError`` when it is a refusal, or no answer at all."""
    seen = b""
    deadline = time.monotonic() + ANSWER_S
    while time.monotonic() < deadline and not stop.is_set() and len(seen) < LONGEST_HEADER:
        seen += connection.read()
        status, ended, rest = seen.partition(b"\r\n")
        if not ended:
            continue
        _refuse(status, caster)
        if status.startswith(b"ICY"):
            return _Answer(_behind_icy(rest), chunked=False)
        header, ended, data = seen.partition(b"\r\n\r\n")
        if ended:
            if b"sourcetable" in header.lower():
                raise LinkError(_no_mount(caster))
            return _Answer(data, chunked=re.search(rb"(?i)\r\ntransfer-encoding:\s*chunked", header) is not None)
    raise LinkError(sentence("the caster {host} does not answer as a caster: check host and port", host=caster.host))


def _refuse(status: bytes, caster: Caster) -> None:
    """Raises ``LinkError`` unless the first line of the answer says that corrections follow."""
    text = status.decode("latin-1")
    if re.match(r"(ICY|HTTP/1\.[01]) 200\b", text):
        return
    if text.startswith("SOURCETABLE") or re.match(r"HTTP/1\.[01] 404\b", text):
        raise LinkError(_no_mount(caster))
    if re.match(r"HTTP/1\.[01] 40[13]\b", text) or "bad password" in text.lower():
        raise LinkError(sentence("the caster {host} refuses user and password: check both", host=caster.host))
    shown = "".join(one if one.isprintable() else "?" for one in text[:SHOWN])
    raise LinkError(sentence("the caster {host} refuses: {answer}", host=caster.host, answer=shown))


def _no_mount(caster: Caster) -> str:
    return sentence(
        "the caster {host} has no mount point {mount}: check its name", host=caster.host, mount=caster.mount
    )


def _behind_icy(rest: bytes) -> bytes:
    """Version 1 puts corrections behind one line, or behind an empty second one."""
    return rest.removeprefix(b"\r\n")


class _Stream:
    """An answered request as a link that reads nothing for us."""

    def __init__(self, connection: SocketConnection, corrections: Corrections, answer: _Answer) -> None:
        self.what = connection.what
        self._connection = connection
        self._corrections = corrections
        self._chunks = _Unchunked() if answer.chunked else None
        self._first = answer.data
        self._told = -corrections.gga_every_s

    def read(self) -> bytes:
        """Hands on what has come and sends the position back when it is time. Raises ``LinkError``."""
        self._tell_position()
        data = self._first or self._connection.read()
        self._first = b""
        data = data if self._chunks is None else self._chunks.feed(data)
        if data:
            self._corrections.pass_on(data)
        return b""

    def _tell_position(self) -> None:
        now = time.monotonic()
        if now - self._told >= self._corrections.gga_every_s and self._corrections.position:
            self._told = now
            self._connection.write(self._corrections.position)

    def write(self, data: bytes) -> None:
        """Sends these bytes to the caster. Raises ``LinkError``."""
        self._connection.write(data)

    def close(self) -> None:
        """Closes it."""
        self._connection.close()


class _Unchunked:
    """Takes HTTP's chunk headers out of a stream, however it was cut."""

    def __init__(self) -> None:
        self._rest = b""
        self._left = 0

    def feed(self, data: bytes) -> bytes:
        """The payload. Raises ``LinkError`` when there is none any more, or when it is no such stream."""
        self._rest += data
        payload = []
        while self._rest:
            if self._left:
                payload.append(self._rest[: self._left])
                self._left -= len(payload[-1])
                self._rest = self._rest[len(payload[-1]) :]
                continue
            line, ended, behind = self._rest.removeprefix(b"\r\n").partition(b"\r\n")
            if not ended:
                break
            self._left, self._rest = _size_of(line), behind
        return b"".join(payload)


def _size_of(line: bytes) -> int:
    """The size that a chunk's first line says, in hexadecimal digits. Raises ``LinkError`` for none."""
    try:
        size = int(line.partition(b";")[0], 16)
    except ValueError:
        raise LinkError(sentence("the caster's stream is damaged: connecting again")) from None
    if size <= 0:
        raise LinkError(sentence("the caster has ended the corrections"))
    return size


def corrected(receiver: Kept, caster: Caster, traffic: Traffic | None = None) -> Mapping[str, Source]:
    """The receiver and the corrections that it gets, by the names of their links; ``traffic`` counts them."""
    corrections = Corrections(caster, receiver.write, traffic=traffic)
    return {RECEIVER: Overheard(receiver, corrections.hear), CORRECTIONS: corrections}


def first_corrections(caster: Caster, patience: float = TRY_S) -> int:
    """How many bytes come first, sent to nobody; 0 when it accepts the request and sends nothing in time.

    Raises ``LinkError`` when it is not there, or refuses.
    """
    traffic = Traffic()
    deadline = time.monotonic() + patience
    stream = Corrections(caster, lambda _: True, traffic=traffic).connect(threading.Event())
    try:
        while not traffic.received and time.monotonic() < deadline:
            stream.read()
    finally:
        stream.close()
    return traffic.received


def mount_points(caster: Caster, patience: float = TRY_S) -> tuple[str, ...]:
    """The mount points that the caster's table names, sorted. Raises ``LinkError`` when there is no such table."""
    deadline = time.monotonic() + patience
    stop = threading.Event()
    connection = SocketConnection(dial(caster.host, caster.port, stop), caster.host, SILENT_S)
    seen = b""
    try:
        connection.write(_request(replace(caster, mount=""), b""))
        while b"ENDSOURCETABLE" not in seen and time.monotonic() < deadline and len(seen) < LONGEST_TABLE:
            seen += connection.read()
    except LinkError:
        if not seen:
            raise
    finally:
        connection.close()
    names = {name.decode("utf-8", "replace").strip() for name in _find_streams(seen)}
    if not names:
        _refuse(seen.partition(b"\r\n")[0].replace(b"SOURCETABLE", b"ICY"), caster)
        raise LinkError(
            sentence("the caster {host} names no mount points: write the one you were given", host=caster.host)
        )
    return tuple(sorted(names))


class Overheard:
    """A source whose bytes somebody else hears too."""

    live = True

    def __init__(self, source: Source, hear: Callable[[bytes], None]) -> None:
        self.description = source.description
        self.duration = source.duration
        self._source = source
        self._hear = hear

    def events(self, stop: threading.Event) -> Iterator[SourceEvent]:
        """The source's own."""
        for event in self._source.events(stop):
            if isinstance(event, Chunk):
                self._hear(event.data)
            yield event
