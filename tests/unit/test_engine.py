"""The engine: the same bytes give the same snapshots to the bit, however cut, forked or repeated."""

from dataclasses import fields

import numpy as np
import pytest
from support.drives import FRAME, a_job, path_chunks, up_and_down
from support.nmea import epoch

from guidance_app.engine import Engine
from guidance_app.estimation.filters import FILTERS
from guidance_app.geodesy import FieldFrame
from guidance_app.model import (
    Chunk,
    Commanded,
    LinkStatus,
    Nudge,
    OffsetKind,
    OnTheMark,
    SetLookAhead,
    SetWork,
    Snapshot,
    SourceDown,
    SourceUp,
    TakePass,
    WorkMode,
)

CENTIMETRE = 0.01
METRE = 1.0
DRIVE = path_chunks(up_and_down())


def same(one: Snapshot, other: Snapshot) -> bool:
    """Whether two snapshots say the same of the drive, to the bit; what only counts events is left out."""
    told = [
        field.name for field in fields(Snapshot) if field.name not in {"sequence", "track", "worked", "passes", "plan"}
    ]
    return all(_equal(getattr(one, name), getattr(other, name)) for name in told)


def _equal(one: object, other: object) -> bool:
    if isinstance(one, tuple) and one and isinstance(one[0], np.ndarray):
        return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))
    if hasattr(one, "target"):
        names = [field.name for field in fields(one) if field.name not in {"target", "turn"}]
        return one.target.number == other.target.number and all(getattr(one, n) == getattr(other, n) for n in names)
    return one == other


@pytest.mark.parametrize("name", FILTERS)
def test_the_same_bytes_give_the_same_snapshots(name: str) -> None:
    first, second = Engine(a_job(), filter_name=name), Engine(a_job(), filter_name=name)
    for chunk in DRIVE:
        assert same(first.step(chunk), second.step(chunk))


@pytest.mark.parametrize("name", FILTERS)
def test_a_fork_goes_on_as_the_original_would_and_leaves_it_alone(name: str) -> None:
    straight = Engine(a_job(), filter_name=name)
    middle = len(DRIVE) // 2
    for chunk in DRIVE[:middle]:
        straight.step(chunk)
    fork = straight.fork(generation=1)
    before = straight.snapshot
    for chunk in DRIVE[middle:]:
        fork.step(chunk)
    assert straight.snapshot is before
    for chunk in DRIVE[middle:]:
        straight.step(chunk)
    assert fork.snapshot.generation == 1
    assert fork.snapshot.pose == straight.snapshot.pose
    assert fork.snapshot.totals == straight.snapshot.totals


def test_a_pass_driven_true_has_no_cross_track_and_is_worked() -> None:
    engine = Engine(a_job(field=False))
    for chunk in path_chunks([(0.0, 0.0), (0.0, 200.0)]):
        snapshot = engine.step(chunk)
    assert snapshot.guidance is not None
    assert abs(snapshot.guidance.cross_track) < CENTIMETRE
    assert snapshot.working
    assert snapshot.totals.worked > 0.5 * 200.0 * 6.0


@pytest.mark.parametrize(("back", "sign"), [(False, 1.0), (True, -1.0)], ids=["going on", "coming back"])
def test_right_of_the_pass_is_positive_in_both_directions(back: bool, sign: float) -> None:
    engine = Engine(a_job(field=False))
    for chunk in path_chunks([(0.0, 0.0), (0.0, 100.0), (0.5, 100.0), (0.5, 0.0 if back else 200.0)]):
        snapshot = engine.step(chunk)
        if chunk.arrival == 60.0:
            engine.step(Commanded(60.0, TakePass(0)))
    assert snapshot.guidance is not None
    assert snapshot.guidance.cross_track == pytest.approx(sign * 0.5, abs=5 * CENTIMETRE)


def test_one_chunk_with_many_epochs_gives_a_snapshot_for_each_fix() -> None:
    whole = Chunk(DRIVE[-1].arrival, b"".join(chunk.data for chunk in DRIVE[:50]))
    engine = Engine(a_job())
    fixes = [one.fix for one in engine.steps(whole)]
    assert len(set(map(id, fixes))) >= 49


def test_commands_act_and_are_shown() -> None:
    engine = Engine(a_job())
    for chunk in DRIVE[:40]:
        engine.step(chunk)
    at = DRIVE[39].arrival
    assert engine.step(Commanded(at, SetWork(down=True))).work_mode is WorkMode.BUTTON
    assert engine.step(Commanded(at, SetLookAhead(3.0))).look_ahead_s == pytest.approx(3.0)
    taken = engine.step(Commanded(at, TakePass(2)))
    assert taken.guidance is not None
    assert taken.guidance.target.number == 2
    nudged = engine.step(Commanded(at, Nudge(0.10)))
    assert [one.kind for one in nudged.offsets] == [OffsetKind.NUDGE]
    assert nudged.guidance is not None
    assert nudged.guidance.cross_track == pytest.approx(taken.guidance.cross_track - 0.10, abs=CENTIMETRE)


def test_on_the_mark_moves_the_position_and_can_be_taken_back() -> None:
    engine = Engine(a_job())
    for chunk in DRIVE[:40]:
        engine.step(chunk)
    mark = (20.0, 30.0)
    engine.step(Commanded(8.0, OnTheMark(*FRAME.degrees_from_east_north(*mark))))
    offset = engine.snapshot.offsets[0]
    assert offset.kind is OffsetKind.MARK
    before = engine.snapshot.pose
    after = engine.step(DRIVE[40]).pose
    assert before is not None
    assert after is not None
    assert after.east - before.east == pytest.approx(offset.east, abs=1.0)


def test_a_fix_far_from_the_field_is_said_and_steers_nobody() -> None:
    engine = Engine(a_job())
    far = path_chunks([(0.0, 0.0), (0.0, 50.0)])
    moved = [Chunk(chunk.arrival, chunk.data.replace(b"4730.", b"4930.")) for chunk in far]
    for chunk in DRIVE[:10]:
        engine.step(chunk)
    snapshot = engine.snapshot
    for chunk in moved:
        snapshot = engine.step(chunk)
    assert snapshot.guidance is None or snapshot.fix is None or snapshot.fix.latitude_deg < 48.0


def test_the_link_is_told_in_words() -> None:
    engine = Engine(a_job())
    assert engine.snapshot.link.status is LinkStatus.CONNECTING
    assert engine.step(SourceUp(0.0, "a port")).link.status is LinkStatus.NO_DATA
    assert engine.step(Chunk(0.1, b"\x00\xff" * 50)).link.status is LinkStatus.NO_SENTENCE
    for chunk in DRIVE[:3]:
        engine.step(Chunk(chunk.arrival + 1.0, chunk.data))
    assert engine.snapshot.link.status is LinkStatus.FIX
    down = engine.step(SourceDown(9.0, "unplugged"))
    assert down.link.status is LinkStatus.DOWN
    assert down.link.reason == "unplugged"


def test_a_failure_is_shown_with_nothing_to_steer_by() -> None:
    engine = Engine(a_job())
    for chunk in DRIVE[:20]:
        engine.step(chunk)
    failed = engine.failed(5.0, "broken")
    assert failed.link.status is LinkStatus.DOWN
    assert failed.pose is None
    assert failed.guidance is None


@pytest.mark.parametrize("name", FILTERS)
def test_a_receiver_that_sets_its_clock_back_is_followed(name: str) -> None:
    """Receivers that start cold may say any time first; the drive goes on from where the tractor is."""
    engine = Engine(a_job().model_copy(update={"field": None, "operation": None}), filter_name=name)
    engine.step(Commanded(0.0, SetWork(down=True)))
    noon, rate, speed = 43200.0, 5, 5.0 * 1852.0 / 3600.0
    worked = 0.0
    for number in range(60 * rate):
        seconds = number / rate
        clock = noon + seconds - (30.0 if seconds >= 30.0 else 0.0)
        engine.step(Chunk(seconds, epoch(clock, east=speed * seconds)))
        if seconds == 30.0:
            worked = engine.snapshot.totals.worked
    last = engine.snapshot
    assert last.fix is not None
    assert last.pose is not None
    assert last.pose.t == last.fix.t
    east, _ = FieldFrame(52.0, 8.0).east_north_from_degrees(last.fix.latitude_deg, last.fix.longitude_deg)
    assert abs(east - last.pose.east) < METRE
    assert last.pose.heading_known
    assert last.totals.worked > 1.8 * worked > 0.0
