"""Live sessions over written events, recorded into a data folder, and engines that take a recording again."""

import contextlib
import queue
import threading
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.model import Chunk, Command, LinkStatus, Snapshot, SourceDown, SourceUp
from guidance_app.recording import RecordedDrive
from guidance_app.runtime import LiveSession
from guidance_app.runtime.recorder import new_recording
from guidance_app.runtime.stepping import stepped
from support.drives import a_job

PATIENCE = 150.0


class Script:
    """A source that gives chunks at once; a command in its place is posted to the session before the next chunk.

    With ``waits`` it stays open at the end, as a receiver's wire does.
    """

    description = "a written source"
    duration = None
    live = True

    def __init__(self, steps: Iterable[Chunk | Command], *, waits: bool = False) -> None:
        self._steps = steps
        self._waits = waits
        self.session: LiveSession | None = None
        self.given = threading.Event()

    def events(self, stop: threading.Event) -> Iterator[Chunk | SourceUp | SourceDown]:
        yield SourceUp(0.0, self.description)
        arrival = 0.0
        for step in self._steps:
            if isinstance(step, Chunk):
                arrival = step.arrival
                yield step
            else:
                assert self.session is not None
                self.session.post(step)
        self.given.set()
        if self._waits:
            stop.wait()
        else:
            yield SourceDown(arrival, "the script has ended", ended=True)


class Heard:
    """Keeps every snapshot it hears, and waits for one that fulfils a condition."""

    def __init__(self, session: LiveSession) -> None:
        self._changed = threading.Condition()
        self.snapshots: list[Snapshot] = [session.snapshot()]
        session.subscribe(self)

    def __call__(self, snapshot: Snapshot) -> None:
        with self._changed:
            self.snapshots.append(snapshot)
            self._changed.notify_all()

    def wait(self, fulfilled) -> Snapshot:
        with self._changed:
            done = self._changed.wait_for(lambda: fulfilled(self.snapshots[-1]), PATIENCE)
            assert done, f"not in {PATIENCE} s: {self.snapshots[-1].link}"
            return self.snapshots[-1]


def is_over(snapshot: Snapshot) -> bool:
    return snapshot.link.status in {LinkStatus.ENDED, LinkStatus.DOWN}


def driven_live(
    data: Path, steps: Sequence[Chunk | Command], job: Job | None = None, filter_name: str | None = None
) -> tuple[Path, list[Snapshot]]:
    """Drives a recorded session to the script's end; the recording's folder and the snapshots heard."""
    job = job or a_job()
    source = Script(steps)
    recorder = new_recording(data, job, source.description, filter_name)
    session = LiveSession(job, source, filter_name, recorder=recorder)
    source.session = session
    heard = Heard(session)
    session.start()
    heard.wait(is_over)
    session.close()
    return recorder.path, heard.snapshots


def taken_again(drive: RecordedDrive) -> dict[int, Snapshot]:
    """Every snapshot of an engine that takes the recording, by its number."""
    engine = Engine(drive.job, filter_name=drive.filter_name, settings=drive.settings, notices=drive.notices)
    made = [engine.snapshot]
    made += [stepped(engine, event) for event in drive.events]
    return {one.sequence: one for one in made}


def assert_same(live: Snapshot, replayed: Snapshot) -> None:
    """Equal to the bit in all that a driver sees and a report counts."""
    for member in ("arrival", "link", "fix", "pose", "implement", "totals", "offsets", "working", "work_mode"):
        assert getattr(live, member) == getattr(replayed, member), member
    assert live.notices == replayed.notices
    for member in ("cross_track", "heading_error", "along_track", "done", "on_pass"):
        assert getattr(live.guidance, member, None) == getattr(replayed.guidance, member, None), member
    if live.prediction is not None:
        assert live.prediction == replayed.prediction
        assert live.prediction.arc.tobytes() == replayed.prediction.arc.tobytes()
    assert (live.track is None) == (replayed.track is None)
    if live.track is not None:
        assert live.track.count == replayed.track.count
        for ours, theirs in zip(live.track.pieces[: live.track.count], replayed.track.pieces, strict=False):
            assert ours.tobytes() == theirs.tobytes()


class Fed:
    """A source that gives what a test feeds it."""

    description = "a fed source"
    duration = None
    live = True

    def __init__(self) -> None:
        self._fed: queue.SimpleQueue[Chunk] = queue.SimpleQueue()

    def give(self, chunks: Iterable[Chunk]) -> None:
        for chunk in chunks:
            self._fed.put(chunk)

    def events(self, stop: threading.Event) -> Iterator[Chunk | SourceUp]:
        yield SourceUp(0.0, self.description)
        while not stop.is_set():
            with contextlib.suppress(queue.Empty):
                yield self._fed.get(timeout=0.02)
