"""``gpsd://host``: a receiver that gpsd looks after, here or on another machine; it passes on what the receiver says.

gpsd is asked for the raw stream, and for sentences of its own making where the receiver speaks binary (gpsd itself sets
some receivers so); of those the raw stream holds hexadecimal lines. These and gpsd's own messages, JSON lines, are
dropped by the framing of sentences. Only the list of devices is looked at: a gpsd without a receiver stays silent.
"""

import threading

from guidance_app.language import sentence
from guidance_app.sources.addresses import SocketConnection, dial, host_and_port
from guidance_app.sources.kept import Kept, LinkError

__all__ = ["open_gpsd"]

PORT = 2947
WATCH = b'?WATCH={"enable":true,"raw":1,"nmea":true};\n'
NO_DEVICE = b'"devices":[]'
GREETING_BYTES = 2000
"""The list of devices comes within the first so many bytes."""


def open_gpsd(uri: str) -> Kept:
    """The source that ``gpsd://localhost`` or ``gpsd://192.168.1.20:2947`` names. Raises ``SourceError``."""
    rule = sentence(
        "'{uri}' needs the machine on which gpsd runs: write it as gpsd://localhost or gpsd://192.168.1.20:{port}.",
        uri=uri,
        port=PORT,
    )
    host, port = host_and_port(uri, rule, PORT)
    what = (
        sentence("gpsd on {host}", host=host)
        if port == PORT
        else sentence("gpsd on {host}:{port}", host=host, port=port)
    )

    def connect(stop: threading.Event) -> _Watching:
        connection = _Watching(SocketConnection(dial(host, port, stop), what))
        try:
            connection.write(WATCH)
        except LinkError:
            connection.close()
            raise
        return connection

    return Kept(what, connect)


class _Watching:
    """A connection to gpsd."""

    def __init__(self, connection: SocketConnection) -> None:
        self.what = connection.what
        self._connection = connection
        self._greeting = b""

    def read(self) -> bytes:
        """What the receiver has said, between gpsd's own lines. Raises ``LinkError``."""
        data = self._connection.read()
        if len(self._greeting) < GREETING_BYTES:
            self._greeting += data[:GREETING_BYTES]
            if NO_DEVICE in self._greeting:
                raise LinkError(
                    sentence("{what} has no receiver: plug it in, or name it in gpsd's own settings", what=self.what)
                )
        return data

    def write(self, data: bytes) -> None:
        """Sends these bytes to gpsd. Raises ``LinkError``."""
        self._connection.write(data)

    def close(self) -> None:
        """Closes it."""
        self._connection.close()
