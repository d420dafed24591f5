"""Clients without a screen: they speak what the page speaks, draw nothing, and count.

A frame of viser is two little-endian 64-bit numbers (length of the message, and of its compressed form), the compressed
msgpack, then the raw arrays. ``msgspec``, ``zstandard`` and ``websockets`` are viser's own libraries for it. A client
keeps the names of the scene's nodes and no message, so that what grows in a measurement is not the client.
"""

import struct
import threading
from collections.abc import Callable, Mapping
from typing import Any, Self

import msgspec
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin, Subprotocol

from guidance_app.bench.errors import BenchError

__all__ = ["BarClient", "SceneClient"]

PATIENCE_S = 30.0
LENGTHS = struct.Struct("<QQ")
TABLET = (820, 674)
"""The scene's share of a tablet's window, in pixels."""


class _Client:
    """A socket, the thread that reads it, and what it has heard; ``until`` waits for more."""

    def __init__(self, socket: ClientConnection) -> None:
        self._socket = socket
        self._heard = threading.Condition()
        self.frames = 0
        self.bytes = 0
        self._thread = threading.Thread(target=self._listen, name="client", daemon=True)
        self._thread.start()

    def _listen(self) -> None:
        try:
            for frame in self._socket:
                raw = frame.encode() if isinstance(frame, str) else bytes(frame)
                self._take(raw)
                with self._heard:
                    self.frames += 1
                    self.bytes += len(raw)
                    self._heard.notify_all()
        except ConnectionClosed:
            return

    def _take(self, raw: bytes) -> None:
        """What this kind of client does with a frame, before it is counted."""
        raise NotImplementedError

    def soon(self, true: Callable[[], bool], seconds: float) -> bool:
        """Whether ``true`` is within so many seconds; looked at after each frame."""
        with self._heard:
            return self._heard.wait_for(true, seconds)

    def until(self, true: Callable[[], bool]) -> None:
        """Waits until ``true`` is. Raises ``BenchError`` when the console stays silent."""
        if not self.soon(true, PATIENCE_S):
            msg = f"the console has not sent what was waited for in {PATIENCE_S:g} s; see its log above."
            raise BenchError(msg)

    def close(self) -> None:
        """Leaves."""
        self._socket.close()
        self._thread.join(PATIENCE_S)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class BarClient(_Client):
    """Hears the light bar's socket of a console and answers each message as a page does that has drawn it."""

    def __init__(self, address: str) -> None:
        super().__init__(connect(_socket_address(address, "/live"), origin=Origin(address), proxy=None))

    def _take(self, raw: bytes) -> None:
        message = msgspec.json.decode(raw)
        if "t" in message:
            self._socket.send(str(message["t"]))


class SceneClient(_Client):
    """Hears viser's socket and knows the name of every node of the scene."""

    def __init__(self, address: str, headers: Mapping[str, str] | None = None) -> None:
        self.nodes: frozenset[str] = frozenset()
        self._replayed = False
        self._unpacked = zstandard.ZstdDecompressor()
        super().__init__(
            connect(
                _socket_address(address, "/"),
                origin=Origin(address),
                subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
                additional_headers=headers,
                max_size=None,
                compression=None,
                proxy=None,
            )
        )
        self.until(lambda: self._replayed)
        self._tell_the_window()

    def _take(self, raw: bytes) -> None:
        size, packed = LENGTHS.unpack_from(raw)
        inner = raw[LENGTHS.size : LENGTHS.size + packed]
        for message in msgspec.msgpack.decode(self._unpacked.decompress(inner, max_output_size=size))["messages"]:
            self._know(message)

    def _know(self, message: Mapping[str, Any]) -> None:
        kind = message["type"]
        if kind == "ReplayDoneMessage":
            self._replayed = True
        elif kind == "RemoveSceneNodeMessage":
            gone = message["name"]
            self.nodes = frozenset(one for one in self.nodes if one != gone and not one.startswith(f"{gone}/"))
        elif "name" in message and "props" in message:
            self.nodes |= {message["name"]}

    def _tell_the_window(self) -> None:
        """The page's first word; with it the console begins to draw for this client."""
        width, height = TABLET
        camera = {
            "type": "ViewerCameraMessage",
            "wxyz": [1.0, 0.0, 0.0, 0.0],
            "position": [3.0, 3.0, 3.0],
            "fov": 1.3,
            "near": 0.01,
            "far": 1000.0,
            "image_height": height,
            "image_width": width,
            "look_at": [0.0, 0.0, 0.0],
            "up_direction": [0.0, 0.0, 1.0],
        }
        self._socket.send(msgspec.msgpack.encode(camera))


def _socket_address(address: str, path: str) -> str:
    return address.replace("http", "ws", 1).rstrip("/") + path
