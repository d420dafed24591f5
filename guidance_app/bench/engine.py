"""How much faster than real time the engine is, and whether a fix costs the same in hour 8 as in minute 10."""

import statistics
import time
from collections.abc import Iterator

from guidance_app.bench.rows import Row, Subparsers, add_bench, add_hours
from guidance_app.bench.streams import Day, day_of_work, first_chunks
from guidance_app.engine import Engine
from guidance_app.estimation.filters import FILTERS
from guidance_app.model import Chunk

__all__ = ["add_parser", "measured"]

EARLY = 600.0
"""The window of the tenth minute begins here (s)."""
WINDOW_FIXES = 500
WINDOWS = 12


def add_parser(subparsers: Subparsers) -> None:
    """Describes the bench."""
    parser = add_bench(
        subparsers,
        "engine",
        lambda given: measured(given.hours),
        about="decode, filter, tracking and coverage on one core: times real time, and flatness over the hours",
        does="Feeds the bytes of a simulated day's work (10 Hz, GGA RMC VTG, 12 m) to the engine on one core.",
    )
    add_hours(parser)


def measured(hours: float) -> list[Row]:
    """Every row of this bench."""
    day = day_of_work(hours=hours)
    rows = [_speed(day, name) for name in FILTERS]
    return [*rows, *_flatness(day)]


def _speed(day: Day, name: str) -> Row:
    """The best of three runs over five minutes, after one that warms up."""
    seconds = 300.0
    chunks = first_chunks(day, seconds)
    best = min(_seconds_for(Engine(day.job, filter_name=name), chunks) for _ in range(4))
    return Row("engine", f"times real time, filter {name}", seconds / best, "x", ">= 500", "10 Hz, one core")


def _seconds_for(engine: Engine, chunks: list[Chunk]) -> float:
    """Seconds of this thread's processor, so that a busy machine does not count."""
    begin = time.thread_time()
    for chunk in chunks:
        engine.step(chunk)
    return time.thread_time() - begin


def _flatness(day: Day) -> Iterator[Row]:
    """Median cost of windows of 500 fixes from minute 10 on, and of the day's last ones.

    Both are driven in turns once the day is over, so that what else the machine does weighs on both alike.
    """
    length = WINDOWS * WINDOW_FIXES
    late = max(int(day.hours * 3600 * day.rate) - length, 0)
    chunks: dict[int, list[Chunk]] = {min(int(EARLY * day.rate), late): [], late: []}
    engine, standing = Engine(day.job), {}
    for number, chunk in enumerate(day.chunks()):
        for start, kept in chunks.items():
            if number == start:
                standing[start] = engine.fork()
            if start <= number < start + length:
                kept.append(chunk)
        if number < late:
            engine.step(chunk)
    costs: dict[int, list[float]] = {start: [] for start in chunks}
    for window in range(0, length, WINDOW_FIXES):
        for start, kept in chunks.items():
            part = kept[window : window + WINDOW_FIXES]
            costs[start].append(_seconds_for(standing[start], part) / max(len(part), 1))
    first, last = (statistics.median(one) for one in (costs[min(costs)], costs[max(costs)]))
    yield Row("engine", "cost per fix at minute 10", first * 1e6, "us")
    yield Row("engine", f"cost per fix at hour {day.hours:g}", last * 1e6, "us")
    yield Row("engine", f"hour {day.hours:g} over minute 10", last / first, "x", "<= 1.1", "same run, in turns")
