"""Events and their lines: there and back is the same, and a cut or a flipped byte changes nothing before it."""

import json
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.commands import COMMAND_KINDS, commands_of, events

from guidance_app.model import Chunk, Commanded, Event, Nudge, SourceDown, SourceUp
from guidance_app.recording import LineWriter, RecordingError, read_lines

SMALL = [
    SourceUp(0.0, "serial /dev/ttyUSB0"),
    Chunk(0.1, b"$GPGGA,073000.00\r\n"),
    Chunk(0.2, b"\x80\xff\n\x00"),
    Commanded(0.25, Nudge(0.1)),
    SourceDown(0.3, "unplugged"),
]


def written(events: list[Event]) -> bytes:
    writer = LineWriter()
    return b"".join(writer.line(one) for one in events)


@pytest.mark.parametrize("kind", COMMAND_KINDS, ids=lambda kind: kind.__name__)
def test_every_command_reads_back_as_it_was(kind: type) -> None:
    @given(commands_of(kind), st.floats(0.0, 1e6))
    def there_and_back(command, arrival) -> None:
        event = Commanded(arrival, command)
        (read,) = read_lines(written([event]))
        assert read == event
        assert type(read.command) is kind

    there_and_back()


@given(st.lists(events(), max_size=12))
def test_any_events_read_back_to_the_bit(given_events: list[Event]) -> None:
    lines = read_lines(written(given_events))
    assert list(lines) == given_events
    assert lines.left_over == 0
    assert all(late >= early for early, late in zip(lines.arrivals, lines.arrivals[1:], strict=False))


def test_a_file_cut_at_any_byte_opens_up_to_the_cut() -> None:
    text = written(SMALL)
    ends = [place + 1 for place, byte in enumerate(text) if byte == ord("\n")]
    for cut in range(len(text) + 1):
        lines = read_lines(text[:cut])
        whole = sum(end <= cut for end in ends)
        assert list(lines) == SMALL[:whole]
        assert lines.left_over == cut - (ends[whole - 1] if whole else 0)


def test_a_file_goes_on_after_a_cut() -> None:
    text = written(SMALL)
    before = read_lines(text[: len(text) // 2])
    writer = LineWriter(before.check)
    rest = b"".join(writer.line(one) for one in SMALL[len(before) :])
    assert text[: before.size] + rest == text


@given(st.data())
def test_a_damaged_byte_changes_nothing_before_its_line(data: st.DataObject) -> None:
    text = bytearray(written(SMALL))
    place = data.draw(st.integers(0, len(text) - 1))
    text[place] ^= data.draw(st.integers(1, 255))
    before = text.count(b"\n", 0, place) if place else 0
    lines = read_lines(bytes(text))
    assert list(lines)[:before] == SMALL[:before]
    assert len(lines) <= max(before, len(SMALL) - 1)


def test_a_line_that_is_missing_doubled_or_out_of_place_ends_the_reading() -> None:
    first, second, third, *rest = written(SMALL).splitlines(keepends=True)
    for order in ([first, third, second], [first, first, second], [first, *rest]):
        assert list(read_lines(b"".join(order))) == SMALL[:1]


def sealed(*rows: object) -> bytes:
    check, text = 0, b""
    for row in rows:
        line = json.dumps(row).encode()
        check = zlib.crc32(line, check)
        text += b"%04x %s\n" % (check & 0xFFFF, line)
    return text


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ([1.0, "command", "FlyAway", {}], "FlyAway"),
        ([1.0, "command", "Nudge", {"metres": "far"}], "Nudge"),
        ([1.0, "command", "SkipPass", {"twice": True}], "twice"),
        ([1.0, "picture", "x"], "picture"),
    ],
)
def test_what_only_a_newer_program_knows_is_said(row: list[object], said: str) -> None:
    with pytest.raises(RecordingError, match=said) as caught:
        read_lines(sealed([0.0, "bytes", "receiver", ""], row))
    assert "update this one" in str(caught.value)


@pytest.mark.parametrize("row", [{"a": 1}, [], ["soon", "bytes"], 7])
def test_a_whole_line_that_is_no_event_ends_the_reading(row: object) -> None:
    lines = read_lines(sealed([0.0, "bytes", "receiver", "x"], row))
    assert list(lines) == [Chunk(0.0, b"x")]
    assert lines.left_over > 0


def test_events_are_given_by_number_and_by_slice() -> None:
    lines = read_lines(written(SMALL))
    assert lines[-1] == SMALL[-1]
    assert lines[1:3] == SMALL[1:3]
    heard: list[float] = []
    read_lines(written(SMALL * 1500), heard.append)
    assert heard == sorted(heard)
    assert heard[-1] > 0.5
