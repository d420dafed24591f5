"""Recordings are put away with a way back and taken in from elsewhere; the ledger of several takes the right ones."""

import datetime
import io
import zipfile
from pathlib import Path

import pytest
from support.drives import a_job, path_chunks, up_and_down
from support.field_files import task_data, zipped
from support.recordings import driven_live

from guidance_app.batch.ledgers import Choice, day_of, ledger_entries
from guidance_app.batch.taking_in import taken_in
from guidance_app.exchange.time_log import Instant, LoggedValue, written_log
from guidance_app.recording import RecordingMeta
from guidance_app.store import StoreError
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_keeping import bring_back, remove_recording
from guidance_app.store.recordings_list import list_recordings, resumable
from guidance_app.store.recordings_writing import RecordingFolder


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The zip of a recorded drive."""
    folder, _ = driven_live(tmp_path_factory.mktemp("driven"), path_chunks(up_and_down(passes=1)), a_job())
    return zip_of(folder)


def zip_of(folder: Path, inside: str = "", leave_out: str = "") -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for path in folder.iterdir():
            if path.name != leave_out:
                archive.write(path, inside + path.name)
    return content.getvalue()


def test_what_is_taken_in_is_the_same_drive_and_over(tmp_path: Path, drive: bytes) -> None:
    (folder,), told = taken_in(tmp_path, drive, "drive.zip")
    original = tmp_path / "drive.zip"
    original.write_bytes(drive)
    assert list(open_recording(folder).events) == list(open_recording(original).events)
    assert told == ()
    (listed,) = list_recordings(tmp_path)
    assert listed.summary is not None
    assert listed.summary.ended
    assert resumable(tmp_path) is None


def test_a_zipped_folder_is_taken_in_too_and_the_same_twice_is_not(tmp_path: Path, drive: bytes) -> None:
    (folder,), _ = taken_in(tmp_path, drive, "drive.zip")
    with pytest.raises(StoreError, match=f"in the list already: {folder.name}"):
        taken_in(tmp_path, zip_of(folder, inside="my drive/"), "again.zip")


def test_a_removed_recording_comes_back_as_it_was(tmp_path: Path, drive: bytes) -> None:
    (folder,), _ = taken_in(tmp_path, drive, "drive.zip")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    removed = remove_recording(tmp_path, folder)
    assert list_recordings(tmp_path) == ()
    bring_back(tmp_path, removed)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_one_that_is_being_written_is_not_removed(tmp_path: Path) -> None:
    meta = RecordingMeta(
        program="test", started_utc="2026-05-04T06:00:00Z", source="none", filter="adaptive", job=a_job()
    )
    writing = RecordingFolder.create(tmp_path, meta)
    writing.append(b"")
    with pytest.raises(StoreError, match="being recorded now"):
        remove_recording(tmp_path, writing.path)
    writing.close()
    remove_recording(tmp_path, writing.path)


def test_nothing_is_kept_of_what_is_no_drive(tmp_path: Path, drive: bytes) -> None:
    (folder,), _ = taken_in(tmp_path / "good", drive, "drive.zip")
    (folder / "events.jsonl.gz").write_bytes(b"")
    for content, says in (
        (b"no zip", "is no recording, and not ISOXML"),
        (drive[: len(drive) // 2], "is no recording"),
        (zip_of(folder), "holds no event"),
        (zip_of(folder, leave_out="events.jsonl.gz"), r"there is no events\.jsonl"),
    ):
        with pytest.raises(StoreError, match=says):
            taken_in(tmp_path, content, "x.zip")
    assert list_recordings(tmp_path) == ()


def test_of_several_time_logs_the_damaged_one_is_left_out_and_said(tmp_path: Path) -> None:
    instants = [Instant(1.7e9 + n, (41.93 + n / 111_100, -4.87), 700.0, {"D": 4.0}, {0: 1}) for n in range(20)]
    head, body = written_log([LoggedValue(141, "DET-1")], instants)
    tasks = "".join(f'<TSK A="TSK{n}" B="Sowing"><TLG A="TLG0000{n}"/></TSK>' for n in (1, 2))
    files = {"TASKDATA.XML": task_data(tasks), "TLG00001.XML": head, "TLG00001.BIN": body}
    folders, told = taken_in(tmp_path, zipped(files | {"TLG00002.XML": b"<", "TLG00002.BIN": body}), "up.zip")
    assert len(folders) == 1
    assert any("TLG00002 was left out" in one for one in told)
    with pytest.raises(StoreError, match="TLG00002 was left out"):
        taken_in(
            tmp_path,
            zipped({"TASKDATA.XML": task_data(tasks), "TLG00002.XML": b"<", "TLG00002.BIN": body}),
            "up.zip",
        )


def test_the_ledger_takes_the_days_and_the_field_that_were_chosen(tmp_path: Path, drive: bytes) -> None:
    (folder,), _ = taken_in(tmp_path, drive, "drive.zip")
    heard: list[tuple[int, float]] = []
    assert len(ledger_entries([folder], tmp_path, lambda number, done: heard.append((number, done))).entries) == 1
    assert heard[-1] == (0, 1.0)
    (listed,) = list_recordings(tmp_path)
    day = day_of(listed)
    assert day is not None
    before, later = day - datetime.timedelta(days=1), day + datetime.timedelta(days=1)
    choices = (
        Choice(day, day),
        Choice(last=later),
        Choice(first=later),
        Choice(last=before),
        Choice(field="elsewhere"),
    )
    assert [choice.takes(listed) for choice in choices] == [True, True, False, False, False]


def test_what_cannot_be_opened_is_left_out_of_the_ledger_and_said(tmp_path: Path, drive: bytes) -> None:
    (folder,), _ = taken_in(tmp_path, drive, "drive.zip")
    found = ledger_entries([tmp_path / "nothing", folder], tmp_path)
    assert len(found.entries) == 1
    assert "there is no recording" in found.left_out[0]
