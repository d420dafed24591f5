"""Whether a long day stays cheap: bytes on the wire for each fix and memory, hour by hour, and who joins at the end.

The engine works a simulated day as fast as it can and the console's own screen draws it for a client that reads every
byte. A redraw comes after each hundred fixes and is waited for, so that nothing piles up. Words in the panels change by
the true clock, so in a hurried hour they come more rarely than in a drive: two stretches are therefore driven in true
time, one after ten minutes and one at the end.

The hurried curve shows what grows, undiluted by redraws: the nodes of worked ground are sent again as they fill, so it
rises and falls with them. A drive pays for its redraws and for that.

Memory is that of the whole process: engine, console and the clients that measure.
"""

import argparse
import contextlib
import gc
import math
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from guidance_app.bench.errors import BenchError
from guidance_app.bench.rows import Row, Subparsers, add_bench
from guidance_app.bench.streams import day_of_work
from guidance_app.bench.wire import SceneClient
from guidance_app.console.house import House
from guidance_app.console.inner import InnerViser
from guidance_app.console.screen import TICK_S, Screen
from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.model import Chunk, Command, Snapshot
from guidance_app.runtime import SessionManager, Tap
from guidance_app.view.bar import bar_of
from guidance_app.view.bar_wire import bar_json

__all__ = ["Growth", "Hour", "Joining", "Stretch", "add_parser", "measured", "rows_of"]

FIXES_A_REDRAW = 100
MINUTE = 60.0
HOUR = 3600.0
EARLY = 10 * MINUTE
MEGABYTE = 1e6
MOST_NODES = 100
"""A scene graph of more nodes slows the page down."""
STATUS = Path("/proc/self/status")


class DrivenSession:
    """What the screen sees of a session whose engine is driven by hand."""

    replay = None

    def __init__(self, job: Job) -> None:
        self.job = job
        self.tap = Tap()
        self._engine = Engine(job)
        self._now = 0.0

    def take(self, chunk: Chunk) -> None:
        """One epoch."""
        self.tap.hear(chunk)
        self._engine.step(chunk)
        self._now = chunk.arrival

    def at(self, moment: float) -> None:
        """Lets the clock run on between two epochs."""
        self._now = moment

    def snapshot(self) -> Snapshot:
        """The newest snapshot."""
        return self._engine.snapshot

    def now(self) -> float:
        """The session clock."""
        return self._now

    def post(self, command: Command) -> None:
        """Nobody has fingers here."""
        msg = f"{type(command).__name__} was posted in a measurement that posts nothing"
        raise AssertionError(msg)

    def subscribe(self, hear: Callable[[Snapshot], None]) -> Callable[[], None]:
        """The screen looks by itself; nobody is told."""
        msg = f"{hear} wants to be told in a measurement that tells nobody"
        raise AssertionError(msg)

    def start(self) -> None:
        """Driven by hand: nothing runs."""

    def close(self) -> None:
        """Nothing runs that could be ended."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Fixes that were driven in true time: bytes for each, of the scene and of the light bar's message."""

    scene: float
    bar: int


@dataclass(frozen=True, slots=True)
class Hour:
    """Up to ``hour``, from the one before: bytes for each fix. ``memory`` (bytes) at its end."""

    hour: float
    scene: float
    memory: float
    nodes: int


@dataclass(frozen=True, slots=True)
class Joining:
    """A client that comes at the end: until it has every node, and how many bytes that took."""

    seconds: float
    bytes: int
    nodes: int


@dataclass(frozen=True, slots=True)
class Growth:
    """One measured day. ``early`` is the tenth minute."""

    early: Hour
    hours: tuple[Hour, ...]
    first_stretch: Stretch
    last_stretch: Stretch
    joining: Joining


def add_parser(subparsers: Subparsers) -> None:
    """Describes the bench."""
    parser = add_bench(
        subparsers,
        "growth",
        lambda given: rows_of(measured(given.hours, given.seconds)),
        about="bytes on the wire per fix and memory over a simulated day, and a client that joins at its end",
        does="Works a simulated day (10 Hz) as fast as possible while a client hears everything that is drawn.",
    )
    parser.add_argument("--hours", type=_hours, default=8.0, help="length of the day (default 8, at least 0.5)")
    parser.add_argument(
        "--seconds", type=float, default=10.0, help="length of each of the two stretches in true time (default 10)"
    )


def _hours(text: str) -> float:
    try:
        hours = float(text)
    except ValueError:
        hours = 0.0
    if not 0.5 <= hours <= 24.0:
        msg = f"{text} is no length for this day; it goes from 0.5 to 24 hours"
        raise argparse.ArgumentTypeError(msg)
    return hours


def measured(hours: float, seconds: float) -> Growth:
    """Works a day of so many hours and measures it, with two stretches of ``seconds`` in true time."""
    memory_in_use()  # a system that does not tell it is found out before the day, not after
    day = day_of_work(hours=hours + (2 * seconds + MINUTE) / HOUR)
    session = DrivenSession(day.job)
    with contextlib.ExitStack() as opened:
        inner = InnerViser(label="Guidance")
        opened.callback(inner.close)
        screen = Screen(inner.server, House(SessionManager(session)))
        screen.attach()
        opened.callback(screen.close)
        chunks = day.chunks()
        for _ in range(day.rate * 2):
            session.take(next(chunks))
        first = opened.enter_context(SceneClient(_address(inner), inner.headers))
        worker = _Worker(session, screen, chunks, first, day.rate)
        worker.until_drawn()
        worker.hurry_to(EARLY - MINUTE)
        early = worker.hurry_to(EARLY)
        first_stretch = worker.in_true_time(seconds)
        ends = [*range(1, math.ceil(hours)), hours]
        measured_hours = tuple(worker.hurry_to(end * HOUR) for end in ends)
        last_stretch = worker.in_true_time(seconds)
        return Growth(early, measured_hours, first_stretch, last_stretch, worker.join(inner))


def _address(inner: InnerViser) -> str:
    return inner.uri.replace("ws", "http", 1)


class _Worker:
    """Drives the session on and redraws, and counts what the first client hears of it."""

    def __init__(
        self, session: DrivenSession, screen: Screen, chunks: Iterator[Chunk], client: SceneClient, rate: int
    ) -> None:
        self._session = session
        self._screen = screen
        self._chunks = chunks
        self._client = client
        self._rate = rate

    def until_drawn(self) -> None:
        """Redraws until the client has its tractor."""
        deadline = time.monotonic() + 30.0
        while not any(name.endswith("/tractor") for name in self._client.nodes):
            self._screen.tick()
            self._client.soon(lambda: False, TICK_S)
            if time.monotonic() > deadline:
                msg = "the console has not drawn a tractor for its first client; see its log above."
                raise BenchError(msg)

    def _redraw(self) -> None:
        """One redraw that has been heard: a tractor that moves is drawn anew by every one."""
        heard = self._client.frames
        self._screen.tick()
        self._client.until(lambda: self._client.frames > heard)

    def hurry_to(self, moment: float) -> Hour:
        """Works on to ``moment`` of the session clock, as fast as it goes."""
        before = self._client.bytes
        fixes = 0
        while self._session.now() < moment:
            for _ in range(FIXES_A_REDRAW):
                self._session.take(next(self._chunks))
            fixes += FIXES_A_REDRAW
            self._redraw()
        sent = self._client.bytes - before
        gc.collect()
        return Hour(self._session.now() / HOUR, sent / fixes, memory_in_use(), len(self._client.nodes))

    def in_true_time(self, seconds: float) -> Stretch:
        """Works on at the receiver's own pace, redrawing as often as the console does."""
        before = self._client.bytes
        begin, start = time.monotonic(), self._session.now()
        fixes = 0
        pause = threading.Event()
        for number in range(1, int(seconds / TICK_S) + 1):
            pause.wait(max(0.0, begin + number * TICK_S - time.monotonic()))
            moment = start + number * TICK_S
            while fixes < int((moment - start) * self._rate):
                self._session.take(next(self._chunks))
                fixes += 1
            self._session.at(moment)
            self._redraw()
        snapshot = self._session.snapshot()
        view = bar_of(snapshot, snapshot.arrival, self._session.job.settings)
        bar = len(bar_json(view, time.time() * 1000.0).encode())
        return Stretch((self._client.bytes - before) / fixes, bar)

    def join(self, inner: InnerViser) -> Joining:
        """A second client comes; redraws go on at their own pace until it has all that the first one has."""
        begin = time.monotonic()
        with SceneClient(_address(inner), inner.headers) as second:
            while not second.soon(lambda: second.nodes >= self._client.nodes, TICK_S):
                self._screen.tick()
                if time.monotonic() - begin > 60.0:
                    missing = ", ".join(sorted(self._client.nodes - second.nodes))
                    msg = f"a client that joined late was still without {missing} after 60 s."
                    raise BenchError(msg)
            return Joining(time.monotonic() - begin, second.bytes, len(self._client.nodes))


def memory_in_use() -> float:
    """Bytes of this process that lie in memory. Raises ``BenchError`` where the system does not tell."""
    try:
        lines = STATUS.read_text("ascii").splitlines()
    except OSError as error:
        msg = f"memory is read from {STATUS}, which this system does not have: run this bench on Linux."
        raise BenchError(msg) from error
    return 1024.0 * float(next(line for line in lines if line.startswith("VmRSS")).split()[1])


def rows_of(growth: Growth) -> list[Row]:
    """The day as rows: the curves, then what was asked."""
    early, last = growth.early, growth.hours[-1]
    points = [early, *(replace(one, hour=round(one.hour, 1)) for one in growth.hours)]
    names = ["minute 10", *(f"hour {one.hour:g}" for one in points[1:])]
    first, second, joining = growth.first_stretch, growth.last_stretch, growth.joining
    note = f"one redraw in {FIXES_A_REDRAW} fixes"
    rows = [("scene, bytes per fix", one.scene, "B", "", note) for one in points]
    rows += [("memory of the process", one.memory / MEGABYTE, "MB", "", f"{one.nodes} nodes") for one in points]
    curves = [
        Row("growth", f"{quantity}, {name}", value, unit, asked, remark)
        for (quantity, value, unit, asked, remark), name in zip(rows, names * 2, strict=True)
    ]
    true_time = f"true time, {1.0 / TICK_S:g} redraws a second"
    return [
        *curves,
        Row("growth", f"memory, {names[-1]} over minute 10", last.memory / early.memory, "x", "<= 1.1"),
        Row("growth", "scene, bytes per fix after minute 10", first.scene, "B", note=true_time),
        Row("growth", "scene, bytes per fix at the end", second.scene, "B", note=true_time),
        Row(
            "growth",
            f"scene, bytes per fix, {names[-1]} over minute 10",
            (second.scene + last.scene) / (first.scene + early.scene),
            "x",
            "<= 1.1",
            "redraws in true time, and what grows in the hurried curve",
        ),
        Row("growth", "light bar, bytes per message, minute 10", first.bar, "B"),
        Row("growth", "light bar, bytes per message, end", second.bar, "B"),
        Row("growth", "joining at the end, until every node is there", joining.seconds, "s", "<= 3"),
        Row("growth", "joining at the end, bytes", joining.bytes / MEGABYTE, "MB"),
        Row("growth", "nodes of the scene at the end", joining.nodes, "", f"< {MOST_NODES}"),
    ]
