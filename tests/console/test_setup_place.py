"""Driving and setting up: a client is where its drive is, may go to and fro, and a new drive makes its scene anew."""

from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
from support.sessions import HandSession
from support.setup_place import SetupPlace, setup_place
from support.snapshots import SetSession, field_snapshot

from guidance_app.model import EndDrive, SessionState
from guidance_app.store import copy_sample, load_job


@pytest.fixture
def place(server: viser.ViserServer, tmp_path: Path) -> Iterator[SetupPlace]:
    """The sample's documents, and nothing driven."""
    with setup_place(server, copy_sample(tmp_path)) as one:
        yield one


def test_a_console_that_drives_nothing_opens_where_things_are_set_up(place: SetupPlace) -> None:
    place.until(lambda: place.newest("Drive now"))
    assert not place.newest("Skip")


def test_a_registered_operation_is_driven_by_its_name(place: SetupPlace) -> None:
    place.press("▶ Round trip")
    place.until(lambda: place.newest("Skip"))
    place.sees("/w/field/boundary")
    assert place.house.driving


def test_the_end_of_a_drive_asks_once(server: viser.ViserServer) -> None:
    session = SetSession(field_snapshot())
    with setup_place(server, None, session) as place:
        place.press("End the drive")
        place.until(lambda: place.newest("Yes, end the drive now"))
        assert place.house.driving
        place.press("Yes, end the drive now")
        place.until(lambda: place.newest("Drive now"))
        assert not place.house.driving
    assert session.commands == [EndDrive()]


def test_a_drive_that_is_ended_has_heard_of_it(place: SetupPlace) -> None:
    states: list[SessionState] = []
    place.house.drive(load_job(place.store, "Round trip"))
    place.house.manager.subscribe(lambda snapshot: states.append(snapshot.state))
    place.house.end()
    assert SessionState.ENDED in states
    assert not place.house.driving


def test_a_new_drive_takes_the_old_ground_away(server: viser.ViserServer) -> None:
    with setup_place(server, None, SetSession(field_snapshot())) as place:
        place.sees("/w/field/soil", "/w/here/tractor")
        place.house.manager.take(HandSession())
        place.sees_no("/w/field/soil")
        place.sees("/w/here/tractor")


def test_to_the_setup_and_back_without_touching_the_drive(server: viser.ViserServer) -> None:
    session = SetSession(field_snapshot())
    with setup_place(server, None, session) as place:
        place.press("Fields, machines, recordings")
        place.press("Back to the drive")
        place.until(lambda: place.newest("Skip"))
    assert session.commands == []


def test_panels_that_are_left_await_no_file_any_more(place: SetupPlace) -> None:
    token = place.token("each of its time logs becomes a recording")
    assert place.house.files.taker(token)
    place.house.drive(load_job(place.store, "Round trip"))
    place.press("Back to the drive")
    place.until(lambda: place.house.files.taker(token) is None)


def test_a_browser_that_has_gone_awaits_no_file_any_more(place: SetupPlace) -> None:
    token = place.token("each of its time logs becomes a recording")
    place.client.close()
    place.until(lambda: place.house.files.taker(token) is None)
