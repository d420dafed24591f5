"""Inoue et al., equations 15 to 27: the two-wheel model and the steering that the simulated tractor is made of."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from guidance_app.angles import wrap_pi
from guidance_app.simulation.vehicle import (
    TractorModel,
    model_for,
    moved,
    rear_axle,
    slip_and_yaw_rate,
    standing_at,
)

MODEL = TractorModel()
MILLIMETRE = 1e-3
DEGREE = math.radians(1)


@given(st.floats(0.2, 8.0), st.floats(-0.5, 0.5))
def test_slip_and_yaw_rate_solve_equations_15_and_16_at_rest(speed: float, steering: float) -> None:
    """The oracle solves both equations with their derivatives zero; as printed, without v squared, 18 does not."""
    front, rear = MODEL.to_front, MODEL.to_rear
    stiff_front, stiff_rear = MODEL.front_stiffness, MODEL.rear_stiffness
    turn = 2 * (stiff_front * front - stiff_rear * rear)
    left = [
        [2 * (stiff_front + stiff_rear), MODEL.mass * speed + turn / speed],
        [turn, 2 * (stiff_front * front**2 + stiff_rear * rear**2) / speed],
    ]
    slip, yaw_rate = np.linalg.solve(left, [2 * stiff_front * steering, 2 * stiff_front * front * steering])
    assert slip_and_yaw_rate(MODEL, speed, steering) == pytest.approx((slip, yaw_rate), rel=1e-9, abs=1e-12)


def test_the_wheel_reaches_ten_degrees_after_the_idling_time_and_seven_tenths_of_a_second() -> None:
    """Equation 27: 14.3 (t - 0.2) degrees."""
    state, dt = standing_at(MODEL, 0, 0, 0), 0.01
    angles = []
    for _ in range(100):
        state = moved(MODEL, state, (math.radians(10), 0.0), dt)
        angles.append((state.t, math.degrees(state.steering)))
    for t, angle in angles:
        assert angle == pytest.approx(min(10.0, max(0.0, 14.3 * (t - 0.2))), abs=14.3 * 2 * dt)
    reached = next(t for t, angle in angles if angle > 9.99)
    assert reached == pytest.approx(0.9, abs=2 * dt)


def test_the_valve_idles_again_when_the_wheel_turns_round() -> None:
    state, dt = standing_at(MODEL, 0, 0, 0), 0.01
    for _ in range(60):
        state = moved(MODEL, state, (0.5, 0.0), dt)
    turned_at = state.steering
    idle_steps = 0
    while state.steering == turned_at:
        state = moved(MODEL, state, (-0.5, 0.0), dt)
        idle_steps += 1
    assert idle_steps * dt == pytest.approx(MODEL.idle, abs=2 * dt)
    assert state.steering < turned_at


@settings(max_examples=30)
@given(st.floats(-0.4, 0.4), st.floats(0.5, 3.0))
def test_a_mirrored_wheel_drives_the_mirrored_path(steering: float, speed: float) -> None:
    right = left = standing_at(MODEL, 0, 0, 0)
    for _ in range(50):
        right = moved(MODEL, right, (steering, speed), 0.05)
        left = moved(MODEL, left, (-steering, speed), 0.05)
    assert left.east == pytest.approx(-right.east, abs=MILLIMETRE)
    assert left.north == pytest.approx(right.north, abs=MILLIMETRE)
    assert wrap_pi(left.heading + right.heading) == pytest.approx(0, abs=1e-9)


def test_a_held_wheel_drives_the_circle_that_the_yaw_rate_says() -> None:
    steering, speed = 20 * DEGREE, 1.5
    state = replace(standing_at(MODEL, 0, 0, 0), speed=speed, steering=steering)
    _, yaw_rate = slip_and_yaw_rate(MODEL, speed, steering)
    radius = speed / yaw_rate
    track = []
    for _ in range(round(math.tau / yaw_rate / 0.01)):
        state = moved(MODEL, state, (steering, speed), 0.01)
        track.append((state.east, state.north))
    middle = np.mean(track, axis=0)
    assert np.hypot(*(np.array(track) - middle).T) == pytest.approx(radius, rel=2e-3)
    assert radius == pytest.approx(MODEL.wheelbase / steering, rel=0.01)


def test_backwards_the_same_wheel_turns_the_body_the_other_way() -> None:
    forward = moved(MODEL, replace(standing_at(MODEL, 0, 0, 0), speed=1, steering=0.3), (0.3, 1), 0.01)
    backward = moved(MODEL, replace(standing_at(MODEL, 0, 0, 0), speed=-1, steering=0.3), (0.3, -1), 0.01)
    assert forward.yaw_rate > 0 > backward.yaw_rate
    assert backward.north < standing_at(MODEL, 0, 0, 0).north < forward.north


def test_the_reference_point_is_the_rear_axle() -> None:
    model = model_for(2.45)
    assert model.wheelbase == pytest.approx(2.45)
    state = standing_at(model, 10.0, 20.0, 2.0)
    assert rear_axle(model, state) == pytest.approx((10.0, 20.0))
    assert math.hypot(state.east - 10, state.north - 20) == pytest.approx(model.to_rear)


def test_speed_changes_no_faster_than_the_tractor_can() -> None:
    state = standing_at(MODEL, 0, 0, 0)
    speeds = []
    for _ in range(100):
        state = moved(MODEL, state, (0.0, 3.0), 0.1)
        speeds.append(state.speed)
    assert np.diff(speeds).max() <= MODEL.acceleration * 0.1 + 1e-12
    assert speeds[-1] == 3.0
