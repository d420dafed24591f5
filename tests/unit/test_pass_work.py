"""What is left out of a pass: driven by with the implement up, until it is worked after all."""

import numpy as np
import pytest

from guidance_app.guidance.pass_work import PassWork
from guidance_app.model import Guidance, Pass

LENGTH = 100.0
DECIMETRE = 0.1
LINE = Pass(3, np.array([[0.0, 0.0], [0.0, LENGTH]]), order=2)


def along(metres: float, *, target: Pass = LINE, against: bool = False, on_pass: bool = True) -> Guidance:
    return Guidance(target, 0.0, 0.0, metres, against, on_pass=on_pass)


def drive(work: PassWork, first: float, last: float, *, working: bool, against: bool = False) -> None:
    for metres in np.linspace(first, last, 1 + int(abs(last - first) * 2)):
        work.step(along(float(metres), against=against), int(working))


def test_what_was_worked_is_not_missed():
    work = PassWork()
    drive(work, 0.0, 60.0, working=True)
    assert work.missed == pytest.approx(0.0, abs=DECIMETRE)


def test_a_stretch_driven_with_the_implement_up_is_missed_until_it_is_worked():
    work = PassWork()
    drive(work, 0.0, 20.0, working=True)
    drive(work, 20.0, 35.0, working=False)
    drive(work, 35.0, 60.0, working=True)
    assert work.missed == pytest.approx(15.0, abs=DECIMETRE)
    work.step(None, 0)
    drive(work, LENGTH - 40.0, LENGTH - 10.0, working=True, against=True)
    assert work.missed == pytest.approx(0.0, abs=DECIMETRE)


def test_a_jump_and_a_turn_leave_nothing_out():
    work = PassWork()
    drive(work, 0.0, 20.0, working=True)
    work.step(along(40.0, on_pass=False), 0)
    drive(work, 70.0, 80.0, working=True)
    assert work.missed == pytest.approx(0.0, abs=DECIMETRE)


def test_the_implement_hangs_behind():
    work = PassWork(behind=5.0)
    drive(work, 0.0, 5.0, working=False)
    assert work.missed == 0.0
    drive(work, 5.0, 15.0, working=False)
    assert work.missed == pytest.approx(10.0, abs=DECIMETRE)


def test_each_pass_has_its_own_and_a_fork_goes_its_own_way():
    work = PassWork()
    drive(work, 0.0, 20.0, working=False)
    other = Pass(4, LINE.points + 6.0, order=3)
    fork = work.fork()
    fork.step(along(0.0, target=other), 1)
    assert fork.missed == 0.0
    assert work.missed == pytest.approx(20.0, abs=DECIMETRE)


def test_a_lap_goes_round_over_its_seam():
    ring = Pass(9, np.array([[0.0, 0.0], [50.0, 0.0], [50.0, 50.0], [0.0, 50.0]]), closed=True, lap=True)
    work = PassWork()
    for metres in range(190, 206):
        work.step(along(metres % 200.0, target=ring), 0)
    assert work.missed == pytest.approx(15.0, abs=DECIMETRE)


def test_a_section_that_is_off_leaves_its_strip_out_until_that_strip_is_worked() -> None:
    work = PassWork(sections=4)
    for metres in np.linspace(0.0, 40.0, 81):
        work.step(along(float(metres)), 0b1101)
    assert work.missed == pytest.approx(40.0 / 4, abs=DECIMETRE)
    work.step(None, 0)
    wrong, right = work.fork(), work.fork()
    for metres in np.linspace(LENGTH - 40.0, LENGTH, 81):
        wrong.step(along(float(metres), against=True), 0b0010)
        right.step(along(float(metres), against=True), 0b0100)
    assert wrong.missed == pytest.approx(40.0 / 4, abs=DECIMETRE)
    assert right.missed == pytest.approx(0.0, abs=DECIMETRE)
