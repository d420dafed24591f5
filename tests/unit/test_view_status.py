"""The panels' words and numbers: absent is a dash, ages are shown, units follow the settings."""

import math
from dataclasses import replace

import pytest
from support.snapshots import field_snapshot

from guidance_app.documents import Units
from guidance_app.language import ENGLISH
from guidance_app.model import (
    CoverageTotals,
    FixQuality,
    LinkState,
    LinkStatus,
    OffsetKind,
    OffsetRecord,
    Pass,
    Snapshot,
)
from guidance_app.view.status import (
    ABSENT,
    Figure,
    age_words,
    clock,
    fix_words,
    info_view,
    line_offset,
    link_words,
    neighbour,
    nudge_steps,
    pass_words,
    replay_rows,
    work_view,
)

EMPTY = Snapshot(0, 0.0, LinkState())


def figure(snapshot: Snapshot, name: str, units: Units = Units.METRIC) -> Figure:
    return next(one for one in work_view(snapshot, snapshot.arrival, units, ENGLISH).figures if one.name == name)


def test_what_is_not_known_is_a_dash_never_a_zero() -> None:
    for name in ("pass", "speed", "left", "time left", "per hour"):
        assert figure(EMPTY, name).value == ABSENT
    rows = dict(info_view(EMPTY, 0.0, Units.METRIC, ENGLISH).rows)
    for name in ("Last data", "Receiver grid", "Corrections", "Filter", "Uncertainty"):
        assert rows[name] == ABSENT


def test_the_numbers_of_a_job() -> None:
    snapshot = field_snapshot()
    assert figure(snapshot, "pass") == Figure("pass", "3", "of 12")
    assert figure(snapshot, "speed") == Figure("speed", "9.0", "km/h")
    assert figure(snapshot, "done") == Figure("done", "0.52", "ha")
    assert figure(snapshot, "left") == Figure("left", "1.80", "ha")
    assert figure(snapshot, "per hour") == Figure("per hour", "5.20", "ha")
    assert figure(snapshot, "time left") == Figure("time left", "21", "min")


def test_a_rate_waits_for_enough_work() -> None:
    young = replace(field_snapshot(), totals=CoverageTotals(worked=50.0, left=1e5, working_s=3.0))
    assert figure(young, "per hour").value == ABSENT
    assert figure(young, "time left").value == ABSENT


def test_a_long_job_counts_hours() -> None:
    long = replace(field_snapshot(), totals=CoverageTotals(worked=10_000.0, left=60_000.0, working_s=3600.0))
    assert figure(long, "time left") == Figure("time left", "6:00", "h")


@pytest.mark.parametrize(
    ("units", "speed", "area"),
    [
        (Units.METRIC, "km/h", "ha"),
        (Units.IMPERIAL, "mph", "ac"),
        (Units.JAPANESE, "km/h", "a"),
        (Units.TAN, "km/h", "tan"),
    ],
)
def test_units_follow_the_settings(units: Units, speed: str, area: str) -> None:
    assert figure(field_snapshot(), "speed", units).unit == speed
    assert figure(field_snapshot(), "done", units).unit == area


def test_without_a_plan_the_line_is_named() -> None:
    snapshot = field_snapshot()
    assert snapshot.guidance is not None
    free = replace(snapshot.guidance.target, number=-2, order=None)
    beside = replace(snapshot, guidance=replace(snapshot.guidance, target=free, count=None))
    assert figure(beside, "line") == Figure("line", "-2")
    assert pass_words(beside.guidance, ENGLISH) == "Line -2"
    lap = Pass(9, free.points, lap=True)
    assert pass_words(replace(snapshot.guidance, target=lap), ENGLISH) == "Lap 9"
    assert pass_words(None, ENGLISH) == "No line"


def test_the_neighbour_is_the_next_line_there_is() -> None:
    snapshot = field_snapshot(target=3, count=4)
    assert neighbour(snapshot, 1) == 4
    assert neighbour(snapshot, -1) == 2
    assert neighbour(field_snapshot(target=4, count=4), 1) is None
    assert neighbour(EMPTY, 1) is None


def test_line_offsets_add_up_and_positions_do_not_count() -> None:
    offsets = (
        OffsetRecord(OffsetKind.NUDGE, 1.0, metres=0.06),
        OffsetRecord(OffsetKind.LINE_HERE, 2.0, metres=-0.10),
        OffsetRecord(OffsetKind.MARK, 3.0, east=3.0, north=4.0),
    )
    moved = replace(field_snapshot(), offsets=offsets)
    assert line_offset(moved) == pytest.approx(-0.04)
    assert work_view(moved, 100.0, Units.METRIC, ENGLISH).line_words == "Moved 4 cm left"
    assert work_view(field_snapshot(), 100.0, Units.METRIC, ENGLISH).line_words == "Moved 0 cm"
    rows = dict(info_view(moved, 100.0, Units.METRIC, ENGLISH).rows)
    assert rows["Offsets"] == "nudge 6 cm right, line here 10 cm left, mark 5.00 m"
    assert moved.guidance is not None
    back = replace(moved, guidance=replace(moved.guidance, mirrored=True))
    assert work_view(back, 100.0, Units.METRIC, ENGLISH).line_words == "Moved 4 cm right"
    rows = dict(info_view(back, 100.0, Units.METRIC, ENGLISH).rows)
    assert rows["Offsets"] == "nudge 6 cm left, line here 10 cm right, mark 5.00 m"


def test_nudges_go_from_left_to_right_in_the_drivers_unit() -> None:
    assert [metres for _, metres in nudge_steps(Units.METRIC)] == pytest.approx([-0.10, -0.02, 0.02, 0.10])
    inches = [metres / 0.0254 for _, metres in nudge_steps(Units.IMPERIAL)]
    assert inches == pytest.approx([-4, -1, 1, 4])


def test_the_fix_says_quality_age_satellites_and_hdop() -> None:
    assert fix_words(field_snapshot(100.0), 100.2, ENGLISH) == ("RTK fixed · <1 s · 17 satellites · HDOP 0.7", "good")
    assert fix_words(field_snapshot(100.0), 104.0, ENGLISH) == ("RTK fixed · 4 s · 17 satellites · HDOP 0.7", "bad")
    fix = field_snapshot().fix
    assert fix is not None
    bare = replace(fix, quality=FixQuality.AUTONOMOUS, satellites=None, hdop=None)
    assert fix_words(replace(field_snapshot(), fix=bare), 100.0, ENGLISH) == ("GPS · <1 s", "fair")


@pytest.mark.parametrize("status", list(LinkStatus))
def test_every_state_of_the_link_has_words_with_its_age(status: LinkStatus) -> None:
    words, level = link_words(LinkState(status, since=10.0, reason="the cable is out"), 55.0, ENGLISH)
    assert "for 45 s" in words
    assert level in {"good", "fair", "bad", "off"}
    assert ("the cable is out" in words) == (status is not LinkStatus.ENDED)


def test_without_a_fix_the_links_state_is_said_instead() -> None:
    lost = replace(field_snapshot(), link=LinkState(LinkStatus.NO_FIX, since=98.0))
    assert fix_words(lost, 100.0, ENGLISH) == ("The receiver has no position, for 2 s", "bad")
    assert fix_words(EMPTY, 3.0, ENGLISH)[0].startswith("Connecting")


def test_the_receivers_grid_is_shown_in_a_fitting_unit() -> None:
    rows = dict(info_view(field_snapshot(), 100.0, Units.METRIC, ENGLISH).rows)
    assert rows["Receiver grid"] == "1.8 cm north, 1.3 cm east"
    assert rows["Sentences"] == "3000, 2 rejected"
    assert rows["Fixes"] == "1000, every 0.1 s"
    assert rows["Filter"] == "adaptive"
    assert rows["Uncertainty"] == "± 30 cm"


@pytest.mark.parametrize(("seconds", "words"), [(0.2, "<1 s"), (7.4, "7 s"), (119.0, "119 s"), (600.0, "10 min")])
def test_ages_are_whole(seconds: float, words: str) -> None:
    assert age_words(seconds, ENGLISH) == words


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.0, "00:00"), (75.9, "01:15"), (3725.0, "1:02:05"), (-3.0, "00:00"), (None, ABSENT), (math.inf, ABSENT)],
)
def test_a_clock_shows_minutes_and_seconds(seconds: float | None, words: str) -> None:
    assert clock(seconds) == words


def test_the_replay_says_where_it_is() -> None:
    assert replay_rows(65.0, 130.0, 2.0, None, ENGLISH) == (("Position", "01:05 of 02:10"), ("Pace", "2 × real time"))
    fast = dict(replay_rows(65.0, 130.0, math.inf, 0.4, ENGLISH))
    assert fast["Pace"] == "as fast as it can"
    assert fast["Catching up"] == "40 %"
