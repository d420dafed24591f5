"""What recording a drive costs, how large it gets, and how soon a long one is open and any second of it is reached."""

import statistics
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from guidance_app.bench.errors import BenchError
from guidance_app.bench.rows import Row, Subparsers, add_bench, add_hours
from guidance_app.bench.streams import Day, day_of_work, first_chunks
from guidance_app.model import Snapshot
from guidance_app.runtime import ReplaySession, new_recording
from guidance_app.store.recordings import open_recording

__all__ = ["add_parser", "measured"]

PACED_S = 15.0
JUMPS = 40
SEED = 20130
PATIENCE = 600.0
AT_ONCE = 3600.0
"""Seconds of the day that are given to the recorder before it is waited for: what waits in memory has a bound."""
NEAR = 0.25
"""A jump has arrived when the snapshot is so near (s): between two epochs there is none."""


def add_parser(subparsers: Subparsers) -> None:
    """Describes the bench."""
    parser = add_bench(
        subparsers,
        "recording",
        lambda given: measured(given.hours),
        about="what recording costs, its size, opening a long one, and jumps in it",
        does="Records a simulated day's work (10 Hz, GGA RMC VTG), opens it twice and jumps about in it.",
    )
    add_hours(parser)


def measured(hours: float, paced_s: float = PACED_S, jumps: int = JUMPS) -> list[Row]:
    """Every row of this bench. Raises ``BenchError`` when a jump does not arrive."""
    day = day_of_work(hours=hours)
    with tempfile.TemporaryDirectory(prefix="guidance-bench-") as name:
        folder = Path(name)
        rows = [_cost(day, folder / "paced", paced_s)]
        recording, row = _size(day, folder / "whole")
        rows.append(row)
        for which in ("first", "second"):
            rows += _opening(recording, folder / "cache", which, jumps)
    return rows


def _cost(day: Day, data: Path, seconds: float) -> Row:
    """The processor's time of this process while a recorder takes events in real time and nothing else is done."""
    chunks = first_chunks(day, seconds)
    recorder = new_recording(data, day.job, "bench")
    begin, spent = time.monotonic(), time.process_time()
    never = threading.Event()
    for chunk in chunks:
        never.wait(max(begin + chunk.arrival - time.monotonic(), 0.0))
        recorder.take(chunk)
    spent = time.process_time() - spent
    took = time.monotonic() - begin
    recorder.close()
    return Row("recording", "processor while recording", 100 * spent / took, "% of a core", "< 5", "10 Hz, real time")


def _size(day: Day, data: Path) -> tuple[Path, Row]:
    recorder = new_recording(data, day.job, "bench")
    never, following = threading.Event(), AT_ONCE
    for chunk in day.chunks():
        recorder.take(chunk)
        if chunk.arrival >= following:
            following += AT_ONCE
            while recorder.flushed_to < chunk.arrival:
                never.wait(0.02)
    recorder.close()
    size = sum(path.stat().st_size for path in recorder.path.iterdir()) / 1e6
    return recorder.path, Row("recording", "size when ended", size / day.hours, "MB/h", "< 4", "10 Hz, GGA RMC VTG")


def _opening(recording: Path, cache: Path, which: str, count: int) -> Iterator[Row]:
    """Until it can be played, until every second is near, and jumps then."""
    begin = time.perf_counter()
    drive = open_recording(recording)
    session = ReplaySession.of_drive(drive)
    hours = drive.duration / 3600
    asked = {"first": "<= 20", "second": "<= 2"}[which]
    yield Row("recording", f"open, {which} time", time.perf_counter() - begin, "s", asked, f"{hours:.3g} h, to play")
    session.make_index(cache)
    if not session.wait_for_index(PATIENCE):
        msg = f"the index was not made in {PATIENCE:g} s"
        raise BenchError(msg)
    yield Row("recording", f"indexed, {which} time", time.perf_counter() - begin, "s", "", "beside, by a process")
    jumps = _jumps(session, drive.duration, count)
    yield Row("recording", f"jump, median, {which} time", statistics.median(jumps), "s", "<= 0.5", f"{count} at random")
    yield Row("recording", f"jump, longest, {which} time", max(jumps), "s", "<= 0.5")


def _jumps(session: ReplaySession, duration: float, count: int) -> list[float]:
    """Seconds from the wish to the snapshot."""
    arrived, wanted = threading.Event(), [0.0]

    def hear(snapshot: Snapshot) -> None:
        if abs(snapshot.arrival - wanted[0]) < NEAR and session.replay.catching_up is None:
            arrived.set()

    session.subscribe(hear)
    session.start()
    session.replay.pause()
    took = []
    for position in np.random.default_rng(SEED).uniform(0.0, duration, count):
        wanted[0] = float(position)
        arrived.clear()
        begin = time.perf_counter()
        session.replay.seek(wanted[0])
        if not arrived.wait(PATIENCE):
            msg = f"a jump to {wanted[0]:g} s did not arrive"
            raise BenchError(msg)
        took.append(time.perf_counter() - begin)
    session.close()
    return took
