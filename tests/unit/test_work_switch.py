"""The implement goes down under a narrow rule and comes up under a wide one, whoever decides."""

import math
from dataclasses import replace

import numpy as np
import pytest

from guidance_app.guidance.work import WorkSwitch
from guidance_app.model import Guidance, Pass, Pose, WorkMode

PASS = Pass(3, np.array([[0.0, 0.0], [0.0, 100.0]]))
POSE = Pose(t=0.0, arrival=0.0, east=0.0, north=50.0, heading=0.0, speed=2.0)
ON = Guidance(PASS, cross_track=0.1, heading_error=0.0, along_track=50.0, against=False, on_pass=True)


def test_on_the_pass_the_implement_goes_down_by_itself() -> None:
    assert WorkSwitch(3.0).after(POSE, ON, None).down


@pytest.mark.parametrize(
    "guidance",
    [
        None,
        replace(ON, on_pass=False),
        replace(ON, heading_error=math.radians(25)),
        replace(ON, cross_track=1.7),
    ],
    ids=["no line", "beyond the ends", "turned", "beside"],
)
def test_off_the_pass_it_stays_up(guidance: Guidance | None) -> None:
    assert not WorkSwitch(3.0).after(POSE, guidance, None).down


def test_a_working_implement_bears_more_than_a_lifted_one() -> None:
    edge = replace(ON, heading_error=math.radians(30), cross_track=1.9)
    assert not WorkSwitch(3.0).after(POSE, edge, None).down
    assert WorkSwitch(3.0, down=True).after(POSE, edge, None).down


@pytest.mark.parametrize("pose", [None, replace(POSE, speed=0.0), replace(POSE, speed=-1.0, reverse=True)])
def test_nobody_works_standing_or_backwards(pose: Pose | None) -> None:
    assert not WorkSwitch(3.0, down=True).after(pose, ON, None).down


def test_the_button_decides_until_another_way_is_chosen() -> None:
    pressed = WorkSwitch(3.0).pressed(down=True)
    assert pressed.after(POSE, None, None).down
    assert pressed.mode is WorkMode.BUTTON
    assert not pressed.with_mode(WorkMode.AUTO).after(POSE, None, None).down


def test_the_implements_own_switch_is_believed_and_silence_changes_nothing() -> None:
    switch = WorkSwitch(3.0).with_mode(WorkMode.SWITCH)
    down = switch.after(POSE, None, reported=True)
    assert down.down
    assert down.after(POSE, None, None).down
    assert not down.after(POSE, None, reported=False).down


def test_by_speed_there_is_a_gap_between_beginning_and_ending() -> None:
    switch = WorkSwitch(3.0).with_mode(WorkMode.SPEED)
    slow = replace(POSE, speed=0.2)
    assert not switch.after(slow, None, None).down
    assert switch.after(POSE, None, None).after(slow, None, None).down
