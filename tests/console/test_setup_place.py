"""Driving and setting up: a client is where its drive is, may go to and fro, and a new drive makes its scene anew."""

from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
from support.sessions import HandSession
from support.snapshots import SetSession, field_snapshot
from support.stage import running_viser
from support.viser_client import ViserClient, viser_client

from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.model import EndDrive, SessionState
from guidance_app.runtime import SessionManager
from guidance_app.store import Store, copy_sample, load_job

MOST_REDRAWS = 2000
SOON_S = 0.05


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


def tick_until(screen: Screen, client: ViserClient, true: object) -> None:
    """Redraws until it is so."""
    for _ in range(MOST_REDRAWS):
        screen.tick()
        if client.soon(true, SOON_S):  # type: ignore[arg-type]  # a function without arguments
            return
    pytest.fail("the client has not heard of it")


def test_a_console_that_drives_nothing_opens_where_things_are_set_up(server: viser.ViserServer, house: House) -> None:
    screen = Screen(server, house)
    screen.attach()
    with viser_client(server) as client:
        tick_until(screen, client, lambda: client.control("Drive now"))
        assert not client.control("Skip")


def test_a_registered_operation_is_driven_by_its_name(server: viser.ViserServer, house: House) -> None:
    screen = Screen(server, house)
    screen.attach()
    with viser_client(server) as client:
        tick_until(screen, client, lambda: client.control("▶ Round trip"))
        client.press("▶ Round trip")
        tick_until(screen, client, lambda: client.control("Skip") and "/w/field/boundary" in client.nodes)
        assert house.driving


def test_the_end_of_a_drive_asks_once(server: viser.ViserServer) -> None:
    session = SetSession(field_snapshot())
    house = House(SessionManager(session))
    screen = Screen(server, house)
    screen.attach()
    with viser_client(server) as client:
        tick_until(screen, client, lambda: client.control("End the drive"))
        client.press("End the drive")
        tick_until(screen, client, lambda: client.control("Yes, end the drive now"))
        assert house.driving
        client.press("Yes, end the drive now")
        tick_until(screen, client, lambda: client.control("Drive now"))
        assert not house.driving
    assert session.commands == [EndDrive()]
    house.manager.close()
    house.close()


def test_a_drive_that_is_ended_has_heard_of_it(house: House) -> None:
    states: list[SessionState] = []
    house.drive(load_job(house.store, "Round trip"))
    house.manager.subscribe(lambda snapshot: states.append(snapshot.state))
    house.end()
    assert SessionState.ENDED in states
    assert not house.driving


def test_a_new_drive_takes_the_old_ground_away(server: viser.ViserServer) -> None:
    manager = SessionManager(SetSession(field_snapshot()))
    screen = Screen(server, House(manager))
    screen.attach()
    with viser_client(server) as client:
        tick_until(screen, client, lambda: "/w/field/soil" in client.nodes and "/w/here/tractor" in client.nodes)
        manager.take(HandSession())
        tick_until(screen, client, lambda: "/w/field/soil" not in client.nodes and "/w/here/tractor" in client.nodes)


def test_to_the_setup_and_back_without_touching_the_drive(server: viser.ViserServer) -> None:
    session = SetSession(field_snapshot())
    screen = Screen(server, House(SessionManager(session)))
    screen.attach()
    with viser_client(server) as client:
        tick_until(screen, client, lambda: client.control("Fields, machines, recordings"))
        client.press("Fields, machines, recordings")
        tick_until(screen, client, lambda: client.control("Back to the drive"))
        client.press("Back to the drive")
        tick_until(screen, client, lambda: client.control("Skip"))
        assert session.commands == []
