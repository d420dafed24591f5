"""Host and port of a source's address, and a connection to them that says in words why there is none."""

import errno
import os
import select
import socket
import threading
import time
from urllib.parse import SplitResult, urlsplit

from guidance_app.language import Sentence, sentence
from guidance_app.sources import SourceError
from guidance_app.sources.kept import READ_S, LinkError

__all__ = ["SocketConnection", "dial", "host_and_port", "split"]

DIAL_S = 5.0
SILENT_S = 15.0
"""A connection over which nothing comes for so long is taken for dead: a tablet that left the network gets no word."""

RECEIVED_AT_ONCE = 1 << 16


def split(uri: str, rule: str) -> SplitResult:
    """The parts of an address. Raises ``SourceError`` with ``rule``, which says how it should look."""
    try:
        parts = urlsplit(uri)
        _ = parts.port
    except ValueError:
        raise SourceError(rule) from None
    if not uri.partition(":")[2].startswith("//"):
        raise SourceError(rule)
    return parts


def host_and_port(uri: str, rule: str, default_port: int | None = None) -> tuple[str, int]:
    """Host and port of an address that holds nothing else. Raises ``SourceError`` with ``rule``."""
    parts = split(uri, rule)
    port = parts.port or default_port
    if not parts.hostname or port is None or parts.path.strip("/") or parts.query or parts.username is not None:
        raise SourceError(rule)
    return parts.hostname, port


def dial(host: str, port: int, stop: threading.Event) -> socket.socket:
    """A connected socket whose calls time out after ``READ_S``. Raises ``LinkError``, soon after ``stop`` is set."""
    try:
        places = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        raise LinkError(
            sentence(
                "{host} is not known in this network: check the spelling, or write its number, as in 192.168.1.20",
                host=host,
            )
        ) from None
    deadline = time.monotonic() + DIAL_S
    reason = None
    for family, kind, protocol, _, place in places:
        connection = socket.socket(family, kind, protocol)
        try:
            number = _connect(connection, place, deadline, stop)
        except BaseException:
            connection.close()
            raise
        if not number:
            connection.settimeout(READ_S)
            return connection
        connection.close()
        reason = _why_not(number, host, port)
    raise LinkError(reason)


def _connect(connection: socket.socket, place: object, deadline: float, stop: threading.Event) -> int:
    """Connects; 0, or the number of the error."""
    connection.settimeout(0.0)
    number = connection.connect_ex(place)  # type: ignore[arg-type]  # as getaddrinfo has given it
    while number in (errno.EINPROGRESS, errno.EWOULDBLOCK, errno.EALREADY):
        if stop.is_set() or time.monotonic() > deadline:
            return errno.ETIMEDOUT
        _, writable, failed = select.select([], [connection], [connection], READ_S)
        if writable or failed:
            number = connection.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
    return number


def _why_not(number: int, host: str, port: int) -> Sentence:
    if number == errno.ETIMEDOUT:
        return sentence("{host} does not answer: is it switched on and in the same network?", host=host)
    if number == errno.ECONNREFUSED:
        return sentence(
            "{host} is there, but nothing answers at its port {port}: is the port right, and its server running?",
            host=host,
            port=port,
        )
    return sentence(
        "{host} cannot be reached ({error}): is this machine in its network?", host=host, error=os.strerror(number)
    )


def _broken(what: str, error: OSError) -> Sentence:
    return sentence("the connection to {what} broke: {error}", what=what, error=error.strerror or str(error))


class SocketConnection:
    """A connected socket as a link."""

    def __init__(self, connection: socket.socket, what: str, silent_s: float | None = None) -> None:
        self.what = what
        self._silent_s = SILENT_S if silent_s is None else silent_s
        self._socket = connection
        self._heard = time.monotonic()

    def read(self) -> bytes:
        """What has come. Raises ``LinkError`` when the other side has closed, or has been silent for too long."""
        try:
            data = self._socket.recv(RECEIVED_AT_ONCE)
        except TimeoutError:
            if time.monotonic() - self._heard > self._silent_s:
                raise LinkError(
                    sentence(
                        "{what} has sent nothing for {seconds:.0f} s: connecting again",
                        what=self.what,
                        seconds=self._silent_s,
                    )
                ) from None
            return b""
        except OSError as error:
            raise LinkError(_broken(self.what, error)) from None
        if not data:
            raise LinkError(sentence("{what} has closed the connection", what=self.what))
        self._heard = time.monotonic()
        return data

    def write(self, data: bytes) -> None:
        """Sends these bytes. Raises ``LinkError``."""
        try:
            self._socket.sendall(data)
        except OSError as error:
            raise LinkError(_broken(self.what, error)) from None

    def close(self) -> None:
        """Closes it."""
        self._socket.close()
