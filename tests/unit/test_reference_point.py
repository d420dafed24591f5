"""From the antenna to the ground, and to the implement."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.angles import wrap_pi
from guidance_app.documents import HitchKind, Implement, Tractor
from guidance_app.estimation.reference_point import (
    ImplementPoint,
    level_lever_arm,
    measurement_from_fix,
    offset_point,
)
from guidance_app.geodesy import FieldFrame
from guidance_app.model import Attitude, Fix, FixQuality, FloatArray, Pose

MILLIMETRE = 1e-3
NANOMETRE = 1e-9
FRAME = FieldFrame(41.32, -4.84)
TRACTOR = Tractor(
    name="tractor", antenna_forward=0.8, antenna_right=-0.2, antenna_height=2.7, roll_zero_deg=1.5, pitch_zero_deg=-0.5
)


def rotation(heading: float, pitch: float, roll: float) -> FloatArray:
    """East, north, up from forward, right, up: heading after pitch after roll, written out as matrices."""
    to_enu = np.array(
        [[math.sin(heading), math.cos(heading), 0], [math.cos(heading), -math.sin(heading), 0], [0, 0, 1]]
    )
    nose_up = np.array([[math.cos(pitch), 0, -math.sin(pitch)], [0, 1, 0], [math.sin(pitch), 0, math.cos(pitch)]])
    right_down = np.array([[1, 0, 0], [0, math.cos(roll), math.sin(roll)], [0, -math.sin(roll), math.cos(roll)]])
    return np.asarray(to_enu @ nose_up @ right_down)


@given(
    arm=st.tuples(st.floats(-5, 5), st.floats(-2, 2), st.floats(0, 6)),
    angles=st.tuples(st.floats(-3.2, 6.4), st.floats(-0.4, 0.4), st.floats(-0.4, 0.4)),
)
def test_the_lever_arm_is_the_rotation_matrices(arm: tuple[float, float, float], angles: tuple[float, float, float]):
    heading, pitch, roll = angles
    forward, right, up = level_lever_arm(arm, roll, pitch)
    expected = rotation(heading, pitch, roll) @ np.array(arm)
    assert offset_point(0.0, 0.0, heading, forward, right) == pytest.approx(tuple(expected[:2]), abs=NANOMETRE)
    assert up == pytest.approx(expected[2], abs=NANOMETRE)


def test_rolling_to_the_right_moves_the_antenna_right_and_nose_up_moves_it_back():
    assert level_lever_arm((0, 0, 2), math.radians(10), 0)[1] > 0.3
    assert level_lever_arm((0, 0, 2), 0, math.radians(10))[0] < -0.3


def some_fix(**more: object) -> Fix:
    return Fix(10.0, 100.0, 41.3205, -4.8395, FixQuality.DGPS, **more)  # type: ignore[arg-type] # fields by name


def test_the_measurement_carries_what_the_epoch_holds_and_nothing_else():
    bare = measurement_from_fix(some_fix(), None, FRAME, TRACTOR)
    assert (bare.speed, bare.course, bare.heading, bare.yaw_rate, bare.roll, bare.pitch) == (None,) * 6
    assert bare.antenna == pytest.approx((0.8, -0.2, 2.7))
    full = measurement_from_fix(
        some_fix(cell=(0.18, 0.14), sigma=(0.2, 0.1), speed=2.0, course=1.0, heading=1.1), None, FRAME, TRACTOR
    )
    assert full.cell == (0.14, 0.18)
    assert full.sigma == (0.1, 0.2)
    assert (full.speed, full.course, full.heading, full.heading_sigma) == (2.0, 1.0, 1.1, None)
    assert (full.t, full.arrival, full.quality) == (10.0, 100.0, FixQuality.DGPS)


def test_roll_and_pitch_are_taken_less_their_zeros():
    attitude = Attitude(100.1, roll=math.radians(6.5), pitch=math.radians(1.5), yaw_rate=0.2)
    z = measurement_from_fix(some_fix(roll=0.3), attitude, FRAME, TRACTOR)
    assert z.roll == pytest.approx(math.radians(5))
    assert z.pitch == pytest.approx(math.radians(2))
    assert z.antenna == pytest.approx(level_lever_arm((0.8, -0.2, 2.7), math.radians(5), math.radians(2)))
    assert z.yaw_rate == 0.2


def test_a_heading_from_the_attitude_sensor_is_known_to_drift_and_the_receivers_own_wins():
    attitude = Attitude(100.1, heading=2.0)
    assert measurement_from_fix(some_fix(), attitude, FRAME, TRACTOR).heading_sigma == pytest.approx(math.radians(3))
    both = measurement_from_fix(some_fix(heading=1.0), attitude, FRAME, TRACTOR)
    assert (both.heading, both.heading_sigma) == (1.0, None)


def test_an_old_attitude_is_left_out():
    attitude = Attitude(98.5, heading=2.0, roll=0.1, yaw_rate=0.3)
    z = measurement_from_fix(some_fix(), attitude, FRAME, TRACTOR)
    assert (z.heading, z.roll, z.yaw_rate) == (None, None, None)


def test_a_fix_far_from_the_field_is_refused():
    with pytest.raises(ValueError, match="100 km"):
        measurement_from_fix(Fix(0, 0, 50.0, 8.0, FixQuality.DGPS), None, FRAME, TRACTOR)


# --- the implement -------------------------------------------------------------------------------------------------


def pose(t: float, east: float, north: float, heading: float, speed: float) -> Pose:
    return Pose(t, t, east, north, heading, speed)


@given(heading=st.floats(0, 6.28), back=st.floats(-5, 8), right=st.floats(-3, 3))
def test_a_mounted_implement_is_fixed_to_the_body(heading: float, back: float, right: float):
    point = ImplementPoint(Implement(name="drill", offset_back=back, offset_right=right)).step(
        pose(0, 5, 6, heading, 1)
    )
    away = np.array(point[:2]) - (5, 6)
    expected = rotation(heading, 0, 0) @ np.array([-back, right, 0])
    assert away == pytest.approx(expected[:2], abs=NANOMETRE)
    assert point[2] == heading


TRAILED = Implement(name="trailer", hitch=HitchKind.TRAILED, hitch_back=0.8, drawbar=4.0, offset_back=5.3)


def follow(
    implement: Implement, speed: float, curvature: float, seconds: float, rate: float = 20
) -> list[tuple[Pose, tuple[float, float, float]]]:
    east = north = heading = 0.0
    follower = ImplementPoint(implement)
    pairs = []
    for k in range(round(seconds * rate)):
        here = pose(k / rate, east, north, heading, speed)
        pairs.append((here, follower.step(here)))
        turn = speed * curvature / rate
        east += speed / rate * math.sin(heading + turn / 2)
        north += speed / rate * math.cos(heading + turn / 2)
        heading += turn
    return pairs


def test_a_trailed_implement_follows_straight_behind():
    here, point = follow(TRAILED, 2.0, 0.0, 20)[-1]
    assert point[0] == pytest.approx(here.east, abs=MILLIMETRE)
    assert point[1] == pytest.approx(here.north - 5.3, abs=MILLIMETRE)


def test_on_a_circle_it_runs_inside_at_the_angle_of_geometry():
    """Hitch on a circle of sqrt(R2 + a2); the implement's axle on one of sqrt(R2 + a2 - drawbar2)."""
    radius = 9.0
    axle = TRAILED.model_copy(update={"offset_back": 4.8})  # the working point is the implement's own axle
    here, point = follow(axle, 1.5, 1 / radius, 80)[-1]
    centre = (here.east + radius * math.cos(here.heading), here.north - radius * math.sin(here.heading))
    expected = math.sqrt(radius**2 + 0.8**2 - 4.0**2)
    assert math.dist(point[:2], centre) == pytest.approx(expected, abs=0.01)
    assert wrap_pi(here.heading - point[2]) > 0.3


def test_the_result_does_not_depend_on_the_fix_rate():
    slow = follow(TRAILED, 1.5, 0.1, 12, rate=5)[-1][1]
    fast = follow(TRAILED, 1.5, 0.1, 12, rate=50)[-10][1]
    assert slow[:2] == pytest.approx(fast[:2], abs=0.02)


def test_a_receivers_step_sideways_does_not_swing_it():
    pairs = follow(TRAILED, 1.5, 0.0, 10)
    follower = ImplementPoint(TRAILED)
    for here, _ in pairs:
        follower.step(here)
    last = pairs[-1][0]
    stepped = follower.step(pose(last.t + 0.05, last.east + 0.5, last.north + 0.075, last.heading, 1.5))
    assert stepped[2] == pytest.approx(last.heading, abs=MILLIMETRE)


def test_backing_up_it_folds_no_farther_than_it_can():
    follower = ImplementPoint(TRAILED)
    follower.step(pose(0, 0, 0, 0, 1))
    follower.step(pose(0.2, 0, 0.2, 0.1, 1))
    for k in range(600):
        point = follower.step(pose(0.4 + k / 5, 0, -k / 5, 0.1, -1.0))
    assert abs(wrap_pi(point[2] - 0.1)) == pytest.approx(math.radians(75), abs=MILLIMETRE)


def test_a_fork_and_its_origin_do_not_touch_each_other():
    follower = ImplementPoint(TRAILED)
    for here, _ in follow(TRAILED, 1.5, 0.1, 5):
        follower.step(here)
    fork = follower.fork()
    fork.step(pose(5.2, 3, 8, 2.0, 1.5))
    again = follower.fork().step(pose(5.2, 0, 0, 0.8, 1.5))
    assert again == follower.step(pose(5.2, 0, 0, 0.8, 1.5))


def test_without_a_heading_it_hangs_straight():
    follower = ImplementPoint(TRAILED)
    unknown = Pose(0, 0, 1, 2, 0.0, 0.0, heading_known=False)
    assert follower.step(unknown) == pytest.approx((1, 2 - 5.3, 0.0))
