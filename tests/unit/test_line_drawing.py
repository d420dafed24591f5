"""Guidance lines that the driver draws: the passes lie where they were driven, and what cannot be is said."""

import math
from collections.abc import Sequence

import pytest
from support.drives import FRAME, a_job, path_chunks

from guidance_app.engine import Engine
from guidance_app.model import (
    BeginLine,
    Command,
    Commanded,
    DropLine,
    EndLine,
    LineKind,
    SetWork,
    SetWorkMode,
    Snapshot,
    WorkMode,
)

CENTIMETRES = 0.05
DEGREE = math.radians(1.0)


def driven(points: list[tuple[float, float]], commands: dict[int, Command], *, field: bool = False) -> list[Snapshot]:
    """The snapshots of driving through these points; a command is given before the epoch of its number."""
    engine = Engine(a_job(field=field))
    made = []
    for number, chunk in enumerate(path_chunks(points)):
        if number in commands:
            made.append(engine.step(Commanded(chunk.arrival, commands[number])))
        made.append(engine.step(chunk))
    return made


def frame_shift(snapshot: Snapshot) -> tuple[float, float]:
    """Where the drive's own frame has its origin in the frame of the test."""
    assert snapshot.origin_deg is not None
    return FRAME.east_north_from_degrees(*snapshot.origin_deg)


def target(snapshot: Snapshot) -> Sequence[tuple[float, float]]:
    assert snapshot.guidance is not None
    east, north = frame_shift(snapshot)
    return [(float(e) + east, float(n) + north) for e, n in snapshot.guidance.target.points]


ROUND = [(0.0, 0.0), (10.0, 40.0), (20.0, 80.0), (26.0, 80.0), (16.0, 40.0), (6.0, 0.0)]


def test_an_ab_line_runs_through_both_points_whatever_was_driven_between() -> None:
    bent = [(0.0, 0.0), (0.0, 20.0), (5.0, 40.0), (0.0, 60.0), (0.0, 120.0)]
    last = driven(bent, {20: BeginLine(LineKind("ab")), 160: EndLine()})[-1]
    assert last.line_begun is None
    assert last.guidance is not None
    (east, north), (far_east, far_north) = target(last)[0], target(last)[-1]
    assert abs(math.atan2(far_east - east, far_north - north)) < 6 * DEGREE
    assert len(last.passes) > 5


def test_while_a_line_is_drawn_the_first_straight_stretch_takes_nothing() -> None:
    snapshots = driven([(0.0, 0.0), (0.0, 150.0)], {10: BeginLine(LineKind("curve"))})
    assert snapshots[-1].line_begun is not None
    assert snapshots[-1].line_begun.kind == "curve"
    assert snapshots[-1].working
    assert snapshots[-1].guidance is None


def test_a_plus_guides_at_once_in_the_typed_heading() -> None:
    last = driven([(0.0, 0.0), (0.0, 30.0)], {20: BeginLine(LineKind("a-plus"), 90.0)})[-1]
    (east, north), (far_east, far_north) = target(last)[0], target(last)[-1]
    direction = math.atan2(far_east - east, far_north - north)
    assert abs(abs(direction) - math.pi / 2) < DEGREE


def test_a_curve_is_followed_where_it_was_driven() -> None:
    snapshots = driven(ROUND, {5: BeginLine(LineKind("curve")), 158: EndLine()})
    last = snapshots[-1]
    assert last.guidance is not None
    assert last.guidance.target.number in (-1, 0, 1)
    assert abs(last.guidance.cross_track) < 3.5


def test_a_pivot_is_the_circle_of_the_part_that_was_driven() -> None:
    arc = [(60 - 60 * math.cos(a), 60 * math.sin(a)) for a in (0.02 * n for n in range(80))]
    last = driven(arc, {5: BeginLine(LineKind("pivot")), 170: EndLine()})[-1]
    assert last.guidance is not None
    radii = [math.hypot(east - 60.0, north) for east, north in target(last)]
    assert max(radii) - min(radii) < 2.0
    assert sum(radii) / len(radii) == pytest.approx(60.0, abs=3.5)


def test_the_last_pass_is_learned_and_the_next_runs_beside_it() -> None:
    bend = [(0.0, 0.0), (3.0, 50.0), (0.0, 100.0)]
    back = [(3.0, 104.0), (6.0, 100.0), (9.0, 50.0), (6.0, 5.0)]
    commands = {
        5: BeginLine(LineKind("last-pass")),
        6: SetWorkMode(WorkMode.BUTTON),
        7: SetWork(down=True),
        198: SetWork(down=False),
    }
    snapshots = driven([*bend, *back], commands)
    assert snapshots[100].guidance is None
    last = snapshots[-40]
    assert last.guidance is not None
    assert abs(last.guidance.target.number) == 1
    assert abs(last.guidance.cross_track) < 0.5


def test_a_straight_pivot_and_a_short_ab_line_are_refused_and_drawing_goes_on() -> None:
    snapshots = driven([(0.0, 0.0), (0.0, 60.0)], {10: BeginLine(LineKind("pivot")), 60: EndLine(), 70: DropLine()})
    refused = [one for one in snapshots if any("straight line" in notice for notice in one.notices)]
    assert refused
    assert refused[0].line_begun is not None
    assert refused[0].line_begun.kind == "pivot"
    assert snapshots[-1].line_begun is None
    short = driven([(0.0, 0.0), (0.0, 60.0)], {10: BeginLine(LineKind("ab")), 14: EndLine()})
    assert any("less than 5 m" in notice for one in short for notice in one.notices)


def test_with_a_plan_no_line_is_drawn_and_an_end_needs_a_beginning() -> None:
    planned = driven([(20.0, 20.0), (20.0, 60.0)], {10: BeginLine(LineKind("ab"))}, field=True)
    assert any("follows a plan" in notice for one in planned for notice in one.notices)
    assert all(one.line_begun is None for one in planned)
    ended = driven([(0.0, 0.0), (0.0, 20.0)], {10: EndLine()})
    assert any("press A first" in notice for one in ended for notice in one.notices)


def test_while_another_line_is_drawn_nothing_is_guided_and_giving_up_leads_back_to_the_old_one() -> None:
    straight = [(0.0, 0.0), (0.0, 220.0)]
    snapshots = driven(straight, {200: BeginLine(LineKind.AB), 300: DropLine()})
    drawn = [one for one in snapshots if one.line_begun is not None]
    assert snapshots[199].guidance is not None
    assert len(drawn) > 50
    assert all(one.guidance is None for one in drawn[1:])
    begun = drawn[-1].line_begun
    assert begun is not None
    assert begun.start is not None
    here = drawn[-1].pose
    assert here is not None
    assert begun.metres == pytest.approx(math.dist(begun.start, (here.east, here.north)), abs=1.0)
    assert snapshots[-1].line_begun is None
    assert snapshots[-1].guidance is not None


def test_the_first_pass_is_followed_without_a_press_and_lines_are_shown_beside_it() -> None:
    """With the implement on Auto, as every drive begins: nobody has to think of the button."""
    there, back = [(0.0, 0.0), (0.0, 120.0)], [(1.0, 123.0), (2.5, 121.0), (3.0, 110.0), (3.0, 20.0)]
    snapshots = driven([*there, *back], {5: BeginLine(LineKind.FOLLOW)})
    first = snapshots[100]
    assert first.line_begun is not None
    assert first.line_begun.start is None
    assert first.working
    assert first.passes == ()
    last = snapshots[-1]
    assert last.line_begun is None
    assert last.guidance is not None
    assert abs(last.guidance.target.number) == 1
    assert {-1, 0, 1, 2} <= {one.number for one in last.passes}


def test_a_fork_draws_its_own_line() -> None:
    engine = Engine(a_job(field=False))
    chunks = path_chunks([(0.0, 0.0), (0.0, 100.0)])
    for chunk in chunks[:20]:
        engine.step(chunk)
    engine.step(Commanded(4.0, BeginLine(LineKind("ab"))))
    other = engine.fork()
    for chunk in chunks[20:100]:
        engine.step(chunk)
    engine.step(Commanded(20.0, EndLine()))
    assert engine.snapshot.line_begun is None
    assert other.snapshot.line_begun is not None
    assert other.snapshot.line_begun.kind == "ab"


@pytest.mark.parametrize("heading", [400.0, -1.0, math.nan])
def test_a_heading_that_is_none_is_refused(heading: float) -> None:
    with pytest.raises(ValueError, match="heading"):
        BeginLine(LineKind.A_PLUS, heading)
