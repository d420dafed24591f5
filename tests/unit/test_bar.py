"""What the bars say: sides, lamps, steps, the states in which there is nothing to steer by, and the wire."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.sessions import driving

from guidance_app.documents import Settings, Units
from guidance_app.model import (
    FixQuality,
    LinkState,
    LinkStatus,
    Pass,
    Pose,
    Snapshot,
    TurnGuide,
)
from guidance_app.view.bar import Steering, TurnLevel, bar_of
from guidance_app.view.bar_states import TROUBLES, BarState
from guidance_app.view.bar_wire import bar_json, lamp_zones, style_json

MICROMETRE = 1e-6
AT = 100.0
SETTINGS = Settings()
STEPS = SETTINGS.light_bar_steps
LONGEST_MESSAGE = 260

offsets = st.floats(-20.0, 20.0).filter(lambda off: abs(off) > 1e-3)


def steering_at(snapshot: Snapshot, now: float = AT, settings: Settings = SETTINGS) -> Steering:
    steering = bar_of(snapshot, now, settings).steering
    assert steering is not None
    return steering


# --- sides ---------------------------------------------------------------------------------------------------------


@given(offsets)
def test_right_of_the_line_the_lamps_light_on_the_left(off: float) -> None:
    steering = steering_at(driving(off))
    assert steering.lamps * off <= 0
    assert (steering.lamps != 0) == (abs(off) >= STEPS[0])


@given(offsets)
def test_the_mark_stands_on_the_side_where_the_tractor_is_heading(predicted: float) -> None:
    steering = steering_at(driving(0.3, predicted=predicted))
    assert steering.predicted is not None
    assert steering.predicted * predicted > 0


@given(offsets, offsets)
def test_mirrored_world_mirrored_bars(off: float, predicted: float) -> None:
    one = steering_at(driving(off, predicted=predicted))
    other = steering_at(driving(-off, predicted=-predicted))
    assert one.predicted is not None
    assert other.predicted is not None
    assert one.lamps == -other.lamps
    assert one.cross_track == pytest.approx(-other.cross_track, abs=MICROMETRE)
    assert one.predicted == pytest.approx(-other.predicted, abs=MICROMETRE)
    assert (one.number, one.predicted_number) == (other.number, other.predicted_number)


@pytest.mark.parametrize(("step", "lamps"), [(step, k + 1) for k, step in enumerate(STEPS)])
def test_each_step_lights_one_lamp_more(step: float, lamps: int) -> None:
    assert steering_at(driving(-step)).lamps == lamps
    assert steering_at(driving(-step + MICROMETRE)).lamps == lamps - 1


def test_the_steps_are_the_settings_and_stay_metres_in_every_unit() -> None:
    coarse = Settings(light_bar_steps=(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8))
    for units in Units:
        assert steering_at(driving(0.45), settings=coarse.model_copy(update={"units": units})).lamps == -4


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_the_mark_never_moves_against_the_prediction(one: float, other: float) -> None:
    low, high = sorted((one, other))
    left = steering_at(driving(predicted=low)).predicted
    right = steering_at(driving(predicted=high)).predicted
    assert left is not None
    assert right is not None
    assert -1.0 <= left <= right <= 1.0


def test_the_mark_uses_the_lamps_own_scale() -> None:
    for k, step in enumerate(STEPS):
        assert steering_at(driving(predicted=step)).predicted == pytest.approx((k + 1) / len(STEPS))
    assert steering_at(driving(predicted=50.0)).predicted == 1.0


def test_zones_begin_green_at_the_line_and_end_red() -> None:
    assert lamp_zones(STEPS) == "gggyyyrr"


# --- nothing to steer by -------------------------------------------------------------------------------------------


def test_every_state_of_a_link_is_judged() -> None:
    assert set(TROUBLES) == set(LinkStatus)


@pytest.mark.parametrize("status", [status for status in LinkStatus if status is not LinkStatus.FIX])
def test_without_a_fix_nothing_is_left_of_the_last_value(status: LinkStatus) -> None:
    view = bar_of(replace(driving(), link=LinkState(status)), AT, SETTINGS)
    assert view.steering is None
    assert view.speed == ""
    assert view.working is None
    assert view.reason
    assert view.state is TROUBLES[status]


def test_a_broken_link_says_what_broke() -> None:
    view = bar_of(replace(driving(), link=LinkState(LinkStatus.DOWN, reason="cable pulled out")), AT, SETTINGS)
    assert view.reason == "receiver lost: cable pulled out"


@pytest.mark.parametrize(("interval", "limit"), [(None, 1.0), (0.1, 1.0), (0.5, 1.0), (1.0, 2.0), (2.0, 4.0)])
def test_an_old_fix_blanks_the_bars(interval: float | None, limit: float) -> None:
    snapshot = replace(driving(at=AT), fix_interval=interval)
    assert bar_of(snapshot, AT + limit, SETTINGS).state is BarState.GUIDE
    view = bar_of(snapshot, AT + limit + 0.01, SETTINGS)
    assert view.state is BarState.STALE
    assert view.steering is None
    assert view.reason == f"no position for {limit:.0f} s"
    assert "ago" in view.fix


def test_a_filter_that_is_not_ready_says_so() -> None:
    view = bar_of(replace(driving(), pose=None), AT, SETTINGS)
    assert (view.state, view.steering) == (BarState.NOT_READY, None)
    assert view.reason == "finding the position"


def test_an_unknown_direction_asks_to_drive() -> None:
    snapshot = driving()
    assert snapshot.pose is not None
    view = bar_of(replace(snapshot, pose=replace(snapshot.pose, heading_known=False)), AT, SETTINGS)
    assert (view.state, view.steering) == (BarState.NO_DIRECTION, None)
    assert view.reason == "direction unknown: drive 2 m"


def test_across_the_lines_there_is_no_side_to_steer_to_but_where_one_is() -> None:
    """Without a plan: nobody knows which line is looked for, until the tractor turns to one."""
    plain = driving(3.0)
    assert plain.guidance is not None
    line = replace(plain.guidance.target, number=12, order=None)
    guidance = replace(plain.guidance, target=line, on_pass=False, turn=None, heading_error=math.radians(85))
    view = bar_of(replace(plain, guidance=guidance), AT, SETTINGS)
    assert (view.state, view.reason, view.steering) == (BarState.ACROSS, "across line 12", None)
    assert view.speed == "8.3"
    towards = replace(guidance, heading_error=math.radians(-85))
    planned = replace(guidance, target=replace(line, order=3))
    along = replace(guidance, heading_error=math.radians(40))
    for other in (towards, planned, along):
        assert bar_of(replace(plain, guidance=other), AT, SETTINGS).state is BarState.GUIDE


def test_without_a_line_speed_and_fix_still_stand() -> None:
    view = bar_of(replace(driving(), guidance=None), AT, SETTINGS)
    assert (view.state, view.reason, view.steering) == (BarState.NO_LINE, "no line", None)
    assert view.speed == "8.3"
    assert view.fix == "RTK fixed, <1 s"


def test_a_raised_implement_is_said_and_does_not_end_the_guidance() -> None:
    view = bar_of(driving(working=False), AT, SETTINGS)
    assert view.state is BarState.GUIDE
    assert view.working is False


def test_without_a_prediction_only_its_bar_is_empty() -> None:
    steering = steering_at(driving(predicted=None))
    assert steering.predicted is None
    assert steering.lean is None
    assert steering.number == "12 cm"


# --- the instant of the redraw -------------------------------------------------------------------------------------


def slanting(snapshot: Snapshot, degrees: float) -> Snapshot:
    """The same, but the tractor drives at this angle to the line, positive to the right."""
    assert snapshot.pose is not None
    return replace(snapshot, pose=replace(snapshot.pose, heading=math.radians(degrees)))


def test_at_the_fix_it_is_the_engines_number_to_the_bit() -> None:
    snapshot = slanting(driving(0.1234567), 20)
    assert snapshot.guidance is not None
    assert steering_at(snapshot, AT).cross_track == snapshot.guidance.cross_track


@given(st.floats(-30, 30), st.floats(0, 0.9))
def test_between_fixes_the_error_drifts_with_the_heading(degrees: float, later: float) -> None:
    drifted = steering_at(slanting(driving(0.1, speed=2.0), degrees), AT + later).cross_track
    assert drifted == pytest.approx(0.1 + 2.0 * later * math.sin(math.radians(degrees)), abs=MICROMETRE)


def test_driven_the_other_way_right_is_the_other_side() -> None:
    snapshot = slanting(driving(0.1, speed=2.0), 180 + 10)
    assert snapshot.guidance is not None
    turned = replace(snapshot, guidance=replace(snapshot.guidance, against=True))
    expected = 0.1 + 2.0 * 0.5 * math.sin(math.radians(10))
    assert steering_at(turned, AT + 0.5).cross_track == pytest.approx(expected, abs=MICROMETRE)


def test_on_a_circle_a_tractor_that_follows_it_does_not_drift() -> None:
    angles = np.radians(np.arange(0.0, 360.0, 0.25))
    circle = 30.0 * np.column_stack([np.sin(angles), np.cos(angles)])
    snapshot = driving(0.0, speed=2.0, predicted=None)
    assert snapshot.pose is not None
    assert snapshot.guidance is not None
    pose = Pose(t=AT, arrival=AT, east=0.0, north=30.0, heading=math.pi / 2, speed=2.0, curvature=1 / 30)
    target = Pass(number=1, points=circle, closed=True, lap=True, order=0)
    round_the_circle = replace(snapshot, pose=pose, guidance=replace(snapshot.guidance, target=target))
    assert steering_at(round_the_circle, AT + 0.5).cross_track == pytest.approx(0.0, abs=0.005)


def test_a_guided_implement_swings_with_the_tractors_tail() -> None:
    snapshot = driving(0.0, speed=2.0)
    assert snapshot.pose is not None
    turning = replace(snapshot, pose=replace(snapshot.pose, curvature=0.1), implement=(0.0, -3.0, 0.0))
    tractor = steering_at(turning, AT + 0.5)
    implement = steering_at(turning, AT + 0.5, SETTINGS.model_copy(update={"guide_implement": True}))
    assert tractor.cross_track > 0 > implement.cross_track


def test_a_standing_tractor_does_not_drift() -> None:
    snapshot = driving(0.1)
    assert snapshot.pose is not None
    standing = replace(snapshot, pose=replace(snapshot.pose, standing=True, speed=0.02, heading=1.0))
    assert steering_at(standing, AT + 0.9).cross_track == 0.1


# --- words ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("target", "count", "text"),
    [
        (Pass(2, np.zeros((2, 2)), order=2), 24, "pass 3 of 24 (line +2)"),
        (Pass(5, np.zeros((2, 2)), order=0), None, "pass 1 (line +5)"),
        (Pass(1, np.zeros((2, 2)), order=1, lap=True, closed=True), 9, "pass 2 of 9 (lap 1)"),
        (Pass(-3, np.zeros((2, 2)), endless=True), None, "line -3"),
        (Pass(0, np.zeros((2, 2)), endless=True), None, "line 0"),
    ],
)
def test_the_pass_is_named_by_its_place_and_its_line(target: Pass, count: int | None, text: str) -> None:
    snapshot = driving(speed=0.0)
    assert snapshot.guidance is not None
    moved = replace(snapshot.guidance, target=replace(target, points=snapshot.guidance.target.points), count=count)
    assert steering_at(replace(snapshot, guidance=moved)).pass_text == text


@pytest.mark.parametrize(
    ("seconds", "words", "level"),
    [
        (None, "", TurnLevel.FAR),
        (120.0, "", TurnLevel.FAR),
        (60.0, "60 s", TurnLevel.FAR),
        (10.0, "10 s", TurnLevel.FAR),
        (9.9, "10 s", TurnLevel.SOON),
        (3.0, "3 s", TurnLevel.SOON),
        (2.9, "3 s", TurnLevel.NOW),
        (0.0, "0 s", TurnLevel.NOW),
    ],
)
def test_a_turn_gets_yellow_below_ten_seconds_and_then_red(seconds: float | None, words: str, level: TurnLevel) -> None:
    turn = steering_at(driving(turn=TurnGuide(42.4, seconds, np.zeros((2, 2))))).turn
    assert turn is not None
    assert (turn.distance, turn.seconds, turn.level, turn.fits) == ("42 m", words, level, True)


def test_without_a_planned_turn_the_end_of_the_pass_is_told() -> None:
    turn = steering_at(driving(speed=10.0)).turn
    assert turn is not None
    assert (turn.distance, turn.seconds) == ("500 m", "50 s")


def test_a_turn_that_does_not_fit_says_so() -> None:
    turn = steering_at(driving(turn=TurnGuide(42.0, 20.0, np.zeros((2, 2)), fits=False))).turn
    assert turn is not None
    assert turn.fits is False


def test_every_fix_quality_has_its_word() -> None:
    words = {bar_of(driving(quality=quality), AT, SETTINGS).fix for quality in FixQuality}
    assert len(words) == len(FixQuality)


@pytest.mark.parametrize(
    ("units", "number", "speed", "area"),
    [
        (Units.METRIC, "12 cm", "8.3", "3.42 ha"),
        (Units.IMPERIAL, "5 in", "5.1", "8.45 ac"),
        (Units.JAPANESE, "12 cm", "8.3", "342 a"),
    ],
)
def test_units_are_the_settings(units: Units, number: str, speed: str, area: str) -> None:
    settings = SETTINGS.model_copy(update={"units": units})
    view = bar_of(driving(), AT, settings)
    assert view.steering is not None
    assert (view.steering.number, view.speed, view.area) == (number, speed, area)


# --- the wire ------------------------------------------------------------------------------------------------------


@given(offsets, st.one_of(st.none(), offsets), st.integers(0, 10**7), st.floats(0, 10))
def test_a_message_stays_small_whatever_happens(
    off: float, predicted: float | None, sequence: int, later: float
) -> None:
    snapshot = driving(off, predicted=predicted, sequence=sequence, quality=FixQuality.DEAD_RECKONING)
    text = bar_json(bar_of(snapshot, AT + later, SETTINGS), sent_ms=1.7e12 + 0.1)
    assert len(text.encode()) <= LONGEST_MESSAGE
    assert None not in json.loads(text).values()


def test_a_message_carries_what_the_view_says() -> None:
    turn = TurnGuide(42.0, 8.0, np.zeros((2, 2)))
    assert json.loads(bar_json(bar_of(driving(turn=turn, sequence=7), AT + 0.05, SETTINGS), sent_ms=12.34)) == {
        "q": 7,
        "t": 12.3,
        "s": "guide",
        "a": 50,
        "x": 124,
        "k": -3,
        "d": "12 cm",
        "p": 325,
        "e": "8 cm",
        "h": 3,
        "n": "pass 3 of 24 (line +2)",
        "u": ["42 m", "8 s", "soon", 1],
        "v": "8.3",
        "f": "RTK fixed, <1 s",
        "c": "3.42 ha",
        "w": 1,
    }


def test_a_message_without_steering_has_no_number_at_all() -> None:
    message = json.loads(bar_json(bar_of(driving(at=AT - 5), AT, SETTINGS)))
    assert set(message) == {"q", "s", "r", "a", "f", "c"}


def test_the_style_tells_what_seldom_changes() -> None:
    settings = SETTINGS.model_copy(update={"guide_implement": True, "units": Units.IMPERIAL, "sounds": False})
    style = json.loads(style_json(settings, 1.5))["style"]
    said = style.pop("words")
    assert style == {"speed": "mph", "zones": "gggyyyrr", "guided": "implement", "sounds": False, "language": "en"}
    assert said["ahead"] == "IN 1.5 s"
    assert said["steerLeft"] == "steer left"
    assert all(said.values())


@pytest.mark.parametrize(
    ("language", "number", "name", "ahead"),
    [("ja", "1.24 m", "行程 3/24 (ライン +2)", "1.5 秒後"), ("es", "1,24 m", "pasada 3/24 (línea +2)", "EN 1,5 s")],
)
def test_the_bar_speaks_the_drivers_language(language: str, number: str, name: str, ahead: str) -> None:
    settings = SETTINGS.model_copy(update={"language": language})
    view = bar_of(driving(1.239), AT, settings)
    assert view.steering is not None
    assert (view.steering.number, view.steering.pass_text) == (number, name)
    assert json.loads(style_json(settings, 1.5))["style"]["words"]["ahead"] == ahead
