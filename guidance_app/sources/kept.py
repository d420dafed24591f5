"""A link that is kept open: opened, read, and opened again for ever, with a pause that grows while nothing comes.

What a link is made of is a ``Connection``; how it is opened, a function. Both say what is wrong by ``LinkError``, in
one sentence for the driver. Everything happens on the thread that takes the events; only ``write`` may be called from
another one.
"""

import logging
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

from guidance_app.model import RECEIVER, Chunk, SourceDown, SourceUp

__all__ = ["READ_S", "Connection", "Kept", "LinkError", "Pauses"]

log = logging.getLogger(__name__)

READ_S = 0.2
"""A read gives up after so long, so that a source ends promptly when it is told to."""


class LinkError(Exception):
    """Why a link cannot be opened or has broken, and what to do: one sentence for the driver."""


class Connection(Protocol):
    """One open link. ``what`` is what it reads from, and may change while it is open (a baud rate that was found)."""

    @property
    def what(self) -> str:
        """What is read from, for the driver."""
        ...

    def read(self) -> bytes:
        """What has come, as soon as something has; nothing after ``READ_S``. Raises ``LinkError``."""
        ...

    def write(self, data: bytes) -> None:
        """Sends these bytes. Raises ``LinkError``."""
        ...

    def close(self) -> None:
        """Closes it; never raises."""
        ...


@dataclass(frozen=True, slots=True)
class Pauses:
    """Seconds before the next try: ``first``, then twice as long each time, up to ``longest``."""

    first: float = 0.5
    longest: float = 5.0


Connect = Callable[[threading.Event], Connection]
"""Opens the link; gives up early when the event is set. Raises ``LinkError``."""


class Kept:
    """A live source that opens its link again whenever it breaks."""

    live = True
    duration: float | None = None

    def __init__(self, description: str, connect: Connect, pauses: Pauses | None = None, link: str = RECEIVER) -> None:
        self.description = description
        self._connect = connect
        self._pauses = pauses or Pauses()
        self._link = link
        self._connection: Connection | None = None
        self._lock = threading.Lock()

    def write(self, data: bytes) -> bool:
        """Sends bytes to the other end, from any thread; whether the link was open and took them."""
        with self._lock:
            if self._connection is None:
                return False
            try:
                self._connection.write(data)
            except LinkError as error:
                log.info("%s did not take %d bytes: %s", self.description, len(data), error)
                return False
        return True

    def events(self, stop: threading.Event) -> Iterator[Chunk | SourceUp | SourceDown]:
        """``SourceUp`` when the link opens, its bytes, ``SourceDown`` when it breaks, until ``stop`` is set.

        While the link stays closed for the same reason that is said once.
        """
        start = time.monotonic()
        pause = self._pauses.first
        said = ""
        while not stop.is_set():
            heard = False
            try:
                with self._opened(stop) as connection:
                    for event in self._read(connection, stop, start):
                        said = ""
                        heard = heard or isinstance(event, Chunk)
                        yield event
            except LinkError as error:
                if str(error) != said and not stop.is_set():
                    said = str(error)
                    yield SourceDown(time.monotonic() - start, said, self._link)
            pause = self._pauses.first if heard else pause
            if stop.wait(pause):
                return
            pause = min(2.0 * pause, self._pauses.longest)

    def _opened(self, stop: threading.Event) -> "_Opened":
        return _Opened(self, self._connect(stop))

    def hold(self, connection: Connection | None) -> None:
        """Which connection ``write`` uses from now on."""
        with self._lock:
            self._connection = connection

    def _read(self, connection: Connection, stop: threading.Event, start: float) -> Iterator[Chunk | SourceUp]:
        what = ""
        while not stop.is_set():
            data = b"" if not what else connection.read()
            if connection.what != what:
                what = connection.what
                yield SourceUp(time.monotonic() - start, what, self._link)
            if data:
                yield Chunk(time.monotonic() - start, data, self._link)


class _Opened:
    """A connection for the length of a block; afterwards nobody writes to it any more, and it is closed."""

    def __init__(self, kept: Kept, connection: Connection) -> None:
        self._kept = kept
        self._connection = connection

    def __enter__(self) -> Connection:
        self._kept.hold(self._connection)
        return self._connection

    def __exit__(self, *_: object) -> None:
        self._kept.hold(None)
        self._connection.close()
