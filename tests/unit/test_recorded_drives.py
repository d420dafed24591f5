"""A live drive is recorded, listed, opened, gone on with; what is broken or foreign is said in words."""

import gzip
import json
import os
import shutil
import zipfile
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import TimeoutError as FuturesTimeoutError
from contextlib import suppress
from pathlib import Path

import pytest
from support.drives import a_job, path_chunks, up_and_down
from support.recordings import Heard, Script, assert_same, driven_live, is_over, taken_again

from guidance_app import decoding_beside
from guidance_app.model import Chunk, LineHere, Nudge, OffsetKind, SetLookAhead, SetWork, TakePass
from guidance_app.runtime import LiveSession
from guidance_app.runtime.recorder import Recorder, new_recording
from guidance_app.store import StoreError
from guidance_app.store.files import try_lock
from guidance_app.store.recordings import EVENTS, PACKED, SESSION, SUMMARY, is_recording, open_recording
from guidance_app.store.recordings_list import finish_recording, list_recordings, resumable
from guidance_app.store.recordings_writing import LOCK, RecordingFolder, is_being_written

MICROSECOND = 1e-6


def a_drive(passes: int = 3) -> list:
    """Bytes with the driver's wishes between them."""
    chunks = path_chunks(up_and_down(passes=passes))
    steps: list = list(chunks)
    for place, command in ((700, SetWork(down=True)), (500, TakePass(3)), (300, Nudge(0.2)), (200, SetLookAhead(2.0))):
        if place < len(steps):
            steps.insert(place, command)
    return steps


@pytest.fixture(scope="module")
def ended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return driven_live(tmp_path_factory.mktemp("data"), a_drive())[0]


@pytest.fixture
def recording(ended: Path, tmp_path: Path) -> Path:
    """A copy to break."""
    return Path(shutil.copytree(ended, tmp_path / "recordings" / ended.name))


def cut_off(recording: Path, part: float) -> Path:
    """As a power cut leaves a folder: plain events up to some byte."""
    text = gzip.decompress((recording / PACKED).read_bytes())
    (recording / EVENTS).write_bytes(text[: int(part * len(text))])
    (recording / PACKED).unlink()
    summary = json.loads((recording / SUMMARY).read_text(encoding="utf-8"))
    (recording / SUMMARY).write_text(json.dumps(summary | {"ended": False}), encoding="utf-8")
    return recording


def test_an_ended_drive_is_packed_whole_and_holds_its_inputs(ended: Path) -> None:
    assert {path.name for path in ended.iterdir()} == {SESSION, PACKED, SUMMARY}
    drive = open_recording(ended)
    assert drive.truncated is None
    assert drive.job == a_job()
    assert drive.filter_name == "quantisation_kf"
    assert [type(one).__name__ for one in drive.events[:2]] == ["SourceUp", "Chunk"]
    assert b"".join(one.data for one in drive.chunks) == b"".join(
        one.data for one in a_drive() if isinstance(one, Chunk)
    )
    assert drive.duration == pytest.approx(drive.events[-1].arrival, abs=MICROSECOND)


def test_what_was_live_comes_back_to_the_bit(tmp_path: Path) -> None:
    folder, heard = driven_live(tmp_path, a_drive())
    replayed = taken_again(open_recording(folder))
    assert len(heard) > 3
    for snapshot in heard:
        assert_same(snapshot, replayed[snapshot.sequence])
    assert any(one.kind is OffsetKind.NUDGE for one in heard[-1].offsets)


def test_the_list_reads_no_events(recording: Path) -> None:
    (recording / PACKED).write_bytes(b"these are no events")
    (listed,) = list_recordings(recording.parent.parent)
    assert listed.summary is not None
    assert listed.summary.ended
    assert listed.summary.field == "Square"
    assert listed.summary.passes_planned is not None
    assert listed.summary.worked_m2 is not None
    assert listed.summary.worked_m2 > 100
    assert resumable(recording.parent.parent) is None


def test_a_list_says_what_cannot_be_opened_and_makes_a_missing_summary(recording: Path) -> None:
    data = recording.parent.parent
    (recording / SUMMARY).unlink()
    (listed,) = list_recordings(data)
    assert listed.summary is not None
    assert listed.summary.duration_s == open_recording(recording).duration
    assert (recording / SUMMARY).is_file()
    (recording / SUMMARY).unlink()
    (recording / SESSION).write_text("{", encoding="utf-8")
    (broken,) = list_recordings(data)
    assert broken.summary is None
    assert broken.problem is not None
    assert list_recordings(data / "nowhere") == ()


def test_whoever_asks_who_writes_keeps_no_writer_out(recording: Path) -> None:
    for _ in range(20):
        asking = os.open(recording / LOCK, os.O_RDWR | os.O_CREAT)  # as a power cut leaves it
        assert try_lock(asking)
        with ThreadPoolExecutor(1) as pool:
            writer = pool.submit(RecordingFolder, recording)
            with suppress(FuturesTimeoutError):
                writer.result(timeout=0.02)
            os.close(asking)
            writer.result().close()


@pytest.mark.parametrize("long", [1, decoding_beside.LONG])
def test_a_drive_that_was_cut_off_can_be_gone_on_with(
    recording: Path, long: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(decoding_beside, "LONG", long)
    data = cut_off(recording, 0.6123).parent.parent
    drive = open_recording(recording)
    assert drive.truncated is not None
    assert "breaks off at 0:0" in drive.truncated
    found = resumable(data)
    assert found is not None
    assert found.path == recording
    assert found.passes_planned
    folder, past = RecordingFolder.go_on(recording)
    assert is_being_written(recording)
    assert resumable(data) is None
    rest = [Chunk(one.arrival, one.data) for one in a_drive() if isinstance(one, Chunk)][-200:]
    source = Script(rest)
    heard_parts: list[float] = []
    session = LiveSession.resumed(past, source, Recorder(folder, past), heard_parts.append)
    assert heard_parts
    before = session.snapshot()
    assert before.totals == taken_again(drive)[before.sequence - 1].totals
    heard = Heard(session)
    session.start()
    assert session.now() >= past.duration
    heard.wait(lambda one: is_over(one) and one.link.reason.startswith("the script"))
    session.close()
    assert not is_being_written(recording)
    whole = open_recording(recording)
    assert whole.truncated is None
    assert list(whole.events)[: len(past.events)] == list(past.events)
    replayed = taken_again(whole)
    for snapshot in heard.snapshots:
        assert_same(snapshot, replayed[snapshot.sequence])
    assert heard.snapshots[-1].totals.worked > before.totals.worked


def test_a_drive_that_is_not_gone_on_with_is_ended(recording: Path) -> None:
    data = cut_off(recording, 0.5).parent.parent
    known = open_recording(recording).events
    finish_recording(recording)
    assert resumable(data) is None
    assert (recording / PACKED).is_file()
    assert not (recording / EVENTS).exists()
    assert list(open_recording(recording).events) == list(known)
    (listed,) = list_recordings(data)
    assert listed.summary is not None
    assert listed.summary.ended


def test_two_programs_do_not_write_one_recording(recording: Path) -> None:
    cut_off(recording, 0.5)
    first, _ = RecordingFolder.go_on(recording)
    with pytest.raises(StoreError, match="another program"):
        RecordingFolder.go_on(recording)
    first.close()
    second, _ = RecordingFolder.go_on(recording)
    second.close()


def test_a_packed_recording_can_be_gone_on_with_too(recording: Path) -> None:
    before = list(open_recording(recording).events)
    folder, past = RecordingFolder.go_on(recording)
    folder.append(b"")
    folder.close()
    assert list(past.events) == before
    assert list(open_recording(recording).events) == before


def test_a_drive_with_nothing_in_it_leaves_nothing(tmp_path: Path) -> None:
    folder, _ = driven_live(tmp_path, [])
    assert not folder.exists()


def test_a_zip_of_a_folder_opens_too(recording: Path, tmp_path: Path) -> None:
    path = tmp_path / "report.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for name in (SESSION, PACKED):
            archive.write(recording / name, name)
    assert is_recording(path)
    assert list(open_recording(path).events) == list(open_recording(recording).events)
    assert open_recording(path).digest == open_recording(recording).digest


# --- what is broken or foreign ---------------------------------------------------------------------------------------


def changed(recording: Path, change) -> None:
    members = json.loads((recording / SESSION).read_text(encoding="utf-8"))
    change(members)
    (recording / SESSION).write_text(json.dumps(members), encoding="utf-8")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda members: members.update(schema_version=99), "newer version"),
        (lambda members: members["job"]["tractor"].update(schema_version=99), "newer version"),
        (lambda members: members["job"].pop("field"), "field 'Square', which its operation names"),
        (lambda members: members["job"].pop("tractor"), "the tractor is not there"),
        (lambda members: members["job"]["tractor"].update(wheelbase="long"), "tractor is broken: wheelbase"),
        (lambda members: members.update(kind="session"), "not that of a recorded drive"),
        (lambda members: members.pop("job"), "holds no documents"),
        (lambda members: members.update(filter=3), "filter"),
        (lambda members: members.update(colour="red"), "colour"),
    ],
)
def test_a_session_that_cannot_be_used_is_said(recording: Path, change, said: str) -> None:
    changed(recording, change)
    with pytest.raises(StoreError, match=said) as caught:
        open_recording(recording)
    assert recording.name in str(caught.value)


@pytest.mark.parametrize("content", ["{", "[]", "\x00" * 40, "[" * 100_000])
def test_a_broken_session_is_said(recording: Path, content: str) -> None:
    (recording / SESSION).write_text(content, encoding="utf-8")
    with pytest.raises(StoreError, match=SESSION):
        open_recording(recording)


def test_what_is_no_recording_is_said(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "text.zip").write_text("no zip", encoding="utf-8")
    with zipfile.ZipFile(tmp_path / "other.zip", "w") as archive:
        archive.writestr("a.txt", "a")
    for name, said in (
        ("empty", "is no recording"),
        ("text.zip", "neither"),
        ("other.zip", "is no recording"),
        ("nowhere", "no recording"),
    ):
        assert not is_recording(tmp_path / name)
        with pytest.raises(StoreError, match=said):
            open_recording(tmp_path / name)


@pytest.mark.parametrize("part", [0.0, 0.3, 0.9])
def test_a_damaged_archive_gives_what_it_still_has(recording: Path, part: float) -> None:
    whole = open_recording(recording)
    content = (recording / PACKED).read_bytes()
    (recording / PACKED).write_bytes(content[: int(part * len(content))])
    drive = open_recording(recording)
    assert list(drive.events) == list(whole.events)[: len(drive.events)]
    if part:
        assert drive.truncated is not None
        assert len(drive.events) > 10


def test_a_folder_with_a_session_alone_is_an_empty_drive(recording: Path) -> None:
    (recording / PACKED).unlink()
    assert len(open_recording(recording).events) == 0
    assert open_recording(recording).duration == 0.0


def test_a_data_folder_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("a file", encoding="utf-8")
    with pytest.raises(StoreError, match="data"):
        new_recording(tmp_path / "data", a_job(), "nothing")


def test_line_here_is_recorded(tmp_path: Path) -> None:
    steps = a_drive()
    steps.insert(400, LineHere())
    folder, heard = driven_live(tmp_path, steps)
    assert any(one.kind is OffsetKind.LINE_HERE for one in heard[-1].offsets)
    last = heard[-1]
    assert_same(last, taken_again(open_recording(folder))[last.sequence])
