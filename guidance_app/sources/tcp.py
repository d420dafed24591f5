"""``tcp://host:port``: a receiver, or a bridge to one, that listens for connections in the network."""

import threading

from guidance_app.language import sentence
from guidance_app.sources.addresses import SocketConnection, dial, host_and_port
from guidance_app.sources.kept import Kept

__all__ = ["open_tcp"]


def open_tcp(uri: str) -> Kept:
    """The source that ``tcp://192.168.1.20:2000`` names. Raises ``SourceError``."""
    host, port = host_and_port(
        uri, sentence("'{uri}' needs a host and a port: write it as tcp://192.168.1.20:2000.", uri=uri)
    )
    what = f"{host}:{port}"

    def connect(stop: threading.Event) -> SocketConnection:
        return SocketConnection(dial(host, port, stop), what)

    return Kept(what, connect)
