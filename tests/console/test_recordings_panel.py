"""The recordings panel: what was driven is found, shown on the map, compared, replayed and handed in."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import viser
from support.recordings import driven_live
from support.stage import running_viser
from support.viser_client import ViserClient, viser_client

from guidance_app.batch.reviewing import additions_of
from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.runtime import SessionManager
from guidance_app.sources.file import load_log
from guidance_app.store import SAMPLE_RECORDING, Store, copy_sample, load_job
from guidance_app.store.recordings_list import list_recordings

MOST_REDRAWS = 1500
SOON_S = 0.03


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with two recorded drives of the sample's beginning."""
    folder = copy_sample(tmp_path_factory.mktemp("data"))
    chunks = load_log(folder / SAMPLE_RECORDING / "receiver.nmea").chunks
    job = load_job(Store(folder), "Round trip")
    driven_live(folder, chunks[:1200], job)
    driven_live(folder, chunks[:1000], job, "off")
    return folder


class Office:
    """A console where nothing is driven, and one client that looks back."""

    def __init__(self, house: House, screen: Screen, client: ViserClient) -> None:
        self.house, self.screen, self.client = house, screen, client

    def until(self, true: Callable[[], object]) -> None:
        for _ in range(MOST_REDRAWS):
            self.screen.tick()
            if self.client.soon(true, SOON_S):
                return
        pytest.fail("it did not happen; the panels say: " + self.client.words()[-3000:])

    def says(self, pattern: str) -> None:
        self.until(lambda: re.search(pattern, self.client.words()))

    def label(self, pattern: str) -> str:
        labels = [str(one["props"].get("label")) for one in self.client.controls.values()]
        return next(one for one in labels if re.search(pattern, one))

    def open_newest(self) -> None:
        self.says("Look at")
        self.client.press(self.label("Look at"))
        self.until(lambda: "/w/sketch/review" in self.client.nodes)


@pytest.fixture
def office(data: Path) -> Iterator[Office]:
    """The console's setup place on the data folder."""
    manager = SessionManager()
    manager.start()
    house = House(manager, Store(data))
    with running_viser() as server:
        yield from _opened(server, house)
    house.close()
    manager.close()


def _opened(server: viser.ViserServer, house: House) -> Iterator[Office]:
    screen = Screen(server, house)
    screen.attach()
    with viser_client(server) as client:
        yield Office(house, screen, client)


def test_the_list_has_every_drive_with_its_map(office: Office) -> None:
    office.says("Sample field · Round trip")
    office.until(lambda: office.client.words().count("<svg width") >= 2)


def test_a_drive_is_shown_in_colours_with_its_numbers(office: Office) -> None:
    office.open_newest()
    office.says("up to 5 cm")
    office.says("<th>rms</th>")
    before = len(office.client.heard("LineSegmentsMessage", name="/w/sketch/review"))
    office.client.press("Speed")
    office.says("km/h")
    office.until(lambda: len(office.client.heard("LineSegmentsMessage", name="/w/sketch/review")) > before)
    office.until(lambda: "/w/field/boundary" in office.client.nodes)


def test_two_drives_are_compared(office: Office, data: Path) -> None:
    office.open_newest()
    other = min(one.path.name for one in list_recordings(data) if one.summary is not None)
    office.until(lambda: office.client.control("Compare with"))
    options = office.client.control("Compare with")["props"]["options"]  # type: ignore[index]  # it was there
    assert other in options or len(options) == 2
    office.client.set("Compare with", options[1])
    office.says("other rms")
    office.until(lambda: "/w/sketch/review other" in office.client.nodes)
    office.client.set("Compare with", options[0])
    office.until(lambda: "/w/sketch/review other" not in office.client.nodes)


def test_the_ledger_keeps_what_the_driver_adds(office: Office, data: Path) -> None:
    office.open_newest()
    office.client.set("Product", "小麦 <b>")
    office.client.press("Keep")
    paths = [one.path for one in list_recordings(data) if one.summary is not None]
    office.until(lambda: any(additions_of(path).product == "小麦 <b>" for path in paths))
    addresses = re.findall(r"/download/([\w-]+)\"[^>]*>Ledger as PDF", office.client.words())
    make = office.house.files.maker(addresses[0])
    assert make is not None
    made = make()
    assert made is not None
    assert made.data.startswith(b"%PDF")


def test_a_drive_is_replayed_from_the_list(office: Office) -> None:
    office.open_newest()
    office.client.press("Replay")
    office.until(lambda: office.client.control("Skip"))
    assert office.house.manager.replay is not None


def test_without_any_recording_it_says_how_one_comes(tmp_path: Path) -> None:
    manager = SessionManager()
    house = House(manager, Store(tmp_path))
    with running_viser() as server:
        for empty in _opened(server, house):
            empty.says("Every drive records itself")
    house.close()
    manager.close()
