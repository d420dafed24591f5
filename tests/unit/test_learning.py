"""The pass being driven begins with the implement and ends where the tractor turns away."""

import math

import numpy as np
import pytest
from support.passes import half_circle, poses_along

from guidance_app.guidance.learning import DrivenPass
from guidance_app.guidance.reading import Seen
from guidance_app.model import FloatArray

SPACING = 4.0
UP = np.array([[0.0, 0.0], [0.0, 60.0]])
ROUND = half_circle((0.0, 60.0), (SPACING, 60.0), clockwise=True)
DOWN = np.array([[SPACING, 60.0], [SPACING, 0.0]])


def seen_along(points: FloatArray, *, working: bool, start: float = 0.0) -> list[Seen]:
    return [
        Seen(pose.t, pose.east, pose.north, pose.heading, heading_known=True, working=working)
        for pose in poses_along(points, start=start)
    ]


def passes(driven: DrivenPass, steps: list[Seen]) -> list[FloatArray]:
    answers = [driven.step(seen, 5) for seen in steps]
    return [answer for answer in answers if answer is not None]


def test_a_pass_ends_where_the_tractor_turns_away_with_the_implement_up() -> None:
    found = passes(DrivenPass(), [*seen_along(UP, working=True), *seen_along(ROUND, working=False, start=40.0)])
    assert len(found) == 1
    assert found[0][0] == pytest.approx([0.0, 0.0])
    assert found[0][-1] == pytest.approx([0.0, 60.0], abs=0.6)


def test_it_is_known_on_which_pass_it_was_driven() -> None:
    driven = DrivenPass()
    passes(driven, seen_along(UP, working=True))
    assert driven.key == 5


def test_lifting_on_the_way_does_not_end_a_pass() -> None:
    low, middle, high = (np.array([[0.0, a], [0.0, b]]) for a, b in ((0, 20), (20, 30), (30, 60)))
    steps = [
        *seen_along(low, working=True),
        *seen_along(middle, working=False, start=20.0),
        *seen_along(high, working=True, start=40.0),
        *seen_along(ROUND, working=False, start=70.0),
    ]
    found = passes(DrivenPass(), steps)
    assert len(found) == 1
    assert float(np.ptp(found[0][:, 1])) == pytest.approx(60.0, abs=1.0)


def test_turning_round_with_the_implement_down_ends_a_pass_before_the_turn() -> None:
    path = np.vstack([UP, ROUND[1:], DOWN[1:]])
    found = passes(DrivenPass(), seen_along(path, working=True))
    assert len(found) == 1
    assert np.abs(found[0][:, 0]).max() < 1.0
    assert found[0][-1, 1] > 55.0


def test_less_than_ten_metres_are_no_pass() -> None:
    short = np.array([[0.0, 52.0], [0.0, 60.0]])
    assert not passes(DrivenPass(), [*seen_along(short, working=True), *seen_along(ROUND, working=False, start=40.0)])


def test_the_turn_in_and_out_is_cut_off() -> None:
    turn_in = half_circle((-2 * SPACING, 0.0), (0.0, 0.0), clockwise=False)
    steps = [
        *seen_along(turn_in, working=True),
        *seen_along(UP, working=True, start=20.0),
        *seen_along(ROUND[:14], working=True, start=60.0),
        *seen_along(ROUND[14:], working=False, start=63.0),
    ]
    found = passes(DrivenPass(), steps)
    assert len(found) == 1
    headings = np.arctan2(*np.diff(found[0], axis=0).T)
    assert np.abs(headings).max() < math.radians(50)


def test_a_fork_goes_its_own_way() -> None:
    driven = DrivenPass()
    passes(driven, seen_along(UP, working=True))
    fork = driven.fork()
    away = seen_along(ROUND, working=False, start=40.0)
    assert len(passes(fork, away)) == 1
    assert len(passes(driven, away)) == 1
