"""The session's states: each transition by a command, a wrong one says why and changes nothing, and replays agree."""

import math
from dataclasses import replace

import pytest
from support.drives import FRAME, a_job, path_chunks, up_and_down
from support.sayings import stood

from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.model import (
    BeginInitialisation,
    Chunk,
    Command,
    Commanded,
    DropOffset,
    EndDrive,
    Event,
    Nudge,
    OffsetKind,
    OnTheMark,
    Pause,
    Resume,
    SessionState,
    SetLookAhead,
    SetSection,
    SetWork,
    SkipInitialisation,
    SkipPass,
    Snapshot,
    TakePass,
    WorkMode,
)

CENTIMETRE = 0.01
ONE_EPOCH = 3.1
"""Square metres between two epochs: what is said of the implement holds from the next one on."""
DRIVE = path_chunks(up_and_down())
START = (15.0, 15.0)


def job_with_sections(sections: int) -> Job:
    job = a_job()
    return job.model_copy(update={"implement": job.implement.model_copy(update={"sections": sections})})


def told(engine: Engine, command: Command) -> Snapshot:
    """What a command leads to, given right now."""
    return engine.step(Commanded(engine.snapshot.arrival, command))


def driven(engine: Engine, chunks: list[Chunk]) -> Snapshot:
    for chunk in chunks:
        engine.step(chunk)
    return engine.snapshot


def test_idle_until_a_receiver_speaks_then_driving():
    engine = Engine(a_job())
    assert engine.snapshot.state is SessionState.IDLE
    assert driven(engine, DRIVE[:3]).state is SessionState.DRIVING


@pytest.mark.parametrize(
    ("before", "command", "sentence"),
    [
        ([], Pause(), "no position"),
        ([Pause()], Pause(), "paused"),
        ([Pause()], SetWork(down=True), "paused"),
        ([], SkipInitialisation(), "no position"),
        ([EndDrive()], Resume(), "has ended"),
        ([EndDrive()], EndDrive(), "has ended"),
        ([EndDrive()], TakePass(1), "has ended"),
        ([BeginInitialisation()], BeginInitialisation(), "being measured"),
        ([BeginInitialisation()], Pause(), "being measured"),
    ],
)
def test_a_wrong_transition_says_why_and_changes_nothing(before: list[Command], command: Command, sentence: str):
    engine = Engine(a_job())
    if before:
        driven(engine, DRIVE[:30])
    for one in before:
        told(engine, one)
    was = engine.snapshot
    now = told(engine, command)
    assert sentence in now.notices[0]
    assert _same(was, now)


def _same(was: Snapshot, now: Snapshot) -> bool:
    names = ("state", "pose", "working", "work_mode", "totals", "offsets", "ground_version", "initialising")
    return all(getattr(was, name) == getattr(now, name) for name in names)


def test_an_answer_goes_with_the_next_command_and_by_itself():
    engine = Engine(a_job())
    driven(engine, DRIVE[:30])
    assert told(engine, Resume()).notices
    assert not told(engine, SetLookAhead(2.0)).notices
    assert told(engine, Resume()).notices
    assert not driven(engine, DRIVE[30:120]).notices


def test_paused_nothing_is_worked_and_guidance_stays():
    engine = Engine(a_job())
    worked = driven(engine, DRIVE[:60])
    assert worked.working
    paused = told(engine, Pause())
    assert paused.state is SessionState.PAUSED
    assert not paused.working
    on = driven(engine, DRIVE[60:90])
    assert on.totals.worked == pytest.approx(worked.totals.worked, abs=ONE_EPOCH)
    assert on.guidance is not None
    told(engine, Resume())
    again = driven(engine, DRIVE[90:130])
    assert again.state is SessionState.DRIVING
    assert again.working
    assert again.totals.worked > on.totals.worked + 50.0


def test_a_button_that_was_down_before_a_pause_is_up_after_it():
    engine = Engine(a_job())
    driven(engine, DRIVE[:60])
    told(engine, SetWork(down=True))
    told(engine, Pause())
    told(engine, Resume())
    after = driven(engine, DRIVE[60:70])
    assert after.work_mode is WorkMode.BUTTON
    assert not after.working


def test_ended_nothing_is_guided_and_nothing_counts():
    engine = Engine(a_job())
    driven(engine, DRIVE[:60])
    ended = told(engine, EndDrive())
    assert ended.state is SessionState.ENDED
    assert ended.guidance is None
    later = driven(engine, DRIVE[60:100])
    assert later.totals == ended.totals
    assert later.pose is not None
    assert later.guidance is None


# --- initialisation ------------------------------------------------------------------------------------------------


def test_measuring_at_a_known_start_point_corrects_the_position():
    engine = Engine(a_job())
    driven(engine, stood(2.0, START))
    known = FRAME.degrees_from_east_north(START[0] + 1.0, START[1] - 0.5)
    assert told(engine, BeginInitialisation(*known)).state is SessionState.INITIALISING
    half = driven(engine, stood(5.0, START, begin=2.0))
    assert half.initialising is not None
    assert half.initialising.done == pytest.approx(0.5, abs=0.05)
    done = driven(engine, stood(6.0, START, begin=7.0))
    assert done.state is SessionState.DRIVING
    assert done.initialising is None
    assert done.initialised is not None
    assert done.initialised.samples > 40
    assert (done.initialised.east, done.initialised.north) == (
        pytest.approx(1.0, abs=CENTIMETRE),
        pytest.approx(-0.5, abs=CENTIMETRE),
    )
    (record,) = done.offsets
    assert record.kind is OffsetKind.INITIALISATION
    assert math.hypot(record.east - 1.0, record.north + 0.5) < CENTIMETRE
    before = done.pose
    after = told(engine, DropOffset(OffsetKind.INITIALISATION))
    assert not after.offsets
    assert before is not None
    moved = driven(engine, stood(0.4, START, begin=13.0)).pose
    assert moved is not None
    assert before.east - moved.east == pytest.approx(1.0, abs=5 * CENTIMETRE)


def test_measuring_without_a_known_point_corrects_nothing_but_shows_the_scatter():
    engine = Engine(a_job())
    told(engine, BeginInitialisation())
    done = driven(engine, stood(11.0, START))
    assert done.state is SessionState.DRIVING
    assert not done.offsets
    assert done.initialised is not None
    assert done.initialised.east is None
    assert 0.005 < done.initialised.scatter[0] < 0.05


def test_a_tractor_that_moves_begins_again_and_says_so():
    engine = Engine(a_job())
    told(engine, BeginInitialisation())
    driven(engine, stood(5.0, START))
    moving = driven(engine, stood(1.0, START, begin=5.0, speed=1.5))
    assert moving.initialising is not None
    assert moving.initialising.done == 0.0
    assert moving.initialising.refused is not None
    assert "stand still" in moving.initialising.refused


def test_the_measuring_time_may_be_skipped():
    engine = Engine(a_job())
    driven(engine, stood(2.0, START))
    told(engine, BeginInitialisation())
    skipped = told(engine, SkipInitialisation())
    assert skipped.state is SessionState.DRIVING
    assert skipped.initialising is None
    assert skipped.initialised is None


def test_after_a_pause_the_measuring_time_leads_back_to_the_pause():
    engine = Engine(a_job())
    driven(engine, stood(2.0, START))
    told(engine, Pause())
    told(engine, BeginInitialisation())
    assert told(engine, SkipInitialisation()).state is SessionState.PAUSED


def test_without_a_measuring_time_there_is_nothing_to_measure():
    job = a_job()
    job = job.model_copy(update={"receiver": job.receiver.model_copy(update={"measuring_time": 0.0})})
    engine = Engine(job)
    refused = told(engine, BeginInitialisation())
    assert "0 s" in refused.notices[0]
    assert refused.state is SessionState.IDLE


def test_a_start_point_elsewhere_is_refused_after_measuring():
    engine = Engine(a_job())
    told(engine, BeginInitialisation(*FRAME.degrees_from_east_north(START[0] + 300.0, START[1])))
    done = driven(engine, stood(11.0, START))
    assert not done.offsets
    assert "300 m away" in done.notices[0]


# --- the mark ------------------------------------------------------------------------------------------------------


def test_a_wild_mark_is_refused_with_a_sentence():
    engine = Engine(a_job())
    driven(engine, DRIVE[:40])
    wild = told(engine, OnTheMark(*FRAME.degrees_from_east_north(400.0, 30.0)))
    assert not wild.offsets
    assert "another point" in wild.notices[0]


def test_a_mark_before_any_position_is_refused():
    assert "no position" in told(Engine(a_job()), OnTheMark(47.5, 8.5)).notices[0]


def test_a_mark_counts_on_top_of_the_initialisation_and_both_go_one_by_one():
    engine = Engine(a_job())
    told(engine, BeginInitialisation(*FRAME.degrees_from_east_north(START[0] + 1.0, START[1])))
    driven(engine, stood(11.0, START))
    marked = told(engine, OnTheMark(*FRAME.degrees_from_east_north(START[0] + 1.5, START[1])))
    assert [one.kind for one in marked.offsets] == [OffsetKind.INITIALISATION, OffsetKind.MARK]
    assert marked.offsets[1].east == pytest.approx(0.5, abs=5 * CENTIMETRE)
    left = told(engine, DropOffset(OffsetKind.MARK)).offsets
    assert [one.kind for one in left] == [OffsetKind.INITIALISATION]


# --- sections, lines, and what cannot be -----------------------------------------------------------------------------


def test_a_section_switched_off_works_nothing():
    whole, half = Engine(job_with_sections(2)), Engine(job_with_sections(2))
    assert told(half, SetSection(1, on=False)).sections == (False, True)
    both, one = driven(whole, DRIVE[:100]), driven(half, DRIVE[:100])
    assert one.totals.worked == pytest.approx(0.5 * both.totals.worked, rel=0.01)
    again = told(half, SetSection(1, on=True))
    assert again.sections == (True, True)


def test_with_every_section_off_nothing_works():
    engine = Engine(job_with_sections(2))
    for number in (1, 2):
        told(engine, SetSection(number, on=False))
    after = driven(engine, DRIVE[:100])
    assert not after.working
    assert after.totals.worked == 0.0


@pytest.mark.parametrize(
    ("command", "sentence"),
    [
        (SetSection(3, on=False), "no section 3"),
        (TakePass(99), "no line 99"),
        (Nudge(2000.0), "cannot be moved"),
    ],
)
def test_what_does_not_exist_is_said(command: Command, sentence: str):
    engine = Engine(a_job())
    driven(engine, DRIVE[:30])
    assert sentence in told(engine, command).notices[0]


def test_without_a_line_wishes_about_lines_are_answered():
    engine = Engine(a_job(field=False))
    driven(engine, DRIVE[:5])
    assert "no line" in told(engine, SkipPass()).notices[0]


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: OnTheMark(91.0, 0.0),
        lambda: OnTheMark(float("nan"), 0.0),
        lambda: BeginInitialisation(47.0, None),
        lambda: BeginInitialisation(47.0, 200.0),
        lambda: SetSection(0, on=True),
        lambda: SetSection(65, on=True),
        lambda: Nudge(float("inf")),
        lambda: Nudge(1.0, OffsetKind.MARK),
    ],
)
def test_a_command_out_of_bounds_cannot_be_made(wrong):
    with pytest.raises(ValueError, match=r"\w"):
        wrong()


def test_the_same_events_give_the_same_snapshots():
    events: list[Event] = [*stood(12.0, START)]
    events.insert(5, Commanded(0.9, BeginInitialisation(*FRAME.degrees_from_east_north(15.3, 15.0))))
    later = [replace(chunk, arrival=chunk.arrival + 60.0) for chunk in DRIVE]
    events += later[:100]
    events += [Commanded(80.0, Pause()), Commanded(80.0, SetSection(1, on=False)), *later[100:120]]
    events += [Commanded(84.0, Resume()), *later[120:], Commanded(400.0, EndDrive())]
    one, other = Engine(a_job()), Engine(a_job())
    for event in events:
        first, second = one.step(event), other.step(event)
        for name in ("state", "pose", "offsets", "totals", "working", "initialising", "initialised", "notices"):
            assert getattr(first, name) == getattr(second, name)
