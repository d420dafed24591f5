"""Sessions: a replay that was wound to and fro says the same as one that played through; live threads end."""

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.drives import a_job, path_chunks, up_and_down

from guidance_app.model import Chunk, LinkStatus, SetLookAhead, SetWork, Snapshot, SourceDown, SourceUp, TakePass
from guidance_app.runtime import LiveSession, ReplaySession
from guidance_app.sources.file import FileLog, load_log

PATIENCE = 60.0


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> FileLog:
    path = tmp_path_factory.mktemp("drive") / "drive.nmea"
    path.write_bytes(b"".join(chunk.data for chunk in path_chunks(up_and_down(passes=5))))
    return load_log(path)


class Hearing:
    """Waits for a snapshot that fulfils a condition."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._newest: Snapshot | None = None

    def __call__(self, snapshot: Snapshot) -> None:
        with self._changed:
            self._newest = snapshot
            self._changed.notify_all()

    def wait(self, fulfilled) -> Snapshot:
        with self._changed:
            done = self._changed.wait_for(lambda: self._newest is not None and fulfilled(self._newest), PATIENCE)
        assert done, f"not in {PATIENCE} s"
        return self._newest


@pytest.fixture
def session(drive: FileLog) -> Iterator[ReplaySession]:
    made = ReplaySession(a_job(), drive, speed=float("inf"))
    yield made
    made.close()


def ended(snapshot: Snapshot) -> bool:
    return snapshot.link.status is LinkStatus.ENDED


def test_a_replay_plays_to_the_end_and_says_so(session: ReplaySession) -> None:
    hearing = Hearing()
    session.subscribe(hearing)
    session.start()
    last = hearing.wait(ended)
    assert session.replay.state.ended
    assert last.totals.worked > 0
    assert session.now() == pytest.approx(session.replay.state.duration)


def test_after_jumps_to_and_fro_the_second_is_the_same_to_the_bit(session: ReplaySession) -> None:
    hearing = Hearing()
    session.subscribe(hearing)
    session.start()
    through = hearing.wait(ended)
    session.replay.pause()
    seen = {}
    for position in (90.0, 15.0, 150.0, 61.0, 90.0):
        session.replay.seek(position)
        snapshot = hearing.wait(
            lambda one, at=position: (
                not ended(one) and at - 0.25 <= one.arrival <= at and session.replay.catching_up is None
            )
        )
        if position in seen:
            assert snapshot.pose == seen[position].pose
            assert snapshot.totals == seen[position].totals
            assert snapshot.guidance.cross_track == seen[position].guidance.cross_track
        seen[position] = snapshot
    session.replay.set_speed(float("inf"))
    session.replay.play()
    again = hearing.wait(ended)
    assert again.pose == through.pose
    assert again.totals == through.totals
    assert again.generation > through.generation


def test_a_command_acts_again_when_its_place_is_passed_again(session: ReplaySession) -> None:
    hearing = Hearing()
    session.subscribe(hearing)
    session.replay.seek(50.0)
    session.start()
    session.replay.pause()
    session.replay.seek(50.0)
    hearing.wait(lambda one: 49.0 < one.arrival <= 50.0)
    session.post(SetWork(down=False))
    session.post(SetLookAhead(2.5))
    hearing.wait(lambda one: one.work_mode.value == "button" and one.look_ahead_s == 2.5)
    session.replay.seek(10.0)
    before = hearing.wait(lambda one: one.arrival <= 10.0)
    assert before.work_mode.value == "auto"
    assert before.look_ahead_s == 2.5
    session.replay.seek(60.0)
    after = hearing.wait(lambda one: 59.0 < one.arrival <= 60.0)
    assert after.work_mode.value == "button"


class Written:
    """A live source that gives what it was made of, then waits until it is stopped."""

    description = "a written source"
    duration = None
    live = True

    def __init__(self, chunks: list[Chunk], *, fails: bool = False) -> None:
        self._chunks = chunks
        self._fails = fails

    def events(self, stop: threading.Event) -> Iterator[Chunk | SourceUp | SourceDown]:
        yield SourceUp(0.0, self.description)
        yield from self._chunks
        if self._fails:
            msg = "the cable broke"
            raise OSError(msg)
        stop.wait()


def test_a_live_session_guides_and_its_threads_end() -> None:
    before = threading.active_count()
    live = LiveSession(a_job(), Written(path_chunks(up_and_down())))
    hearing = Hearing()
    live.subscribe(hearing)
    live.start()
    hearing.wait(lambda one: one.guidance is not None)
    live.post(TakePass(3))
    hearing.wait(lambda one: one.guidance is not None and one.guidance.target.number == 3)
    live.close()
    assert threading.active_count() == before


def test_a_source_that_fails_is_told_and_the_session_lives() -> None:
    live = LiveSession(a_job(), Written(path_chunks([(15.0, 15.0), (15.0, 40.0)]), fails=True))
    hearing = Hearing()
    live.subscribe(hearing)
    live.start()
    down = hearing.wait(lambda one: one.link.status is LinkStatus.DOWN)
    assert "the cable broke" in down.link.reason
    live.post(SetLookAhead(2.0))
    hearing.wait(lambda one: one.look_ahead_s == 2.0)
    live.close()


def test_a_hearer_that_fails_is_dropped_and_the_others_hear_on(drive: FileLog) -> None:
    session = ReplaySession(a_job(), drive, speed=float("inf"))
    hearing = Hearing()

    def broken(_snapshot: Snapshot) -> None:
        raise RuntimeError

    session.subscribe(broken)
    session.subscribe(hearing)
    session.start()
    hearing.wait(ended)
    session.close()


def test_a_log_is_not_written_to(drive: FileLog, session: ReplaySession, tmp_path: Path) -> None:
    session.start()
    session.close()
    assert not list(tmp_path.iterdir())


# --- epochs that stay incomplete -----------------------------------------------------------------------------------


def without_its_last_sentence(chunks: list[Chunk], every: int) -> list[Chunk]:
    """Now and then the course sentence of an epoch is lost, so that its end is only told by time."""
    return [
        Chunk(
            one.arrival, b"".join(one.data.splitlines(keepends=True)[:-1]) if place % every == every - 1 else one.data
        )
        for place, one in enumerate(chunks)
    ]


def test_a_replay_closes_an_incomplete_epoch_in_its_own_interval(tmp_path: Path) -> None:
    chunks = without_its_last_sentence(path_chunks(up_and_down(passes=1)), every=7)
    path = tmp_path / "lossy.nmea"
    path.write_bytes(b"".join(chunk.data for chunk in chunks))
    session = ReplaySession(a_job(), load_log(path), speed=float("inf"))
    session._publisher.least_interval = 0.0  # every snapshot is told, so that none is missed in which a fix is new
    late: dict[float, float] = {}

    def hear(snapshot: Snapshot) -> None:
        if snapshot.fix_interval is not None and snapshot.link.status is LinkStatus.FIX:
            late.setdefault(snapshot.fix.t, snapshot.arrival - snapshot.fix.arrival)

    hearing = Hearing()
    session.subscribe(hear)
    session.subscribe(hearing)
    session.start()
    try:
        last = hearing.wait(ended)
    finally:
        session.close()
    assert last.link.fixes == len(chunks)
    assert len(late) > 0.9 * len(chunks)
    assert 0.0 < max(late.values()) < 0.2


def test_a_replay_on_the_clock_says_the_same_as_one_at_full_speed(tmp_path: Path) -> None:
    chunks = without_its_last_sentence(path_chunks(up_and_down(passes=1))[:60], every=7)
    path = tmp_path / "lossy.nmea"
    path.write_bytes(b"".join(chunk.data for chunk in chunks))
    told = []
    for speed in (float("inf"), 50.0):
        session = ReplaySession(a_job(), load_log(path), speed=speed)
        hearing = Hearing()
        session.subscribe(hearing)
        session.start()
        told.append(hearing.wait(ended))
        session.close()
    assert told[0].pose == told[1].pose
    assert told[0].sequence == told[1].sequence
