"""What the screen says of the drive's state, of known points, of the measuring time and of the roll sensor's zero."""

import json
from dataclasses import replace

import numpy as np
import pytest
from support.snapshots import FIELD, ORIGIN_DEG, field_job, field_snapshot

from guidance_app.documents import FieldDocument, GuidanceLineDocument, LineGeometry, Settings, Units
from guidance_app.geodesy import FieldFrame
from guidance_app.language import ENGLISH
from guidance_app.model import (
    BeginRollZero,
    Initialised,
    Initialising,
    Pause,
    Resume,
    RollZeroFound,
    RollZeroProgress,
    RollZeroStage,
    SessionState,
    SetWork,
    SkipInitialisation,
)
from guidance_app.view.bar import bar_of
from guidance_app.view.bar_states import BarState
from guidance_app.view.bar_wire import bar_json
from guidance_app.view.drive import pass_work_words, pause_press, state_words, work_press
from guidance_app.view.points import distance_to, known_points, nearest_of
from guidance_app.view.position import measured_words, measuring_words, roll_zero_view

DECIMETRE = 0.1


@pytest.mark.parametrize(
    ("state", "command"),
    [
        (SessionState.IDLE, SetWork(down=True)),
        (SessionState.DRIVING, SetWork(down=True)),
        (SessionState.PAUSED, Resume()),
        (SessionState.INITIALISING, SkipInitialisation()),
        (SessionState.ENDED, None),
    ],
)
def test_the_large_button_does_what_its_words_say(state: SessionState, command: object):
    press = work_press(field_snapshot(state=state, working=False), ENGLISH)
    assert press.command == command
    assert press.words
    assert not press.lit
    assert state_words(state, ENGLISH)


def test_the_pause_button_leads_in_and_out():
    assert pause_press(field_snapshot(), ENGLISH).command == Pause()
    assert pause_press(field_snapshot(state=SessionState.PAUSED), ENGLISH).command == Resume()


def test_without_a_pass_nothing_is_said_of_it():
    assert pass_work_words(field_snapshot(pass_totals=None), Units.METRIC, ENGLISH) == ""


@pytest.mark.parametrize(
    ("state", "shown"),
    [
        (SessionState.INITIALISING, BarState.MEASURING),
        (SessionState.ENDED, BarState.FINISHED),
        (SessionState.PAUSED, BarState.GUIDE),
    ],
)
def test_the_bar_says_the_drives_state(state: SessionState, shown: BarState):
    snapshot = field_snapshot(state=state, working=False)
    view = bar_of(snapshot, snapshot.arrival, Settings())
    assert view.state is shown
    assert bool(view.steering) == (shown is BarState.GUIDE)
    assert bool(view.reason) == (shown is not BarState.GUIDE)
    assert json.loads(bar_json(view)).get("z") == (1 if state is SessionState.PAUSED else None)


# --- known points --------------------------------------------------------------------------------------------------


def field_with_line() -> FieldDocument:
    field = field_job().field
    assert field is not None
    frame = FieldFrame(*ORIGIN_DEG)
    ends = [tuple(map(float, end)) for end in frame.lonlat_from_array(np.array([[10.0, 10.0], [20.0, 150.0]]))]
    line = GuidanceLineDocument(name="Hedge", geometry=LineGeometry(coordinates=ends))
    return field.model_copy(update={"lines": [line]})


def test_entrance_corners_and_ends_of_lines_are_known():
    points = known_points(field_with_line(), ENGLISH)
    names = [one.name for one in points]
    assert names == ["Entrance", "Corner 1", "Corner 2", "Corner 3", "Corner 4", "1. Hedge A", "1. Hedge B"]
    assert len(set(names)) == len(names)
    assert known_points(None, ENGLISH) == ()


def test_a_straight_edge_with_many_vertices_has_no_corner():
    field = field_job().field
    frame = FieldFrame(*ORIGIN_DEG)
    edge = np.concatenate([np.linspace(FIELD[i], FIELD[i + 1], 50, endpoint=False) for i in range(4)] + [FIELD[:1]])
    ring = [tuple(map(float, place)) for place in frame.lonlat_from_array(edge)]
    ring[-1] = ring[0]
    fine = field.model_copy(update={"boundary": field.boundary.model_copy(update={"coordinates": [ring]})})
    assert sum("Corner" in one.name for one in known_points(fine, ENGLISH)) == 4


def test_the_nearest_point_and_how_far_it_is():
    points = known_points(field_with_line(), ENGLISH)
    snapshot = field_snapshot()
    assert snapshot.pose is not None
    near = replace(snapshot, pose=replace(snapshot.pose, east=148.0, north=199.0))
    nearest = nearest_of(points, near)
    assert nearest is not None
    assert nearest.name == "Corner 3"
    assert distance_to(nearest, near) == pytest.approx(5**0.5, abs=DECIMETRE)
    lost = replace(snapshot, pose=None)
    assert nearest_of(points, lost) is None
    assert distance_to(points[0], lost) is None


# --- measuring and roll zero ---------------------------------------------------------------------------------------


def test_measuring_is_told_only_while_it_is_done():
    assert measuring_words(field_snapshot(), ENGLISH) == ""
    assert "50 %" in measuring_words(field_snapshot(initialising=Initialising(0.5, 25)), ENGLISH)
    assert "turns" in measuring_words(field_snapshot(initialising=Initialising(0.0, 0, "the tractor turns")), ENGLISH)


def test_the_result_tells_what_is_known():
    assert measured_words(field_snapshot(), Units.METRIC, ENGLISH) == ()
    unknown = Initialised(100.0, 52, 10.2, None, None, (0.03, 0.04), None)
    assert len(measured_words(field_snapshot(initialised=unknown), Units.METRIC, ENGLISH)) == 2
    known = replace(unknown, east=0.3, north=0.4, gyro_bias=0.002)
    rows = dict(measured_words(field_snapshot(initialised=known), Units.METRIC, ENGLISH))
    assert rows["Position moved by"] == "50 cm"


def test_the_calibration_begins_and_shows_what_it_found():
    view = roll_zero_view(field_snapshot(roll_zero_deg=0.5), Units.METRIC, ENGLISH)
    assert view.command == BeginRollZero()
    assert "0.50°" in view.said
    found = RollZeroProgress(RollZeroStage.FOUND, 60.0, 60.0, RollZeroFound(1.52, 1.02, 0.04, 58.0))
    view = roll_zero_view(field_snapshot(roll_zero=found), Units.METRIC, ENGLISH)
    assert view.under_way
    for part in ("58 m", "1.52°", "0.04°", "+1.02°"):
        assert part in view.said
