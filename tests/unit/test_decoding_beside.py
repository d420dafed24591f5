"""Events decoded by a process beside are what the engine hears itself, whatever becomes of the process."""

import multiprocessing
from collections.abc import Iterator
from itertools import islice

import pytest
from support.drives import a_job, path_chunks, up_and_down

from guidance_app.decoding_beside import BATCH, DecodedEvents
from guidance_app.engine import Engine
from guidance_app.model import RECEIVER, Chunk, Commanded, Event, Nudge, Snapshot, SourceDown, SourceUp

NAME = "decoding"


def _events() -> list[Event]:
    """A drive with a wish, a lost link, and one that comes back in the middle of a sentence."""
    chunks = path_chunks(up_and_down(passes=4))
    middle = len(chunks) // 2
    at = chunks[middle].arrival
    lost = [SourceDown(at, "pulled out", RECEIVER), SourceUp(at, "again", RECEIVER), Chunk(at, b"$GPGGA,07", RECEIVER)]
    first: list[Event] = [SourceUp(0.0, "a receiver"), *chunks[:middle]]
    return [*first, *lost, Commanded(at, Nudge(0.1)), *chunks[middle + 1 :]]


def _said(snapshot: Snapshot) -> tuple[object, ...]:
    return snapshot.sequence, snapshot.link, snapshot.fix, snapshot.pose, snapshot.totals, snapshot.sky


def _taken(decoded: DecodedEvents) -> Iterator[tuple[object, ...]]:
    engine = Engine(a_job())
    for event, heard in decoded:
        yield from (_said(snapshot) for snapshot in engine.steps(event, heard))
    if decoded.hearing is not None:
        engine.take_hearing(decoded.hearing)
    late = SourceDown(1e6, "over")
    yield from (_said(snapshot) for snapshot in engine.steps(late))


@pytest.fixture(scope="module")
def events() -> list[Event]:
    """The drive."""
    return _events()


@pytest.fixture(scope="module")
def heard_alone(events: list[Event]) -> list[tuple[object, ...]]:
    """What the engine says when it listens itself."""
    return list(_taken(DecodedEvents(events)))


def test_a_short_drive_is_heard_by_the_engine_itself(events: list[Event]) -> None:
    decoded = DecodedEvents(events)
    assert all(heard is None for _, heard in decoded)
    assert decoded.hearing is None


def test_the_process_says_what_the_engine_hears(
    events: list[Event], heard_alone: list[tuple[object, ...]], caplog: pytest.LogCaptureFixture
) -> None:
    decoded = DecodedEvents(events, long=1)
    assert list(_taken(decoded)) == heard_alone
    assert caplog.records == []


def test_the_process_may_be_killed(events: list[Event], heard_alone: list[tuple[object, ...]]) -> None:
    assert len(events) > 2 * BATCH
    many = [*events, *events[-1:] * 20_000]
    said = _taken(DecodedEvents(many, long=1))
    begun = list(islice(said, BATCH))
    for process in multiprocessing.active_children():
        if process.name == NAME:
            process.kill()
            process.join()
    assert begun == heard_alone[:BATCH]
    assert list(islice(said, len(heard_alone) - BATCH - 1)) == heard_alone[BATCH:-1]


def test_nothing_is_left_running(events: list[Event]) -> None:
    decoded = iter(DecodedEvents(events * 50, long=1))
    next(decoded)
    decoded.close()
    assert not [process for process in multiprocessing.active_children() if process.name == NAME]
