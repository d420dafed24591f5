"""The way through a turn: beside its path, forward over itself where the tractor backs up, and calm on the bar."""

import itertools
import json
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from support.sessions import driving

from guidance_app.documents import Settings
from guidance_app.guidance.turning import Turning, turning_of
from guidance_app.model import FloatArray, Guidance, Pass, Pose, TurnGuide
from guidance_app.view.bar import TurnLevel, bar_of
from guidance_app.view.bar_wire import bar_json

CENTIMETRE = 0.01
QUARTER = 0.25
"""Metres: the vertices of a turn's path lie so far apart, and nothing is told apart between two of them."""
RADIUS = 5.0
U_TURN = np.array([(RADIUS - RADIUS * math.cos(a), RADIUS * math.sin(a)) for a in np.linspace(0.0, math.pi, 60)])
"""From the origin, heading north, clockwise round to (10, 0), heading south."""
THERE_AND_BACK = np.array([[0.0, 0.0], [0.0, 10.0], [0.0, 2.0], [0.0, -8.0]])
"""North to a cusp, then backwards over the same way."""
TARGET = Pass(4, np.array([[10.0, 0.0], [10.0, -100.0]]), order=3)


def guidance(points: FloatArray, *, driven: bool = True) -> Guidance:
    return Guidance(TARGET, 1.74, 0.0, -5.0, against=False, turn=TurnGuide(0.0, 0.0, points, driven=driven), count=24)


def a_pose(heading: float, speed: float = 2.0) -> Pose:
    return Pose(t=0.0, arrival=100.0, east=0.0, north=0.0, heading=heading, speed=speed)


def along(points: FloatArray, places: list[tuple[float, float, float]]) -> list[TurnGuide]:
    """The turn as it is shown at these places (east, north, heading), one after the other."""
    turning: Turning | None = None
    shown = []
    for east, north, heading in places:
        seen = guidance(points)
        turning = turning_of(turning, seen, a_pose(heading), (east, north))
        assert turning is not None
        assert seen.turn is not None
        shown.append(turning.shown(seen.turn, heading))
    return shown


@pytest.mark.parametrize("beside", [-0.5, 0.0, 0.8])
def test_right_of_the_path_is_positive_all_the_way_round(beside: float):
    angles = np.linspace(0.1, math.pi - 0.1, 30)
    reach = RADIUS - beside  # the turn goes clockwise: its middle is on the right
    places = [(RADIUS - reach * math.cos(a), reach * math.sin(a), float(a)) for a in angles]
    for one, angle in zip(along(U_TURN, places), angles, strict=True):
        assert one.cross_track == pytest.approx(beside, abs=2 * CENTIMETRE)
        assert one.heading_error == pytest.approx(0.0, abs=0.06)
        assert one.to_go == pytest.approx(RADIUS * (math.pi - angle), abs=0.1)


def test_backing_up_over_the_same_way_goes_on_and_keeps_the_drivers_sides():
    there = [(0.3, float(north), 0.0) for north in np.linspace(0.0, 10.0, 21)]
    back = [(0.3, float(north), 0.0) for north in np.linspace(9.5, -6.0, 32)]
    shown = along(THERE_AND_BACK, there + back)
    to_go = [one.to_go for one in shown]
    assert all(after <= before + QUARTER for before, after in itertools.pairwise(to_go))
    assert to_go[-1] == pytest.approx(2.0, abs=0.1)
    assert all(one.cross_track == pytest.approx(0.3, abs=CENTIMETRE) for one in shown)


def test_a_turn_that_was_kept_in_a_file_goes_on_where_it_was():
    crossing = np.array([[0.0, 0.0], [0.0, 12.0], [12.0, 12.0], [12.0, 6.0], [-6.0, 6.0]])
    seen = guidance(crossing)
    turning = turning_of(None, seen, a_pose(0.0), (0.0, 0.0))
    for north in (2.0, 4.0, 5.8):
        turning = turning_of(turning, seen, a_pose(0.0), (0.0, north))
    kept = turning_of(pickle.loads(pickle.dumps(turning)), seen, a_pose(0.0), (0.0, 6.0))
    gone_on = turning_of(turning, seen, a_pose(0.0), (0.0, 6.0))
    assert kept is not None
    assert gone_on is not None
    assert kept.foot == gone_on.foot
    assert gone_on.foot.along < 12.0  # on the first way through the crossing, as it came


def test_who_leaves_the_path_is_found_again():
    shown = along(U_TURN, [(0.0, 0.1, 0.0), (9.9, 0.5, math.pi)])
    assert shown[-1].to_go < 1.0


def test_beyond_the_turn_the_line_counts():
    turning = turning_of(None, guidance(U_TURN), a_pose(math.pi), (10.0, 0.4))
    assert turning is not None
    assert turning.errors_at((10.2, 0.2), math.pi) is not None
    assert turning.errors_at((10.2, -3.0), math.pi, moved=3.4) is None


def test_no_turn_is_driven_on_a_pass_or_without_a_heading():
    assert turning_of(None, None, a_pose(0.0), (0.0, 0.0)) is None
    assert turning_of(None, guidance(U_TURN, driven=False), a_pose(0.0), (0.0, 0.0)) is None
    assert turning_of(None, guidance(U_TURN), replace(a_pose(0.0), heading_known=False), (0.0, 0.0)) is None


# --- on the bar ----------------------------------------------------------------------------------------------------


def test_in_a_turn_the_bar_is_about_the_turn():
    snapshot = driving(1.74)
    turn = TurnGuide(0.0, 0.0, U_TURN, driven=True, cross_track=-0.12, heading_error=0.0, to_go=8.4)
    assert snapshot.guidance is not None
    turning = replace(snapshot, guidance=replace(guidance(U_TURN), turn=turn))
    steering = bar_of(turning, snapshot.arrival, Settings()).steering
    assert steering is not None
    assert steering.turning == "turn to pass 4"
    assert steering.cross_track == pytest.approx(-0.12)
    assert steering.lamps == 3
    assert steering.turn is not None
    assert steering.turn.level is TurnLevel.FAR
    assert steering.turn.distance == "8 m"
    assert steering.turn.seconds == ""
    assert json.loads(bar_json(bar_of(turning, snapshot.arrival, Settings())))["m"] == "turn to pass 4"


def test_without_an_order_the_turn_leads_to_a_line():
    snapshot = driving()
    turn = TurnGuide(0.0, 0.0, U_TURN, driven=True, cross_track=0.0, heading_error=0.0, to_go=8.4)
    seen = replace(guidance(U_TURN), turn=turn, target=replace(TARGET, order=None))
    steering = bar_of(replace(snapshot, guidance=seen), snapshot.arrival, Settings()).steering
    assert steering is not None
    assert steering.turning == "turn to line 4"
    assert "m" not in json.loads(bar_json(bar_of(snapshot, snapshot.arrival, Settings())))
