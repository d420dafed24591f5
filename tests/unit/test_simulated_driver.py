"""The simulated driver: comes to the line, mirrors, turns, backs up, stops, and is as imperfect as it is told to be."""

import math

import numpy as np
import pytest

from guidance_app.angles import wrap_pi
from guidance_app.documents import Implement, Tractor
from guidance_app.geodesy import FieldFrame
from guidance_app.model import FloatArray, Segment, SegmentKind
from guidance_app.simulation.driver import DriverSettings
from guidance_app.simulation.job import JobSettings, LossOfFix, SimulatedEpoch, simulated_epochs
from guidance_app.simulation.receiver import ReceiverSettings
from guidance_app.simulation.route import Stretch, stretches_of

FRAME = FieldFrame(41.93, -4.87)
MACHINE = (Tractor(name="T"), Implement(name="I", working_width=3.0))
CALM = DriverSettings(wander=0.0)
NO_DRIFT = ReceiverSettings(drift=0.0)
CENTIMETRE = 0.01
TURN_RADIUS = 6.0


def segment(
    kind: SegmentKind, number: int, points: list[tuple[float, float]] | FloatArray, *, reverse: bool = False
) -> Segment:
    array = np.asarray(points, dtype=float)
    length = float(np.hypot(*np.diff(array, axis=0).T).sum())
    return Segment(kind, number, array, kind is SegmentKind.PASS, length, reverse=reverse)


def half_circle(side: int) -> FloatArray:
    """From (0, 100) heading north to (side * 2 R, 100) heading south."""
    angles = np.linspace(0, math.pi, 30)
    return np.column_stack([side * TURN_RADIUS * (1 - np.cos(angles)), 100 + TURN_RADIUS * np.sin(angles)])


def two_passes(side: int = 1) -> list[Segment]:
    across = side * 2 * TURN_RADIUS
    return [
        segment(SegmentKind.PASS, 1, [(0, 0), (0, 100)]),
        segment(SegmentKind.TURN, 2, half_circle(side)),
        segment(SegmentKind.PASS, 2, [(across, 100), (across, 0)]),
    ]


def driven(segments: list[Segment], settings: JobSettings, seed: int = 1) -> list[SimulatedEpoch]:
    return list(simulated_epochs(segments, MACHINE, FRAME, settings, np.random.default_rng(seed)))


def off_line(stretch: Stretch, epochs: list[SimulatedEpoch]) -> FloatArray:
    """Metres right of the route at each epoch."""
    along, off = 0.0, []
    for epoch in epochs:
        place = stretch.place_of(epoch.truth.east, epoch.truth.north, along)
        along = max(along, place.along)
        off.append(place.right)
    return np.array(off)


@pytest.mark.parametrize(("speed", "beyond"), [(1.0, 0.08), (1.5, 0.08), (2.7, 0.30)])
def test_from_one_metre_beside_the_driver_comes_to_the_line_and_stays(speed: float, beyond: float) -> None:
    calm = DriverSettings(wander=0.0, work_speed=speed)
    settings = JobSettings(driver=calm, receiver=NO_DRIFT, start_right=1.0, disturbance=0.0)
    epochs = driven([segment(SegmentKind.PASS, 1, [(0, 0), (0, 100)])], settings)
    off = np.array([epoch.truth.east for epoch in epochs])
    far = np.array([epoch.truth.north for epoch in epochs]) > 40
    assert off[0] == pytest.approx(1.0)
    assert abs(off[far]).max() < 3 * CENTIMETRE
    assert off.min() > -beyond


def test_a_mirrored_field_is_driven_in_mirror() -> None:
    settings = JobSettings(driver=CALM, receiver=NO_DRIFT, disturbance=0.0)
    right, left = driven(two_passes(1), settings), driven(two_passes(-1), settings)
    assert len(right) == len(left)
    for one, other in zip(right, left, strict=True):
        assert one.truth.east == pytest.approx(-other.truth.east, abs=CENTIMETRE / 10)
        assert one.truth.north == pytest.approx(other.truth.north, abs=CENTIMETRE / 10)


def test_a_turn_is_driven_along_its_path_and_the_next_pass_met() -> None:
    segments = two_passes()
    (stretch,) = stretches_of(segments)
    epochs = driven(segments, JobSettings(driver=CALM, receiver=NO_DRIFT, disturbance=0.0))
    off = off_line(stretch, epochs)
    assert abs(off).max() < 0.35
    back = [value for value, epoch in zip(off, epochs, strict=True) if epoch.number == 2 and epoch.truth.north < 80]
    assert abs(np.array(back)).max() < 5 * CENTIMETRE


def test_speed_follows_what_is_driven() -> None:
    epochs = driven(two_passes(), JobSettings(driver=CALM))
    speeds = {kind: [e.truth.speed for e in epochs if e.kind is kind] for kind in SegmentKind}
    assert max(speeds[SegmentKind.PASS]) == pytest.approx(CALM.work_speed)
    assert max(speeds[SegmentKind.TURN]) < CALM.turn_speed + 0.35  # braking is not done at the very end of the pass
    assert speeds[SegmentKind.PASS][0] == speeds[SegmentKind.PASS][-1] == 0.0


def test_the_implement_goes_down_and_up_where_it_stands_itself() -> None:
    epochs = driven(two_passes(), JobSettings(driver=CALM))
    raised = [e.truth.north for e in epochs if not e.implement_down and e.number == 1]
    lifted = next(e for e in epochs if e.kind is SegmentKind.TURN and not e.implement_down)
    back = MACHINE[1].offset_back
    assert max(raised) == pytest.approx(back, abs=0.6)
    assert lifted.truth.north == pytest.approx(100 + back, abs=0.6)


def test_a_fishtail_is_driven_forwards_backwards_forwards_with_a_stop_at_each_change() -> None:
    out = np.array([(0, 60 + y) for y in range(9)], dtype=float)
    back_angles = np.linspace(0, math.pi / 2, 20)
    back = np.column_stack([-8 * (1 - np.cos(back_angles)), 68 - 8 * np.sin(back_angles)])
    segments = [
        segment(SegmentKind.PASS, 1, [(0, 0), (0, 60)]),
        segment(SegmentKind.TURN, 2, out),
        segment(SegmentKind.TURN, 2, back, reverse=True),
        segment(SegmentKind.TURN, 2, [(-8, 60), (20, 60)]),
    ]
    assert [stretch.reverse for stretch in stretches_of(segments)] == [False, True, False]
    epochs = driven(segments, JobSettings(driver=CALM, receiver=NO_DRIFT, disturbance=0.0))
    signs = [int(np.sign(epoch.truth.speed)) for epoch in epochs]
    changes = [sign for sign, before in zip(signs, [None, *signs], strict=False) if sign != before]
    assert changes == [0, 1, 0, -1, 0, 1, 0]
    backwards = [epoch for epoch in epochs if epoch.truth.speed < 0]
    assert all(epoch.truth.reverse and not epoch.implement_down for epoch in backwards)
    last = backwards[-1].truth
    assert math.dist((last.east, last.north), (-8, 60)) < 0.4
    assert abs(wrap_pi(last.heading - math.pi / 2)) < math.radians(12)
    assert epochs[-1].truth.east == pytest.approx(20, abs=0.3)


def test_an_implement_that_hangs_to_the_right_runs_on_the_line_itself() -> None:
    machine = (MACHINE[0], Implement(name="I", working_width=3.0, offset_right=0.8))
    settings = JobSettings(driver=CALM, receiver=NO_DRIFT, disturbance=0.0)
    line = [segment(SegmentKind.PASS, 1, [(0, 0), (0, 60)])]
    epochs = list(simulated_epochs(line, machine, FRAME, settings, np.random.default_rng(1)))
    assert [e.truth.east for e in epochs] == pytest.approx([-0.8] * len(epochs), abs=CENTIMETRE)


def test_the_driver_follows_the_drifting_screen() -> None:
    settings = JobSettings(driver=CALM, receiver=ReceiverSettings(drift=0.5, drift_s=1e6), disturbance=0.0)
    epochs = driven([segment(SegmentKind.PASS, 1, [(0, 0), (0, 100)])], settings, seed=5)
    assert abs(epochs[-1].truth.east) > 10 * CENTIMETRE


def test_an_ordinary_driver_keeps_within_half_a_metre_and_is_no_machine() -> None:
    passes = [segment(SegmentKind.PASS, 1, [(0, 0), (0, 600)])]
    off = np.array([e.truth.east for e in driven(passes, JobSettings(receiver=NO_DRIFT))])
    assert 3 * CENTIMETRE < off.std() < 15 * CENTIMETRE
    assert abs(off).max() < 0.5


def test_the_fix_is_lost_once_in_the_middle_of_its_pass() -> None:
    settings = JobSettings(driver=CALM, loss=LossOfFix(2, 8.0))
    epochs = driven(two_passes(), settings)
    lost = [epoch for epoch in epochs if not epoch.has_fix]
    assert len(lost) == 8 * settings.receiver.rate
    assert np.diff([epoch.t for epoch in lost]) == pytest.approx(0.2)
    assert lost[0].truth.north == pytest.approx(50, abs=2)
    assert all(b",V," in epoch.data for epoch in lost)


def test_it_stands_at_the_beginning_and_at_the_end() -> None:
    epochs = driven(two_passes(), JobSettings(stand_s=7.0, end_s=4.0))
    standing = [epoch.t for epoch in epochs if epoch.truth.speed == 0]
    first = [t for t in standing if t < 60]
    last = [t for t in standing if t > 60]
    assert first[-1] - first[0] == pytest.approx(7.0, abs=0.3)
    assert last[-1] - last[0] == pytest.approx(4.0, abs=0.5)


def test_what_cannot_be_driven_is_refused() -> None:
    with pytest.raises(ValueError, match="no segment"):
        driven([], JobSettings())
    with pytest.raises(ValueError, match="does not go into"):
        driven(two_passes(), JobSettings(receiver=ReceiverSettings(rate=4)))


def test_a_closed_lap_comes_back_to_its_first_point() -> None:
    corners = np.array([(0, 0), (0, 60), (60, 60), (60, 0)], dtype=float)
    lap = Segment(SegmentKind.LAP, 1, corners, implement_down=True, length=240.0, closed=True)
    (stretch,) = stretches_of([lap])
    assert stretch.length == pytest.approx(240)
    assert stretch.place_of(30, -1, 210).right == pytest.approx(-1)
