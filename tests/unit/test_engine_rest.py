"""The rest of a plan, planned again through the engine: what is done stays, and nothing jumps while working."""

import pytest
from support.drives import FRAME, a_job, path_chunks, up_and_down

from guidance_app.engine import Engine
from guidance_app.geodesy import FieldFrame
from guidance_app.model import (
    Command,
    Commanded,
    Nudge,
    ReplanRest,
    ReverseDirection,
    SegmentKind,
    SkipPass,
    Snapshot,
    TakePass,
)

CENTIMETRE = 0.01


def passes_ahead(snapshot: Snapshot) -> list[int]:
    """Numbers of the passes left, in their driving order."""
    assert snapshot.plan is not None
    return [one.number for one in snapshot.plan.segments if one.kind in {SegmentKind.PASS, SegmentKind.LAP}]


def told(engine: Engine, command: Command) -> Snapshot:
    return engine.step(Commanded(engine.snapshot.arrival, command))


def driven_along_its_plan(passes: int) -> Engine:
    """An engine that has driven the first passes of its own plan, and a little of the next one."""
    engine = Engine(a_job())
    plan = engine.snapshot.plan
    assert plan is not None
    assert engine.snapshot.origin_deg is not None
    here = FieldFrame(*engine.snapshot.origin_deg)
    points: list[tuple[float, float]] = []
    works = [one for one in plan.segments if one.kind is SegmentKind.PASS]
    for segment in plan.segments:
        line = [_in_the_drives_frame(here, float(east), float(north)) for east, north in segment.points]
        last = segment is works[passes]
        points += [line[0], _between(line, 0.5)] if last else line
        if last:
            break
    for chunk in path_chunks(_without_repeats(points)):
        engine.step(chunk)
    return engine


def _in_the_drives_frame(field: FieldFrame, east: float, north: float) -> tuple[float, float]:
    return FRAME.east_north_from_degrees(*field.degrees_from_east_north(east, north))


def _between(line: list[tuple[float, float]], share: float) -> tuple[float, float]:
    (east, north), (last_east, last_north) = line[0], line[-1]
    return east + share * (last_east - east), north + share * (last_north - north)


def _without_repeats(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    return [one for place, one in enumerate(points) if place == 0 or one != points[place - 1]]


@pytest.fixture(scope="module")
def under_way() -> Engine:
    return driven_along_its_plan(2)


def test_the_rest_keeps_what_is_done_and_the_pass_being_worked(under_way: Engine):
    engine = under_way.fork()
    was = engine.snapshot
    assert was.working
    assert was.guidance is not None
    now = told(engine, ReplanRest())
    assert now.guidance is not None
    assert not now.notices or now.notices == was.notices
    assert now.guidance.target.number == was.guidance.target.number
    assert now.guidance.cross_track == pytest.approx(was.guidance.cross_track, abs=CENTIMETRE)
    assert now.guidance.done == was.guidance.done
    assert now.guidance.count == was.guidance.count
    assert now.ground_version > was.ground_version
    assert passes_ahead(now)[0] == was.guidance.target.number
    assert {one.number for one in now.passes} == {one.number for one in was.passes}


def test_a_pass_that_is_taken_comes_first_and_the_rest_follows(under_way: Engine):
    engine = under_way.fork()
    target = engine.snapshot.guidance.target.number
    wanted = passes_ahead(told(engine, ReplanRest()))[3]
    taken = told(engine, TakePass(wanted))
    assert taken.guidance is not None
    assert taken.guidance.target.number == wanted
    ahead = passes_ahead(taken)
    assert ahead[0] == wanted
    assert target in ahead


def test_a_pass_that_is_skipped_comes_last(under_way: Engine):
    engine = under_way.fork()
    target = engine.snapshot.guidance.target.number
    skipped = told(engine, SkipPass())
    assert skipped.guidance is not None
    assert skipped.guidance.target.number != target
    assert passes_ahead(skipped)[-1] == target
    again = told(engine, ReplanRest())
    assert passes_ahead(again)[-1] == target


def test_a_pass_that_is_done_may_be_taken_again(under_way: Engine):
    engine = under_way.fork()
    done = min(engine.snapshot.guidance.done)
    plan = engine.snapshot.plan
    taken = told(engine, TakePass(done))
    assert taken.guidance is not None
    assert taken.guidance.target.number == done
    assert taken.plan is plan


def test_the_other_way_round_is_planned_on_from_the_other_end(under_way: Engine):
    engine = under_way.fork()
    was = engine.snapshot
    turned = told(engine, ReverseDirection())
    assert was.guidance is not None
    assert turned.guidance is not None
    assert turned.guidance.target.number == was.guidance.target.number
    assert passes_ahead(turned)[0] == was.guidance.target.number


def test_moved_lines_stay_moved(under_way: Engine):
    engine = under_way.fork()
    moved = told(engine, Nudge(0.10))
    again = told(engine, ReplanRest())
    assert again.offsets == moved.offsets
    assert again.guidance is not None
    assert moved.guidance is not None
    assert again.guidance.cross_track == pytest.approx(moved.guidance.cross_track, abs=CENTIMETRE)


def test_without_a_plan_there_is_nothing_to_plan_again():
    engine = Engine(a_job(field=False))
    for chunk in path_chunks([(0.0, 0.0), (0.0, 100.0)]):
        engine.step(chunk)
    assert "no plan" in told(engine, ReplanRest()).notices[0]


def test_the_rest_is_the_same_in_a_replay():
    chunks = path_chunks(up_and_down())
    snapshots = []
    for _ in range(2):
        engine = Engine(a_job())
        for chunk in chunks[:80]:
            engine.step(chunk)
        told(engine, SkipPass())
        for chunk in chunks[80:]:
            engine.step(chunk)
        snapshots.append(engine.snapshot)
    assert passes_ahead(snapshots[0]) == passes_ahead(snapshots[1])
    assert snapshots[0].totals == snapshots[1].totals
    assert snapshots[0].guidance.cross_track == snapshots[1].guidance.cross_track
