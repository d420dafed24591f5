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
    """Median cost of windows of 500 fixes: a few around minute 10, and the day's last ones."""
    engine = Engine(day.job)
    costs: list[tuple[float, float]] = []
    window: list[Chunk] = []
    for chunk in day.chunks():
        window.append(chunk)
        if len(window) == WINDOW_FIXES:
            costs.append((chunk.arrival, _seconds_for(engine, window) / WINDOW_FIXES))
            window.clear()
    early = statistics.median([cost for arrival, cost in costs if arrival >= EARLY][:WINDOWS])
    late = statistics.median([cost for _, cost in costs[-WINDOWS:]])
    yield Row("engine", "cost per fix at minute 10", early * 1e6, "us")
    yield Row("engine", f"cost per fix at hour {day.hours:g}", late * 1e6, "us")
    yield Row("engine", f"hour {day.hours:g} over minute 10", late / early, "x", "<= 1.1", "same run")
