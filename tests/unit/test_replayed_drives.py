"""A recorded drive replayed: the same to the bit, from anywhere, by pass, with an index, and beside another filter."""

import multiprocessing
import shutil
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.drives import a_job, path_chunks, up_and_down
from support.recordings import Heard, assert_same, driven_live, is_over, taken_again

from guidance_app.estimation.filter import FilterSettings
from guidance_app.model import Chunk, Commanded, LinkStatus, Nudge, SetLookAhead, SetWork, Snapshot
from guidance_app.recording import RecordedDrive
from guidance_app.runtime import Comparison, ReplaySession
from guidance_app.runtime.engines import Engines, Setup
from guidance_app.runtime.indexing import Index, IndexPart, index_parts
from guidance_app.runtime.timeline import timeline_of
from guidance_app.sources.file import FileLog
from guidance_app.store.recordings import open_recording

PATIENCE = 60.0
METRE = 1.0


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> RecordedDrive:
    steps: list = list(path_chunks(up_and_down(passes=5)))
    for place, command in ((600, SetWork(down=True)), (400, Nudge(0.3)), (300, SetLookAhead(2.0))):
        steps.insert(place, command)
    return open_recording(driven_live(tmp_path_factory.mktemp("data"), steps)[0])


@pytest.fixture(scope="module")
def known(drive: RecordedDrive) -> list[Snapshot]:
    made = taken_again(drive)
    return [made[number] for number in sorted(made)]


@pytest.fixture
def session(drive: RecordedDrive) -> Iterator[ReplaySession]:
    made = ReplaySession.of_drive(drive, speed=float("inf"))
    yield made
    made.close()


def at(known: list[Snapshot], position: float) -> Snapshot:
    """What the engine knew at this second."""
    return [one for one in known if one.arrival <= position][-1]


def sought(session: ReplaySession, heard: Heard, position: float) -> Snapshot:
    session.replay.pause()
    session.replay.seek(position)
    return heard.wait(
        lambda one: (
            one.link.status is not LinkStatus.ENDED
            and abs(one.arrival - position) < 0.5
            and session.replay.catching_up is None
        )
    )


def test_a_replayed_drive_is_the_drive(session: ReplaySession, known: list[Snapshot]) -> None:
    heard = Heard(session)
    session.start()
    heard.wait(is_over)
    by_number = {one.sequence: one for one in known}
    compared = [one for one in heard.snapshots if not is_over(one)]
    for snapshot in compared:
        assert_same(snapshot, by_number[snapshot.sequence])
    assert heard.snapshots[-1].totals == known[-1].totals


def test_any_second_is_the_same_however_one_came_there(session: ReplaySession, known: list[Snapshot]) -> None:
    heard = Heard(session)
    session.start()
    heard.wait(is_over)
    for position in (100.0, 20.0, 150.0, 60.0):
        found, live = sought(session, heard, position), at(known, position)
        assert found.pose == live.pose
        assert found.totals == live.totals
        assert found.look_ahead_s == live.look_ahead_s
        assert found.offsets == live.offsets


def test_the_watchers_look_ahead_goes_before_the_recorded_one(session: ReplaySession) -> None:
    heard = Heard(session)
    session.start()
    session.replay.pause()
    session.post(SetLookAhead(0.7))
    heard.wait(lambda one: one.look_ahead_s == 0.7)
    assert sought(session, heard, 150.0).look_ahead_s == 0.7


def test_passes_are_found_and_jumped_to(session: ReplaySession) -> None:
    heard = Heard(session)
    assert not session.replay.seek_pass(2)
    session.start()
    heard.wait(is_over)
    starts = session.replay.passes
    assert len(starts) >= 3
    assert [one.position for one in starts] == sorted(one.position for one in starts)
    session.replay.pause()
    wanted = starts[2]
    assert session.replay.seek_pass(wanted.number)
    first = next(one for one in starts if one.number == wanted.number)
    heard.wait(lambda one: abs(one.arrival - (first.position - 2.0)) < 0.5 and not is_over(one))


# --- the index --------------------------------------------------------------------------------------------------------


EVERY = 20.0


def collected(drive: RecordedDrive | FileLog, folder: Path | None, setup: Setup) -> list[IndexPart]:
    parts: list[IndexPart] = []
    index = Index(timeline_of(drive), setup, parts.append, folder, EVERY)
    index.start()
    assert index.wait(PATIENCE)
    assert index.done == 1.0
    index.close()
    return parts


@pytest.fixture(scope="module")
def setup(drive: RecordedDrive) -> Setup:
    return Setup(drive.job, drive.filter_name, drive.settings, drive.notices)


@pytest.fixture(scope="module")
def made(drive: RecordedDrive, setup: Setup, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[IndexPart]]:
    """A cache with the drive's index, and the parts as the process gave them."""
    folder = tmp_path_factory.mktemp("cache") / "indexes"
    return folder, collected(drive, folder, setup)


@pytest.fixture
def cache(made: tuple[Path, list[IndexPart]], tmp_path: Path) -> Path:
    return Path(shutil.copytree(made[0], tmp_path / "cache"))


def test_an_index_is_read_from_the_cache_and_goes_on_to_the_bit(
    drive: RecordedDrive, setup: Setup, known: list[Snapshot], made: tuple[Path, list[IndexPart]], cache: Path
) -> None:
    (kept,) = cache.iterdir()
    content = kept.read_bytes()
    read = collected(drive, cache, setup)
    assert kept.read_bytes() == content
    assert len(made[1]) == len(read) > 5
    for one, other in zip(made[1], read, strict=True):
        assert one.starts == other.starts
    checkpoint = read[3].checkpoint
    assert checkpoint is not None
    engines = checkpoint.engines.fork()
    for event in drive.events[checkpoint.index :]:
        engines.step(event)
    assert_same(engines.snapshot, known[-1])


def test_a_damaged_index_is_made_again(drive: RecordedDrive, setup: Setup, cache: Path) -> None:
    (kept,) = cache.iterdir()
    content = kept.read_bytes()
    kept.write_bytes(content[: len(content) // 2])
    parts = collected(drive, cache, setup)
    assert parts[-1].done == 1.0
    assert kept.stat().st_size > 0.9 * len(content)


def test_another_setup_has_another_index(drive: RecordedDrive, cache: Path) -> None:
    other = Setup(drive.job, "off", FilterSettings(), compare=Comparison(look_ahead=2.5, settings=FilterSettings()))
    collected(drive, cache, other)
    assert len(list(cache.glob("*.index"))) == 2


def test_a_session_with_an_index_knows_all_passes_and_jumps_ahead_at_once(
    drive: RecordedDrive, known: list[Snapshot], cache: Path
) -> None:
    session = ReplaySession.of_drive(drive)
    session.make_index(cache, EVERY)
    assert session.wait_for_index(PATIENCE)
    heard = Heard(session)
    session.start()
    assert session.replay.state.indexed == 1.0
    assert len(session.replay.passes) >= 3
    found = sought(session, heard, 150.0)
    assert found.pose == at(known, 150.0).pose
    assert found.totals == at(known, 150.0).totals
    session.close()


def test_what_an_index_says_is_dropped_after_a_command(drive: RecordedDrive, cache: Path) -> None:
    session = ReplaySession.of_drive(drive)
    heard = Heard(session)
    session.start()
    sought(session, heard, 30.0)
    session.post(SetWork(down=False))
    heard.wait(lambda one: not one.working and one.work_mode == "button")
    session.make_index(cache, EVERY)
    assert session.wait_for_index(PATIENCE)
    found = sought(session, heard, 70.0)
    assert found.work_mode == "button"
    assert not found.working
    session.close()


def test_parts_of_a_logs_index_close_epochs_as_a_session_does() -> None:
    chunks = [
        Chunk(one.arrival, b"".join(one.data.splitlines(keepends=True)[:-1]) if place % 7 == 6 else one.data)
        for place, one in enumerate(path_chunks(up_and_down(passes=1)))
    ]
    log = FileLog("a log", b"".join(one.data for one in chunks))
    session = ReplaySession(a_job(), log, speed=float("inf"))
    heard = Heard(session)
    session.start()
    last = heard.wait(is_over)
    session.close()
    *_, checkpoint = (
        part.checkpoint for part in index_parts(timeline_of(log), Setup(a_job()), 10.0) if part.checkpoint
    )
    engines = checkpoint.engines.fork()
    for event in log.chunks[checkpoint.index :]:
        engines.step(event)
    assert engines.snapshot.pose == last.pose
    assert engines.snapshot.totals.worked == pytest.approx(last.totals.worked, abs=METRE)


def test_closing_ends_the_process_of_an_index(drive: RecordedDrive) -> None:
    session = ReplaySession.of_drive(drive)
    session.make_index(None)
    indexing = next(one for one in threading.enumerate() if one.name == "index")
    session.close()
    indexing.join(PATIENCE)  # on a busy machine it outlives the seconds that closing waits
    assert not indexing.is_alive()
    assert not [one for one in multiprocessing.active_children() if one.name == "index"]


# --- beside another filter --------------------------------------------------------------------------------------------


def test_a_ghost_drives_beside(drive: RecordedDrive, known: list[Snapshot]) -> None:
    compare = Comparison(filter_name="off", look_ahead=3.0, antenna=(0.0, 1.0, 0.0))
    session = ReplaySession.of_drive(drive, speed=float("inf"), compare=compare)
    heard = Heard(session)
    session.start()
    last = heard.wait(is_over)
    session.close()
    assert last.totals == known[-1].totals
    assert last.ghost is not None
    assert last.ghost.filter_name == "off"
    assert last.ghost.prediction is not None
    assert last.ghost.prediction.look_ahead_s == 3.0
    assert last.pose is not None
    assert last.ghost.pose is not None
    apart = ((last.pose.east - last.ghost.pose.east) ** 2 + (last.pose.north - last.ghost.pose.north) ** 2) ** 0.5
    assert apart == pytest.approx(METRE, abs=0.2)
    assert last.ghost.track is not None
    assert last.ghost.track.count > 0
    assert all(one.ghost is None for one in known)


def test_a_second_engine_keeps_its_look_ahead() -> None:
    engines = Engines.made_of(Setup(a_job(), compare=Comparison(look_ahead=2.5)))
    engines.step(Commanded(0.0, SetLookAhead(1.0)))
    copied = engines.fork(generation=3)
    assert copied.snapshot.look_ahead_s == 1.0
    assert copied.snapshot.generation == 3


def test_what_documents_cannot_hold_is_refused() -> None:
    with pytest.raises(ValueError, match="look_ahead"):
        Engines.made_of(Setup(a_job(), compare=Comparison(look_ahead=9.0)))
    with pytest.raises(ValueError, match="antenna_height"):
        Engines.made_of(Setup(a_job(), compare=Comparison(antenna=(0.0, 0.0, 99.0))))


def test_passes_are_stepped_through(session: ReplaySession) -> None:
    heard = Heard(session)
    session.start()
    heard.wait(is_over)
    session.replay.pause()
    starts = [one.position for one in session.replay.passes]
    assert not session.replay.step_pass(1)

    def position() -> float:
        return session.replay.state.position + 2.0

    session.replay.seek(starts[1] - 2.0)
    assert session.replay.step_pass(1)
    assert position() == pytest.approx(starts[2])
    session.replay.seek(starts[1] + 20.0)
    assert session.replay.step_pass(-1)
    assert position() == pytest.approx(starts[1])
    assert session.replay.step_pass(-1)
    assert position() == pytest.approx(max(starts[0], 2.0))
    assert not session.replay.step_pass(-1)


def test_an_index_that_cannot_be_kept_is_there_all_the_same(drive: RecordedDrive, setup: Setup, tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file stands here", encoding="utf-8")
    assert collected(drive, tmp_path / "cache", setup)[-1].done == 1.0
