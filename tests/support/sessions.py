"""A session whose snapshots a test writes by hand, and snapshots to begin with."""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from guidance_app.documents import Implement, Job, Receiver, Settings, Tractor
from guidance_app.model import (
    CoverageTotals,
    Fix,
    FixQuality,
    Guidance,
    LinkState,
    LinkStatus,
    Pass,
    Pose,
    Prediction,
    SessionState,
    Snapshot,
    TurnGuide,
)
from guidance_app.runtime import Tap

__all__ = ["HandSession", "a_job", "driven", "driving"]

STRAIGHT_NORTH = Pass(number=2, points=np.array([[0.0, -500.0], [0.0, 500.0]]), order=2)


def a_job(settings: Settings | None = None) -> Job:
    """The documents of a session, all by their defaults."""
    return Job(
        tractor=Tractor(name="Tractor"),
        implement=Implement(name="Implement"),
        receiver=Receiver(name="Receiver"),
        settings=settings or Settings(),
    )


def driving(
    cross_track: float = 0.124,
    *,
    at: float = 100.0,
    speed: float = 2.3,
    predicted: float | None = 0.08,
    turn: TurnGuide | None = None,
    sequence: int = 1,
    working: bool = True,
    quality: FixQuality = FixQuality.RTK_FIXED,
) -> Snapshot:
    """A tractor that drives north along ``STRAIGHT_NORTH`` at the session time ``at``, so far right of it."""
    pose = Pose(t=at, arrival=at, east=cross_track, north=0.0, heading=0.0, speed=speed)
    prediction = None
    if predicted is not None:
        later = replace(pose, t=at + 1.5, arrival=at + 1.5, east=predicted, north=1.5 * speed)
        prediction = Prediction(1.5, later, np.zeros((2, 2)), cross_track=predicted, heading_error=0.05)
    return Snapshot(
        sequence=sequence,
        arrival=at,
        link=LinkState(LinkStatus.FIX, fixes=sequence),
        fix=Fix(t=at, arrival=at, latitude_deg=41.0, longitude_deg=-4.7, quality=quality, satellites=17, hdop=0.7),
        fix_interval=0.1,
        pose=pose,
        implement=(cross_track, -1.5, 0.0),
        prediction=prediction,
        guidance=Guidance(
            target=STRAIGHT_NORTH,
            cross_track=cross_track,
            heading_error=0.0,
            along_track=500.0,
            against=False,
            remaining=500.0,
            turn=turn,
            on_pass=True,
            count=24,
        ),
        working=working,
        state=SessionState.DRIVING,
        totals=CoverageTotals(worked=34_212.0),
    )


class HandSession:
    """A session as the console sees it. ``publish`` is what an engine would do; its clock is the machine's."""

    def __init__(self, settings: Settings | None = None, first: Snapshot | None = None) -> None:
        self.job = a_job(settings)
        self.replay: Any = None
        self.tap = Tap()
        self.commands: list[object] = []
        self._began = time.monotonic()
        self._newest = first or Snapshot(sequence=0, arrival=0.0, link=LinkState())
        self._hearing: list[Callable[[Snapshot], None]] = []
        self._lock = threading.Lock()

    def now(self) -> float:
        return time.monotonic() - self._began

    def snapshot(self) -> Snapshot:
        return self._newest

    def post(self, command: object) -> None:
        self.commands.append(command)

    def subscribe(self, hear: Callable[[Snapshot], None]) -> Callable[[], None]:
        with self._lock:
            self._hearing.append(hear)

        def stop() -> None:
            with self._lock:
                self._hearing.remove(hear)

        return stop

    @property
    def listeners(self) -> int:
        return len(self._hearing)

    def publish(self, snapshot: Snapshot) -> None:
        self._newest = snapshot
        with self._lock:
            hearing = tuple(self._hearing)
        for hear in hearing:
            hear(snapshot)

    def start(self) -> None:
        """Nothing to begin."""

    def close(self) -> None:
        """Nothing to end."""


@contextlib.contextmanager
def driven(session: HandSession, make: Callable[[float, int], Snapshot], hertz: float = 10.0) -> Iterator[None]:
    """Meanwhile an engine publishes ``make(session time, sequence)`` so many times a second, on its own thread."""
    stop = threading.Event()

    def drive() -> None:
        sequence = 1
        while not stop.wait(1.0 / hertz):
            session.publish(make(session.now(), sequence))
            sequence += 1

    engine = threading.Thread(target=drive, name="engine")
    session.publish(make(session.now(), 0))
    engine.start()
    try:
        yield
    finally:
        stop.set()
        engine.join()
