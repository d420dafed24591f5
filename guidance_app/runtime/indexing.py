"""The index of a recording: its engines every minute, so that any second is half a second away, and its passes' starts.

It is made once, by a process beside the replay that plays meanwhile, and kept in the user's cache folder under a name
that stands for the content, the documents, the filter and this very program.
"""

import contextlib
import hashlib
import io
import json
import logging
import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import BinaryIO

from guidance_app.model import Event
from guidance_app.runtime.cache import CachePickler, keep_newest, program_now
from guidance_app.runtime.checkpoints import Checkpoint, PassStart, PassStarts
from guidance_app.runtime.engines import Engines, Setup
from guidance_app.runtime.timeline import Timeline

__all__ = ["CHECKPOINT_S", "Index", "IndexPart", "index_parts", "steps_between"]

log = logging.getLogger(__name__)

CHECKPOINT_S = 60.0
"""Seconds of the recording between two checkpoints: at 10 Hz some 600 epochs to take again, at most, after a jump."""
LOOK_EVERY = 0.1
"""Seconds until it is noticed that the replay has been closed."""
KEPT = 20
"""Indexes in the cache folder; beyond that the one not used for longest goes."""


@dataclass(frozen=True, slots=True, eq=False)
class IndexPart:
    """A stretch of the index: a checkpoint, the passes that began before it, and how much is done, from 0 to 1."""

    checkpoint: Checkpoint | None
    starts: tuple[PassStart, ...]
    done: float


def steps_between(timeline: Timeline, engines: Engines, index: int) -> Iterator[Event]:
    """What the engines take for event number ``index``: where the session closes epochs, that before."""
    event = timeline.events[index]
    if timeline.closes_epochs:
        while (close := engines.close_epoch) is not None and close.arrival < event.arrival:
            yield close
    yield event


def index_parts(timeline: Timeline, setup: Setup, every: float = CHECKPOINT_S) -> Iterator[IndexPart]:
    """Takes the whole recording once."""
    engines, passes = Engines.made_of(setup), PassStarts()
    for event in timeline.first:
        engines.step(event)
    starts: list[PassStart] = []
    following = every
    duration = max(timeline.duration, every)
    for index in range(len(timeline.events)):
        for event in steps_between(timeline, engines, index):
            start = passes.look(engines.step(event))
            if start is not None:
                starts.append(start)
        arrival = timeline.events[index].arrival
        if arrival >= following:
            following = arrival + every
            checkpoint = Checkpoint(arrival, index + 1, 0, engines.fork())
            yield IndexPart(checkpoint, tuple(starts), min(arrival / duration, 1.0))
            starts.clear()
    yield IndexPart(None, tuple(starts), 1.0)


class Index:
    """Finds the parts of the index, in the cache or by a process of its own, and hands each one to ``hear``.

    ``hear`` is called on a thread of the index. ``folder`` None keeps nothing.
    """

    def __init__(
        self,
        timeline: Timeline,
        setup: Setup,
        hear: Callable[[IndexPart], None],
        folder: Path | None,
        every: float = CHECKPOINT_S,
    ) -> None:
        self._timeline = timeline
        self._setup = setup
        self._hear = hear
        self._folder = folder
        self._every = every
        self._done = 0.0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="index", daemon=True)

    @property
    def done(self) -> float:
        """The part that is there, from 0 to 1."""
        return self._done

    def start(self) -> None:
        """Begins to read or to make it."""
        self._thread.start()

    def close(self) -> None:
        """Ends it, and the process; what was made so far is dropped unless it was the whole."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join(timeout=5.0)

    def wait(self, timeout: float) -> bool:
        """Waits until all parts have been handed over."""
        self._thread.join(timeout)
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            path = None if self._folder is None else self._folder / f"{self._key()}.index"
            if path is None or not self._read(path):
                self._make(path)
        except Exception:
            log.exception("the index of %s cannot be made; jumps take longer without it", self._timeline.description)

    def _key(self) -> str:
        """Stands for everything that the index depends on."""
        digest = hashlib.sha256()
        if self._timeline.digest is not None:
            digest.update(self._timeline.digest.encode())
        else:
            for event in self._timeline.events:
                digest.update(getattr(event, "data", b""))
        setup = self._setup
        parts = [
            self._timeline.description,
            setup.job.model_dump_json(),
            setup.filter_name,
            None if setup.settings is None else setup.settings.model_dump_json(),
            setup.notices,
            None if setup.compare is None else _compared(setup),
            self._every,
            program_now(),
        ]
        digest.update(json.dumps(parts).encode())
        return digest.hexdigest()

    def _read(self, path: Path) -> bool:
        """Hands over what is in the cache; False when it is not there or not whole."""
        try:
            file = path.open("rb")
        except OSError:
            return False
        with file:
            unpickler = pickle.Unpickler(file)  # noqa: S301 - from this user's own cache folder, never from a recording
            while not self._stop.is_set():
                try:
                    part = unpickler.load()
                except (EOFError, pickle.UnpicklingError, AttributeError, ImportError, ValueError, TypeError):
                    log.warning("%s is damaged and made again", path)
                    return False
                self._take(part)
                if part.checkpoint is None:
                    path.touch()
                    return True
        return True

    def _make(self, path: Path | None) -> None:
        """Lets a process make it, hands each part over as it comes, and keeps the whole."""
        context = multiprocessing.get_context("spawn")
        receiving, sending = context.Pipe(duplex=False)
        process = context.Process(
            target=_work, args=(sending, self._timeline, self._setup, self._every), name="index", daemon=True
        )
        process.start()
        sending.close()
        feed = _Feed()
        unpickler = pickle.Unpickler(feed)  # noqa: S301 - from a process of this program, through its own pipe
        kept = _Kept(path)
        try:
            while not self._stop.is_set():
                if not receiving.poll(LOOK_EVERY):
                    continue
                frame = receiving.recv_bytes()
                kept.add(frame)
                feed.give(frame)
                part = unpickler.load()
                self._take(part)
                if part.checkpoint is None:
                    kept.finish()
                    break
        except EOFError:
            if not self._stop.is_set():
                log.warning("the process that makes the index of %s has ended early", self._timeline.description)
        finally:
            kept.drop()
            receiving.close()
            if self._stop.is_set():
                process.terminate()
            process.join(timeout=5.0)

    def _take(self, part: IndexPart) -> None:
        self._hear(part)
        self._done = part.done


class _Feed:
    """A file to read from, to which frames are added."""

    def __init__(self) -> None:
        self._held = io.BytesIO()

    def give(self, frame: bytes) -> None:
        """Everything given before has been read."""
        self._held = io.BytesIO(frame)

    def read(self, size: int = -1) -> bytes:
        return self._held.read(size)

    def readline(self) -> bytes:
        return self._held.readline()


def _work(sending: Connection, timeline: Timeline, setup: Setup, every: float) -> None:
    """The process: each part as one frame of one pickling, so that what checkpoints share is sent once."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the program that plays
    buffer = io.BytesIO()
    pickler = CachePickler(buffer, protocol=5)
    try:
        for part in index_parts(timeline, setup, every):
            pickler.dump(part)
            sending.send_bytes(buffer.getvalue())
            buffer.seek(0)
            buffer.truncate()
    except BrokenPipeError:
        return  # the replay has been closed
    finally:
        sending.close()


class _Kept:
    """The cache's file while it is made; a full disk only means that it is made again the next time."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._temporary = None if path is None else path.with_suffix(f".{os.getpid()}-{threading.get_ident()}.tmp")
        self._file: BinaryIO | None = None
        if self._temporary is not None:
            with self._warned():
                self._temporary.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
                self._file = self._temporary.open("wb")

    def add(self, frame: bytes) -> None:
        """One frame more."""
        if self._file is not None:
            with self._warned():
                self._file.write(frame)

    def finish(self) -> None:
        """It is whole: takes its place, and the oldest go."""
        if self._file is None or self._temporary is None or self._path is None:
            return
        with self._warned():
            self._file.close()
            self._temporary.replace(self._path)
            keep_newest(self._path.parent, "*.index", KEPT)

    def drop(self) -> None:
        """Leaves nothing behind that is not whole."""
        if self._file is not None:
            self._file.close()
            self._file = None
        if self._temporary is not None:
            with contextlib.suppress(OSError):
                self._temporary.unlink(missing_ok=True)

    @contextlib.contextmanager
    def _warned(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            log.warning("the index is not kept: %s", error)
            self.drop()


def _compared(setup: Setup) -> dict[str, object]:
    assert setup.compare is not None
    members = asdict(setup.compare)
    if setup.compare.settings is not None:
        members["settings"] = setup.compare.settings.model_dump_json()
    return members
