"""A browser without a screen: speaks viser's wire protocol, counts bytes, presses buttons and knows every node.

A frame is two little-endian 64-bit numbers (length of the inner message, and of its compressed form), the compressed
msgpack, then the raw arrays. What viser's page does with the messages is kept as far as tests ask for it.
"""

import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import msgspec
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

__all__ = ["Redraws", "ViserClient", "viser_client"]

PATIENCE_S = 40.0
MARK = "/redraws"


def _says(option: str, words: str) -> bool:
    """Whether a button of a row has these words, marked or not."""
    return option.removeprefix("● ") == words


class ViserClient:
    """One connected client. All that it has heard is in its attributes; ``until`` waits for more."""

    def __init__(self, port: int, *, width: int = 820, height: int = 674) -> None:
        self._socket = connect(
            f"ws://127.0.0.1:{port}",
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            max_size=None,
            compression=None,
            proxy=None,
        )
        self._heard = threading.Condition()
        self.bytes = 0
        self.redraws = 0
        self.gone = False
        self.messages: list[dict[str, Any]] = []
        self.nodes: dict[str, dict[str, Any]] = {}
        self.controls: dict[str, dict[str, Any]] = {}
        self.replayed = False
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()
        self.until(lambda: self.replayed)
        self.camera(width, height)

    # --- what is heard -----------------------------------------------------------------------------------------

    def _listen(self) -> None:
        unpacked = zstandard.ZstdDecompressor()
        try:
            for frame in self._socket:
                raw = bytes(frame)  # type: ignore[arg-type]  # viser sends bytes only
                size, packed = struct.unpack("<QQ", raw[:16])
                inner = msgspec.msgpack.decode(unpacked.decompress(raw[16 : 16 + packed], max_output_size=size))
                with self._heard:
                    self.bytes += len(raw)
                    for message in inner["messages"]:
                        self._take(message)
                    self._heard.notify_all()
        except ConnectionClosed:
            pass
        with self._heard:
            self.gone = True
            self._heard.notify_all()

    def _take(self, message: dict[str, Any]) -> None:
        kind = message["type"]
        if message.get("name") == MARK:
            self.redraws = max(self.redraws, int(message.get("position", (0,))[0]))
            return
        self.messages.append(message)
        if kind == "ReplayDoneMessage":
            self.replayed = True
        elif kind == "RemoveSceneNodeMessage":
            gone = message["name"]
            self.nodes = {name: node for name, node in self.nodes.items() if name != gone and gone + "/" not in name}
        elif "name" in message and "props" in message:
            self.nodes[message["name"]] = message
        elif kind == "GuiUpdateMessage" and message["uuid"] in self.controls:
            control = self.controls[message["uuid"]]
            for name, value in message["updates"].items():
                target = control if name == "value" else control["props"]
                target[name] = value
        elif kind == "GuiRemoveMessage":
            self._remove_control(message["uuid"])
        elif kind.startswith("Gui") and "uuid" in message and "props" in message:
            self.controls[message["uuid"]] = message

    def _remove_control(self, uuid: str) -> None:
        self.controls.pop(uuid, None)
        for inner in [key for key, one in self.controls.items() if one.get("container_uuid") == uuid]:
            self._remove_control(inner)

    def until(self, true: Callable[[], Any]) -> None:
        """Waits until ``true`` is, looking after each frame."""
        with self._heard:
            assert self._heard.wait_for(true, PATIENCE_S), "the client waited in vain"

    def soon(self, true: Callable[[], Any], seconds: float) -> bool:
        """Whether ``true`` is within so many seconds."""
        with self._heard:
            return bool(self._heard.wait_for(true, seconds))

    def place_of(self, name: str) -> tuple[float, ...]:
        """Where this node was moved to last; empty when it never was."""
        moved = self.heard("SetPositionMessage", name=name)
        return tuple(moved[-1]["position"]) if moved else ()

    def heard(self, kind: str, **members: Any) -> list[dict[str, Any]]:
        """Every message of this type with these members."""
        return [
            one
            for one in self.messages
            if one["type"] == kind and all(one.get(name) == value for name, value in members.items())
        ]

    # --- what is said ------------------------------------------------------------------------------------------

    def _say(self, **message: Any) -> None:
        self._socket.send(msgspec.msgpack.encode(message))

    def camera(self, width: int, height: int) -> None:
        """Tells the window's size, as the page does when it opens and when it is turned."""
        self._say(
            type="ViewerCameraMessage",
            wxyz=[1.0, 0.0, 0.0, 0.0],
            position=[3.0, 3.0, 3.0],
            fov=1.3,
            near=0.01,
            far=1000.0,
            image_height=height,
            image_width=width,
            look_at=[0.0, 0.0, 0.0],
            up_direction=[0.0, 0.0, 1.0],
        )

    def control(self, label: str) -> dict[str, Any] | None:
        """The control with this label, or the row of buttons that has one with these words."""
        with self._heard:
            for control in self.controls.values():
                props = control["props"]
                if props.get("label") == label or any(_says(word, label) for word in props.get("options", ())):
                    return control
        return None

    def press(self, words: str) -> None:
        """Presses the button, or the button of a row, with these words."""
        self.until(lambda: self.control(words))
        control = self.control(words)
        assert control is not None
        options = control["props"].get("options", ())
        value = next((word for word in options if _says(word, words)), True)
        self._say(type="GuiUpdateMessage", uuid=control["uuid"], updates={"value": value})

    def set(self, label: str, value: Any) -> None:
        """Sets a slider, a text or a list."""
        self.until(lambda: self.control(label))
        control = self.control(label)
        assert control is not None
        self._say(type="GuiUpdateMessage", uuid=control["uuid"], updates={"value": value})

    def tap(self, x: float, y: float) -> None:
        """A tap on the ground of the scene's root, from straight above."""
        self._say(
            type="ScenePointerMessage",
            event_type="click",
            ray_origin=[x, y, 50.0],
            ray_direction=[0.0, 0.0, -1.0],
            screen_pos=[[0.5, 0.5]],
            modifier=None,
        )

    def words(self) -> str:
        """Everything that the panels say."""
        with self._heard:
            return "\n".join(
                str(one["props"].get("content", one["props"].get("label", ""))) for one in self.controls.values()
            )

    def close(self) -> None:
        """Leaves."""
        self._socket.close()
        self._thread.join(PATIENCE_S)


@contextmanager
def viser_client(server: viser.ViserServer, **window: int) -> Iterator[ViserClient]:
    """A client that leaves at the end."""
    client = ViserClient(server.get_port(), **window)
    try:
        yield client
    finally:
        client.close()


class Redraws:
    """Redraws that a client is known to have heard whole: viser sends in order, and each ends with a mark."""

    def __init__(self, server: viser.ViserServer, tick: Callable[[], None]) -> None:
        self._scene = server.scene
        self._tick = tick
        self._count = 0

    def next(self, client: ViserClient) -> None:
        """Redraws, and waits until the client has all of it, or has gone."""
        self._tick()
        self._count += 1
        self._scene.add_frame(MARK, show_axes=False, position=(float(self._count), 0.0, 0.0))
        client.until(lambda: client.redraws >= self._count or client.gone)
