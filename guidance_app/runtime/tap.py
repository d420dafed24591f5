"""A look at the raw stream as it comes in: the last lines, how fast, and which sentences. Bounded, whatever comes.

The reader thread gives it every event of the source; any other thread may look. It decides nothing and decodes
nothing: what it counts are names, of sentences that the decoder knows and of others, right or wrong.
"""

import re
import threading
from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, field

from guidance_app.model import RECEIVER, Chunk, SourceDown, SourceUp

__all__ = ["RawStream", "Tap"]

LINES_KEPT = 30
LONGEST_LINE = 200
"""Of a line without an end so many bytes are shown, and the rest is dropped."""

RATE_OVER_S = 5.0
MOST_NAMES = 60
"""Noise makes up names without end; what is new beyond so many is counted together."""

OTHERS = "others"
_find_names = re.compile(rb"[$#]([A-Z][A-Z0-9]{2,9}),").finditer
_split_lines = re.compile(rb"[\r\n]+").split


@dataclass(frozen=True, slots=True)
class RawStream:
    """What one link's stream looks like now. ``lines`` are bytes as they came, oldest first; ``rate`` bytes a second.

    ``kinds`` counts the names of sentences with their talkers (GNGGA), most frequent first.
    """

    lines: tuple[bytes, ...] = ()
    total: int = 0
    rate: float = 0.0
    last: float | None = None
    kinds: Mapping[str, int] = field(default_factory=dict)


class _Stream:
    """One link's."""

    def __init__(self) -> None:
        self.lines: deque[bytes] = deque(maxlen=LINES_KEPT)
        self.rest = b""
        self.total = 0
        self.seconds: deque[tuple[int, int]] = deque(maxlen=round(RATE_OVER_S) + 2)
        self.last: float | None = None
        self.kinds: Counter[str] = Counter()

    def take(self, chunk: Chunk) -> None:
        self.total += len(chunk.data)
        self.last = chunk.arrival
        second = int(chunk.arrival)
        before = self.seconds.pop()[1] if self.seconds and self.seconds[-1][0] == second else 0
        self.seconds.append((second, before + len(chunk.data)))
        *whole, self.rest = _split_lines(self.rest + chunk.data)
        self.lines.extend(line[:LONGEST_LINE] for line in whole[-LINES_KEPT:] if line)
        for line in whole:
            self._count(line)
        if len(self.rest) > LONGEST_LINE:
            self._count(self.rest)
            self.lines.append(self.rest[:LONGEST_LINE])
            self.rest = b""

    def _count(self, line: bytes) -> None:
        for match in _find_names(line):
            name = match[1].decode("ascii")
            self.kinds[name if name in self.kinds or len(self.kinds) < MOST_NAMES else OTHERS] += 1

    def rate(self, now: float) -> float:
        """Bytes a second over the last whole seconds."""
        this = int(now)
        return sum(count for second, count in self.seconds if this - RATE_OVER_S <= second < this) / RATE_OVER_S


class Tap:
    """Hears what comes over each link. Any thread may call it."""

    def __init__(self) -> None:
        self._streams: dict[str, _Stream] = {}
        self._lock = threading.Lock()

    def hear(self, event: Chunk | SourceUp | SourceDown) -> None:
        """One event of the source; only bytes count."""
        if isinstance(event, Chunk) and event.data:
            with self._lock:
                self._streams.setdefault(event.link, _Stream()).take(event)

    def look(self, now: float, link: str = RECEIVER) -> RawStream:
        """The stream of a link at this session time; an empty one when nothing has come over it."""
        with self._lock:
            stream = self._streams.get(link)
            if stream is None:
                return RawStream()
            kinds = dict(stream.kinds.most_common())
            return RawStream(tuple(stream.lines), stream.total, stream.rate(now), stream.last, kinds)
