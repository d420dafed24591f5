"""What lies within a driver's reach, and the state that begins again from the last two fixes."""

import math

import numpy as np
import pytest

from guidance_app.estimation.kernels import CURVATURE, EAST, GYRO_BIAS, HEADING, NORTH, SPEED, STATES
from guidance_app.estimation.manoeuvre_kernels import UNFORESEEN, begin_again, distances
from guidance_app.estimation.observation_kernels import CELL_EAST, CELL_NORTH, READINGS, WHITE, Z_EAST, Z_NORTH
from guidance_app.model import FloatArray

GATE = 15.0
LIVE = 6
DEGREE = math.radians(1)


def reading(east: float, north: float, cell: float = 0.14) -> FloatArray:
    z = np.zeros(READINGS)
    z[[Z_EAST, Z_NORTH, CELL_EAST, CELL_NORTH, WHITE]] = east, north, cell, cell, 0.008
    return z


def driving(speed: float, heading: float = 0.0, sd: float = 0.05) -> tuple[FloatArray, FloatArray]:
    x = np.zeros(STATES)
    x[[HEADING, SPEED]] = heading, speed
    return x, np.diag([sd**2, sd**2, (2 * DEGREE) ** 2, 0.1**2, 0.01**2, 1e-4, 1e-4, 0.1, 0.1])


def reach(speed: float, ahead: float, aside: float, dt: float) -> tuple[float, float]:
    """The distances of a fix so far ahead and aside of the predicted place."""
    x, p = driving(speed)
    return distances(x, p, LIVE, dt, reading(aside, ahead), np.zeros(2))


@pytest.mark.parametrize(("speed", "ahead"), [(6.0, -2.5), (0.1, 1.9), (3.0, -3.5), (3.0, 3.0)])
def test_at_1_hz_a_stop_and_a_start_are_within_reach(speed: float, ahead: float):
    foreseen, reached = reach(speed, ahead, 0.0, 1.0)
    assert foreseen > UNFORESEEN
    assert reached < GATE


@pytest.mark.parametrize(
    ("speed", "ahead", "aside", "dt"),
    [(1.5, 1.0, 0.0, 0.2), (1.5, 0.0, 2.0, 1.0), (0.1, 0.0, 1.5, 1.0), (1.5, -9.0, 0.0, 1.0), (6.0, 8.0, 0.0, 1.0)],
)
def test_what_no_driver_does_is_out_of_reach(speed: float, ahead: float, aside: float, dt: float):
    assert reach(speed, ahead, aside, dt)[1] > GATE


@pytest.mark.parametrize("speed", [-2.0, 0.3, 4.0])
def test_left_and_right_are_alike_and_backwards_is_forward_turned_round(speed: float):
    left, right = reach(speed, 0.5, -1.5, 1.0), reach(speed, 0.5, 1.5, 1.0)
    assert left == pytest.approx(right)
    assert reach(speed, 2.2, 0.3, 1.0) == pytest.approx(reach(-speed, -2.2, 0.3, 1.0))


def test_an_expected_fix_has_one_distance():
    foreseen, reached = reach(1.5, 0.05, 0.03, 1.0)
    assert foreseen == reached < UNFORESEEN


def begun(east: float, north: float, dt: float, before: float) -> tuple[FloatArray, FloatArray, float]:
    """A new start at a fix that is so far from a last pose at the origin, heading north."""
    x, p = driving(before)
    x[NORTH] = before * dt
    innovation = np.array([east, north - x[NORTH]])
    likelihood = begin_again(x, p, LIVE, reading(east, north), innovation, np.array([0.0, 0.0, 0.0, before, dt]))
    return x, p, likelihood


def test_a_new_start_stands_at_the_fix_and_looks_along_the_way():
    x, p, likelihood = begun(1.0, 2.0, 1.0, 5.0)
    assert x[[EAST, NORTH]] == pytest.approx([1.0, 2.0])
    assert x[HEADING] == pytest.approx(math.atan2(1, 2), abs=3 * DEGREE)
    assert x[SPEED] == pytest.approx(math.hypot(1, 2))
    assert x[CURVATURE] > 0
    assert np.linalg.eigvalsh(p[:LIVE, :LIVE]).min() > 0
    assert p[GYRO_BIAS, GYRO_BIAS] == 1e-4
    assert math.isfinite(likelihood)


def test_a_way_back_is_driven_backwards_without_turning():
    x, _, _ = begun(0.05, -2.0, 1.0, 0.5)
    assert x[SPEED] == pytest.approx(-2.0, abs=0.01)
    assert abs(x[HEADING]) < 3 * DEGREE


def test_a_way_within_a_cell_leaves_the_heading():
    x, p, _ = begun(0.03, 0.0, 1.0, 1.5)
    assert abs(x[HEADING]) < 3 * DEGREE
    assert p[HEADING, HEADING] < (6 * DEGREE) ** 2


def test_the_receivers_drift_stays_and_the_position_is_as_doubtful():
    x, p = driving(2.0)
    p[7:, 7:] = [[0.03, 0.006], [0.006, 0.02]]
    begin_again(x, p, STATES, reading(0.0, 1.0), np.array([0.0, 1.0]), np.array([0.0, -2.0, 0.0, 2.0, 1.0]))
    assert p[7:, 7:] == pytest.approx(np.array([[0.03, 0.006], [0.006, 0.02]]))
    assert np.linalg.eigvalsh(p).min() >= 0
    sum_of_both = p[:2, :2] + p[7:, 7:] + p[:2, 7:] + p[7:, :2]
    assert sum_of_both == pytest.approx(np.eye(2) * (0.14**2 / 12 + 0.008**2))
