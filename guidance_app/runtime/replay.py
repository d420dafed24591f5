"""A session on a log or a recorded drive, under a person's hands: play, pause, faster, and to any second of it.

A jump back starts from the nearest checkpoint (a copy of the engine, kept every 20 s of what was played, and with an
index every minute of the whole) and takes the events from there to the wanted second as fast as the machine can. The
driver's commands keep the place at which they were given and act again when that place is passed again; only the
look-ahead, which is about the screen and not about the work, stays as it was set last, and then goes before the one
that was set in a recorded drive.
"""

import bisect
import math
import queue
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from guidance_app.documents import Job
from guidance_app.estimation.filter import FilterSettings
from guidance_app.language import sentence
from guidance_app.model import Command, Commanded, Event, SetLookAhead, Snapshot, SourceDown
from guidance_app.recording import RecordedDrive
from guidance_app.runtime.checkpoints import Checkpoint, Checkpoints, PassStart, PassStarts
from guidance_app.runtime.engines import Comparison, Engines, Setup
from guidance_app.runtime.indexing import CHECKPOINT_S, Index, IndexPart
from guidance_app.runtime.session import Hearer, Publisher
from guidance_app.runtime.tap import Tap
from guidance_app.runtime.timeline import timeline_of
from guidance_app.sources.file import FileLog
from guidance_app.sources.pacing import Pacer, Seek

__all__ = ["ReplayControl", "ReplaySession", "ReplayState"]

CHECKPOINT_EVERY = 20.0
"""Seconds of the log between two checkpoints that are kept while it is played."""
BEFORE_PASS = 2.0
"""A jump to a pass goes so many seconds before it."""
NEAR_START = 5.0
SAME_PLACE = 0.5
SHORTEST_WAIT = 0.001


@dataclass(frozen=True, slots=True)
class ReplayState:
    """Where a replay stands. ``catching_up`` is the part (0 to 1) of a jump that is done, None when there is none.

    ``indexed`` is the part of the recording that any jump reaches at once, None where no index is made.
    """

    position: float
    duration: float
    speed: float
    playing: bool
    ended: bool
    catching_up: float | None = None
    indexed: float | None = None


class ReplayControl:
    """Play, pause, speed and seek; each returns at once and may be called from any thread."""

    def __init__(self, pacer: Pacer[Event], starts: PassStarts) -> None:
        self._pacer = pacer
        self._starts = starts
        self.catching_up: float | None = None
        self.indexed: float | None = None

    def play(self) -> None:
        """Lets time run; at the end, from the start again."""
        self._pacer.play()

    def pause(self) -> None:
        """Stops time."""
        self._pacer.pause()

    def set_speed(self, speed: float) -> None:
        """0.5 to 50 times real time, or ``math.inf``. Raises ``ValueError`` otherwise."""
        self._pacer.set_speed(speed)

    def seek(self, position: float) -> None:
        """Jumps to so many seconds from the start, cut to the log's length."""
        self._pacer.seek(position)

    @property
    def passes(self) -> tuple[PassStart, ...]:
        """When the tractor came onto each pass: all of them with a whole index, else those that were played."""
        return self._starts.found

    def seek_pass(self, number: int) -> bool:
        """Jumps to just before the tractor first came onto this pass; False when that is not known."""
        start = next((one for one in self._starts.found if one.number == number), None)
        if start is None:
            return False
        self.seek(start.position - BEFORE_PASS)
        return True

    def step_pass(self, steps: int) -> bool:
        """Jumps so many starts of a pass ahead, or back if negative; False where there is none."""
        here = self._pacer.position + BEFORE_PASS
        starts = [one.position for one in self._starts.found]
        place = bisect.bisect_right(starts, here + SAME_PLACE) + steps - 1
        if steps < 0 and place + 1 < len(starts) and here - starts[place + 1] > NEAR_START:
            place += 1  # well inside a pass, back is its own start
        if not 0 <= place < len(starts):
            return False
        self.seek(starts[place] - BEFORE_PASS)
        return True

    @property
    def state(self) -> ReplayState:
        """Where the replay stands now."""
        pacer = self._pacer
        return ReplayState(
            pacer.position,
            pacer.duration,
            pacer.speed,
            pacer.playing,
            pacer.ended,
            catching_up=self.catching_up,
            indexed=self.indexed,
        )


class ReplaySession:
    """Drives the engine from a log, or from a recorded drive, at the chosen pace. ``of_drive`` takes all from a drive.

    ``compare`` lets a second engine take the same events; its track is the snapshots' ``ghost``.
    """

    def __init__(  # noqa: PLR0913 - what a replay is made of; a call names each
        self,
        job: Job,
        source: FileLog | RecordedDrive,
        filter_name: str | None = None,
        speed: float = 1.0,
        notices: tuple[str, ...] = (),
        settings: FilterSettings | None = None,
        *,
        compare: Comparison | None = None,
    ) -> None:
        self.job = job
        self.tap = Tap()
        self._setup = Setup(job, filter_name, settings, notices, compare)
        self._source = source
        self._timeline = timeline_of(source)
        self._engines = Engines.made_of(self._setup)
        for event in self._timeline.first:
            self._engines.step(event)
        self._pacer: Pacer[Event] = Pacer(self._timeline.events, speed)
        self._starts = PassStarts()
        self.replay = ReplayControl(self._pacer, self._starts)
        self._publisher = Publisher(self._engines.snapshot)
        self._posted: queue.SimpleQueue[Command] = queue.SimpleQueue()
        self._commands: list[Commanded] = []
        self._given = 0
        self._index = 0
        self._generation = 0
        self._look_ahead: SetLookAhead | None = None
        self._checkpoints = Checkpoints(self._engines.fork())
        self._ended = False
        self._indexing: Index | None = None
        self._thread = threading.Thread(target=self._run, name="engine", daemon=True)

    @classmethod
    def of_drive(cls, drive: RecordedDrive, speed: float = 1.0, compare: Comparison | None = None) -> "ReplaySession":
        """The drive as it was, with its own documents and filter; what it breaks off at is among the notices."""
        return cls(drive.job, drive, drive.filter_name, speed, drive.notices, drive.settings, compare=compare)

    def again(self, compare: Comparison | None) -> "ReplaySession":
        """The same from the start, not begun, beside another second engine, or none.

        Raises ``ValueError`` for what documents cannot hold.
        """
        setup, speed = self._setup, self._pacer.speed
        return ReplaySession(
            setup.job, self._source, setup.filter_name, speed, setup.notices, setup.settings, compare=compare
        )

    @property
    def compare(self) -> Comparison | None:
        """What the second engine has else; None without one."""
        return self._setup.compare

    @property
    def filter_name(self) -> str:
        """The filter of the drive's own engine."""
        return self._engines.snapshot.filter_name

    def make_index(self, folder: Path | None, every: float = CHECKPOINT_S) -> None:
        """Makes any second near: reads the index from this folder, or lets a process make it. Returns at once."""
        if self._indexing is None:
            self.replay.indexed = 0.0
            self._indexing = Index(self._timeline, self._setup, self._take_part, folder, every)
            self._indexing.start()

    def wait_for_index(self, timeout: float) -> bool:
        """Waits until the index is whole; False when it is not by then, or none is made."""
        return self._indexing is not None and self._indexing.wait(timeout) and self._indexing.done >= 1.0

    def start(self) -> None:
        """Begins to play."""
        self._thread.start()
        self._pacer.play()

    def close(self) -> None:
        """Ends the engine thread and waits for it."""
        self._pacer.close()
        if self._thread.is_alive():
            self._thread.join(timeout=5.0)
        if self._indexing is not None:
            self._indexing.close()

    def snapshot(self) -> Snapshot:
        """The newest snapshot."""
        return self._publisher.newest

    def now(self) -> float:
        """The playing position in seconds from the start of the log."""
        return self._pacer.position

    def post(self, command: Command) -> None:
        """Hands a command to the engine, which takes it at the playing position; never waits."""
        self._posted.put(command)
        self._pacer.interrupt()

    def subscribe(self, hear: Hearer) -> Callable[[], None]:
        """Calls ``hear`` after each new snapshot."""
        return self._publisher.subscribe(hear)

    def _take_part(self, part: IndexPart) -> None:
        """On the index's thread."""
        if part.checkpoint is not None:
            self._checkpoints.add_found(part.checkpoint)
        self._starts.take(part.starts)
        self.replay.indexed = part.done

    def _run(self) -> None:
        while not self._pacer.closed:
            due = self._pacer.next(self._patience())
            match due:
                case Seek():
                    self._jump(due)
                case None:
                    self._publisher.tell()
                case _:
                    if not isinstance(due, Commanded):
                        self.tap.hear(due)
                    self._advance(due)
            self._take_posted()
            self._close_epoch(self._here())
            self._note_the_end()

    def _patience(self) -> float | None:
        """How long nothing needs to be done but what the pacer has: to the hearers' turn or the close of an epoch."""
        waits = [self._publisher.least_interval] if self._publisher.pending else []
        wake_at, speed = self._engines.wake_at, self._pacer.speed
        if self._timeline.closes_epochs and wake_at is not None and self._pacer.playing and math.isfinite(speed):
            waits.append(max((wake_at - self._pacer.position) / speed, SHORTEST_WAIT))
        return min(waits, default=None)

    def _close_epoch(self, until: float) -> None:
        """Closes a half-received epoch whose time is over, at the instant at which a live session would."""
        if not self._timeline.closes_epochs:
            return
        events = self._timeline.events
        following = events[self._index].arrival if self._index < len(events) else math.inf
        while (close := self._engines.close_epoch) is not None and close.arrival <= until:
            if close.arrival >= following:
                return
            self._step(close)

    def _take_posted(self) -> None:
        """Takes what was posted, here; while a jump waits, there."""
        while not (self._pacer.sought or self._posted.empty()):
            given = Commanded(self._here(), self._posted.get())
            self._close_epoch(given.arrival)
            if isinstance(given.command, SetLookAhead):
                self._look_ahead = given.command
            else:
                self._remember(given)
            self._step(given)

    def _here(self) -> float:
        """The playing position, between the event taken last and the next one."""
        events = self._timeline.events
        last = events[self._index - 1].arrival if self._index else 0.0
        following = events[self._index].arrival if self._index < len(events) else self._pacer.duration
        return min(max(self._pacer.position, last), following)

    def _remember(self, given: Commanded) -> None:
        """Keeps a command at its place. Checkpoints farther on do not know it and are dropped."""
        self._commands.insert(self._given, given)
        self._given += 1
        self._checkpoints.forget_after(self._index, given.arrival)

    def _advance(self, event: Event) -> None:
        """One event, after the commands that were given here before it."""
        while self._given < len(self._commands) and self._commands[self._given].arrival <= event.arrival:
            given = self._commands[self._given]
            self._given += 1
            self._close_epoch(given.arrival)
            self._step(given)
        self._close_epoch(event.arrival)
        self._index += 1
        if not (self._look_ahead is not None and _is_look_ahead(event)):
            self._step(event)
        last = self._checkpoints.before(self._index)
        if self._index > last.index and event.arrival >= last.arrival + CHECKPOINT_EVERY:
            checkpoint = Checkpoint(event.arrival, self._index, self._given, self._engines.fork())
            self._checkpoints.add(checkpoint)

    def _step(self, event: Event) -> None:
        snapshot = self._engines.step(event)
        start = self._starts.look(snapshot)
        if start is not None and (self._indexing is None or not self._indexing.done):
            self._starts.take((start,))
        self._publisher.publish(snapshot)

    def _note_the_end(self) -> None:
        if self._pacer.ended and not self._ended:
            self._ended = True
            self._step(
                SourceDown(
                    self._pacer.duration,
                    sentence("{description} has ended", description=self._timeline.description),
                    ended=True,
                )
            )
            self._publisher.tell()

    def _jump(self, seek: Seek) -> None:
        """Brings the engine to what the first ``seek.index`` events say; a newer jump or the end breaks it off."""
        start = self._checkpoints.before(seek.index)
        if self._ended or not start.index <= self._index <= seek.index:
            self._generation += 1
            self._engines = start.engines.fork(generation=self._generation)
            self._index, self._given = start.index, start.given
            self._ended = False
            if self._look_ahead is not None:
                self._step(Commanded(start.arrival, self._look_ahead))
        todo = max(seek.index - self._index, 1)
        for done, index in enumerate(range(self._index, seek.index)):
            if self._pacer.closed or self._pacer.sought:
                break
            self.replay.catching_up = done / todo
            self._advance(self._timeline.events[index])
        self.replay.catching_up = None
        self._publisher.publish(self._engines.snapshot)
        self._publisher.tell()


def _is_look_ahead(event: Event) -> bool:
    return isinstance(event, Commanded) and isinstance(event.command, SetLookAhead)
