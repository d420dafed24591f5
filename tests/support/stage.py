"""A screen on a real viser server whose redraws a test calls, so that nothing depends on the machine's speed."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
import viser

from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.runtime import SessionManager
from support.viser_client import Redraws, ViserClient, viser_client

__all__ = ["Stage", "running_viser", "server", "visible"]

MOST_REDRAWS = 2000
SOON_S = 0.05


class Stage:
    """A screen that draws when it is told to."""

    def __init__(self, server: viser.ViserServer, session: Any) -> None:
        self.server = server
        self.session = session
        self.screen = Screen(server, House(SessionManager(session)))
        self.screen.attach()
        self._redraws = Redraws(server, self.screen.tick)

    @contextmanager
    def client(self, **window: int) -> Iterator[ViserClient]:
        """A client that has been welcomed and drawn."""
        with viser_client(self.server, **window) as client:
            self.tick_until(client, lambda: "/w/worked_open" in client.nodes and client.control("Night"))
            yield client

    def tick_until(self, client: ViserClient, true: Callable[[], Any]) -> None:
        """Redraws until the client has heard of it."""
        for _ in range(MOST_REDRAWS):
            self.screen.tick()
            if client.soon(true, SOON_S):
                return
        pytest.fail("the client has not heard of it")

    def settle(self, client: ViserClient) -> None:
        """Redraws at the same instant until nothing new comes."""
        self.tick_until(client, lambda: client.place_of("/w/here"))
        before = -1
        while len(client.messages) != before:
            before = len(client.messages)
            self._redraws.next(client)


@contextmanager
def running_viser() -> Iterator[viser.ViserServer]:
    """viser on a free port of this machine."""
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    try:
        yield server
    finally:
        server.stop()


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    """viser on a free port, for one test: nothing of another test is in its scene."""
    with running_viser() as running:
        yield running


def visible(client: ViserClient, name: str) -> bool:
    """What the client was told last about this node; as it was made when nothing was."""
    told = client.heard("SetSceneNodeVisibilityMessage", name=name)
    return bool(told[-1]["visible"]) if told else True
