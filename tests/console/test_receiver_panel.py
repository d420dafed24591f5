"""The receiver panel on a real viser server: what a port sends is shown, and another port is taken from the screen."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import viser
from support.cables import Cable
from support.nmea import epoch, sentence
from support.stage import running_viser
from support.viser_client import ViserClient, viser_client

from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.runtime import SessionManager
from guidance_app.sources import SourceError
from guidance_app.sources.ports import FoundPort

NOON = 43200.0
MOST_REDRAWS = 2000
SOON_S = 0.05
SKY = (
    sentence("GPGSV,2,1,05,02,25,181,42,06,45,146,45,12,19,292,,13,17,209,28"),
    sentence("GPGSV,2,2,05,24,80,010,47"),
)


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    with running_viser() as running:
        yield running


@pytest.fixture
def cable(tmp_path: Path) -> Iterator[Cable]:
    made = Cable(tmp_path / "ttyUSB0")
    made.plug()
    yield made
    made.unplug()


@pytest.fixture
def house(cable: Cable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[House]:
    """Nothing driven, and one port: the cable's."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    manager = SessionManager()
    manager.start()
    made = House(manager, list_ports=lambda: (FoundPort(str(cable.path), "a receiver"),))
    yield made
    made.close()
    manager.close()


class Sender:
    """Sends an epoch with each redraw, until the client has heard of something."""

    def __init__(self, server: viser.ViserServer, house: House, cable: Cable) -> None:
        self.screen = Screen(server, house)
        self.screen.attach()
        self._cable = cable
        self._second = 0

    def until(self, client: ViserClient, true: Callable[[], object]) -> None:
        for _ in range(MOST_REDRAWS):
            self._cable.send(epoch(NOON + self._second) + b"".join(SKY) + b"$GPXYZ,<b>*00\r\n")
            self._second += 1
            self.screen.tick()
            if client.soon(true, SOON_S):
                return
        pytest.fail(f"the client has not heard of it; it shows\n{client.words()}")


def test_a_port_is_chosen_and_what_it_sends_is_shown(server: viser.ViserServer, house: House, cable: Cable) -> None:
    send = Sender(server, house, cable)
    with viser_client(server) as client:
        send.until(client, lambda: client.control(f"{cable.path} · a receiver"))
        client.set("Port", f"{cable.path} · a receiver")
        send.until(client, lambda: (client.control("Address") or {}).get("value") == f"serial://{cable.path}")
        client.press("Use this receiver")
        send.until(client, lambda: "The receiver gives positions" in client.words())
        send.until(client, lambda: "4 of 5 satellites tracked, the strongest with 47 dB-Hz" in client.words())
        words = client.words()
        assert "its rounding does not matter" in words
        assert "<svg" in words
        assert "$GPXYZ" not in words
        client.press("Show what it sends")
        send.until(client, lambda: "$GPXYZ,&lt;b&gt;*00" in client.words())
        assert "(not used)" in client.words()
        client.press("Hide what it sends")
        send.until(client, lambda: "$GPXYZ" not in client.words())
        assert str(cable.path) in house.manager.snapshot().link.what


def test_while_driving_another_receiver_is_asked_for_twice(
    server: viser.ViserServer, house: House, cable: Cable
) -> None:
    house.use_source(f"serial://{cable.path}?baud=115200")
    driven = house.manager.episode
    reasons: set[str] = set()
    house.manager.subscribe(lambda snapshot: reasons.add(snapshot.link.reason))
    send = Sender(server, house, cable)
    with viser_client(server) as client:
        send.until(client, lambda: client.control("Use this receiver"))
        client.press("Use this receiver")
        send.until(client, lambda: client.control("Yes, begin anew with it"))
        assert "The drive ends and a new one begins" in client.words()
        client.press("No, keep this one")
        send.until(client, lambda: client.control("Use this receiver"))
        assert house.manager.episode == driven
        client.press("Use this receiver")
        send.until(client, lambda: client.control("Yes, begin anew with it"))
        client.press("Yes, begin anew with it")
        send.until(client, lambda: house.manager.episode == driven + 1)
        send.until(client, lambda: house.manager.snapshot().fix is not None)
    assert not any("in use by another program" in one for one in reasons)


def test_a_wrong_address_is_answered_and_nothing_ends(server: viser.ViserServer, house: House, cable: Cable) -> None:
    send = Sender(server, house, cable)
    with viser_client(server) as client:
        send.until(client, lambda: client.control("Address"))
        client.set("Address", "tcp://nowhere")
        client.press("Use this receiver")
        send.until(
            client,
            lambda: any(
                "needs a host and a port" in str(one) for one in client.messages if "otification" in one["type"]
            ),
        )
        assert not house.driving


def test_looking_again_finds_what_was_plugged_in(server: viser.ViserServer, house: House, cable: Cable) -> None:
    send = Sender(server, house, cable)
    house.list_ports = tuple
    with viser_client(server) as client:
        send.until(client, lambda: client.control("no port found: plug the receiver in"))
        house.list_ports = lambda: (FoundPort("/dev/ttyACM0"),)
        client.press("Look again")
        send.until(client, lambda: client.control("/dev/ttyACM0"))


def test_an_address_without_end_is_refused(house: House) -> None:
    with pytest.raises(SourceError, match="too long"):
        house.use_source("tcp://" + "a" * 400 + ":1")
