"""How long a fix takes from its bytes to the light bar drawn in a browser, at 10 Hz with three clients on loopback.

A source hands over the bytes of a simulated day, an epoch each tenth of a second, and notes when. A real Chromium shows
the page; beside it two more clients hear light bar and scene. The page notes when it has drawn which message. The time
of a fix is from its bytes to the first picture that shows it or a newer one, so one that was never drawn counts with
its successor. Drawn means that the canvas has been given its strokes; the screen shows them at its next refresh.

The source's clock and the page's are the system's, on the same machine; that they agree is looked at, and not assumed.
"""

import argparse
import contextlib
import math
import os
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from guidance_app.bench.browser import Browser
from guidance_app.bench.errors import BenchError
from guidance_app.bench.rows import Row, Subparsers, add_bench
from guidance_app.bench.streams import day_of_work, first_chunks
from guidance_app.bench.wire import BarClient, SceneClient
from guidance_app.console.server import Console
from guidance_app.model import Chunk, Snapshot
from guidance_app.runtime import LiveSession
from guidance_app.sources import SourceEvent

__all__ = ["Drawn", "Latency", "add_parser", "measured", "rows_of", "times_to_drawn"]

LEAN_CLIENTS = 2
WARM_UP_S = 5.0
DRAIN_S = 5.0
"""The page keeps a thousand timings; they are fetched before they are dropped."""

START_S = 120.0
"""The source goes on for so long before a measurement: the browser may need it to start on a busy machine."""

CLOCKS_MS = 5.0
"""By so much the page's clock may differ from the system's."""

GUIDING = "window.__lightbar?.state === 'guide' && !!window.__viserMutable?.nodeRefFromName?.['/w/here/tractor']"
MICROSECOND_DIGITS = 6

TAKE_TIMINGS = "window.__lightbar.timings.splice(0)"
CLOCK = "performance.timeOrigin + performance.now() - Date.now()"


class SteadySource:
    """Epochs at their own pace, stamped when they are handed over, as a receiver's bytes are when they come.

    Stamps are whole microseconds, as the session counts: so a fix bears the very stamp that its bytes were given. One
    that was rounded down would stand before its own, and the fix be counted with its successor's picture.
    """

    description = "a simulated receiver at 10 Hz"
    duration: float | None = None
    live = True

    def __init__(self, chunks: Sequence[Chunk]) -> None:
        self._chunks = chunks
        self.handed_over: dict[float, float] = {}
        """When each epoch was handed over: stamp of the session clock -> milliseconds of the system's clock."""

    def events(self, stop: threading.Event) -> Iterator[SourceEvent]:
        """Each epoch when its time has come."""
        start = time.monotonic()
        for chunk in self._chunks:
            if stop.wait(max(0.0, start + chunk.arrival - time.monotonic())):
                return
            arrival = round(time.monotonic() - start, MICROSECOND_DIGITS)
            self.handed_over[arrival] = time.time() * 1000.0
            yield Chunk(arrival, chunk.data, chunk.link)


@dataclass(frozen=True, slots=True)
class Drawn:
    """One message that the page has drawn: the snapshot's number, and when, in milliseconds of the system's clock."""

    sequence: int
    moment: float


@dataclass(frozen=True, slots=True)
class Latency:
    """What was measured, in milliseconds: each fix to its picture, and each message to its answer from any client."""

    to_drawn: tuple[float, ...]
    round_trips: tuple[float, ...]
    note: str


def add_parser(subparsers: Subparsers) -> None:
    """Describes the bench."""
    parser = add_bench(
        subparsers,
        "latency",
        lambda given: rows_of(measured(given.seconds)),
        about="from a fix's bytes to the light bar drawn in a browser, with three clients",
        does="Runs a live session at 10 Hz with a real Chromium and two more clients on this machine. Needs"
        " Chromium, and Playwright from the extra 'test'.",
    )
    parser.add_argument("--seconds", type=_seconds, default=60.0, help="length of the measurement (default 60)")


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 1.0 <= seconds <= 3600.0:
        msg = f"{text} is no length for this measurement; it goes from 1 to 3600 seconds"
        raise argparse.ArgumentTypeError(msg)
    return seconds


def measured(seconds: float) -> Latency:
    """Runs the session with its clients and measures for so many seconds, after a few that do not count."""
    length = seconds + START_S + WARM_UP_S
    day = day_of_work(hours=length / 3600.0)
    source = SteadySource(first_chunks(day, length))
    session = LiveSession(day.job, source)
    fixes: dict[int, float] = {}

    def hear(snapshot: Snapshot) -> None:
        if snapshot.fix is not None:
            fixes[snapshot.sequence] = snapshot.fix.arrival

    session.subscribe(hear)
    console = Console(session, port=0)
    with contextlib.ExitStack() as opened:
        address = console.start()
        opened.callback(console.close)
        session.start()
        opened.callback(session.close)
        page = opened.enter_context(Browser(address))
        for _ in range(LEAN_CLIENTS):
            opened.enter_context(BarClient(address))
            opened.enter_context(SceneClient(address))
        page.until(GUIDING)
        page.wait(WARM_UP_S)
        _check_clocks(page)
        page.value_of(TAKE_TIMINGS)
        console.hub.round_trips_ms.clear()
        begin = time.time() * 1000.0
        drawn, round_trips = _collected(page, console, seconds)
        end = time.time() * 1000.0
        console.close()  # before its clients leave: a redraw for one who has just gone makes viser warn
        load = f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors" if hasattr(os, "getloadavg") else ""
    window = {arrival: moment for arrival, moment in source.handed_over.items() if begin <= moment < end - 1000.0}
    return Latency(times_to_drawn(window, fixes, drawn), tuple(round_trips), load)


def _check_clocks(page: Browser) -> None:
    """Both ends of a time are stamped by different programs; they must mean the same by now."""
    apart = abs(float(page.value_of(CLOCK)))
    if apart > CLOCKS_MS:
        msg = (
            f"the browser's clock is {apart:.0f} ms off the system's, which was set a moment ago: run the bench again."
        )
        raise BenchError(msg)


def _collected(page: Browser, console: Console, seconds: float) -> tuple[list[Drawn], list[float]]:
    """What the page has drawn, and the hub's round trips of all clients."""
    drawn: list[Drawn] = []
    round_trips: list[float] = []
    deadline = time.monotonic() + seconds
    while (left := deadline - time.monotonic()) > 0.0:
        page.wait(min(DRAIN_S, left))
        drawn += [Drawn(one["sequence"], one["drawn"]) for one in page.value_of(TAKE_TIMINGS)]
        while console.hub.round_trips_ms:
            round_trips.append(console.hub.round_trips_ms.popleft())
    return drawn, round_trips


def times_to_drawn(
    handed_over: dict[float, float], fixes: dict[int, float], drawn: Sequence[Drawn]
) -> tuple[float, ...]:
    """Milliseconds from each fix handed over to the first picture of it or of a newer one, in order of the fixes.

    ``handed_over`` gives the moment of each fix's stamp, ``fixes`` the stamp of the fix in each snapshot. Raises
    ``BenchError`` when a fix was never followed by a picture.
    """
    pictures = sorted((fixes[one.sequence], one.moment) for one in drawn if one.sequence in fixes)
    stamps = np.array([stamp for stamp, _ in pictures])
    earliest = np.minimum.accumulate(np.array([moment for _, moment in pictures])[::-1])[::-1]
    times = []
    for stamp in sorted(handed_over):
        first = int(np.searchsorted(stamps, stamp))
        if first == len(stamps):
            msg = f"the fix at {stamp:.1f} s was never drawn: the page had stopped, and there is nothing to measure."
            raise BenchError(msg)
        times.append(float(earliest[first]) - handed_over[stamp])
    return tuple(times)


def rows_of(latency: Latency) -> list[Row]:
    """Median and the worst of a hundred."""
    note = f"Chromium, 3D draw calls stubbed, beside {LEAN_CLIENTS} plain clients; {latency.note}".rstrip("; ")
    median, p99 = np.percentile(latency.to_drawn, [50, 99])
    around, around_p99 = np.percentile(latency.round_trips, [50, 99])
    return [
        Row("latency", "fix arriving to light bar drawn, median", float(median), "ms", "< 50", note),
        Row("latency", "fix arriving to light bar drawn, p99", float(p99), "ms", "< 100", note),
        Row("latency", "fix arriving to light bar drawn, worst", max(latency.to_drawn), "ms"),
        Row("latency", "fixes measured", len(latency.to_drawn), ""),
        Row("latency", "message sent to answered, all clients, median", float(around), "ms"),
        Row("latency", "message sent to answered, all clients, p99", float(around_p99), "ms"),
    ]
