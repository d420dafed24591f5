"""The start panel: operations by name, the last used first, going on after a cut, and driving now with a width."""

import gzip
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import viser
from support.drives import path_chunks, up_and_down
from support.recordings import driven_live
from support.setup_place import SetupPlace, setup_place

from guidance_app.console.beginnings import beginnings_of
from guidance_app.console.panels.start import cut_off_words
from guidance_app.documents import Implement, Job, Operation, Receiver, Tractor
from guidance_app.language import ENGLISH
from guidance_app.store import Store, copy_sample, load_job
from guidance_app.store.recordings import EVENTS, PACKED, SUMMARY
from guidance_app.store.recordings_list import Resumable, resumable

EPOCHS = 120
"""At 10 Hz: longer than what is not worth going on with."""


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """The sample's documents, without its recording."""
    copy_sample(tmp_path)
    (tmp_path / "recordings").rename(tmp_path / "aside")
    return tmp_path


@pytest.fixture
def place(server: viser.ViserServer, data: Path) -> Iterator[SetupPlace]:
    """A console on it."""
    with setup_place(server, data) as one:
        yield one


def driven(data: Path, job: Job) -> Path:
    """A short drive of this job, recorded and ended."""
    folder, _ = driven_live(data, path_chunks(up_and_down(passes=1))[:EPOCHS], job)
    return folder


def cut_off(folder: Path) -> None:
    """What a power cut leaves: events, and no word that the drive has ended."""
    (folder / EVENTS).write_bytes(gzip.decompress((folder / PACKED).read_bytes()))
    (folder / PACKED).unlink()
    summary = json.loads((folder / SUMMARY).read_text("utf-8"))
    (folder / SUMMARY).write_text(json.dumps(summary | {"ended": False}), "utf-8")


def test_an_operation_is_started_by_its_name(place: SetupPlace) -> None:
    place.press("▶ Round trip")
    place.until(lambda: place.house.driving)
    job = place.house.manager.job
    assert job.operation is not None
    assert (job.operation.name, job.tractor.name) == ("Round trip", "Sample tractor")


def test_what_is_registered_appears_without_opening_the_page_again(place: SetupPlace) -> None:
    place.until(lambda: place.newest("▶ Round trip"))
    place.open_form("New operation")
    place.fill("Name", "Spraying")
    place.press("Save")
    place.until(lambda: place.newest("▶ Spraying"))


def test_the_last_used_comes_first(data: Path) -> None:
    store = Store(data)
    first = store.load(Operation, "Round trip").document
    for name in ("Alfa", "Zulu"):
        store.save(first.model_copy(update={"name": name}))
    driven(data, load_job(store, "Zulu"))
    found = beginnings_of(store)
    assert [on.field for on in found.work] == ["Sample field"]
    assert found.work[0].operations == ("Zulu", "Alfa", "Round trip")
    assert found.last.tractor == "Sample tractor"


def test_a_drive_that_was_cut_off_is_offered_first_and_goes_on(server: viser.ViserServer, data: Path) -> None:
    cut_off(driven(data, load_job(Store(data), "Round trip")))
    assert resumable(data) is not None
    with setup_place(server, data) as place:
        place.says("The last drive was cut off")
        label = next(
            one["props"]["label"]
            for one in place.client.controls.values()
            if str(one["props"].get("label", "")).startswith("Go on: Sample field, Round trip")
        )
        place.press(label)
        place.until(lambda: place.house.driving)
        assert place.house.manager.job.operation is not None


def test_a_drive_that_was_cut_off_may_be_left(server: viser.ViserServer, data: Path) -> None:
    cut_off(driven(data, load_job(Store(data), "Round trip")))
    with setup_place(server, data) as place:
        place.press("Leave it as it is")
        place.until(lambda: resumable(data) is None)
        place.until(lambda: place.newest("Leave it as it is") is None)
        assert not place.house.driving


def test_how_far_a_drive_was_in_words() -> None:
    found = Resumable(Path("x"), "Home", "Sow", 60.0, "2026-05-01T12:00:00+00:00", None, 7, 6, 24, 1.0)
    assert cut_off_words(found, ENGLISH).startswith("Home, Sow, 6 of 24 passes done, ")
    assert cut_off_words(replace(found, started_utc="nonsense", passes_done=None), ENGLISH) == "Home, Sow"


def test_drive_now_with_nothing_but_a_width(place: SetupPlace) -> None:
    place.until(lambda: place.newest("Working width (m)"))
    place.fill("Working width (m)", "4,5")
    place.fill("Receiver", "Simulated receiver")
    place.press("Drive now")
    place.until(lambda: place.house.driving)
    job = place.house.manager.job
    assert (job.implement.working_width, job.field, job.receiver.source) == (4.5, None, "sim:")


@pytest.mark.parametrize("typed", ["", "0.1", "nan", "abc"])
def test_a_width_that_cannot_be_starts_nothing(place: SetupPlace, typed: str) -> None:
    place.until(lambda: place.newest("Working width (m)"))
    place.fill("Working width (m)", typed)
    place.press("Drive now")
    place.says("Look again at: Working width")
    assert not place.house.driving


def test_registered_machines_are_remembered_from_the_last_time(server: viser.ViserServer, data: Path) -> None:
    store = Store(data)
    store.save(Tractor(name="Old", wheelbase=2.1))
    store.save(Implement(name="Spreader", working_width=12.0))
    store.save(Receiver(name="Mast", source="sim:"))
    driven(
        data,
        Job(
            tractor=store.load(Tractor, "Old").document,
            implement=store.load(Implement, "Spreader").document,
            receiver=store.load(Receiver, "Mast").document,
        ),
    )
    with setup_place(server, data) as place:
        place.until(lambda: (one := place.newest("Tractor")) and one["value"] == "Old")
        place.until(lambda: place.newest("Working width (m)") is None)
        place.press("Drive now")
        place.until(lambda: place.house.driving)
        job = place.house.manager.job
        assert (job.tractor.name, job.implement.name, job.receiver.name) == ("Old", "Spreader", "Mast")
        assert job.implement.working_width == 12.0


def test_without_anything_registered_it_says_the_steps(server: viser.ViserServer, tmp_path: Path) -> None:
    with setup_place(server, tmp_path) as place:
        place.says("☐ Register a tractor")
        place.until(lambda: place.newest("Drive now"))


def test_a_broken_recording_does_not_hide_the_operations(server: viser.ViserServer, data: Path) -> None:
    folder = driven(data, load_job(Store(data), "Round trip"))
    (folder / "session.json").write_text(json.dumps({"kind": "recording"}), "utf-8")
    with setup_place(server, data) as place:
        place.until(lambda: place.newest("▶ Round trip"))


def test_a_folder_that_cannot_be_read_still_lets_one_drive(server: viser.ViserServer, data: Path) -> None:
    (data / "recordings").write_text("a file where a folder belongs", "utf-8")
    with setup_place(server, data) as place:
        place.until(lambda: place.newest("Drive now"))
