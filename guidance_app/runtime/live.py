"""A session on a live source: a reader thread, one queue, one engine thread."""

import logging
import queue
import threading
import time
from collections.abc import Callable
from dataclasses import replace

from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.estimation.filter import FilterSettings
from guidance_app.model import Command, Commanded, Event, Snapshot, SourceDown
from guidance_app.runtime.session import Hearer, Publisher
from guidance_app.runtime.tap import Tap
from guidance_app.sources import Source

__all__ = ["LiveSession"]

log = logging.getLogger(__name__)

IDLE = 0.5
"""Without bytes the engine still looks at the time this often (s)."""


class LiveSession:
    """Drives the engine from a source as its bytes come in. ``replay`` is None: nobody can wind a receiver back."""

    replay = None

    def __init__(
        self, job: Job, source: Source, filter_name: str | None = None, settings: FilterSettings | None = None
    ) -> None:
        self.job = job
        self.tap = Tap()
        self._source = source
        self._engine = Engine(job, filter_name=filter_name, settings=settings)
        self._publisher = Publisher(self._engine.snapshot)
        self._events: queue.SimpleQueue[Event | None] = queue.SimpleQueue()
        self._stop = threading.Event()
        self._start = time.monotonic()
        self._reader = threading.Thread(target=self._read, name="source", daemon=True)
        self._runner = threading.Thread(target=self._run, name="engine", daemon=True)

    def start(self) -> None:
        """Begins to read and to run."""
        self._start = time.monotonic()
        self._reader.start()
        self._runner.start()

    def close(self) -> None:
        """Ends both threads and waits for them, a few seconds at most."""
        self._stop.set()
        self._events.put(None)
        for thread in (self._reader, self._runner):
            if thread.is_alive():
                thread.join(timeout=5.0)

    def snapshot(self) -> Snapshot:
        """The newest snapshot."""
        return self._publisher.newest

    def now(self) -> float:
        """Seconds since the session started."""
        return time.monotonic() - self._start

    def post(self, command: Command) -> None:
        """Hands a command to the engine; never waits."""
        self._events.put(Commanded(self.now(), command))

    def subscribe(self, hear: Hearer) -> Callable[[], None]:
        """Calls ``hear`` after each new snapshot."""
        return self._publisher.subscribe(hear)

    def _read(self) -> None:
        try:
            for event in self._source.events(self._stop):
                self.tap.hear(event)
                self._events.put(event)
        except Exception as error:
            log.exception("the source failed")
            self._events.put(SourceDown(self.now(), f"{self._source.description} failed: {error}"))

    def _run(self) -> None:
        while not self._stop.is_set():
            try:
                event = self._events.get(timeout=self._patience())
            except queue.Empty:
                self._publisher.tell()
                close = self._engine.close_epoch
                if close is not None and close.arrival <= self.now():
                    self._step(replace(close, arrival=self.now()))
                continue
            if event is not None:
                self._step(event)

    def _patience(self) -> float:
        """How long the engine may sleep: to the close of a half-received epoch, or to the hearers' next turn."""
        patience = self._publisher.least_interval if self._publisher.pending else IDLE
        if self._engine.wake_at is not None:
            patience = min(patience, max(self._engine.wake_at - self.now(), 0.001))
        return patience

    def _step(self, event: Event) -> None:
        try:
            self._publisher.publish(self._engine.step(event))
        except Exception as error:
            log.exception("the engine failed on %s", type(event).__name__)
            self._publisher.publish(self._engine.failed(event.arrival, str(error)))
