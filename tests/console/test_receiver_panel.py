"""The receiver panel on a real viser server: what a port sends is shown, and another port is taken from the screen."""

import itertools
from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
from support.cables import Cable
from support.caster import MOUNT, PASSWORD, USER, LocalCaster, local_caster
from support.nmea import epoch, sentence
from support.setup_place import SetupPlace, setup_place

from guidance_app.documents.caster import CasterAccount
from guidance_app.sources import SourceError
from guidance_app.sources.ports import FoundPort
from guidance_app.store.caster import ACCOUNT, caster_account, keep_caster_account

NOON = 43200.0
SKY = (
    sentence("GPGSV,2,1,05,02,25,181,42,06,45,146,45,12,19,292,,13,17,209,28"),
    sentence("GPGSV,2,2,05,24,80,010,47"),
)


@pytest.fixture
def cable(tmp_path: Path) -> Iterator[Cable]:
    made = Cable(tmp_path / "ttyUSB0")
    made.plug()
    yield made
    made.unplug()


@pytest.fixture
def place(
    server: viser.ViserServer, cable: Cable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[SetupPlace]:
    """Nothing driven, and one port: the cable's, over which an epoch comes with each redraw."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    seconds = itertools.count()

    def send() -> None:
        cable.send(epoch(NOON + next(seconds)) + b"".join(SKY) + b"$GPXYZ,<b>*00\r\n")

    ports = (FoundPort(str(cable.path), "a receiver"),)
    with setup_place(server, None, list_ports=lambda: ports) as one:
        one.each_redraw = send
        yield one


def offered(place: SetupPlace, port: str) -> bool:
    """Whether this port stands in the list."""
    return (one := place.newest("Port")) is not None and port in one["props"]["options"]


def test_a_port_is_chosen_and_what_it_sends_is_shown(place: SetupPlace, cable: Cable) -> None:
    place.until(lambda: offered(place, f"{cable.path} · a receiver"))
    place.fill("Port", f"{cable.path} · a receiver")
    place.until(lambda: (one := place.newest("Address")) and one["value"] == f"serial://{cable.path}")
    place.press("Use this receiver")
    place.says("The receiver gives positions")
    place.says("4 of 5 satellites tracked, the strongest with 47 dB-Hz")
    place.says("its rounding does not matter")
    place.says("<svg")
    assert "$GPXYZ" not in place.client.words()
    place.press("Show what it sends")
    place.says(r"\$GPXYZ,&lt;b&gt;\*00")
    place.says(r"\(not used\)")
    place.press("Hide what it sends")
    place.until(lambda: "$GPXYZ" not in place.client.words())
    assert str(cable.path) in place.house.manager.snapshot().link.what


def test_while_driving_another_receiver_is_asked_for_twice(place: SetupPlace, cable: Cable) -> None:
    house = place.house
    house.use_source(f"serial://{cable.path}?baud=115200")
    driven = house.manager.episode
    reasons: set[str] = set()
    house.manager.subscribe(lambda snapshot: reasons.add(snapshot.link.reason))
    place.press("Use this receiver")
    place.until(lambda: place.newest("Yes, begin anew with it"))
    place.says("The drive ends and a new one begins")
    place.press("No, keep this one")
    place.until(lambda: place.newest("Use this receiver"))
    assert house.manager.episode == driven
    place.press("Use this receiver")
    place.press("Yes, begin anew with it")
    place.until(lambda: house.manager.episode == driven + 1)
    place.until(lambda: house.manager.snapshot().fix is not None)
    assert not any("in use by another program" in one for one in reasons)


def test_a_wrong_address_is_answered_and_nothing_ends(place: SetupPlace) -> None:
    place.until(lambda: place.newest("Address"))
    place.fill("Address", "tcp://nowhere")
    place.press("Use this receiver")
    place.says("needs a host and a port")
    assert not place.house.driving


def test_looking_again_finds_what_was_plugged_in(place: SetupPlace) -> None:
    place.house.list_ports = tuple
    place.press("Look again")
    place.until(lambda: offered(place, "no port found: plug the receiver in"))
    place.house.list_ports = lambda: (FoundPort("/dev/ttyACM0"),)
    place.press("Look again")
    place.until(lambda: offered(place, "/dev/ttyACM0"))


def test_an_address_without_end_is_refused(place: SetupPlace) -> None:
    with pytest.raises(SourceError, match="too long"):
        place.house.use_source("tcp://" + "a" * 400 + ":1")


# --- corrections ---------------------------------------------------------------------------------------------------


@pytest.fixture
def stored(server: viser.ViserServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[SetupPlace]:
    """Nothing driven, and a data folder to keep things in."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    with setup_place(server, tmp_path / "data") as one:
        yield one


@pytest.fixture
def caster() -> Iterator[LocalCaster]:
    with local_caster(2, again=True) as one:
        yield one


def fill_in(place: SetupPlace, caster: LocalCaster, **changes: str) -> None:
    said = {"Caster": "127.0.0.1", "Mount point": MOUNT, "User": USER, "Password": PASSWORD, **changes}
    for label, value in {**said, "Port of the caster": str(caster.server.port)}.items():
        place.until(lambda label=label: place.newest(label))
        place.fill(label, value)


def test_a_caster_is_entered_tried_kept_and_corrects_the_next_drive(
    stored: SetupPlace, cable: Cable, caster: LocalCaster
) -> None:
    stored.says("No caster is entered")
    fill_in(stored, caster, Password="wrong")
    stored.press("Try it")
    stored.says("the caster 127.0.0.1 refuses user and password: check both")
    fill_in(stored, caster, **{"Mount point": "ELSEWHERE"})
    stored.press("Try it")
    stored.says("has no mount point ELSEWHERE: check its name")
    assert caster_account(stored.store.root) is None
    fill_in(stored, caster)
    stored.press("Try it")
    stored.says(f"{MOUNT} gives corrections")
    stored.press("Save the caster")
    stored.until(lambda: caster_account(stored.store.root))
    assert caster_account(stored.store.root).password == PASSWORD
    stored.until(lambda: stored.newest("Password")["value"] == "")
    stored.says(f"{MOUNT} of 127.0.0.1 is asked when a drive begins")
    stored.house.use_source(f"serial://{cable.path}?baud=115200")
    stored.says(f"{MOUNT} of 127.0.0.1: .* kB received, the newest .* ago")
    assert stored.house.corrections.received > 0


def test_a_mount_point_is_chosen_from_those_that_the_caster_names(stored: SetupPlace, caster: LocalCaster) -> None:
    fill_in(stored, caster, **{"Mount point": "", "Password": "wrong"})
    stored.press("List its mount points")
    stored.says("the caster 127.0.0.1 refuses user and password: check both")
    fill_in(stored, caster, **{"Mount point": ""})
    stored.press("List its mount points")
    stored.says("Choose the mount point above")
    stored.until(lambda: (one := stored.newest("Mount points there")) and "FAR" in one["props"]["options"])
    stored.fill("Mount points there", MOUNT)
    stored.until(lambda: stored.newest("Mount point")["value"] == MOUNT)


def test_the_kept_password_is_never_shown_and_goes_to_no_other_caster(stored: SetupPlace, caster: LocalCaster) -> None:
    account = CasterAccount(host="127.0.0.1", port=caster.server.port, mount="OLD", user=USER, password=PASSWORD)
    keep_caster_account(stored.store.root, account)
    stored.screen._renew()
    stored.until(lambda: (one := stored.newest("Mount point")) and one["value"] == "OLD")
    assert stored.newest("Password")["value"] == ""
    stored.fill("Mount point", MOUNT)
    stored.press("Save the caster")
    stored.until(lambda: caster_account(stored.store.root).mount == MOUNT)
    assert caster_account(stored.store.root).password == PASSWORD
    stored.fill("User", "another")
    stored.press("Save the caster")
    stored.until(lambda: caster_account(stored.store.root).user == "another")
    assert caster_account(stored.store.root).password == ""
    assert PASSWORD not in str(stored.client.messages)
    stored.press("Forget the caster")
    stored.says("The caster and its password are forgotten")
    assert not (stored.store.root / ACCOUNT).exists()


def test_what_is_wrong_with_a_caster_stands_under_its_entry(stored: SetupPlace, caster: LocalCaster) -> None:
    fill_in(stored, caster, Caster="ntrip://127.0.0.1/")
    stored.press("Save the caster")
    stored.says("Write the caster.*s name alone")
    assert not (stored.store.root / ACCOUNT).exists()


def test_a_receiver_that_takes_no_corrections_is_said(stored: SetupPlace, caster: LocalCaster) -> None:
    fill_in(stored, caster)
    stored.press("Save the caster")
    stored.says("Kept")
    stored.house.use_source("sim:")
    stored.says("This receiver takes no corrections")


def test_a_damaged_account_is_said_where_it_is_entered(stored: SetupPlace) -> None:
    stored.store.root.mkdir(exist_ok=True)
    (stored.store.root / ACCOUNT).write_text("{", encoding="utf-8")
    stored.screen._renew()
    stored.says("is damaged: enter it again")
