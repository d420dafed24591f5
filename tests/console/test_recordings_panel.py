"""The recordings panel: what was driven is found, shown on the map, compared, replayed and handed in."""

import io
import shutil
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
from support.recordings import driven_live
from support.setup_place import SetupPlace, setup_place

from guidance_app.batch.reviewing import additions_of
from guidance_app.console.files import Download, NotMadeError
from guidance_app.exchange.drives import DRIVE_WRITERS
from guidance_app.runtime import ReplaySession
from guidance_app.sources.file import load_log
from guidance_app.store import SAMPLE_RECORDING, Store, copy_sample, load_job
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_list import list_recordings

TIME_LOGS = "time logs becomes a recording"


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with two recorded drives of the sample's beginning."""
    folder = copy_sample(tmp_path_factory.mktemp("data"))
    chunks = load_log(folder / SAMPLE_RECORDING / "receiver.nmea").chunks
    job = load_job(Store(folder), "Round trip")
    driven_live(folder, chunks[:1200], job)
    driven_live(folder, chunks[:1000], job, "off")
    return folder


@pytest.fixture
def office(server: viser.ViserServer, data: Path) -> Iterator[SetupPlace]:
    """The console's setup place on the data folder."""
    with setup_place(server, data) as one:
        yield one


def list_is_drawn(office: SetupPlace) -> None:
    """Both drives with their maps: nothing works on the folders any more."""
    office.label("Look at")
    office.until(lambda: office.client.words().count("<svg width") >= 2)


def open_newest(office: SetupPlace) -> None:
    """The page of the newest drive, whole."""
    list_is_drawn(office)
    office.client.press(office.label("Look at"))  # the first of two drives of the same minute
    office.sees("/w/sketch/review")
    office.until(lambda: office.newest("Delete this recording"))


def test_the_list_has_every_drive_with_its_map(office: SetupPlace) -> None:
    office.says("Sample field · Round trip")
    office.until(lambda: office.client.words().count("<svg width") >= 2)


def test_a_drive_is_shown_in_colours_with_its_numbers(office: SetupPlace) -> None:
    open_newest(office)
    office.says("up to 5 cm")
    office.says("<th>rms</th>")
    before = len(office.client.heard("LineSegmentsMessage", name="/w/sketch/review"))
    office.press("Speed")
    office.says("km/h")
    office.until(lambda: len(office.client.heard("LineSegmentsMessage", name="/w/sketch/review")) > before)
    office.sees("/w/field/boundary")


def test_two_drives_are_compared(office: SetupPlace, data: Path) -> None:
    open_newest(office)
    other = min(one.path.name for one in list_recordings(data) if one.summary is not None)
    compared = office.newest("Compare with")
    assert compared is not None
    options = compared["props"]["options"]
    assert other in options or len(options) == 2
    office.fill("Compare with", options[1])
    office.says("other rms")
    office.sees("/w/sketch/review-other")
    office.fill("Compare with", options[0])
    office.sees_no("/w/sketch/review-other")


def test_the_ledger_keeps_what_the_driver_adds(office: SetupPlace, data: Path) -> None:
    open_newest(office)
    office.fill("Product", "小麦 <b>")
    office.press("Keep")
    paths = [one.path for one in list_recordings(data) if one.summary is not None]
    office.until(lambda: any(additions_of(path).product == "小麦 <b>" for path in paths))
    assert office.made("Ledger as PDF").data.startswith(b"%PDF")


def test_a_drive_is_replayed_from_the_list(office: SetupPlace) -> None:
    open_newest(office)
    office.press("Replay")
    office.until(lambda: office.newest("Skip"))
    assert office.house.manager.replay is not None


def test_a_replay_is_played_again_beside_another_filter_and_without_it(office: SetupPlace) -> None:
    open_newest(office)
    office.press("Replay")
    office.press("Play again with both")
    office.says("Change the filter")
    first = office.house.manager.session
    office.fill("Filter", "None")
    office.fill("Antenna forward (m)", 1.25)
    office.press("Play again with both")
    office.says("as it was driven: ")
    office.says(r"beside it: .*antenna 1\.25 m forward")
    session = office.house.manager.session
    assert isinstance(session, ReplaySession)
    assert session is not first
    assert session.compare is not None
    office.until(lambda: session.snapshot().ghost is not None)
    office.press("Play again without it")
    office.until(lambda: office.house.manager.session is not session)
    office.until(lambda: "as it was driven" not in office.client.words())


def test_without_any_recording_it_says_how_one_comes(server: viser.ViserServer, tmp_path: Path) -> None:
    with setup_place(server, tmp_path) as empty:
        empty.says("Every drive records itself")


def report_differs(office: SetupPlace, other: Download) -> bool:
    return office.made("Zip for a bug report").data != other.data


def test_a_bug_report_is_made_here_and_elsewhere(office: SetupPlace, tmp_path: Path) -> None:
    open_newest(office)
    here = office.made("Zip for a bug report")
    office.fill("Move it elsewhere on earth", value=True)
    office.until(lambda: report_differs(office, here))
    there = office.made("Zip for a bug report")
    drives = []
    for number, one in enumerate((here, there)):
        path = tmp_path / f"{number}.zip"
        path.write_bytes(one.data)
        drives.append(open_recording(path))
    places = [drive.job.field.boundary.coordinates[0][0] for drive in drives if drive.job.field is not None]
    assert abs(places[0][0] - places[1][0]) > 0.9
    assert places[0][1] == places[1][1]


def test_what_cannot_be_made_is_one_sentence(office: SetupPlace, data: Path) -> None:
    open_newest(office)
    office.says("NMEA: ")
    newest = next(one.path for one in list_recordings(data) if one.summary is not None)
    away = newest.rename(data / "away")
    try:
        with pytest.raises(NotMadeError, match="there is no recording"):
            office.made(f"NMEA: {DRIVE_WRITERS['nmea'].words}")
    finally:
        away.rename(newest)


def test_a_recording_is_deleted_and_comes_back(office: SetupPlace, data: Path) -> None:
    before = [one.path for one in list_recordings(data)]
    open_newest(office)
    office.press("Delete this recording")
    office.says("is deleted")
    assert len(list_recordings(data)) == len(before) - 1
    office.press("Undo")
    office.says("It is back")
    assert [one.path for one in list_recordings(data)] == before


def test_a_recording_is_taken_in_once_and_shown(office: SetupPlace, data: Path, tmp_path: Path) -> None:
    list_is_drawn(office)
    newest = next(one.path for one in list_recordings(data) if one.summary is not None)
    kept = newest.rename(data / "away")
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for path in kept.iterdir():
            archive.write(path, f"{newest.name}/{path.name}")
    office.send(TIME_LOGS, "drive.zip", content.getvalue())
    office.says("1 recording was taken in")
    assert newest.name in [one.path.name for one in list_recordings(data)]
    office.send(TIME_LOGS, "drive.zip", content.getvalue())
    office.says("in the list already")
    shutil.rmtree(newest)
    kept.rename(newest)


def test_a_file_of_something_else_is_refused(office: SetupPlace) -> None:
    office.send(TIME_LOGS, "holiday.zip", b"no zip")
    office.says("is no recording")


def test_the_ledger_of_several_drives(office: SetupPlace) -> None:
    office.press("Ledger of several")
    office.until(lambda: office.newest("Make the ledger"))
    office.fill("Field", "Sample field")
    office.press("Any day")
    office.press("Make the ledger")
    office.says("2 drives")
    assert office.made("Ledger as PDF").data.startswith(b"%PDF")
    assert office.made("Ledger as CSV").data.count(b"\n") >= 3
