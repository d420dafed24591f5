"""Where the tractor will be: both ways of looking ahead, on drives whose future is known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.drives_of_filters import Kit, Moment, drive, measured, mirrored, straight

from guidance_app.angles import wrap_pi
from guidance_app.estimation.filter import FilterSettings
from guidance_app.estimation.filters import make_filter
from guidance_app.estimation.prediction import Predictor, Way, pose_after
from guidance_app.model import Pose

MILLIMETRE = 1e-3
CENTIMETRE = 0.01
DEGREE = math.radians(1)

speeds = st.floats(-3, 6)
curvatures = st.floats(-0.2, 0.2)
headings = st.floats(0, 6.28)
BOTH = pytest.mark.parametrize("way", Way)


def exact(moments: list[Moment]) -> list[Pose]:
    """Poses without any error."""
    return [Pose(m.t, m.t, m.east, m.north, m.heading, m.speed, m.curvature) for m in moments]


# --- to the redraw's instant ---------------------------------------------------------------------------------------


@given(heading=headings, speed=speeds)
def test_straight_on_it_moves_by_speed_times_time(heading: float, speed: float):
    later = pose_after(Pose(3, 4, 1, 2, heading, speed), 0.7)
    assert later.east == pytest.approx(1 + 0.7 * speed * math.sin(heading), abs=MILLIMETRE)
    assert later.north == pytest.approx(2 + 0.7 * speed * math.cos(heading), abs=MILLIMETRE)
    assert (later.t, later.arrival) == (3.7, 4.7)


@given(heading=headings, speed=speeds, curvature=curvatures, seconds=st.floats(-2, 0))
def test_going_back_follows_the_circle(heading: float, speed: float, curvature: float, seconds: float):
    earlier = pose_after(Pose(0, 0, 0, 0, heading, speed, curvature), seconds)
    turn = speed * curvature * seconds
    chord = speed * seconds * (math.sin(turn / 2) / (turn / 2) if abs(turn) > 1e-9 else 1.0)
    assert earlier.east == pytest.approx(chord * math.sin(heading + turn / 2), abs=5 * MILLIMETRE)
    assert earlier.north == pytest.approx(chord * math.cos(heading + turn / 2), abs=5 * MILLIMETRE)
    assert wrap_pi(earlier.heading - heading - turn) == pytest.approx(0, abs=1e-9)


def test_the_curvature_fades_and_the_heading_stays_between_straight_and_the_circle():
    pose = Pose(0, 0, 0, 0, 1.0, 2.0, 0.1)
    for seconds in (0.5, 1.5, 3.0):
        later = pose_after(pose, seconds)
        assert 0 < later.curvature < pose.curvature
        assert 0 < wrap_pi(later.heading - 1.0) < 2.0 * 0.1 * seconds


@pytest.mark.parametrize("still", [{"standing": True}, {"heading_known": False}])
def test_standing_or_without_a_heading_it_stays(still: dict[str, bool]):
    pose = replace(Pose(0, 0, 1, 2, 0.5, 2.0), **still)  # type: ignore[arg-type] # fields by name
    later = pose_after(pose, 1.0)
    assert (later.east, later.north, later.t) == (1, 2, 1)


def test_a_1_hz_receiver_drives_a_smooth_bar():
    """Between two fixes of a turning tractor the pose at the redraw's instant is within 5 cm of the truth."""
    truth = drive(lambda _: 2.0, lambda t: 0.05 if t > 10 else 0.0, 30, rate=25)
    worst = 0.0
    for k, moment in enumerate(truth):
        last = exact([truth[k - k % 25]])[0]
        at = pose_after(last, moment.t - last.t)
        if not 10 < moment.t < 11.01:
            worst = max(worst, math.hypot(at.east - moment.east, at.north - moment.north))
    assert worst < 5 * CENTIMETRE


# --- after the look-ahead ------------------------------------------------------------------------------------------


@BOTH
@pytest.mark.parametrize("seconds", [0.6, 1.4, 3.0])
def test_on_a_straight_line_both_ways_are_exact(way: Way, seconds: float):
    predictor = Predictor(way=way)
    truth = straight(duration=20, rate=5)
    for k, pose in enumerate(exact(truth)):
        prediction = predictor.step(pose, seconds)
        assert prediction is not None
        assert prediction.look_ahead_s == seconds
        at = k + round(seconds * 5)
        if at < len(truth):
            there = truth[at]
            assert prediction.pose.east == pytest.approx(there.east, abs=CENTIMETRE)
            assert prediction.pose.north == pytest.approx(there.north, abs=CENTIMETRE)
            assert wrap_pi(prediction.pose.heading - there.heading) == pytest.approx(0, abs=1e-3)


def lateral(prediction: Pose, there: Moment) -> float:
    return (prediction.east - there.east) * math.cos(there.heading) - (prediction.north - there.north) * math.sin(
        there.heading
    )


@BOTH
@pytest.mark.parametrize("name", ["adaptive", "gyro_ekf"])
def test_in_a_meander_looking_ahead_beats_going_straight_on(way: Way, name: str):
    """The bend of the track is worth something: 1.5 s ahead at 13 km/h in Inoue et al.'s meander."""
    truth = drive(lambda _: 3.6, lambda t: -0.02 * math.sin(math.tau * 3.6 * t / 40), 40, rate=10)
    estimator, predictor = make_filter(name), Predictor(way=way)
    ahead, straight_on = [], []
    for k, z in enumerate(measured(truth, Kit(velocity=True, gyro=True, compass=True, cell=(0.01, 0.01), white=0.01))):
        pose = estimator.step(z)
        assert pose is not None
        prediction = predictor.step(pose, 1.5)
        if k > 100 and prediction is not None and k + 15 < len(truth):
            ahead.append(lateral(prediction.pose, truth[k + 15]))
            straight_on.append(lateral(pose_after(replace(pose, curvature=0.0), 1.5), truth[k + 15]))
    assert len(ahead) > 200
    assert np.std(ahead) < (0.6 if way is Way.FILTER else 0.85) * np.std(straight_on)


@BOTH
def test_backing_up_the_prediction_lies_behind_and_points_ahead(way: Way):
    predictor = Predictor(way=way)
    for moment in drive(lambda _: -1.0, lambda _: 0.0, 5, heading=0.0):
        prediction = predictor.step(exact([moment])[0], 1.5)
    assert prediction is not None
    assert prediction.pose.north == pytest.approx(moment.north - 1.5, abs=2 * CENTIMETRE)
    assert wrap_pi(prediction.pose.heading) == pytest.approx(0, abs=DEGREE)


@BOTH
def test_the_arc_begins_here_ends_there_and_is_not_writable(way: Way):
    predictor = Predictor(way=way)
    for pose in exact(drive(lambda _: 2.0, lambda _: 0.1, 6)):
        prediction = predictor.step(pose, 1.5)
    assert prediction is not None
    assert tuple(prediction.arc[0]) == pytest.approx((pose.east, pose.north))
    assert tuple(prediction.arc[-1]) == pytest.approx((prediction.pose.east, prediction.pose.north))
    assert not prediction.arc.flags.writeable
    steps = np.hypot(*np.diff(prediction.arc, axis=0).T)
    assert steps.max() < 0.35


@BOTH
def test_a_mirrored_world_gives_the_mirrored_prediction(way: Way):
    truth = drive(lambda _: 2.0, lambda _: 0.08, 20)
    z = measured(truth, Kit(velocity=True, gyro=True))
    results = []
    for measurements in (z, [mirrored(each) for each in z]):
        estimator, predictor = make_filter("adaptive"), Predictor(way=way)
        for each in measurements:
            pose = estimator.step(each)
            assert pose is not None
            prediction = predictor.step(pose, 2.0)
        assert prediction is not None
        results.append(prediction.pose)
    assert results[1].east == pytest.approx(-results[0].east, abs=MILLIMETRE)
    assert results[1].north == pytest.approx(results[0].north, abs=MILLIMETRE)
    assert wrap_pi(results[1].heading + results[0].heading) == pytest.approx(0, abs=1e-4)


@BOTH
def test_below_walking_pace_or_without_a_heading_there_is_none(way: Way):
    predictor = Predictor(way=way)
    assert predictor.step(Pose(0, 0, 0, 0, 0, 0.29)) is None
    assert predictor.step(Pose(1, 1, 0, 0, 0, 2.0, heading_known=False)) is None
    assert predictor.step(Pose(2, 2, 0, 0, 0, 2.0)) is not None


@pytest.mark.parametrize("seconds", [0.49, 3.01, -1.0])
def test_a_look_ahead_out_of_bounds_is_refused_with_value_and_bounds(seconds: float):
    with pytest.raises(ValueError, match=rf"{seconds:g} s is not between 0.5 and 3 s"):
        Predictor().step(Pose(0, 0, 0, 0, 0, 2.0), seconds)


def test_the_settings_look_ahead_is_used_where_none_is_given():
    prediction = Predictor(FilterSettings(look_ahead=2.5)).step(Pose(0, 0, 0, 0, 0, 2.0))
    assert prediction is not None
    assert prediction.pose.north == pytest.approx(5.0)


@BOTH
def test_a_gap_forgets_the_track_and_a_fork_is_independent(way: Way):
    poses = exact(drive(lambda _: 2.0, lambda _: 0.1, 6))
    predictor, fresh = Predictor(way=way), Predictor(way=way)
    for pose in poses:
        predictor.step(pose, 1.5)
    fork = predictor.fork()
    late = replace(poses[-1], t=poses[-1].t + 60)
    assert fork.step(late, 1.5) == fresh.step(late, 1.5)
    assert predictor.step(poses[-1], 1.5) == predictor.fork().step(poses[-1], 1.5)
