"""The plan panel: a table that grows, one press shows a plan, another stores it; the rest panel posts commands."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import viser
from support.snapshots import SetSession, field_snapshot
from support.stage import running_viser
from support.viser_client import ViserClient, viser_client

from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.documents import Method, Operation
from guidance_app.guidance.preview import METHODS
from guidance_app.model import Command, ReplanRest, TakePass
from guidance_app.runtime import SessionManager
from guidance_app.store import Store, copy_sample

MOST_REDRAWS = 2000
SOON_S = 0.05
PRESSED = [("Plan the rest again from here", ReplanRest()), ("Take this pass", TakePass(1))]


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    """viser on a free port."""
    with running_viser() as running:
        yield running


@pytest.fixture
def house(tmp_path: Path) -> Iterator[House]:
    """The sample's documents, and nothing driven."""
    manager = SessionManager()
    manager.start()
    house = House(manager, Store(copy_sample(tmp_path)))
    yield house
    house.close()
    manager.close()


def tick_until(screen: Screen, client: ViserClient, true: Any) -> None:
    """Redraws until it is so."""
    for _ in range(MOST_REDRAWS):
        screen.tick()
        if client.soon(true, SOON_S):
            return
    pytest.fail("the client has not heard of it")


def in_the_tab_of(client: ViserClient, label: str, neighbour: str) -> bool:
    """Whether the container of one control lies beside the other control, not in another tab."""
    one, other = client.control(label), client.control(neighbour)
    assert one is not None
    assert other is not None
    holder = client.controls[one["container_uuid"]]
    return bool(holder["container_uuid"] == other["container_uuid"])


def rows_of(client: ViserClient) -> list[int]:
    labels = [str(each["props"].get("label")) for each in client.controls.values()]
    return [int(label.removeprefix("row ")) for label in labels if label.startswith("row ")]


def test_plans_are_compared_shown_and_taken(server: viser.ViserServer, house: House) -> None:
    screen = Screen(server, house)
    screen.attach()
    store = house.store
    assert store is not None
    before = store.list(Operation)[0].document
    with viser_client(server) as client:
        tick_until(screen, client, lambda: client.control("Compare plans"))
        client.press("Compare plans")
        tick_until(screen, client, lambda: client.control("Stop") and client.control("row 2"))
        client.press("Stop")
        tick_until(screen, client, lambda: client.control("Compare plans"))
        client.press("Compare plans")
        tick_until(screen, client, lambda: client.control("Compare plans") and "in laps" in client.words())
        assert "g-best" in client.words()
        assert in_the_tab_of(client, "row 1", "Compare plans")
        last = max(rows_of(client))
        client.press(f"row {last}")
        tick_until(screen, client, lambda: "/w/sketch/worked" in client.nodes and client.control("Take this plan"))
        assert store.list(Operation)[0].document == before
        client.press(f"row {last}")
        tick_until(
            screen, client, lambda: client.heard("NotificationMessage") or client.heard("NotificationShowMessage")
        )
    after = store.list(Operation)[0].document
    assert after.method is METHODS[-1] is Method.SURROUNDING
    assert after.model_copy(update={"method": before.method}) == before


@pytest.mark.parametrize(("pressed", "command"), PRESSED)
def test_the_rest_is_counted_and_commands_are_posted(server: viser.ViserServer, pressed: str, command: Command) -> None:
    session = SetSession(field_snapshot())
    house = House(SessionManager(session))
    screen = Screen(server, house)
    screen.attach()
    with viser_client(server) as client:
        tick_until(screen, client, lambda: client.control("Take this pass") and "2 / 12" in client.words())
        assert "3, 4, 5, 6, 7 …" in client.words()
        client.press(pressed)
        session.until_posted(command)
    house.manager.close()
    house.close()
