"""Serial cables of pseudo terminals that a test plugs and unplugs, and a reader of a source on its own thread."""

import contextlib
import os
import threading
import time
import tty
from collections.abc import Callable, Iterator
from pathlib import Path

from guidance_app.model import Chunk, SourceDown, SourceUp
from guidance_app.sources import Source, SourceEvent

__all__ = ["PATIENCE_S", "Cable", "Reading", "reading"]

PATIENCE_S = 60.0
ENDS_WITHIN_S = 10.0
"""Shorter than any source waits for the other side, so one that does not hear of its end is found."""


class Cable:
    """A port at ``path`` while it is plugged in. Closing a pseudo terminal's master unplugs it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.master = -1

    def plug(self) -> None:
        self.master, device = os.openpty()
        tty.setraw(device)
        os.set_blocking(self.master, False)
        name = os.ttyname(device)
        os.close(device)
        self.path.unlink(missing_ok=True)
        self.path.symlink_to(name)

    def unplug(self) -> None:
        self.path.unlink(missing_ok=True)
        if self.master >= 0:
            os.close(self.master)
            self.master = -1

    def send(self, data: bytes) -> int:
        """So many bytes as the wire takes now."""
        try:
            return os.write(self.master, data)
        except BlockingIOError:
            return 0

    def sent_back(self) -> bytes:
        """What the program has written to the device."""
        try:
            return os.read(self.master, 1 << 16)
        except (BlockingIOError, OSError):
            return b""


class Reading:
    """Takes a source's events on a thread of its own, as a session does."""

    def __init__(self, source: Source, keep_chunks: bool = True) -> None:
        self.events: list[SourceEvent] = []
        self.bytes = 0
        self.failed: BaseException | None = None
        self._keep_chunks = keep_chunks
        self._changed = threading.Condition()
        self._stop = threading.Event()
        self._source = source
        self.thread = threading.Thread(target=self._run, name="source")
        self.thread.start()

    def _run(self) -> None:
        try:
            for event in self._source.events(self._stop):
                with self._changed:
                    self.bytes += len(event.data) if isinstance(event, Chunk) else 0
                    if self._keep_chunks or not isinstance(event, Chunk):
                        self.events.append(event)
                    self._changed.notify_all()
        except BaseException as error:
            self.failed = error
            raise

    def wait(self, fulfilled: Callable[["Reading"], bool], meanwhile: Callable[[], object] = lambda: None) -> None:
        """Until it is so; ``meanwhile`` is called again and again."""
        end = time.monotonic() + PATIENCE_S
        with self._changed:
            while not fulfilled(self):
                assert time.monotonic() < end, f"not in {PATIENCE_S} s; heard {self.told}"
                meanwhile()
                self._changed.wait(0.01)

    @property
    def data(self) -> bytes:
        return b"".join(one.data for one in self.events if isinstance(one, Chunk))

    @property
    def told(self) -> list[str]:
        """What was said of the link, in order."""
        return [
            f"up: {one.what}" if isinstance(one, SourceUp) else f"down: {one.reason}"
            for one in self.events
            if isinstance(one, SourceUp | SourceDown)
        ]

    def stop(self) -> None:
        """Ends it; it must hear of that by itself."""
        self._stop.set()
        self.thread.join(ENDS_WITHIN_S)
        assert not self.thread.is_alive()
        assert self.failed is None


@contextlib.contextmanager
def reading(source: Source, keep_chunks: bool = True) -> Iterator[Reading]:
    """Reads meanwhile."""
    one = Reading(source, keep_chunks)
    try:
        yield one
    finally:
        one.stop()
