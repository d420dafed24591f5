"""A session on a live source: a reader thread, one queue, one engine thread; recorded, and gone on with after a stop.

Events are put into one order before the engine takes them: arrivals in whole microseconds that never step back. The
recorder is given each event just before the engine, so a recording holds exactly what the engine was told.
"""

import logging
import queue
import threading
import time
from collections.abc import Callable
from dataclasses import replace

from guidance_app.decoding_beside import DecodedEvents
from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.estimation.filter import FilterSettings
from guidance_app.language import sentence
from guidance_app.model import RECEIVER, Command, Commanded, Event, LinkState, LinkStatus, Snapshot, SourceDown
from guidance_app.recording import RecordedDrive
from guidance_app.runtime.recorder import Recorder
from guidance_app.runtime.resume_points import KEEP_EVERY, ResumePoint
from guidance_app.runtime.session import Hearer, Publisher
from guidance_app.runtime.stepping import stepped
from guidance_app.runtime.tap import Tap
from guidance_app.sources import Source

__all__ = ["LiveSession"]

log = logging.getLogger(__name__)

IDLE = 0.5
"""Without bytes the engine still looks at the time this often (s)."""
MICROSECOND_DIGITS = 6
INTERRUPTED = sentence("the program was stopped here")
TOLD_EVERY = 500
"""Events of a drive that is gone on with between two words about progress."""


class LiveSession:
    """Drives the engine from a source as its bytes come in. ``replay`` is None: nobody can wind a receiver back.

    ``recorder`` is closed with the session. ``notices`` are shown beside those of field and plan. Without a ``source``
    nothing is driven: it plans and shows its job.
    """

    replay = None

    def __init__(
        self,
        job: Job,
        source: Source | None,
        filter_name: str | None = None,
        settings: FilterSettings | None = None,
        *,
        recorder: Recorder | None = None,
        notices: tuple[str, ...] = (),
    ) -> None:
        self.job = job
        self.tap = Tap()
        self.recorder = recorder
        self._source = source
        link = LinkState(LinkStatus.UNUSED) if source is None else None
        self._engine = Engine(job, filter_name=filter_name, settings=settings, notices=notices, link=link)
        self._publisher = Publisher(self._engine.snapshot)
        self._events: queue.SimpleQueue[Event | None] = queue.SimpleQueue()
        self._links: dict[str, None] = {RECEIVER: None}
        self._stop = threading.Event()
        self._begin = 0.0
        self._last = 0.0
        self._keep_at = KEEP_EVERY
        self._notice: str | None = None
        self._start = time.monotonic()
        self._reader = threading.Thread(target=self._read, name="source", daemon=True)
        self._runner = threading.Thread(target=self._run, name="engine", daemon=True)

    @classmethod
    def resumed(
        cls,
        drive: RecordedDrive,
        source: Source,
        recorder: Recorder | None = None,
        progress: Callable[[float], None] | None = None,
        point: ResumePoint | None = None,
    ) -> "LiveSession":
        """A session that goes on where the drive was cut off: same documents, work, pass and offsets; the clock too.

        Returns when all inputs have been taken again, those behind ``point`` where one was kept; ``progress`` hears
        parts of 1 meanwhile.
        """
        session = cls(drive.job, source, drive.filter_name, drive.settings, recorder=recorder, notices=drive.notices)
        session._take_again(drive, progress, point)
        return session

    def start(self) -> None:
        """Begins to read and to run."""
        self._start = time.monotonic()
        self._reader.start()
        self._runner.start()

    def close(self, *, ended: bool = True) -> None:
        """Ends the threads and waits for them. Not ``ended``, the drive can be gone on with at the next start."""
        self._stop.set()
        self._events.put(None)
        for thread in (self._reader, self._runner):
            if thread.is_alive():
                thread.join(timeout=5.0)
        if self.recorder is not None:
            if not ended:
                self._keep_engine()
            self.recorder.close(ended=ended)

    def snapshot(self) -> Snapshot:
        """The newest snapshot."""
        return self._publisher.newest

    def now(self) -> float:
        """Seconds since the session started, those of the drive that it goes on with included."""
        return self._begin + time.monotonic() - self._start

    def post(self, command: Command) -> None:
        """Hands a command to the engine; never waits."""
        self._events.put(Commanded(self.now(), command))

    def subscribe(self, hear: Hearer) -> Callable[[], None]:
        """Calls ``hear`` after each new snapshot."""
        return self._publisher.subscribe(hear)

    def _take_again(
        self, drive: RecordedDrive, progress: Callable[[float], None] | None, point: ResumePoint | None
    ) -> None:
        events = drive.events
        if point is not None:
            self._engine, events = point.engine, drive.events[point.count :]
            self._links.update(dict.fromkeys(point.links))
        decoded = DecodedEvents(events, hearing=self._engine.hearing)
        look_at = None if self.recorder is None else self.recorder.look_at
        for number, (event, heard) in enumerate(decoded):
            self._links.setdefault(_link_of(event))
            stepped(self._engine, event, look_at, heard)
            if progress is not None and number % TOLD_EVERY == 0:
                progress(number / len(events))
        if decoded.hearing is not None:
            self._engine.take_hearing(decoded.hearing)
        self._begin = self._last = drive.duration
        self._keep_at = drive.duration + KEEP_EVERY
        for link in self._links:
            self._step(SourceDown(self._begin, INTERRUPTED, link))

    def _read(self) -> None:
        source = self._source
        if source is None:
            return
        try:
            for event in source.events(self._stop):
                later = replace(event, arrival=self._begin + event.arrival) if self._begin else event
                self.tap.hear(later)
                self._events.put(later)
        except Exception as error:
            log.exception("the source failed")
            self._events.put(
                SourceDown(
                    self.now(),
                    sentence("{description} failed: {reason}", description=source.description, reason=str(error)),
                )
            )

    def _run(self) -> None:
        if self._source is None:
            self._publish(self._engine.snapshot)
        while not self._stop.is_set():
            try:
                event = self._events.get(timeout=self._patience())
            except queue.Empty:
                self._look_at_the_time()
                continue
            if event is not None:
                self._step(event)

    def _look_at_the_time(self) -> None:
        """Closes a half-received epoch whose time has come, and tells what nobody has been told yet."""
        self._publisher.tell()
        close, now = self._engine.close_epoch, self.now()
        if close is not None and close.arrival <= now:
            self._step(replace(close, arrival=now))
        elif self.recorder is not None and self.recorder.notice != self._notice:
            self._publish(self._engine.snapshot)

    def _patience(self) -> float:
        """How long the engine may sleep: to the close of a half-received epoch, or to the hearers' next turn."""
        patience = self._publisher.least_interval if self._publisher.pending else IDLE
        if self._engine.wake_at is not None:
            patience = min(patience, max(self._engine.wake_at - self.now(), 0.001))
        return patience

    def _step(self, event: Event) -> None:
        event = self._in_order(event)
        if self.recorder is not None:
            self.recorder.take(event)
        snapshot = stepped(self._engine, event, None if self.recorder is None else self.recorder.look_at)
        self._publish(snapshot)
        if event.arrival >= self._keep_at:
            self._keep_engine()

    def _keep_engine(self) -> None:
        """A copy for the recorder to keep, so that the drive is gone on with in a moment after a stop."""
        self._keep_at = self._last + KEEP_EVERY
        if self.recorder is not None:
            self.recorder.keep(self._engine.fork(), tuple(self._links))

    def _in_order(self, event: Event) -> Event:
        """The event with an arrival in whole microseconds, not before that of the last one."""
        self._links.setdefault(_link_of(event))
        arrival = max(round(event.arrival, MICROSECOND_DIGITS), self._last)
        self._last = arrival
        return event if arrival == event.arrival else replace(event, arrival=arrival)

    def _publish(self, snapshot: Snapshot) -> None:
        """With what the driver must know of the recording and is no part of the drive."""
        self._notice = None if self.recorder is None else self.recorder.notice
        if self._notice is not None:
            snapshot = replace(snapshot, notices=(*snapshot.notices, self._notice))
        self._publisher.publish(snapshot)


def _link_of(event: Event) -> str:
    return RECEIVER if isinstance(event, Commanded) else event.link
