"""Time for what has none of its own: the only place that sleeps.

``Pacer`` plays a log under a person's hands: play, pause, faster, slower, there and back. ``Paced`` puts a source
that gives everything at once in front of the clock, once, from beginning to end.
"""

import bisect
import math
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from guidance_app.sources import Source, SourceEvent

__all__ = ["MAX_SPEED", "MIN_SPEED", "Paced", "Pacer", "Seek"]

MIN_SPEED = 0.5
MAX_SPEED = 50.0
"""The slowest and fastest play; ``math.inf`` beside them plays as fast as the chunks are taken."""


class Timed(Protocol):
    """Anything with a time in seconds of the log."""

    @property
    def arrival(self) -> float:
        """When it is due."""
        ...


T = TypeVar("T", bound=Timed)


@dataclass(frozen=True, slots=True)
class Seek:
    """The playing position has jumped to ``position``. What was made of earlier chunks is void.

    The first ``index`` chunks lie at or before ``position``: bring the state to what they say, from the start or from
    a checkpoint. The next chunk that the pacer gives is number ``index``.
    """

    position: float
    index: int


class Pacer(Generic[T]):
    """Plays chunks in their own time, from one consumer's thread, under control from any other.

    The consumer calls ``next`` in a loop and gets, in this order of precedence,

    - a ``Seek``, once for each jump (jumps that follow each other before it is taken become one), and always before
      any chunk of the new place;
    - a ``Chunk`` that is due; chunks that are overdue come one after the other without waiting;
    - None when ``timeout`` has passed, or at once when a control has changed something, so that a consumer with timers
      of its own can look at them again; after ``close`` always None.

    A chunk is due when ``position`` reaches its arrival. ``position`` is in seconds of the log; it moves smoothly
    between chunks while playing, never runs past a chunk that has not been taken, and stands still while paused and
    at the end. Playing begins with ``play``. At the end ``ended`` is true; ``play`` there begins from the start.
    With the speed ``math.inf`` every chunk is due at once and the position is that of the chunk taken last.
    """

    def __init__(self, chunks: Sequence[T], speed: float = 1.0, clock: Callable[[], float] = time.monotonic) -> None:
        self._chunks = chunks
        self._clock = clock
        self._changed = threading.Condition()
        self._speed = _checked(speed)
        self._playing = False
        self._closed = False
        self._index = 0
        self._sought: Seek | None = None
        self._controls = 0
        self._anchor_position = 0.0
        self._anchor_time = clock()
        self.duration = chunks[-1].arrival if chunks else 0.0

    @property
    def position(self) -> float:
        """Seconds of the log that have been played."""
        with self._changed:
            return self._position_now()

    @property
    def speed(self) -> float:
        """Seconds of the log for each second of the clock."""
        return self._speed

    @property
    def playing(self) -> bool:
        """Whether time runs; false at the end."""
        with self._changed:
            return self._playing and not self._at_end()

    @property
    def ended(self) -> bool:
        """Whether every chunk has been taken."""
        with self._changed:
            return self._at_end()

    @property
    def closed(self) -> bool:
        """Whether the consumer should leave its loop."""
        return self._closed

    def next(self, timeout: float | None = None) -> T | Seek | None:
        """The next thing to do, or None after ``timeout`` seconds of the clock or a control; see the class."""
        with self._changed:
            controls = self._controls
            deadline = math.inf if timeout is None else self._clock() + timeout
            while not self._closed:
                if self._sought is not None:
                    seek, self._sought = self._sought, None
                    return seek
                now = self._clock()
                due = self._due()
                if due <= now:
                    return self._take()
                if self._controls != controls or deadline <= now:
                    return None
                wait = min(due, deadline) - now
                self._changed.wait(None if wait == math.inf else wait)
            return None

    def play(self) -> None:
        """Lets time run; at the end, from the start again."""
        with self._changed:
            if self._at_end():
                self._jump(0.0)
            self._hold()
            self._playing = True
            self._wake()

    def pause(self) -> None:
        """Stops time."""
        with self._changed:
            self._hold()
            self._playing = False
            self._wake()

    def set_speed(self, speed: float) -> None:
        """Plays at 0.5 to 50 times real time, or as fast as possible with ``math.inf``. Raises ``ValueError``."""
        checked = _checked(speed)
        with self._changed:
            self._hold()
            self._speed = checked
            self._wake()

    def seek(self, position: float) -> None:
        """Jumps to ``position`` in seconds of the log, cut to its length; playing or paused as before."""
        with self._changed:
            self._jump(position)
            self._wake()

    @property
    def sought(self) -> bool:
        """Whether a jump waits to be taken."""
        return self._sought is not None

    def interrupt(self) -> None:
        """Makes a waiting ``next`` give None at once, so that its consumer can look at what else there is."""
        with self._changed:
            self._wake()

    def close(self) -> None:
        """Ends it: ``next`` gives None from now on, at once where it waits."""
        with self._changed:
            self._closed = True
            self._wake()

    def _wake(self) -> None:
        self._controls += 1
        self._changed.notify_all()

    def _at_end(self) -> bool:
        return self._index >= len(self._chunks)

    def _jump(self, position: float) -> None:
        place = min(max(position, 0.0), self.duration)
        self._index = bisect.bisect_right(self._chunks, place, key=_arrival)
        self._sought = Seek(place, self._index)
        self._anchor_position, self._anchor_time = place, self._clock()

    def _hold(self) -> None:
        """Makes here and now the point from which the position is reckoned."""
        self._anchor_position, self._anchor_time = self._position_now(), self._clock()

    def _position_now(self) -> float:
        position = self._anchor_position
        if self._playing and math.isfinite(self._speed):
            position += (self._clock() - self._anchor_time) * self._speed
        end = self.duration if self._at_end() else self._chunks[self._index].arrival
        return min(position, max(end, self._anchor_position))

    def _due(self) -> float:
        """When the next chunk is due, on the clock; infinity when nothing will be."""
        if not self._playing or self._at_end():
            return math.inf
        if math.isinf(self._speed):
            return self._anchor_time
        return self._anchor_time + (self._chunks[self._index].arrival - self._anchor_position) / self._speed

    def _take(self) -> T:
        chunk = self._chunks[self._index]
        self._index += 1
        if math.isinf(self._speed):
            self._anchor_position = chunk.arrival
        return chunk


class Paced:
    """A source whose chunks come when their time has come, once through, ``speed`` times real time."""

    live = True

    def __init__(self, source: Source, speed: float = 1.0) -> None:
        self.description = source.description
        self.duration = source.duration
        self._source = source
        self._speed = _checked(speed)

    def events(self, stop: threading.Event) -> Iterator[SourceEvent]:
        """The source's own events, each not before its arrival; ends early when ``stop`` is set."""
        start = time.monotonic()
        for event in self._source.events(stop):
            if stop.wait(max(0.0, start + event.arrival / self._speed - time.monotonic())):
                return
            yield event


def _arrival(chunk: Timed) -> float:
    return chunk.arrival


def _checked(speed: float) -> float:
    if speed == math.inf or MIN_SPEED <= speed <= MAX_SPEED:
        return speed
    msg = f"{speed} is no speed to play at: it goes from {MIN_SPEED:g} to {MAX_SPEED:g} times real time, or without end"
    raise ValueError(msg)
