"""The pacer on a clock that the test turns: nothing here waits, but for the two tests of waking up."""

import math
import threading
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.model import Chunk, SourceDown, SourceUp
from guidance_app.sources import SourceEvent
from guidance_app.sources.pacing import MAX_SPEED, MIN_SPEED, Paced, Pacer, Seek

ARRIVALS = (0.0, 1.0, 2.0, 5.0, 5.5)
CHUNKS = [Chunk(arrival, f"{arrival}".encode()) for arrival in ARRIVALS]
LONG = 30.0
"""Seconds that a waiting thread would take if nobody woke it."""
PRESSES = 100
"""The first press may come before the consumer waits; one of so many comes while it does."""


class Clock:
    """A clock that stands until it is turned."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def _pacer(speed: float = 1.0) -> tuple[Pacer, Clock]:
    clock = Clock()
    return Pacer(CHUNKS, speed, clock), clock


def _due(pacer: Pacer) -> list[float]:
    """Arrivals of the chunks that are due now."""
    arrivals = []
    while isinstance(chunk := pacer.next(0.0), Chunk):
        arrivals.append(chunk.arrival)
    assert chunk is None
    return arrivals


def test_nothing_comes_before_play() -> None:
    pacer, clock = _pacer()
    clock.now += 50.0
    assert (_due(pacer), pacer.position, pacer.playing, pacer.ended) == ([], 0.0, False, False)


@pytest.mark.parametrize("speed", [0.5, 1.0, 7.0, 50.0])
def test_each_chunk_comes_when_its_time_has_come(speed: float) -> None:
    pacer, clock = _pacer(speed)
    pacer.play()
    for seconds, due in ((0.0, [0.0]), (0.9, []), (0.2, [1.0]), (3.8, [2.0]), (1.0, [5.0, 5.5])):
        clock.now += seconds / speed
        assert _due(pacer) == due
    assert pacer.ended
    assert not pacer.playing
    assert pacer.position == pacer.duration == 5.5


def test_the_position_runs_smoothly_between_chunks_and_never_past_one_that_was_not_taken() -> None:
    pacer, clock = _pacer(2.0)
    pacer.play()
    _due(pacer)
    clock.now += 0.25
    assert pacer.position == pytest.approx(0.5)
    clock.now += 10.0
    assert pacer.position == 1.0
    assert _due(pacer) == [1.0, 2.0, 5.0, 5.5]


def test_a_pause_stops_time_and_play_goes_on_from_there() -> None:
    pacer, clock = _pacer()
    pacer.play()
    clock.now += 1.5
    assert _due(pacer) == [0.0, 1.0]
    pacer.pause()
    clock.now += 100.0
    assert (_due(pacer), pacer.position) == ([], 1.5)
    pacer.play()
    clock.now += 0.4
    assert _due(pacer) == []
    clock.now += 0.1
    assert _due(pacer) == [2.0]


def test_another_speed_goes_on_from_the_same_place() -> None:
    pacer, clock = _pacer()
    pacer.play()
    clock.now += 1.5
    _due(pacer)
    pacer.set_speed(10.0)
    assert pacer.position == pytest.approx(1.5)
    clock.now += 0.06
    assert _due(pacer) == [2.0]
    assert pacer.position == pytest.approx(2.1)


def test_without_a_limit_every_chunk_is_due_and_the_position_is_that_of_the_last() -> None:
    pacer, _ = _pacer(math.inf)
    pacer.play()
    for arrival in ARRIVALS:
        chunk = pacer.next(0.0)
        assert isinstance(chunk, Chunk)
        assert chunk.arrival == pacer.position == arrival
    assert pacer.ended


@pytest.mark.parametrize(
    ("position", "index"), [(0.0, 1), (-5.0, 1), (0.5, 1), (1.0, 2), (4.0, 3), (5.5, 5), (99.0, 5)]
)
def test_a_seek_is_told_before_any_chunk_of_the_new_place(position: float, index: int) -> None:
    pacer, clock = _pacer()
    pacer.play()
    clock.now += 1.0
    pacer.seek(position)
    place = min(max(position, 0.0), 5.5)
    assert pacer.sought
    assert pacer.next(0.0) == Seek(place, index)
    assert not pacer.sought
    assert pacer.position == place
    assert _due(pacer) == []
    clock.now += 60.0
    assert _due(pacer) == list(ARRIVALS[index:])


def test_seeks_that_follow_each_other_become_one() -> None:
    pacer, _ = _pacer()
    pacer.seek(1.0)
    pacer.seek(4.0)
    assert pacer.next(0.0) == Seek(4.0, 3)
    assert pacer.next(0.0) is None


def test_a_seek_while_paused_stays_paused() -> None:
    pacer, clock = _pacer()
    pacer.seek(4.0)
    pacer.next(0.0)
    clock.now += 10.0
    assert (_due(pacer), pacer.position, pacer.playing) == ([], 4.0, False)


def test_play_at_the_end_begins_again() -> None:
    pacer, clock = _pacer(math.inf)
    pacer.play()
    assert _due(pacer) == list(ARRIVALS)
    pacer.play()
    assert pacer.next(0.0) == Seek(0.0, 1)
    clock.now += 1.0
    assert _due(pacer) == list(ARRIVALS[1:])


@given(
    st.lists(st.tuples(st.sampled_from(["play", "pause", "wait", "seek", "speed"]), st.floats(0.0, 6.0)), max_size=30)
)
def test_whatever_is_pressed_chunks_come_in_order_and_in_time(presses: list[tuple[str, float]]) -> None:
    pacer, clock = _pacer()
    expected = 0
    for press, value in presses:
        match press:
            case "play":
                pacer.play()
            case "pause":
                pacer.pause()
            case "seek":
                pacer.seek(value)
            case "speed":
                pacer.set_speed(max(value, MIN_SPEED))
            case "wait":
                clock.now += value
        while (due := pacer.next(0.0)) is not None:
            if isinstance(due, Seek):
                expected = due.index
                assert all((chunk.arrival <= due.position) == (k < due.index) for k, chunk in enumerate(CHUNKS))
            else:
                assert due == CHUNKS[expected]
                assert due.arrival <= pacer.position + 1e-9
                expected += 1
        assert 0.0 <= pacer.position <= pacer.duration


@pytest.mark.parametrize("speed", [0.0, -1.0, 0.49, 51.0, math.nan, -math.inf])
def test_an_impossible_speed_is_refused_with_what_is_possible(speed: float) -> None:
    pacer, _ = _pacer()
    with pytest.raises(ValueError, match=r"0\.5 to 50"):
        pacer.set_speed(speed)
    with pytest.raises(ValueError, match=r"0\.5 to 50"):
        Pacer(CHUNKS, speed)


def test_a_log_without_chunks_has_ended() -> None:
    pacer = Pacer([], MAX_SPEED)
    pacer.play()
    assert pacer.ended
    assert pacer.next(0.0) == Seek(0.0, 0)
    assert pacer.next(0.0) is None


@pytest.mark.parametrize("control", ["pause", "play", "seek", "interrupt", "close", "set_speed"])
def test_a_control_wakes_a_waiting_consumer_at_once(control: str) -> None:
    pacer = Pacer([Chunk(0.0, b""), Chunk(1e6, b"")], MIN_SPEED)
    got: list[object] = []
    waiting, woken = threading.Event(), threading.Event()

    def consume() -> None:
        got.append(pacer.next(LONG))
        waiting.set()
        got.append(pacer.next(LONG))
        woken.set()

    pacer.play()
    thread = threading.Thread(target=consume)
    thread.start()
    assert waiting.wait(LONG)
    for _ in range(PRESSES):
        getattr(pacer, control)(*{"seek": (5.0,), "set_speed": (2.0,)}.get(control, ()))
        if woken.wait(LONG / PRESSES / 3):
            break
    assert woken.is_set(), "nobody woke the consumer"
    thread.join()
    assert isinstance(got[0], Chunk)
    assert got[1] == (Seek(5.0, 1) if control == "seek" else None)
    assert pacer.closed == (control == "close")


class Given:
    """A source that gives everything at once."""

    description, duration, live = "given", 0.06, False

    def events(self, stop: threading.Event) -> Iterator[SourceEvent]:
        yield SourceUp(0.0, "given")
        yield Chunk(0.03, b"a")
        yield Chunk(0.06, b"b")
        yield SourceDown(0.06, "the end", ended=True)


def test_a_source_is_paced_once_through() -> None:
    events = list(Paced(Given(), MAX_SPEED).events(threading.Event()))
    assert [type(one) for one in events] == [SourceUp, Chunk, Chunk, SourceDown]


def test_a_paced_source_ends_when_it_is_stopped() -> None:
    stop = threading.Event()
    events = Paced(Given()).events(stop)
    next(events)
    stop.set()
    assert list(events) == []
