r"""Events to lines of text and back, so that a file that is cut at any byte still opens up to the cut.

A line is four hexadecimal digits, a blank, a JSON array and a line feed::

    6c1f [12.4,"bytes","receiver","$GPGGA,073000.00,...*6F\r\n"]
    a03e [12.9,"command","Nudge",{"metres":0.1,"kind":"nudge"}]
    17b2 [0.0,"up","receiver","serial /dev/ttyUSB0"]
    0d44 [80.2,"down","receiver","the cable was pulled out",false]

The digits are the lower half of the CRC-32 over every array so far, this one included: they tell a damaged line, and
also one that is missing, doubled or out of its place. Bytes stand as the characters of the same numbers (Latin 1).
Numbers are written so that they read back to the bit. A command stands under the name of its class with the members
of its record; the table of commands is that of the vocabulary itself, so none can be forgotten.
"""

import json
import typing
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from types import MappingProxyType
from typing import Any, assert_never, overload

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from guidance_app.model import Chunk, Command, Commanded, Event, FloatArray, SourceDown, SourceUp

__all__ = ["FORMAT", "LineWriter", "Lines", "RecordingError", "read_lines"]

FORMAT = 1
"""The version of these lines; one that only adds commands needs no new number, as an unknown command is told."""

TOLD_EVERY = 5000
"""Lines between two words about progress."""

_ADAPTERS: Mapping[str, TypeAdapter[Any]] = MappingProxyType(
    {kind.__name__: TypeAdapter(kind) for kind in typing.get_args(Command)}
)
"""Name of a command's class -> what writes and reads its members."""


class RecordingError(ValueError):
    """A line that this program cannot read although it is whole; the message says why."""


class LineWriter:
    """Writes events as lines, one after the other. ``check`` is the running CRC-32 of what was written before."""

    def __init__(self, check: int = 0) -> None:
        self.check = check

    def line(self, event: Event) -> bytes:
        """The event's line."""
        text = json.dumps(_row_of(event), separators=(",", ":"), allow_nan=False).encode()
        self.check = zlib.crc32(text, self.check)
        return b"%04x %s\n" % (self.check & 0xFFFF, text)


class Lines(Sequence[Event]):
    """The events of a recording, read from their lines when they are asked for.

    ``arrivals`` never steps back, shape (N,). ``size`` is the length in bytes of what could be read, and ``check`` the
    running CRC-32 at its end; ``left_over`` is how many bytes behind it could not be read.
    """

    def __init__(self, text: bytes, ends: NDArray[np.int64], arrivals: FloatArray, check: int) -> None:
        self.text = text
        self.arrivals = np.maximum.accumulate(arrivals) if len(arrivals) else arrivals
        self.arrivals.setflags(write=False)
        self.size = int(ends[-1]) if len(ends) else 0
        self.left_over = len(text) - self.size
        self.check = check
        self._ends = ends

    def __len__(self) -> int:
        return len(self._ends)

    def size_of(self, count: int) -> int:
        """The length in bytes of the first ``count`` lines."""
        return int(self._ends[count - 1]) if count else 0

    @overload
    def __getitem__(self, index: int) -> Event: ...

    @overload
    def __getitem__(self, index: slice) -> list[Event]: ...

    def __getitem__(self, index: int | slice) -> Event | list[Event]:
        if isinstance(index, slice):
            return [self[place] for place in range(*index.indices(len(self)))]
        place = range(len(self))[index]
        start = int(self._ends[place - 1]) if place else 0
        return _event_of(json.loads(self.text[start + _PREFIX : int(self._ends[place])]))


def read_lines(text: bytes, progress: Callable[[float], None] | None = None) -> Lines:
    """The events of a file up to the first byte that is not as it was written. Raises ``RecordingError``.

    It raises only for a line that is whole and that a newer program has written; ``progress`` hears parts of 1.
    """
    ends: list[int] = []
    arrivals: list[float] = []
    start = check = 0
    while (end := text.find(b"\n", start) + 1) > 0:
        row_text = text[start + _PREFIX : end - 1]
        following = zlib.crc32(row_text, check)
        if text[start : start + _PREFIX] != b"%04x " % (following & 0xFFFF):
            break
        try:
            row = json.loads(row_text)
            arrivals.append(float(row[0]))
        except (ValueError, TypeError, IndexError, KeyError, RecursionError):
            break
        if row[1] != "bytes":
            _event_of(row)
        check = following
        ends.append(end)
        start = end
        if progress is not None and len(ends) % TOLD_EVERY == 0:
            progress(end / len(text))
    return Lines(text, np.array(ends, dtype=np.int64), np.array(arrivals, dtype=np.float64), check)


_PREFIX = 5
"""Characters before the array."""


def _row_of(event: Event) -> list[Any]:
    match event:
        case Chunk():
            return [float(event.arrival), "bytes", event.link, event.data.decode("latin-1")]
        case Commanded():
            name = type(event.command).__name__
            return [float(event.arrival), "command", name, _ADAPTERS[name].dump_python(event.command, mode="json")]
        case SourceUp():
            return [float(event.arrival), "up", event.link, event.what]
        case SourceDown():
            return [float(event.arrival), "down", event.link, event.reason, event.ended]
        case _:
            assert_never(event)


def _event_of(row: list[Any]) -> Event:
    try:
        match row:
            case [arrival, "bytes", str(link), str(text)]:
                return Chunk(float(arrival), text.encode("latin-1"), link)
            case [arrival, "command", str(name), dict(members)]:
                return Commanded(float(arrival), _command_of(name, members))
            case [arrival, "up", str(link), str(what)]:
                return SourceUp(float(arrival), what, link)
            case [arrival, "down", str(link), str(reason), bool(ended)]:
                return SourceDown(float(arrival), reason, link, ended)
    except (TypeError, UnicodeEncodeError) as error:
        raise RecordingError(_newer(f"an event whose members are strange ({error})")) from error
    raise RecordingError(_newer(f"an event {json.dumps(row)[:60]}"))


def _command_of(name: str, members: dict[str, Any]) -> Command:
    adapter = _ADAPTERS.get(name)
    if adapter is None:
        raise RecordingError(_newer(f"the command '{name[:40]}'"))
    try:
        command: Command = adapter.validate_python(members)
    except ValidationError as error:
        raise RecordingError(_newer(f"a command '{name}' whose members are {json.dumps(members)[:80]}")) from error
    if strange := set(members) - {one.name for one in fields(command)}:
        raise RecordingError(_newer(f"a command '{name}' with the member '{min(strange)[:40]}'"))
    return command


def _newer(what: str) -> str:
    return f"it holds {what}, which this program does not know: it was recorded by a newer one; update this one"
