"""How soon a long recording is open for looking back: with the columns kept while driving, without them, and again."""

import shutil
import tempfile
import threading
import time
from pathlib import Path

from guidance_app.batch.reviewing import opened_review
from guidance_app.bench.rows import Row, Subparsers, add_bench, add_hours
from guidance_app.bench.streams import Day, day_of_work
from guidance_app.engine import Engine
from guidance_app.runtime import new_recording
from guidance_app.runtime.stepping import stepped
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
        about="opening a long recording for looking back",
        does="Drives and records a simulated day's work (10 Hz, GGA RMC VTG) at full speed and opens it.",
    )
    add_hours(parser)


def measured(hours: float) -> list[Row]:
    """Every row of this bench."""
    with tempfile.TemporaryDirectory(prefix="guidance-bench-") as name:
        data = Path(name)
        recording = _driven(day_of_work(hours=hours), data)
        note = f"{hours:g} h, 10 Hz"
        driven = _opened("open, first time, driven here", recording, data, "<= 20", note)
        again = _opened("open, second time", recording, data, "<= 2", note)
        shutil.rmtree(data / KEPT)
        elsewhere = _opened("open, first time, from elsewhere", recording, data, "<= 20", "once through the engine")
        return [driven, again, elsewhere]


def _driven(day: Day, data: Path) -> Path:
    """The folder of the day's recording, made as a live session makes it, without its pace."""
    recorder, engine = new_recording(data, day.job, "bench"), Engine(day.job)
    never, following = threading.Event(), AT_ONCE
    for chunk in day.chunks():
        recorder.take(chunk)
        stepped(engine, chunk, recorder.look_at)
        if chunk.arrival >= following:
            following += AT_ONCE
            while recorder.flushed_to < chunk.arrival:
                never.wait(0.02)
    recorder.close()
    return recorder.path


def _opened(quantity: str, recording: Path, data: Path, asked: str, note: str) -> Row:
    begin = time.perf_counter()
    opened_review(recording, data)
    return Row("review", quantity, time.perf_counter() - begin, "s", asked, note)
