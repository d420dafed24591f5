"""A drive that was cut off goes on from the engine that was kept, to the bit; what does not fit is not used."""

import gzip
import pickle
import resource
from pathlib import Path

import numpy as np
import pytest
from support.drives import a_job, path_chunks, up_and_down
from support.recordings import Heard, Script, assert_same, is_over, taken_again

from guidance_app import decoding_beside
from guidance_app.batch.drive_log import drive_log
from guidance_app.batch.reviewing import opened_review
from guidance_app.decoding_beside import DecodedEvents
from guidance_app.engine import Engine
from guidance_app.engine.hearing import Hearing
from guidance_app.model import Chunk, DriveLog, SetWork, Snapshot
from guidance_app.recording import LineWriter, RecordedDrive
from guidance_app.runtime import LiveSession, cache_folder, live, recorded_session, resume_points, resumed_session
from guidance_app.runtime.columns import LiveColumns
from guidance_app.runtime.resume_points import ResumePoints
from guidance_app.store.recordings import EVENTS, PACKED, open_recording

OFTEN_S = 20.0
SHORT_S = 5.0
"""Cut off the end, so that there is something to take again and the newest point still stands before it."""


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GUIDANCE_CACHE", str(tmp_path / "cache"))


def last_of(drive: RecordedDrive) -> Snapshot:
    """Of an engine that took all inputs from the beginning."""
    return list(taken_again(drive).values())[-1]


def steps(passes: int = 3) -> list:
    made: list = list(path_chunks(up_and_down(passes=passes)))
    made.insert(100, SetWork(down=True))
    return made


def killed(data: Path, made: list, monkeypatch: pytest.MonkeyPatch, every: float = OFTEN_S) -> Path:
    """The recording of a drive whose program was killed: the session never learns that it is over."""
    monkeypatch.setattr(live, "KEEP_EVERY", every)
    source = Script(made)
    session = recorded_session(data, a_job(), source)
    source.session = session
    heard = Heard(session)
    session.start()
    heard.wait(is_over)
    recorder, session.recorder = session.recorder, None
    session.close()
    assert recorder is not None
    recorder.close(ended=False)
    return recorder.path


def cut_at(folder: Path, count: int) -> None:
    """Takes the events off that came behind so many."""
    drive = open_recording(folder)
    (folder / EVENTS).write_bytes(drive.lines.text[: drive.lines.size_of(count)])


def points_of(folder: Path) -> tuple[ResumePoints, RecordedDrive]:
    drive = open_recording(folder)
    return ResumePoints(cache_folder(), folder, drive), drive


def test_a_drive_goes_on_from_its_newest_point_and_is_the_same_to_the_bit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = steps()
    folder = killed(tmp_path, made[:-300], monkeypatch)
    drive = open_recording(folder)
    cut_at(folder, int(np.searchsorted(drive.arrivals, drive.duration - SHORT_S)))
    points, drive = points_of(folder)
    found = points.found
    assert found is not None
    assert 0 < found.count < len(drive.events)
    assert_same(found.engine.snapshot, taken_again(drive)[found.engine.snapshot.sequence])
    source = Script([Chunk(one.arrival - drive.duration, one.data) for one in made[-300:]])
    parts: list[float] = []
    session = resumed_session(folder, source, parts.append)
    assert parts
    assert session.snapshot().totals == last_of(drive).totals
    heard = Heard(session)
    session.start()
    heard.wait(lambda one: is_over(one) and one.link.reason.startswith("the script"))
    session.close()
    whole = open_recording(folder)
    assert list(whole.events)[: len(drive.events)] == list(drive.events)
    replayed = taken_again(whole)
    for snapshot in heard.snapshots:
        assert_same(snapshot, replayed[snapshot.sequence])
    assert_columns_kept(folder, tmp_path, monkeypatch)
    assert points_of(folder)[0].found is None
    assert not [*cache_folder().glob("*.point"), *cache_folder().glob("*.rows")]


def assert_columns_kept(folder: Path, data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of the whole drive, although its beginning was not taken again."""
    expected = drive_log(open_recording(folder))
    with monkeypatch.context() as patched:
        patched.setattr("guidance_app.batch.reviewing.gathered", None)
        kept = opened_review(folder, data).log
    for name in DriveLog.columns():
        assert np.array_equal(getattr(kept, name), getattr(expected, name), equal_nan=kept.t.dtype == float), name


def test_a_program_that_is_told_to_stop_keeps_where_it_stands(tmp_path: Path) -> None:
    source = Script(steps(passes=1), waits=True)
    session = recorded_session(tmp_path, a_job(), source)
    source.session = session
    session.start()
    source.given.wait()
    session.close(ended=False)
    assert session.recorder is not None
    points, drive = points_of(session.recorder.path)
    assert points.found is not None
    assert points.found.count == len(drive.events)
    assert_same(points.found.engine.snapshot, last_of(drive))
    again = LiveSession.resumed(drive, Script([]), point=points.found)
    assert again.snapshot().sequence > last_of(drive).sequence


@pytest.fixture
def cut_off(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    return killed(tmp_path, steps(passes=1), monkeypatch, every=10.0)


def test_a_point_that_stands_for_more_than_is_left_is_not_used(cut_off: Path) -> None:
    points, _ = points_of(cut_off)
    assert points.found is not None
    cut_at(cut_off, points.found.count - 1)
    points, drive = points_of(cut_off)
    assert points.found is None
    session = resumed_session(cut_off, Script([]))
    assert session.snapshot().totals == last_of(drive).totals
    session.close()


def test_a_point_of_other_inputs_is_not_used(cut_off: Path) -> None:
    events = cut_off / EVENTS
    drive = open_recording(cut_off)
    write = LineWriter().line
    events.write_bytes(b"".join(write(one) for one in [drive.events[0], *drive.events]))
    points, again = points_of(cut_off)
    assert len(again.events) == len(drive.events) + 1
    assert points.found is None


def test_a_point_of_another_program_or_place_is_not_used(
    cut_off: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drive = open_recording(cut_off)
    assert ResumePoints(cache_folder(), cut_off, drive).found is not None
    assert ResumePoints(cache_folder(), tmp_path / "copy", drive).found is None
    monkeypatch.setattr(resume_points, "program_now", lambda: ["another"])
    assert ResumePoints(cache_folder(), cut_off, drive).found is None


@pytest.mark.parametrize("left", [0, 3, 40, 2000])
def test_a_damaged_point_is_not_used(cut_off: Path, left: int) -> None:
    (point,) = cache_folder().glob("*.point")
    point.write_bytes(point.read_bytes()[:left])
    assert points_of(cut_off)[0].found is None


def test_without_its_rows_a_point_still_serves_and_the_columns_are_made_when_opened(
    cut_off: Path, tmp_path: Path
) -> None:
    for rows in cache_folder().glob("*.rows"):
        rows.unlink()
    points, _ = points_of(cut_off)
    assert points.found is not None
    assert points.found.rows is None
    resumed_session(cut_off, Script([])).close()
    expected = drive_log(open_recording(cut_off))
    assert np.array_equal(opened_review(cut_off, tmp_path).log.t, expected.t)


def test_points_of_the_newest_drives_stay(cut_off: Path, tmp_path: Path) -> None:
    _, drive = points_of(cut_off)
    for name in ("a", "b", "c"):
        points = ResumePoints(cache_folder(), tmp_path / name, drive)
        points.keep(resume_points.ResumePoint(taken_engine(drive), ()))
    assert len(list(cache_folder().glob("*.point"))) == resume_points.KEPT


def taken_engine(drive: RecordedDrive):
    return LiveSession.resumed(drive, Script([]))._engine


def test_where_nothing_can_be_kept_the_drive_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("GUIDANCE_CACHE", str(tmp_path / "file"))
    folder = killed(tmp_path, steps(passes=1), monkeypatch, every=10.0)
    assert "the engine is not kept" in caplog.text
    points, drive = points_of(folder)
    assert points.found is None
    session = resumed_session(folder, Script([]))
    assert session.snapshot().totals == last_of(drive).totals
    session.close()


@pytest.mark.parametrize("long", [1, decoding_beside.LONG])
def test_bytes_are_decoded_from_the_middle_of_a_drive_on(long: int) -> None:
    chunks = list(path_chunks(up_and_down(passes=1)))[:200]
    before, whole = Hearing(), Hearing()
    for chunk in chunks[:101]:
        before.hear(chunk)
    expected = [whole.hear(chunk) for chunk in chunks][101:]
    kept = pickle.dumps(before)
    decoded = DecodedEvents(chunks[101:], long, before)
    heard = [before.hear(event) if one is None else one for event, one in decoded]
    assert heard == expected
    if long == 1:
        assert decoded.hearing is not None
        assert pickle.dumps(before) == kept


def test_a_packed_drive_has_the_same_inputs(cut_off: Path) -> None:
    points, _ = points_of(cut_off)
    (cut_off / PACKED).write_bytes(gzip.compress((cut_off / EVENTS).read_bytes()))
    (cut_off / EVENTS).unlink()
    assert points.found is not None
    again, _ = points_of(cut_off)
    assert again.found is not None
    assert again.found.count == points.found.count


def test_columns_that_the_disk_does_not_take_any_more_are_left_in_peace() -> None:
    columns = LiveColumns()
    heard = taken_snapshots(path_chunks(up_and_down(passes=1))[:3])
    for snapshot in heard:
        columns.look_at(snapshot)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10, before[1]))
    try:
        columns.flush()
        assert columns.whole() is None
        columns.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def taken_snapshots(chunks: list[Chunk]) -> list[Snapshot]:
    engine = Engine(a_job())
    return [engine.step(chunk) for chunk in chunks]
