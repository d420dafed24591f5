"""Viser, reached through the front alone, and everything between the two as it was."""

import contextlib
import socket
import threading
from collections.abc import Iterator

import msgspec
import numpy as np
import pytest
from support.consoles import (
    VISER,
    PlainScreen,
    StartConsole,
    running_console,
    until_closed,
    viser_socket,
)
from support.sessions import HandSession
from viser._messages import ShareUrlDisconnect, ShareUrlRequest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect
from websockets.sync.server import Server, ServerConnection, serve
from websockets.typing import Origin, Subprotocol

from guidance_app.console.address import bind
from guidance_app.console.files import Files
from guidance_app.console.front import front_app, own_files, static_folder
from guidance_app.console.inner import SECRET_HEADER, InnerViser
from guidance_app.console.live import LiveHub
from guidance_app.console.server import Console
from guidance_app.console.web_server import WebServer
from guidance_app.language import ENGLISH

PATIENCE_S = 40.0
MEGABYTE = 1_000_000


@pytest.fixture(scope="module")
def console() -> Iterator[Console]:
    """One console for the tests that change nothing."""
    with running_console() as running:
        yield running


# --- viser behind it -----------------------------------------------------------------------------------------------


def test_viser_cannot_be_asked_for_a_tunnel() -> None:
    inner = InnerViser("test")
    try:
        handlers = inner.server._websock_server._incoming_handlers
        assert ShareUrlRequest not in handlers
        assert ShareUrlDisconnect not in handlers
        assert inner.server._websock_server._host == "127.0.0.1"
    finally:
        inner.close()


@pytest.mark.parametrize("headers", [{}, {SECRET_HEADER: "guessed"}])
def test_viser_turns_away_whoever_goes_round_the_front(headers: dict[str, str]) -> None:
    inner = InnerViser("test")
    came = threading.Event()
    inner.server.on_client_connect(lambda _: came.set())
    try:
        with connect(inner.uri, subprotocols=[VISER], additional_headers=headers, proxy=None) as stranger:
            assert until_closed(stranger) == 1008
        assert not came.is_set()
    finally:
        inner.close()


def camera() -> bytes:
    """The message by which viser counts a browser as connected."""
    return msgspec.msgpack.encode(
        {
            "type": "ViewerCameraMessage",
            "wxyz": [1, 0, 0, 0],
            "position": [3.0, 3.0, 3.0],
            "image_height": 800,
            "image_width": 1280,
            "fov": 1.3,
            "near": 0.01,
            "far": 1000.0,
            "look_at": [0.0, 0.0, 0.0],
            "up_direction": [0.0, 0.0, 1.0],
        }
    )


def test_visers_messages_pass_both_ways(start_console: StartConsole) -> None:
    console = start_console()
    screen = PlainScreen.newest
    text = "å" * MEGABYTE
    with viser_socket(console) as page:
        assert page.subprotocol == VISER
        page.send(camera())
        assert screen.came.wait(PATIENCE_S)
        uuid = screen.field._impl.uuid
        page.send(msgspec.msgpack.encode({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": text}}))
        assert screen.typed.wait(PATIENCE_S)
        assert screen.field.value == text


def test_a_big_scene_passes_in_one_piece(start_console: StartConsole) -> None:
    console = start_console()
    points = np.arange(3 * MEGABYTE, dtype=np.float32).reshape(-1, 3)
    with viser_socket(console) as page:
        PlainScreen.newest.server.scene.add_point_cloud("/cloud", points, colors=(1, 2, 3), precision="float32")
        while len(page.recv(timeout=PATIENCE_S)) <= points.nbytes:
            pass  # what comes before it is small


@pytest.mark.parametrize("offered", [None, ["viser-v0.0.1"], ["other"]])
def test_a_page_of_another_version_is_not_taken_in(console: Console, offered: list[Subprotocol] | None) -> None:
    address = console.addresses[0]
    page = connect(address.replace("http", "ws"), origin=Origin(address), subprotocols=offered, proxy=None)
    with page:
        assert until_closed(page) == 1002


# --- the proxy on its own, before a server of the test's ------------------------------------------------------------


class Inner:
    """A websocket server that does what the test says with its one connection."""

    def __init__(self) -> None:
        self.connected = threading.Event()
        self.ended = threading.Event()
        self.close_code: int | None = None
        self.sent = 0
        self.total = 0
        self.all_sent = threading.Event()

    def __call__(self, connection: ServerConnection) -> None:
        self.connected.set()
        try:
            for message in connection:
                if message == "close":
                    connection.close(4001, "as asked")
                elif message == "flood":
                    self._flood(connection)
                else:
                    connection.send(message)
        except ConnectionClosed:
            pass
        self.close_code = connection.close_code
        self.ended.set()

    def _flood(self, connection: ServerConnection) -> None:
        block = bytes(256 * 1024)
        for _ in range(self.total):
            connection.send(block)
            self.sent += len(block)
        self.all_sent.set()


@pytest.fixture
def proxied() -> Iterator[tuple[Inner, str]]:
    """A front whose viser is ``Inner``, and the address of its socket."""
    inner = Inner()
    with serve(inner, "127.0.0.1", 0, compression=None, max_size=None) as server:
        running = threading.Thread(target=server.serve_forever)
        running.start()
        with _fronted(server) as address:
            yield inner, address
        server.shutdown()
        running.join(PATIENCE_S)


@contextlib.contextmanager
def _fronted(server: Server) -> Iterator[str]:
    port = server.socket.getsockname()[1]
    app = front_app(
        own_files(static_folder()), LiveHub(HandSession()), f"ws://127.0.0.1:{port}/", {}, Files(), lambda: ENGLISH
    )
    listener = bind("127.0.0.1", 0)
    front = WebServer(app, listener)
    try:
        yield f"ws://127.0.0.1:{listener.getsockname()[1]}/"
    finally:
        front.close()


def test_messages_come_back_as_they_went(proxied: tuple[Inner, str]) -> None:
    with connect(proxied[1], proxy=None, max_size=None) as page:
        for message in ("words", b"bytes", "", b"", bytes(20 * MEGABYTE), "é" * MEGABYTE):
            page.send(message)
            assert page.recv(timeout=PATIENCE_S) == message


def test_the_inner_sides_close_reaches_the_page(proxied: tuple[Inner, str]) -> None:
    with connect(proxied[1], proxy=None) as page:
        page.send("close")
        with pytest.raises(ConnectionClosed) as closed:
            page.recv(timeout=PATIENCE_S)
    assert closed.value.rcvd is not None
    assert (closed.value.rcvd.code, closed.value.rcvd.reason) == (4001, "as asked")


def test_the_pages_close_reaches_the_inner_side(proxied: tuple[Inner, str]) -> None:
    inner, address = proxied
    with connect(address, proxy=None) as page:
        assert inner.connected.wait(PATIENCE_S)
        page.close(4002)
    assert inner.ended.wait(PATIENCE_S)
    assert inner.close_code == 4002


def test_a_page_that_vanishes_ends_the_inner_side(proxied: tuple[Inner, str]) -> None:
    inner, address = proxied
    with connect(address, proxy=None) as page:
        assert inner.connected.wait(PATIENCE_S)
        page.socket.shutdown(socket.SHUT_RDWR)
        assert inner.ended.wait(PATIENCE_S)


def test_a_page_that_does_not_read_holds_the_sender(proxied: tuple[Inner, str]) -> None:
    inner, address = proxied
    inner.total = 400  # 100 MB
    with connect(address, proxy=None, max_size=None, max_queue=1) as page:
        page.send("flood")
        assert not inner.all_sent.wait(1.5)
        assert inner.sent < 60 * MEGABYTE
        for _ in range(inner.total):
            page.recv(timeout=PATIENCE_S)
        assert inner.all_sent.wait(PATIENCE_S)


def test_without_an_inner_side_the_page_is_turned_away() -> None:
    with serve(Inner(), "127.0.0.1", 0) as server, _fronted(server) as address:
        server.socket.close()
        with pytest.raises(InvalidStatus):
            connect(address, proxy=None)
