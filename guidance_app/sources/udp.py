"""``udp://:9999``: sentences that a receiver or a controller sends to this machine, or to everybody, as datagrams.

Boards of AgOpenGPS send their sentences and their own binary frames to the same port; the frames begin with 0x80 0x81
and are left out. A datagram that ends with a checksum and no line end is given one: the next may be a second away.
"""

import errno
import re
import socket
import threading

from guidance_app.language import Sentence, sentence
from guidance_app.sources import SourceError
from guidance_app.sources.addresses import split
from guidance_app.sources.kept import READ_S, Kept, LinkError

__all__ = ["open_udp"]

LARGEST_DATAGRAM = 1 << 16
FRAME = b"\x80\x81"
_ends_with_checksum = re.compile(rb"\*[0-9A-Fa-f]{2}\Z").search


def open_udp(uri: str) -> Kept:
    """The source that ``udp://:9999`` names, or ``udp://192.168.5.1:9999`` for one address only.

    Raises ``SourceError``.
    """
    rule = sentence("'{uri}' needs the port to listen at: write it as udp://:9999.", uri=uri)
    parts = split(uri, rule)
    if parts.port is None or parts.path.strip("/") or parts.query or parts.username is not None:
        raise SourceError(rule)
    host, port = parts.hostname or "", parts.port
    what = sentence("UDP port {port}", port=port)

    def connect(stop: threading.Event) -> _Listener:
        del stop
        return _Listener(host, port, what)

    return Kept(what, connect)


class _Listener:
    """A bound socket as a link."""

    def __init__(self, host: str, port: int, what: str) -> None:
        self.what = what
        self._socket = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise LinkError(_why_not(error, host, port)) from None
        self._socket.settimeout(READ_S)

    def read(self) -> bytes:
        """One datagram of text. Raises ``LinkError``."""
        try:
            data = self._socket.recv(LARGEST_DATAGRAM)
        except TimeoutError:
            return b""
        except OSError as error:
            raise LinkError(
                sentence("the connection to {what} broke: {error}", what=self.what, error=error.strerror or str(error))
            ) from None
        if data.startswith(FRAME):
            return b""
        return data + b"\r\n" if _ends_with_checksum(data) else data

    def write(self, data: bytes) -> None:
        """Refused: whoever sends datagrams to everybody does not say where to answer. Raises ``LinkError``."""
        del data
        raise LinkError(sentence("{what} only listens: nothing can be sent over it", what=self.what))

    def close(self) -> None:
        """Closes it."""
        self._socket.close()


def _why_not(error: OSError, host: str, port: int) -> Sentence:
    if error.errno == errno.EADDRINUSE:
        return sentence(
            "UDP port {port} is in use by another program: close it, or let the receiver send to another port",
            port=port,
        )
    if error.errno == errno.EACCES:
        return sentence("UDP port {port} may not be used: choose one from 1024 to 65535", port=port)
    if error.errno in (errno.EADDRNOTAVAIL, -2) or isinstance(error, socket.gaierror):
        return sentence(
            "{host} is not an address of this machine: leave it out, as in udp://:{port}", host=host, port=port
        )
    return sentence("UDP port {port} cannot be opened: {error}", port=port, error=error.strerror or str(error))
