"""The recordings panel: what was driven is found, shown on the map, compared, replayed and handed in."""

import io
import re
import shutil
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import viser
from support.recordings import driven_live
from support.stage import running_viser
from support.viser_client import ViserClient, viser_client

from guidance_app.batch.reviewing import additions_of
from guidance_app.console.files import Download, NotMadeError
from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.exchange.drives import DRIVE_WRITERS
from guidance_app.runtime import ReplaySession, SessionManager
from guidance_app.sources.file import load_log
from guidance_app.store import SAMPLE_RECORDING, Store, copy_sample, load_job
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_list import list_recordings

MOST_REDRAWS = 2000
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

    def told(self, words: str) -> None:
        self.until(lambda: any(words in str(one) for one in self.client.heard("NotificationShowMessage")))

    def label(self, pattern: str) -> str:
        labels = [str(one["props"].get("label")) for one in self.client.controls.values()]
        return next(one for one in labels if re.search(pattern, one))

    def list_is_drawn(self) -> None:
        """Both drives with their maps: nothing works on the folders any more."""
        self.says("Look at")
        self.until(lambda: self.client.words().count("<svg width") >= 2)

    def open_newest(self) -> None:
        self.list_is_drawn()
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
    office.until(lambda: "/w/sketch/review-other" in office.client.nodes)
    office.client.set("Compare with", options[0])
    office.until(lambda: "/w/sketch/review-other" not in office.client.nodes)


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


def test_a_replay_is_played_again_beside_another_filter_and_without_it(office: Office) -> None:
    office.open_newest()
    office.client.press("Replay")
    office.until(lambda: office.client.control("Play again with both"))
    office.client.press("Play again with both")
    office.told("Change the filter")
    first = office.house.manager.session
    office.client.set("Filter", "None")
    office.client.set("Antenna forward (m)", 1.25)
    office.client.press("Play again with both")
    office.says("as it was driven: ")
    office.says(r"beside it: .*antenna 1\.25 m forward")
    session = office.house.manager.session
    assert isinstance(session, ReplaySession)
    assert session is not first
    assert session.compare is not None
    office.until(lambda: session.snapshot().ghost is not None)
    office.client.press("Play again without it")
    office.until(lambda: office.house.manager.session is not session)
    office.until(lambda: "as it was driven" not in office.client.words())


def test_without_any_recording_it_says_how_one_comes(tmp_path: Path) -> None:
    manager = SessionManager()
    house = House(manager, Store(tmp_path))
    with running_viser() as server:
        for empty in _opened(server, house):
            empty.says("Every drive records itself")
    house.close()
    manager.close()


def made_by(office: Office, label: str) -> Download:
    """What the front would send for the link of this label."""
    office.says(label)
    address = re.findall(rf"/download/([\w-]+)\"[^>]*>{re.escape(label)}<", office.client.words())[-1]
    make = office.house.files.maker(address)
    assert make is not None
    made = make()
    assert made is not None
    return made


def report_differs(office: Office, other: Download) -> bool:
    return made_by(office, "Zip for a bug report").data != other.data


def test_a_bug_report_is_made_here_and_elsewhere(office: Office, tmp_path: Path) -> None:
    office.open_newest()
    here = made_by(office, "Zip for a bug report")
    office.client.set("Move it elsewhere on earth", value=True)
    office.until(lambda: report_differs(office, here))
    there = made_by(office, "Zip for a bug report")
    drives = []
    for number, one in enumerate((here, there)):
        path = tmp_path / f"{number}.zip"
        path.write_bytes(one.data)
        drives.append(open_recording(path))
    places = [drive.job.field.boundary.coordinates[0][0] for drive in drives if drive.job.field is not None]
    assert abs(places[0][0] - places[1][0]) > 0.9
    assert places[0][1] == places[1][1]


def test_what_cannot_be_made_is_one_sentence(office: Office, data: Path) -> None:
    office.open_newest()
    office.says("NMEA: ")
    newest = next(one.path for one in list_recordings(data) if one.summary is not None)
    away = newest.rename(data / "away")
    try:
        with pytest.raises(NotMadeError, match="there is no recording"):
            made_by(office, f"NMEA: {DRIVE_WRITERS['nmea'].words}")
    finally:
        away.rename(newest)


def test_a_recording_is_deleted_and_comes_back(office: Office, data: Path) -> None:
    before = [one.path for one in list_recordings(data)]
    office.open_newest()
    office.client.press("Delete this recording")
    office.says("is deleted")
    assert len(list_recordings(data)) == len(before) - 1
    office.client.press("Undo")
    office.says("It is back")
    assert [one.path for one in list_recordings(data)] == before


def taken(office: Office, name: str, content: bytes) -> None:
    office.says("Take in a recording")
    found = re.search(r'time logs becomes a recording.*?data-upload="([\w-]+)"', office.client.words(), re.DOTALL)
    assert found is not None
    take = office.house.files.taker(found[1])
    assert take is not None
    take(name, content)


def test_a_recording_is_taken_in_once_and_shown(office: Office, data: Path, tmp_path: Path) -> None:
    office.list_is_drawn()
    newest = next(one.path for one in list_recordings(data) if one.summary is not None)
    kept = newest.rename(data / "away")
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for path in kept.iterdir():
            archive.write(path, f"{newest.name}/{path.name}")
    taken(office, "drive.zip", content.getvalue())
    office.says("1 recording was taken in")
    assert newest.name in [one.path.name for one in list_recordings(data)]
    taken(office, "drive.zip", content.getvalue())
    office.told("in the list already")
    shutil.rmtree(newest)
    kept.rename(newest)


def test_a_file_of_something_else_is_refused(office: Office) -> None:
    taken(office, "holiday.zip", b"no zip")
    office.told("is no recording")


def test_the_ledger_of_several_drives(office: Office) -> None:
    office.says("Look at")
    office.until(lambda: office.client.control("Ledger of several"))
    office.client.press("Ledger of several")
    office.until(lambda: office.client.control("Make the ledger"))
    office.client.set("Field", "Sample field")
    office.client.press("Any day")
    office.client.press("Make the ledger")
    office.says("2 drives")
    assert made_by(office, "Ledger as PDF").data.startswith(b"%PDF")
    assert made_by(office, "Ledger as CSV").data.count(b"\n") >= 3
