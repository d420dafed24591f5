"""A log's own clock, and its cutting into epochs."""

import gzip
import itertools
import threading
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.nmea import clock_text, epoch, fixes_of, gga, hdt, observations_of, rmc, sentence

from guidance_app.model import Chunk, SourceDown, SourceUp
from guidance_app.sources.file import FileLog, load_log, open_file

NOON = 43200.0
DAY = 86400.0
STEP = 1e-6
DRIVE = b"".join(epoch(NOON + k, float(k)) for k in range(10))


def _arrivals(data: bytes) -> list[float]:
    return [chunk.arrival for chunk in FileLog("log", data).chunks]


@given(st.binary(max_size=300), st.lists(st.sampled_from([gga(NOON), rmc(NOON + 1), hdt(3.0), b"\xb5b$"]), max_size=9))
def test_the_chunks_are_the_whole_file_in_order(noise: bytes, pieces: list[bytes]) -> None:
    data = gga(NOON) + noise + b"".join(pieces)
    log = FileLog("log", data)
    assert b"".join(chunk.data for chunk in log.chunks) == data
    arrivals = [chunk.arrival for chunk in log.chunks]
    assert arrivals[0] == 0.0
    assert all(after > before for before, after in itertools.pairwise(arrivals))
    assert log.duration == arrivals[-1]


def test_one_chunk_holds_one_epoch_and_comes_at_its_time() -> None:
    chunks = FileLog("log", b"# a comment\r\n" + DRIVE).chunks
    assert [chunk.arrival for chunk in chunks] == [float(k) for k in range(10)]
    assert chunks[0].data == b"# a comment\r\n" + epoch(NOON)
    assert chunks[9].data == chunks[-1].data == epoch(NOON + 9, 9.0)
    assert [chunk.data for chunk in chunks[2:4]] == [epoch(NOON + 2, 2.0), epoch(NOON + 3, 3.0)]
    with pytest.raises(IndexError):
        _ = chunks[10]


def test_times_add_up_without_error() -> None:
    count = 36_000
    arrivals = _arrivals(b"".join(gga(NOON + k / 10) for k in range(0, count, 7)))
    assert arrivals[-1] == (count - 1) // 7 * 7 / 10


def test_midnight_is_no_jump() -> None:
    assert _arrivals(b"".join(gga((DAY - 2 + k) % DAY) for k in range(5))) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("jump", [-500.0, 2 * 3600.0, -7200.0])
def test_a_step_back_or_over_an_hour_is_one_interval(jump: float) -> None:
    times = [NOON + k / 5 + (jump if k >= 5 else 0.0) for k in range(10)]
    assert _arrivals(b"".join(gga(t) for t in times)) == pytest.approx([k / 5 for k in range(10)], abs=STEP)


def test_a_pause_is_kept() -> None:
    assert _arrivals(gga(NOON) + gga(NOON + 1) + gga(NOON + 601) + gga(NOON + 602)) == [0, 1, 601, 602]


def test_a_damaged_time_makes_no_hole() -> None:
    damaged = gga(NOON + 2).replace(b",120002", b",125002")
    assert _arrivals(gga(NOON) + gga(NOON + 1) + damaged + gga(NOON + 3) + gga(NOON + 4)) == [0, 1, 3, 4]


@pytest.mark.parametrize(
    "line",
    [
        lambda text: sentence(f"GNGNS,{text},5200.0,N,00800.0,E,AN,9,1.0,50.0,45.0,,"),
        lambda text: sentence(f"GNGST,{text},1.0,,,,0.1,0.1,0.2"),
        lambda text: sentence(f"GPGLL,5200.0,N,00800.0,E,{text},A,A"),
        lambda text: sentence(f"PANDA,{text},5200.0,N,00800.0,E,4,12,0.7,50.0,1,5.0,2217,31,-12,5"),
        lambda text: sentence(f"PAOGI,{text},5200.0,N,00800.0,E,4,12,0.7,50.0,1,5.0,221.7,3.1,-1.2,0.5"),
        lambda text: sentence(f"KSXT,20200102{text},8.0,52.0,95.0,,,90.0,3.6,,2,0,0,12"),
        lambda text: sentence(f"PASHR,{text},010.51,T,+00.39,-00.79,-00.84,0.151,0.075,0.555,1,0"),
        lambda text: sentence(f"PGATT,{text},1.5,-2.0,359.5,0.1,-0.2,12.0"),
        lambda text: sentence(f"GPZDA,{text},02,01,2020,00,00"),
    ],
    ids=["GNS", "GST", "GLL", "PANDA", "PAOGI", "KSXT", "PASHR", "PGATT", "ZDA"],
)
def test_the_clock_is_read_from_whatever_tells_the_time(line: object) -> None:
    times = [NOON, NOON + 0.25, NOON + 0.5, NOON + 10.0]
    data = b"".join(line(clock_text(t)) for t in times)
    assert _arrivals(data) == [0.0, 0.25, 0.5, 10.0]


@pytest.mark.parametrize(
    "prefix",
    [
        lambda k: f"2014-08-01T23:59:{58 + k:06.3f}000Z " if k < 2 else f"2014-08-02T00:00:{k - 2:06.3f}000Z ",
        lambda k: f"[2014-08-01 12:00:{k:02d},250] ",
        lambda k: f"{1406894400 + k}.25 ",
        lambda k: f"{1406894400 + k}250;A;",
        lambda k: f"{1406894400 + k} ",
    ],
    ids=["ISO with T over midnight", "ISO in brackets", "POSIX", "milliseconds", "whole seconds"],
)
def test_a_logger_s_time_counts_where_the_sentences_have_none(prefix: object) -> None:
    data = b"".join(prefix(k).encode() + hdt(10.0 + k) for k in range(4))
    assert _arrivals(data) == [0, 1, 2, 3]


def test_the_sentences_own_time_goes_before_the_logger_s() -> None:
    data = b"".join(f"2014-08-01T00:00:{10 * k:02d}Z ".encode() + gga(NOON + k) for k in range(4))
    assert _arrivals(data) == [0, 1, 2, 3]


def test_without_any_time_a_line_is_a_second() -> None:
    assert _arrivals(hdt(1.0) + b"noise\r\n" + hdt(2.0) + hdt(3.0)) == [0, 1, 2]


def test_a_receiver_that_waits_for_its_first_fix_is_waited_for() -> None:
    waiting = b"".join(
        sentence("GPGGA,,,,,,0,,,,M,,M,,") + sentence(f"GPZDA,{clock_text(NOON + k)},02,01,2020,00,00")
        for k in range(5)
    )
    log = FileLog("log", waiting + b"".join(gga(NOON + 5 + k) for k in range(3)))
    assert log.duration == 7.0
    assert log.has_fix


def test_a_file_is_a_source_from_up_to_down(tmp_path: Path) -> None:
    path = tmp_path / "a run.nmea"
    path.write_bytes(DRIVE)
    for uri in (f"file:{path}", f"file://{str(path).replace(' ', '%20')}"):
        log = open_file(uri)
        assert (log.description, log.duration, log.live) == ("a run.nmea", 9.0, False)
        events = list(log.events(threading.Event()))
        assert isinstance(events[0], SourceUp)
        assert [one.arrival for one in events[1:-1] if isinstance(one, Chunk)] == [float(k) for k in range(10)]
        assert isinstance(events[-1], SourceDown)
        assert events[-1].ended


def test_a_stopped_source_stops() -> None:
    stop = threading.Event()
    events = FileLog("log", DRIVE).events(stop)
    next(events)
    stop.set()
    assert list(events) == []


def test_an_archive_is_the_log_inside(tmp_path: Path) -> None:
    (tmp_path / "run.nmea.gz").write_bytes(gzip.compress(DRIVE))
    log = load_log(tmp_path / "run.nmea.gz")
    assert log.size == len(DRIVE)
    assert len(fixes_of(observations_of(log.chunks))) == 10


def test_chunks_cost_no_memory_of_their_own() -> None:
    log = FileLog("log", DRIVE)
    assert log.chunks[3] == log.chunks[3]
    assert log.chunks[3] is not log.chunks[3]
