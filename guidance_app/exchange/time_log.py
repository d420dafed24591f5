"""Time logs of ISOXML (TLG): a small XML file that tells the layout, and a binary file with one record an instant.

Layout of a record (ISO 11783-10, annex D): time of day in ms (u32) and days since 1980 (u16); those of the position's
members whose attribute is empty in the XML; a count and as many values, each the number of its DLV element (u8) and an
i32. A value holds until it is given again. Read and written here; what the values mean for a drive is in
``time_log_drive``.
"""

import math
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from types import MappingProxyType

from guidance_app.boundary import BoundaryError
from guidance_app.exchange.files import Files
from guidance_app.exchange.isoxml import root_of
from guidance_app.exchange.xml_tree import Element, children, first, local_name, parsed

__all__ = ["DAY_ZERO", "Instant", "LoggedValue", "TimeLogFile", "log_names", "read_instants", "written_log"]

DAY_ZERO = datetime(1980, 1, 1, tzinfo=UTC)
DEGREE = 1e7
"""Units of a latitude or longitude in a degree."""
POSITION: Mapping[str, str] = MappingProxyType(
    {"A": "i", "B": "i", "C": "i", "D": "B", "E": "H", "F": "H", "G": "B", "H": "I", "I": "H"}
)
"""Members of PTN and their binary form: north, east, up, status, PDOP, HDOP, satellites, UTC ms, UTC days."""
NO_POSITION = frozenset({0x7FFFFFFF, -0x80000000})
LARGEST = 86_400_000
"""Milliseconds of a day."""


@dataclass(frozen=True, slots=True)
class LoggedValue:
    """What a DLV of the layout stands for: the data dictionary identifier and the device element it is of."""

    ddi: int
    element: str


@dataclass(frozen=True, slots=True)
class Instant:
    """One record. ``utc`` is POSIX time; ``values`` holds what is in force, by the layout's number.

    ``position`` is latitude and longitude in degrees, None where the log has none; ``up`` is in metres. ``members`` has
    the other members of the position, as numbers of the standard.
    """

    utc: float
    position: tuple[float, float] | None
    up: float | None
    members: Mapping[str, float]
    values: Mapping[int, int]


@dataclass(frozen=True, slots=True)
class TimeLogFile:
    """A log's name, its layout and all its records. ``cut_off`` says how many bytes at the end made no record."""

    name: str
    layout: tuple[LoggedValue, ...]
    instants: tuple[Instant, ...]
    cut_off: int


def log_names(files: Files) -> tuple[str, ...]:
    """The time logs whose two files are there, in the order of the task data."""
    root, _ = root_of(files)
    named = [log.get("A", "") for task in children(root, "TSK") for log in children(task, "TLG")]
    return tuple(name for name in named if files.called(f"{name}.bin") and files.called(f"{name}.xml"))


def read_instants(files: Files, name: str) -> TimeLogFile:
    """The records of a time log. Raises ``BoundaryError``."""
    head, data = files.called(f"{name}.xml"), files.called(f"{name}.bin")
    if head is None or data is None:
        msg = f"the time log {name} is not complete: {name}.{'XML' if head is None else 'BIN'} is missing"
        raise BoundaryError(msg)
    layout = _Layout.of(parsed(files.content(head), "ISOXML"), name)
    content = files.content(data)
    instants = []
    used = 0
    for instant, end in layout.records(content):
        instants.append(instant)
        used = end
    if not instants:
        msg = f"the time log {name} holds no record"
        raise BoundaryError(msg)
    return TimeLogFile(name, layout.values, tuple(instants), len(content) - used)


@dataclass(frozen=True, slots=True)
class _Layout:
    """How a record is laid out. ``constants`` are members of the position that are the same in all."""

    values: tuple[LoggedValue, ...]
    members: tuple[str, ...]
    constants: Mapping[str, float]
    fixed: struct.Struct

    @classmethod
    def of(cls, root: Element, name: str) -> "_Layout":
        if local_name(root) != "TIM":
            msg = f"the layout of the time log {name} begins with <{local_name(root)[:20]}>, not with <TIM>"
            raise BoundaryError(msg)
        if root.get("A", "") != "":
            msg = f"the time log {name} has one time for all its records, which is no log of a drive"
            raise BoundaryError(msg)
        position = first(root, "PTN")
        given = {} if position is None else {key: position.get(key) for key in POSITION if key in position.attrib}
        members = tuple(key for key in POSITION if given.get(key) == "")
        constants = {key: _number(text, name) for key, text in given.items() if text}
        values = tuple(_value(element, name) for element in children(root, "DLV"))
        fixed = struct.Struct("<IH" + "".join(POSITION[key] for key in members) + "B")
        return cls(values, members, constants, fixed)

    def records(self, content: bytes) -> Iterator[tuple[Instant, int]]:
        """Each record with where it ends, up to where the file breaks off."""
        place = 0
        values: dict[int, int] = {}
        while place + self.fixed.size <= len(content):
            milliseconds, days, *members, count = self.fixed.unpack_from(content, place)
            end = place + self.fixed.size + 5 * count
            if end > len(content) or milliseconds > LARGEST:
                return
            given = struct.iter_unpack("<Bi", content[place + self.fixed.size : end])
            values.update(given)
            place = end
            yield self._instant(days, milliseconds, dict(zip(self.members, members, strict=True)), dict(values)), place

    def _instant(self, days: int, milliseconds: int, members: dict[str, int], values: dict[int, int]) -> Instant:
        read: dict[str, float] = {**self.constants, **members}
        north, east = read.pop("A", None), read.pop("B", None)
        up = read.pop("C", None)
        position = None
        if north is not None and east is not None and not {north, east} & NO_POSITION:
            latitude, longitude = (north / DEGREE, east / DEGREE) if "A" in members else (north, east)
            if abs(latitude) <= 90 and abs(longitude) <= 180 and (latitude, longitude) != (0.0, 0.0):
                position = latitude, longitude
        utc = DAY_ZERO.timestamp() + 86_400 * days + milliseconds / 1000
        return Instant(utc, position, None if up is None else up / 1000, read, values)


def _number(text: str | None, name: str) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        msg = f"the layout of the time log {name} has '{(text or '')[:20]}' where a number belongs"
        raise BoundaryError(msg)
    return value


def _value(element: Element, name: str) -> LoggedValue:
    try:
        return LoggedValue(int(element.get("A", ""), 16), element.get("C", ""))
    except ValueError as error:
        msg = f"the layout of the time log {name} has the identifier '{element.get('A', '')[:20]}'"
        raise BoundaryError(msg) from error


def written_log(layout: Sequence[LoggedValue], instants: Sequence[Instant]) -> tuple[bytes, bytes]:
    """The XML and the binary file of a log with north, east, up, status and satellites.

    A value is given where it changes.
    """
    logged = "".join(f'<DLV A="{value.ddi:04X}" B="" C="{value.element}"/>' for value in layout)
    head = (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<TIM A="" D="4"><PTN A="" B="" C="" D="" G=""/>{logged}</TIM>\n'
    ).encode()
    body = bytearray()
    before: Mapping[int, int] = {}
    for instant in instants:
        milliseconds = round((instant.utc - DAY_ZERO.timestamp()) * 1000)
        days, rest = divmod(milliseconds, LARGEST)
        latitude, longitude = instant.position or (0.0, 0.0)
        body += struct.pack(
            "<IHiiiBB",
            rest,
            days,
            round(latitude * DEGREE),
            round(longitude * DEGREE),
            round((instant.up or 0.0) * 1000),
            int(instant.members.get("D", 15)),
            min(255, int(instant.members.get("G", 255))),
        )
        changed = {number: value for number, value in instant.values.items() if before.get(number) != value}
        body += bytes([len(changed)])
        for number, value in changed.items():
            body += struct.pack("<Bi", number, value)
        before = instant.values
    return head, bytes(body)
