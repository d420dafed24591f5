"""Consoles for tests: started on a free port, closed after the test, with a scene of next to nothing unless asked."""

import contextlib
import threading
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
import viser
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.sync.connection import Connection
from websockets.typing import Origin, Subprotocol

from guidance_app.console.house import House
from guidance_app.console.server import Console
from support.sessions import HandSession

__all__ = [
    "VISER",
    "PlainScreen",
    "StartConsole",
    "client_of",
    "live_socket",
    "running_console",
    "start_console",
    "until_closed",
    "viser_socket",
]

VISER = Subprotocol(f"viser-v{viser.__version__}")
PATIENCE_S = 40.0

StartConsole = Callable[..., Console]


class PlainScreen:
    """A screen with one text field. The newest one is remembered, so that a test reaches viser's server."""

    newest: "PlainScreen"

    def __init__(self, server: viser.ViserServer, house: House) -> None:
        PlainScreen.newest = self
        self.server = server
        self.session = house.manager
        self.came = threading.Event()
        self.closed = False
        self.typed = threading.Event()

    def start(self) -> None:
        self.field = self.server.gui.add_text("Field", initial_value="")
        self.field.on_update(lambda _: self.typed.set())
        self.server.on_client_connect(lambda _: self.came.set())

    def close(self) -> None:
        self.closed = True


@pytest.fixture
def start_console() -> Iterator[StartConsole]:
    """``start_console(session, **options)`` gives a started console; its screen is ``PlainScreen`` by default."""
    with contextlib.ExitStack() as started:

        def start(session: Any = None, **options: Any) -> Console:
            return started.enter_context(running_console(session, **options))

        yield start


@contextlib.contextmanager
def running_console(session: Any = None, **options: Any) -> Iterator[Console]:
    """The same for a longer time than one test."""
    console = Console(session or HandSession(), **{"port": 0, "screen_factory": PlainScreen, **options})
    console.start()
    try:
        yield console
    finally:
        console.close()


def client_of(console: Console, **headers: str) -> httpx.Client:
    """An HTTP client at the console's address."""
    return httpx.Client(base_url=console.addresses[0], headers=headers, timeout=PATIENCE_S)


def live_socket(console: Console, **options: Any) -> ClientConnection:
    """The light bar's socket, opened as the page opens it."""
    return _socket(console, "/live", **options)


def viser_socket(console: Console, **options: Any) -> ClientConnection:
    """Viser's socket through the front, opened as the page opens it."""
    return _socket(console, "/", subprotocols=[VISER], max_size=None, compression=None, **options)


def until_closed(socket: Connection) -> int | None:
    """Reads until the other side closes; its close code."""
    try:
        while True:
            socket.recv(timeout=PATIENCE_S)
    except ConnectionClosed as closed:
        return None if closed.rcvd is None else closed.rcvd.code


def _socket(console: Console, path: str, **options: Any) -> ClientConnection:
    address = console.addresses[0]
    options.setdefault("origin", Origin(address))
    return connect(address.replace("http", "ws", 1) + path, open_timeout=PATIENCE_S, proxy=None, **options)
