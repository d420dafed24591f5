"""How soon a long recording is gone on with after a stop, and open for looking back.

Going on: from the newest resume point, and without one from the beginning. Looking back: with the columns kept while
driving, again, and without them.
"""

import shutil
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from guidance_app.batch.reviewing import opened_review
from guidance_app.bench.rows import Row, Subparsers, add_bench, add_hours
from guidance_app.bench.streams import Day, day_of_work
from guidance_app.engine import Engine
from guidance_app.model import RECEIVER
from guidance_app.runtime import LiveSession, new_recording, resumed_session
from guidance_app.runtime.stepping import stepped
from guidance_app.sources import SourceEvent
from guidance_app.store.recordings_writing import RecordingFolder
from guidance_app.store.reviews import KEPT

__all__ = ["add_parser", "measured"]

AT_ONCE = 600.0
"""Seconds of the day that are given to the recorder before it is waited for, as a drive never hurries ahead of it."""


def add_parser(subparsers: Subparsers) -> None:
    """Describes the bench."""
    parser = add_bench(
        subparsers,
        "review",
        lambda given: measured(given.hours),
        about="going on with a long drive after a stop, and opening it for looking back",
        does="Drives and records a simulated day's work (10 Hz, GGA RMC VTG) at full speed, goes on with it, opens it.",
    )
    add_hours(parser)


def measured(hours: float) -> list[Row]:
    """Every row of this bench."""
    with tempfile.TemporaryDirectory(prefix="guidance-bench-") as name:
        data = Path(name)
        recording = _driven(day_of_work(hours=hours), data)
        note = f"{hours:g} h, 10 Hz"
        gone_on = list(_gone_on(recording, note))
        driven = _opened("open, first time, driven here", recording, data, "<= 20", note)
        again = _opened("open, second time", recording, data, "<= 2", note)
        shutil.rmtree(data / KEPT)
        elsewhere = _opened("open, first time, from elsewhere", recording, data, "<= 20", "once through the engine")
        return [*gone_on, driven, again, elsewhere]


def _driven(day: Day, data: Path) -> Path:
    """The folder of the day's recording, made as a live session makes it, without its pace, and stopped."""
    recorder, engine = new_recording(data, day.job, "bench"), Engine(day.job)
    never, following = threading.Event(), AT_ONCE
    for chunk in day.chunks():
        recorder.take(chunk)
        stepped(engine, chunk, recorder.look_at)
        if chunk.arrival >= following:
            following += AT_ONCE
            while recorder.flushed_to < chunk.arrival:
                never.wait(0.02)
            recorder.keep(engine.fork(), (RECEIVER,))
    recorder.close(ended=False)
    return recorder.path


class _Silent:
    """A source that gives nothing."""

    description = "nothing"
    duration: float | None = None
    live = True

    def events(self, stop: threading.Event) -> Iterator[SourceEvent]:
        """None at all."""
        del stop
        yield from ()


def _gone_on(recording: Path, note: str) -> Iterator[Row]:
    """Until the drive could go on. The second time it ends the drive."""
    begin = time.perf_counter()
    writing, drive = RecordingFolder.go_on(recording)
    LiveSession.resumed(drive, _Silent())
    whole = time.perf_counter() - begin
    writing.close()
    begin = time.perf_counter()
    session = resumed_session(recording, _Silent())
    took = time.perf_counter() - begin
    session.close()
    yield Row("review", "go on after a stop", took, "s", "", f"{note}; from the newest resume point")
    yield Row("review", "go on after a stop, without a point", whole, "s", "", "once through the engine")


def _opened(quantity: str, recording: Path, data: Path, asked: str, note: str) -> Row:
    begin = time.perf_counter()
    opened_review(recording, data)
    return Row("review", quantity, time.perf_counter() - begin, "s", asked, note)
