"""The filter of Inoue et al.: which of the printed equations hold, and what the corrected ones are worth."""

import math
from dataclasses import replace

import numpy as np
import pytest
from support.drives_of_filters import Kit, drive, heading_error, measured, position_error, rms

from guidance_app.estimation.filter import FilterSettings, GyroSettings
from guidance_app.estimation.filters import make_filter
from guidance_app.estimation.filters.gyro_ekf import (
    Inputs,
    antenna_position,
    moved,
    observation_jacobian,
    transition_jacobian,
)
from guidance_app.model import FixQuality, FloatArray

DERIVATIVE = 1e-7
MILLIMETRE = 1e-3
PRINTED = FilterSettings(gyro_ekf=GyroSettings(as_printed=True))
U = Inputs(speed=2.4, acceleration=0.5, heading=0.8, dt=0.1)


def some_state(size: int) -> FloatArray:
    return np.array([3.0, -4.0, 0.2, 0.05, 0.1])[:size]


@pytest.mark.parametrize("printed", [False, True])
def test_the_transitions_derivative_is_the_numeric_one(printed: bool):
    x = some_state(5 if printed else 4)
    numeric = np.array(
        [
            (moved(x + d, U, as_printed=printed) - moved(x - d, U, as_printed=printed)) / 2e-6
            for d in 1e-6 * np.eye(x.size)
        ]
    ).T
    assert transition_jacobian(x, U, as_printed=printed) == pytest.approx(numeric, abs=DERIVATIVE)


def test_the_second_printed_observation_matrix_is_the_numeric_derivative():
    x = some_state(4)
    numeric = np.array(
        [
            (antenna_position(x + d, 0.8, 1.2, 0.4) - antenna_position(x - d, 0.8, 1.2, 0.4)) / 2e-6
            for d in 1e-6 * np.eye(4)
        ]
    ).T
    assert observation_jacobian(x, 0.8, 1.2, 0.4) == pytest.approx(numeric, abs=DERIVATIVE)


def test_the_acceleration_term_is_subtracted_because_the_speed_is_that_at_the_end():
    """From 2.35 to 2.40 m/s at 0.5 m/s2 the tractor covers 2.375 m/s times 0.1 s; as printed it is 5 mm more."""
    true_way = 0.5 * (2.35 + 2.40) * 0.1
    ways = [
        math.dist(moved(np.zeros(5 if printed else 4), U, as_printed=printed)[:2], (0, 0)) for printed in (False, True)
    ]
    assert ways[0] == pytest.approx(true_way, abs=1e-9)
    assert ways[1] - true_way == pytest.approx(0.005, abs=1e-9)


def test_the_acceleration_error_cannot_be_observed():
    """Forty seconds of meander leave the five printed states at rank four."""
    rows, product = [], np.eye(5)
    for k in range(400):
        u = Inputs(3 + math.sin(k * 0.02), 0.1, 0.5 * math.sin(k * 0.05), 0.1)
        rows.append(observation_jacobian(np.zeros(5), u.heading, 0.5, 0.1) @ product)
        product = transition_jacobian(np.zeros(5), u, as_printed=True) @ product
    values = np.linalg.svd(np.vstack(rows), compute_uv=False)
    assert (values > 1e-9 * values[0]).sum() == 4


FIELD_KIT = Kit(
    velocity=True,
    gyro=True,
    compass=True,
    white=0.1,
    cell=(0.002, 0.002),
    quality=FixQuality.DGPS,
    antenna=(0.5, -0.1, 2.6),
)


def scores(settings: FilterSettings | None, compass_error: float = 0.05) -> tuple[float, float]:
    """RMS position and heading error over a meander, with a heading sensor that is off by ``compass_error``."""
    truth = drive(lambda _: 3.6, lambda t: -0.02 * math.sin(math.tau * 3.6 * t / 40), 60, rate=10)
    estimator = make_filter("gyro_ekf", settings)
    pairs = []
    for z, moment in zip(measured(truth, FIELD_KIT), truth, strict=True):
        assert z.heading is not None
        pose = estimator.step(replace(z, heading=z.heading + compass_error, heading_sigma=0.05))
        assert pose is not None
        if moment.t > 15:
            pairs.append((pose, moment))
    return rms(position_error(*pair) for pair in pairs), rms(heading_error(*pair) for pair in pairs)


def test_the_heading_sensors_error_is_found_and_the_fixes_are_smoothed():
    position, heading = scores(None)
    assert heading < 0.5 * 0.05
    assert position < 0.5 * 0.1 * math.sqrt(2)


def test_corrected_it_is_better_than_as_printed():
    assert scores(None)[0] < scores(PRINTED)[0]


def test_as_printed_it_shows_raw_data_in_fast_turns():
    truth = drive(lambda _: 2.0, lambda t: 0.2 if t > 10 else 0.0, 20, rate=10)
    estimator = make_filter("gyro_ekf", PRINTED)
    kit = replace(FIELD_KIT, antenna=(0.0, 0.0, 2.6))
    for z, moment in zip(measured(truth, kit), truth, strict=True):
        pose = estimator.step(z)
        assert pose is not None
        if moment.t > 11:
            assert (pose.east, pose.north) == (z.east, z.north)


def test_after_a_gap_the_correction_of_the_heading_is_kept():
    truth = drive(lambda _: 2.0, lambda _: 0.0, 60, rate=10)
    z = [replace(each, heading=each.heading + 0.08) for each in measured(truth, FIELD_KIT) if each.heading is not None]
    estimator = make_filter("gyro_ekf")
    for each in z[:400]:
        estimator.step(each)
    pose = estimator.step(replace(z[500], t=z[500].t + 100))
    assert pose is not None
    assert heading_error(pose, truth[500]) < 0.03


def test_an_antenna_that_is_level_is_found_again_on_the_ground():
    x = np.array([10.0, 20.0, 0.0, 0.0])
    east, north = antenna_position(x, math.pi / 2, 1.0, 0.5)
    assert (east, north) == (pytest.approx(11.0, abs=MILLIMETRE), pytest.approx(20.5, abs=MILLIMETRE))
