"""What every session shares: one engine thread, the newest snapshot, and those who hear of it.

The engine thread is the only one that touches the engine. Others read ``snapshot`` without a lock (a snapshot is
frozen and replaced whole), ``post`` commands into a queue and are called back by ``subscribe``. No exception crosses
a thread: one that a hearer raises is logged and the hearer dropped; one in the engine itself ends the session in a
state that the screen shows.
"""

import logging
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from guidance_app.documents import Job
from guidance_app.model import Command, Snapshot
from guidance_app.runtime.tap import Tap

if TYPE_CHECKING:
    from guidance_app.runtime.replay import ReplayControl

__all__ = ["Publisher", "Session"]

log = logging.getLogger(__name__)

Hearer = Callable[[Snapshot], None]


class Session(Protocol):
    """What the console knows of a session, live or replayed. Every method may be called from any thread."""

    @property
    def job(self) -> Job:
        """The documents in use."""
        ...

    @property
    def replay(self) -> "ReplayControl | None":
        """Play, pause and seek; None when the source is live."""
        ...

    @property
    def tap(self) -> Tap:
        """A look at the raw stream."""
        ...

    def snapshot(self) -> Snapshot:
        """The newest snapshot."""
        ...

    def now(self) -> float:
        """The session clock in seconds; of a replay the playing position."""
        ...

    def post(self, command: Command) -> None:
        """Hands a command to the engine; never waits."""
        ...

    def subscribe(self, hear: Hearer) -> Callable[[], None]:
        """Calls ``hear`` on the engine thread after each new snapshot, until the returned function is called."""
        ...

    def start(self) -> None:
        """Begins to read and to run."""
        ...

    def close(self) -> None:
        """Ends the threads and waits for them."""
        ...


class Publisher:
    """Keeps the newest snapshot and tells the hearers, at most so often that a fast replay does not drown them."""

    def __init__(self, first: Snapshot, least_interval: float = 0.015) -> None:
        self._snapshot = first
        self.least_interval = least_interval
        self._told = 0.0
        self._pending = False
        self._hearers: tuple[Hearer, ...] = ()
        self._lock = threading.Lock()

    @property
    def newest(self) -> Snapshot:
        """The newest snapshot."""
        return self._snapshot

    @property
    def pending(self) -> bool:
        """Whether the hearers still have to be told of the newest."""
        return self._pending

    def subscribe(self, hear: Hearer) -> Callable[[], None]:
        """Adds a hearer; the returned function takes it away."""
        with self._lock:
            self._hearers = (*self._hearers, hear)

        def unsubscribe() -> None:
            with self._lock:
                self._hearers = tuple(one for one in self._hearers if one is not hear)

        return unsubscribe

    def publish(self, snapshot: Snapshot) -> None:
        """Replaces the snapshot and tells the hearers, unless they were told a moment ago."""
        self._snapshot = snapshot
        self._pending = True
        if time.monotonic() - self._told >= self.least_interval:
            self.tell()

    def tell(self) -> None:
        """Tells the hearers of the newest snapshot if they do not know it yet."""
        if not self._pending:
            return
        self._pending = False
        self._told = time.monotonic()
        for hear in self._hearers:
            try:
                hear(self._snapshot)
            except Exception:
                log.exception("a hearer of the session failed and is dropped")
                with self._lock:
                    self._hearers = tuple(one for one in self._hearers if one is not hear)
