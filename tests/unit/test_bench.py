"""The benches: what they count, what they refuse, and rows that hold the bounds that were asked for."""

import argparse
import json
import math

import numpy as np
import pytest
from support.recordings import Heard

from guidance_app.bench import growth, latency, recording, review
from guidance_app.bench.browser import chromium_path
from guidance_app.bench.errors import BenchError
from guidance_app.bench.growth import DrivenSession, Growth, Hour, Joining, Stretch, memory_in_use
from guidance_app.bench.latency import Drawn, Latency, SteadySource, times_to_drawn
from guidance_app.bench.rows import Row, shown
from guidance_app.bench.streams import day_of_work, first_chunks
from guidance_app.cli import main
from guidance_app.commands.options import known_errors
from guidance_app.model import Chunk, LinkStatus
from guidance_app.runtime import LiveSession

MICROSECOND_MS = 1e-3


def parsed(module: object, *arguments: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="guidance-app bench")
    module.add_parser(parser.add_subparsers())
    return parser.parse_args(arguments)


# --- latency -------------------------------------------------------------------------------------------------------


def test_a_fix_is_timed_to_the_first_picture_of_it_or_of_a_newer_one() -> None:
    handed_over = {1.0: 5000.0, 1.1: 5100.0, 1.2: 5200.0}
    fixes = {10: 1.0, 11: 1.0, 12: 1.2}
    drawn = [Drawn(10, 5007.0), Drawn(11, 5040.0), Drawn(12, 5230.0)]
    assert times_to_drawn(handed_over, fixes, drawn) == pytest.approx((7.0, 130.0, 30.0), abs=MICROSECOND_MS)


def test_the_order_in_which_pictures_are_reported_does_not_matter() -> None:
    random = np.random.default_rng(3)
    handed_over = {float(k): 100.0 * k for k in range(50)}
    fixes = {k: float(k) for k in range(50)}
    drawn = [Drawn(k, 100.0 * k + float(random.uniform(1.0, 300.0))) for k in range(50)]
    mixed = [drawn[k] for k in random.permutation(50)]
    times = times_to_drawn(handed_over, fixes, drawn)
    assert times_to_drawn(handed_over, fixes, mixed) == times
    assert all(0.0 < time <= one.moment - 100.0 * one.sequence for time, one in zip(times, drawn, strict=True))


def test_a_page_that_stopped_is_no_measurement() -> None:
    with pytest.raises(BenchError, match="never drawn"):
        times_to_drawn({1.0: 0.0, 2.0: 1000.0}, {7: 1.0}, [Drawn(7, 9.0)])


def test_pictures_of_snapshots_without_a_fix_do_not_count() -> None:
    assert times_to_drawn({1.0: 50.0}, {8: 1.0}, [Drawn(7, 51.0), Drawn(8, 60.0)]) == (10.0,)


def test_the_source_stamps_each_epoch_when_it_is_handed_over() -> None:
    import threading  # noqa: PLC0415 - this test's alone

    chunks = [Chunk(0.0, b"a"), Chunk(0.01, b"b"), Chunk(0.03, b"c")]
    source = SteadySource(chunks)
    given = list(source.events(threading.Event()))
    assert [one.data for one in given] == [b"a", b"b", b"c"]
    assert all(given[k].arrival >= chunks[k].arrival for k in range(3))
    assert list(source.handed_over) == [one.arrival for one in given]
    assert list(source.handed_over.values()) == sorted(source.handed_over.values())


def test_a_fix_is_found_again_by_the_stamp_that_its_bytes_were_given() -> None:
    day = day_of_work(hours=0.01)
    source = SteadySource([Chunk(0.003 * k, one.data) for k, one in enumerate(first_chunks(day, 6.0))])
    session = LiveSession(day.job, source)
    heard = Heard(session)
    session.start()
    heard.wait(lambda one: one.fix is not None and len(source.handed_over) == 60 and one.fix.arrival > 0.15)
    session.close()
    fixes = {one.fix.arrival for one in heard.snapshots if one.fix is not None}
    assert len(fixes) > 3
    assert fixes <= set(source.handed_over)


def test_a_stopped_source_gives_nothing_more() -> None:
    import threading  # noqa: PLC0415

    stop = threading.Event()
    events = SteadySource([Chunk(0.0, b"a"), Chunk(3600.0, b"b")]).events(stop)
    assert next(events).data == b"a"
    stop.set()
    assert list(events) == []


def test_latency_rows_are_the_median_and_the_worst_of_a_hundred() -> None:
    rows = latency.rows_of(Latency(tuple(float(k) for k in range(101)), (4.0, 6.0), "quiet"))
    values = {row.quantity.rpartition(", ")[2]: (row.value, row.asked) for row in rows[:3]}
    assert values == {"median": (50.0, "< 50"), "p99": (99.0, "< 100"), "worst": (100.0, "")}
    assert "stubbed" in rows[0].note


# --- the browser ---------------------------------------------------------------------------------------------------


def test_without_chromium_there_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GUIDANCE_CHROMIUM", "/nowhere/chromium")
    with pytest.raises(BenchError, match=r"no Chromium .*/nowhere/chromium.*GUIDANCE_CHROMIUM\.$"):
        chromium_path()
    assert BenchError in known_errors()


# --- growth --------------------------------------------------------------------------------------------------------


def a_day(last_scene: float, last_memory: float) -> Growth:
    early = Hour(1 / 6, 600.0, 200e6, 34)
    hours = (Hour(1.0, 610.0, 201e6, 36), Hour(2.0, last_scene, last_memory, 40))
    return Growth(early, hours, Stretch(5000.0, 204), Stretch(5500.0, 206), Joining(0.4, 2_000_000, 40))


def test_growth_rows_give_the_curves_and_the_ratios_to_minute_ten() -> None:
    rows = {row.quantity: row for row in growth.rows_of(a_day(660.0, 240e6))}
    assert [rows[f"scene, bytes per fix, {at}"].value for at in ("minute 10", "hour 1", "hour 2")] == [600, 610, 660]
    assert rows["memory of the process, hour 2"].value == pytest.approx(240.0)
    assert rows["scene, bytes per fix, hour 2 over minute 10"].value == pytest.approx((5500 + 660) / (5000 + 600))
    assert rows["memory, hour 2 over minute 10"].value == pytest.approx(1.2)
    assert (rows["nodes of the scene at the end"].value, rows["nodes of the scene at the end"].asked) == (40, "< 100")
    assert rows["joining at the end, until every node is there"].asked == "<= 3"


def test_memory_grows_with_what_is_kept() -> None:
    before = memory_in_use()
    kept = np.ones(8_000_000)
    assert memory_in_use() - before > 0.5 * kept.nbytes


def test_the_driven_session_shows_what_its_engine_has_made() -> None:
    day = day_of_work(hours=0.01)
    session = DrivenSession(day.job)
    for chunk in first_chunks(day, 3.0):
        session.take(chunk)
    snapshot = session.snapshot()
    assert snapshot.link.status is LinkStatus.FIX
    assert snapshot.guidance is not None
    assert math.isclose(session.now(), snapshot.arrival)
    session.at(snapshot.arrival + 0.04)
    assert session.now() > session.snapshot().arrival


@pytest.mark.timeout(200)
def test_a_short_day_is_measured_end_to_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(growth, "EARLY", 90.0)
    measured = growth.measured(0.05, 0.4)
    assert measured.early.scene > 0
    assert measured.hours[-1].hour == pytest.approx(0.05, abs=0.01)
    assert measured.first_stretch.scene > measured.early.scene, "25 redraws a second say more than one in five seconds"
    assert 20 < measured.joining.nodes < 100
    assert measured.joining.bytes > 10_000


# --- the command line ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("module", "arguments"),
    [
        (growth, ("growth", "--hours", "0.1")),
        (growth, ("growth", "--hours", "x")),
        (latency, ("latency", "--seconds", "0")),
    ],
)
def test_a_length_that_makes_no_sense_is_refused(
    module: object, arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        parsed(module, *arguments)
    assert ended.value.code == 2
    assert "it goes from" in capsys.readouterr().err


def test_rows_are_a_table_or_json() -> None:
    rows = [Row("growth", "memory", 12.3456, "MB", "<= 13", "a note")]
    assert shown(rows, as_json=False).splitlines()[1].split("  ")[0] == "memory"
    assert json.loads(shown(rows, as_json=True)) == [
        {"bench": "growth", "quantity": "memory", "value": 12.3456, "unit": "MB", "asked": "<= 13", "note": "a note"}
    ]


# --- recording -----------------------------------------------------------------------------------------------------


def test_recording_is_measured_from_its_cost_to_its_jumps() -> None:
    rows = {row.quantity: row for row in recording.measured(0.05, paced_s=1.0, jumps=3)}
    assert 0.0 < rows["processor while recording"].value < 100.0
    assert 0.1 < rows["size when ended"].value < 4.0
    assert rows["open, second time"].value > 0.0
    assert rows["jump, longest, first time"].value >= rows["jump, median, first time"].value > 0.0


def test_a_recorded_drive_opens_for_review_at_once_and_one_from_elsewhere_too() -> None:
    rows = {row.quantity: row.value for row in review.measured(0.03)}
    assert 0.0 < rows["open, first time, driven here"] < rows["open, first time, from elsewhere"]
    assert rows["open, second time"] < rows["open, first time, from elsewhere"]


# --- the command ---------------------------------------------------------------------------------------------------


def test_the_command_prints_the_rows_of_a_bench(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "review", "--hours", "0.002", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert {row["bench"] for row in rows} == {"review"}
    assert all(row["value"] > 0 for row in rows)
