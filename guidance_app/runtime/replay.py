"""A session on a log, under a person's hands: play, pause, faster, and to any second of it.

A jump back starts from the nearest checkpoint (an engine's ``fork``, kept every 20 s of the log that was played) and
takes the chunks from there to the wanted second as fast as the machine can. The driver's commands keep the place at
which they were given and act again when that place is passed again; only the look-ahead, which is about the screen
and not about the work, stays as it was set last.
"""

import bisect
import logging
import math
import queue
import threading
from collections.abc import Callable
from dataclasses import dataclass

from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.estimation.filter import FilterSettings
from guidance_app.model import Chunk, Command, Commanded, Event, SetLookAhead, Snapshot, SourceDown, SourceUp
from guidance_app.runtime.session import Hearer, Publisher
from guidance_app.runtime.tap import Tap
from guidance_app.sources.file import FileLog
from guidance_app.sources.pacing import Pacer, Seek

__all__ = ["ReplayControl", "ReplaySession", "ReplayState"]

log = logging.getLogger(__name__)

CHECKPOINT_EVERY = 20.0
"""Seconds of the log between two checkpoints."""


@dataclass(frozen=True, slots=True)
class ReplayState:
    """Where a replay stands. ``catching_up`` is the part (0 to 1) of a jump that is done, None when there is none."""

    position: float
    duration: float
    speed: float
    playing: bool
    ended: bool
    catching_up: float | None = None


class ReplayControl:
    """Play, pause, speed and seek; each returns at once and may be called from any thread."""

    def __init__(self, pacer: Pacer) -> None:
        self._pacer = pacer
        self.catching_up: float | None = None

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
    def state(self) -> ReplayState:
        """Where the replay stands now."""
        pacer = self._pacer
        return ReplayState(
            pacer.position, pacer.duration, pacer.speed, pacer.playing, pacer.ended, catching_up=self.catching_up
        )


@dataclass(frozen=True, slots=True)
class _Checkpoint:
    """The engine after the first ``index`` chunks and the first ``given`` commands, at ``arrival``."""

    arrival: float
    index: int
    given: int
    engine: Engine


class ReplaySession:
    """Drives the engine from a log at the chosen pace."""

    def __init__(
        self,
        job: Job,
        source: FileLog,
        filter_name: str | None = None,
        speed: float = 1.0,
        notices: tuple[str, ...] = (),
        settings: FilterSettings | None = None,
    ) -> None:
        self.job = job
        self.tap = Tap()
        self._log = source
        self._engine = Engine(job, filter_name=filter_name, settings=settings, notices=notices)
        self._engine.step(SourceUp(0.0, source.description))
        self._pacer = Pacer(source.chunks, speed)
        self.replay = ReplayControl(self._pacer)
        self._publisher = Publisher(self._engine.snapshot)
        self._posted: queue.SimpleQueue[Command] = queue.SimpleQueue()
        self._commands: list[Commanded] = []
        self._given = 0
        self._index = 0
        self._generation = 0
        self._look_ahead: SetLookAhead | None = None
        self._checkpoints = [_Checkpoint(0.0, 0, 0, self._engine.fork())]
        self._ended = False
        self._thread = threading.Thread(target=self._run, name="engine", daemon=True)

    def start(self) -> None:
        """Begins to play."""
        self._thread.start()
        self._pacer.play()

    def close(self) -> None:
        """Ends the engine thread and waits for it."""
        self._pacer.close()
        if self._thread.is_alive():
            self._thread.join(timeout=5.0)

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

    def _run(self) -> None:
        while not self._pacer.closed:
            due = self._pacer.next(self._patience())
            match due:
                case Chunk():
                    self.tap.hear(due)
                    self._advance(due)
                case Seek():
                    self._jump(due)
                case None:
                    self._publisher.tell()
            self._take_posted()
            self._close_epoch(self._here())
            self._note_the_end()

    def _patience(self) -> float | None:
        """How long nothing needs to be done but what the pacer has: to the hearers' turn or the close of an epoch."""
        waits = [self._publisher.least_interval] if self._publisher.pending else []
        wake_at, speed = self._engine.wake_at, self._pacer.speed
        if wake_at is not None and self._pacer.playing and math.isfinite(speed):
            waits.append(max((wake_at - self._pacer.position) / speed, 0.001))
        return min(waits, default=None)

    def _close_epoch(self, until: float) -> None:
        """Closes a half-received epoch whose time is over, at the instant at which a live session would."""
        chunks = self._log.chunks
        following = chunks[self._index].arrival if self._index < len(chunks) else math.inf
        while (close := self._engine.close_epoch) is not None and close.arrival <= until:
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
        """The playing position, between the chunk taken last and the next one."""
        chunks = self._log.chunks
        last = chunks[self._index - 1].arrival if self._index else 0.0
        following = chunks[self._index].arrival if self._index < len(chunks) else self._pacer.duration
        return min(max(self._pacer.position, last), following)

    def _remember(self, given: Commanded) -> None:
        """Keeps a command at its place. Checkpoints farther on do not know it and are dropped."""
        self._commands.insert(self._given, given)
        self._given += 1
        self._checkpoints = [one for one in self._checkpoints if one.index <= self._index]

    def _advance(self, chunk: Chunk) -> None:
        """One chunk, after the commands that were given before it."""
        while self._given < len(self._commands) and self._commands[self._given].arrival <= chunk.arrival:
            given = self._commands[self._given]
            self._given += 1
            self._close_epoch(given.arrival)
            self._step(given)
        self._close_epoch(chunk.arrival)
        self._index += 1
        self._step(chunk)
        last = self._checkpoints[-1]
        if self._index > last.index and chunk.arrival >= last.arrival + CHECKPOINT_EVERY:
            self._checkpoints.append(_Checkpoint(chunk.arrival, self._index, self._given, self._engine.fork()))

    def _step(self, event: Event) -> None:
        try:
            snapshot = self._engine.step(event)
        except Exception as error:
            log.exception("the engine failed on %s", type(event).__name__)
            snapshot = self._engine.failed(event.arrival, str(error))
        self._publisher.publish(snapshot)

    def _note_the_end(self) -> None:
        if self._pacer.ended and not self._ended:
            self._ended = True
            self._step(SourceDown(self._pacer.duration, f"{self._log.description} has ended", ended=True))
            self._publisher.tell()

    def _jump(self, seek: Seek) -> None:
        """Brings the engine to what the first ``seek.index`` chunks say; a newer jump or the end breaks it off."""
        start = self._checkpoints[bisect.bisect_right(self._checkpoints, seek.index, key=_index) - 1]
        if self._ended or not start.index <= self._index <= seek.index:
            self._generation += 1
            self._engine = start.engine.fork(generation=self._generation)
            self._index, self._given = start.index, start.given
            self._ended = False
            if self._look_ahead is not None:
                self._step(Commanded(start.arrival, self._look_ahead))
        todo = max(seek.index - self._index, 1)
        for done, index in enumerate(range(self._index, seek.index)):
            if self._pacer.closed or self._pacer.sought:
                break
            self.replay.catching_up = done / todo
            self._advance(self._log.chunks[index])
        self.replay.catching_up = None
        self._publisher.tell()


def _index(checkpoint: _Checkpoint) -> int:
    return checkpoint.index
