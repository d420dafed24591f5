"""The console, put together: viser inside, the screen on it, the front with page, light bar and access around it."""

import contextlib
import socket
from collections.abc import Callable
from typing import Protocol

import viser

from guidance_app.console.access import Door, Names, new_pin
from guidance_app.console.address import (
    ALL_INTERFACES,
    LOOPBACK,
    ConsoleError,
    bind,
    is_loopback,
    lan_addresses,
    own_names,
)
from guidance_app.console.files import Download
from guidance_app.console.front import front_app, own_files, static_folder
from guidance_app.console.guard import Guard
from guidance_app.console.house import House
from guidance_app.console.inner import InnerViser
from guidance_app.console.live import LiveHub
from guidance_app.console.qr import terminal_qr
from guidance_app.console.screen import Screen
from guidance_app.console.web_server import WebServer
from guidance_app.language import Words, words_for
from guidance_app.runtime import Session, SessionManager
from guidance_app.store import Store

__all__ = ["Console", "ConsoleError", "Download", "Picture", "ScreenFactory"]

DEFAULT_PORT = 8080
"""Where the console is found when nothing else is asked for."""


class Picture(Protocol):
    """Scene and panels on viser's server."""

    def start(self) -> None:
        """Begins to draw."""
        ...

    def close(self) -> None:
        """Ends its threads."""
        ...


ScreenFactory = Callable[[viser.ViserServer, House], Picture]


class Console:
    """The console in the browser, around one session or a manager that changes between several.

    Reached from this machine alone, or with ``lan`` from the network behind a PIN (six random digits unless ``pin``
    names them). ``screen_factory`` makes scene and panels from viser's server and the house; ``host`` chooses one
    interface instead of all. ``store`` holds the documents that are set up here; without one only the drive is shown.
    """

    def __init__(  # noqa: PLR0913 - a call names each
        self,
        session: Session,
        *,
        host: str | None = None,
        port: int = DEFAULT_PORT,
        lan: bool = False,
        pin: str | None = None,
        screen_factory: ScreenFactory = Screen,
        store: Store | None = None,
    ) -> None:
        if host is not None and not lan and not is_loopback(host):
            msg = f"{host} is reached from the network; add --lan, so that a PIN stands before it."
            raise ConsoleError(msg)
        manager = session if isinstance(session, SessionManager) else SessionManager(session)
        self.house = House(manager, store)
        """What the console can do beside the drive."""
        self._host = host or (ALL_INTERFACES if lan else LOOPBACK)
        self._wanted_port = port
        self._lan = lan
        self._screen_factory = screen_factory
        self._closing = contextlib.ExitStack()
        self.pin = (pin or new_pin()) if lan else None
        """What a browser must show; None without ``lan``."""
        self.hub = LiveHub(manager)
        """The light bar's feed, with the round trips it has measured."""
        self.addresses: tuple[str, ...] = ()
        """Where browsers find the console, the best first; empty until it has started."""

    def start(self) -> str:
        """Opens everything and gives the address for a browser. Raises ``ConsoleError`` when that cannot be."""
        with contextlib.ExitStack() as opened:
            listener = opened.enter_context(bind(self._host, self._wanted_port))
            port = listener.getsockname()[1]
            inner = InnerViser(label="Guidance")
            opened.callback(self.house.close)
            opened.callback(inner.close)
            screen = self._screen_factory(inner.server, self.house)
            screen.start()
            opened.callback(screen.close)
            opened.callback(WebServer(self._application(inner, port), listener).close)
            self._closing = opened.pop_all()
        self.addresses = tuple(f"http://{host}:{port}" for host in self._reachable())
        return self.addresses[0]

    def close(self) -> None:
        """Ends every socket and thread; again is harmless."""
        self._closing.close()

    def invitation(self, *, colour: bool = True) -> str:
        """What to print: the address, and on a network the PIN and a QR code that holds both."""
        if self.pin is None:
            return f"Open {self.addresses[0]} in a browser on this machine."
        others = "".join(f"\n  or {address}" for address in self.addresses[1:])
        link = f"{self.addresses[0]}/?pin={self.pin}"
        return f"On the tablet open {self.addresses[0]}{others}\nPIN {self.pin}\n\n{terminal_qr(link, colour=colour)}"

    def _application(self, inner: InnerViser, port: int) -> Guard:
        files = own_files(static_folder())
        app = front_app(files, self.hub, inner.uri, inner.headers, self.house.files, self._words)
        names = Names(own_names() | {self._host, LOOPBACK, "::1"}, any_number=self._lan)
        return Guard(app, Door(self.pin), files, names, cookie=f"guidance_{port}", words=self._words)

    def _words(self) -> Words:
        return words_for(self.house.settings().language)

    def _reachable(self) -> tuple[str, ...]:
        if self._host != ALL_INTERFACES:
            return (self._host,)
        return lan_addresses() or (f"{socket.gethostname()}.local",)
