"""The true paths and what sensors make of them."""

import math

import numpy as np
import pytest

from guidance_app.evaluation.scenarios import SCENARIOS, UNSEEN, Purpose, drive, generator, straight_line, truth_of
from guidance_app.evaluation.signals import (
    DOPPLER_SIGMA,
    GYRO_NOISE,
    PAPER_CELL,
    Sensors,
    gauss_markov,
    outliers,
    record,
    rounded,
    steps,
)

MILLIMETRE = 1e-3
TENTH_OF_A_MILLIMETRE = 1e-4
ALL = [*SCENARIOS, *UNSEEN]


@pytest.mark.parametrize("name", ALL)
def test_a_path_moves_as_its_speed_and_heading_say(name: str) -> None:
    truth = truth_of(name, np.random.default_rng(1))
    interval = truth.t[1] - truth.t[0]
    step = np.diff(truth.positions, axis=0)
    middle = 0.5 * (truth.velocity[1:] + truth.velocity[:-1]) * interval
    assert np.max(np.hypot(*(step - middle).T)) < 20 * MILLIMETRE
    turned = (np.diff(truth.heading) + math.pi) % math.tau - math.pi
    swing = 0.5 * (truth.yaw_rate[1:] + truth.yaw_rate[:-1]) * interval
    assert np.max(np.abs(turned - swing)) < math.radians(1.5)


@pytest.mark.parametrize("name", ALL)
def test_the_same_number_gives_the_same_run(name: str) -> None:
    one = truth_of(name, generator(Purpose.REPORT, name, 7))
    other = truth_of(name, generator(Purpose.REPORT, name, 7))
    assert np.array_equal(one.positions, other.positions)


@pytest.mark.parametrize("name", ALL)
def test_what_tunes_is_never_what_judges(name: str) -> None:
    reported = [generator(Purpose.REPORT, name, seed).random(4).tolist() for seed in range(100)]
    tuned = [generator(Purpose.TUNING, name, seed).random(4).tolist() for seed in range(100)]
    assert not [draw for draw in tuned if draw in reported]


def test_a_circle_closes() -> None:
    radius, speed = 15.0, 2.0
    truth = drive(
        lambda t: np.full_like(t, speed),
        lambda s: np.full_like(s, 1 / radius),
        math.tau * radius / speed + 0.2,
        heading=0.4,
    )
    assert math.hypot(truth.east[-1] - truth.east[0], truth.north[-1] - truth.north[0]) < speed * 0.2


def test_a_positive_curvature_turns_clockwise() -> None:
    truth = drive(lambda t: np.full_like(t, 2.0), lambda s: np.full_like(s, 0.1), 5.0, heading=0.0)
    assert truth.east[-1] > 1.0
    assert truth.heading[-1] == pytest.approx(2.0 * 0.1 * truth.t[-1], abs=1e-6)


def test_the_u_turn_turns_round() -> None:
    truth = truth_of("uturn", np.random.default_rng(3))
    assert abs((truth.heading[-1] - truth.heading[0]) % math.tau - math.pi) < math.radians(0.1)


def test_the_omega_turn_turns_round_and_comes_back_beside_itself() -> None:
    truth = truth_of("omega turn", np.random.default_rng(3))
    assert abs((truth.heading[-1] - truth.heading[0]) % math.tau - math.pi) < math.radians(0.1)


def test_stop_and_go_really_stops() -> None:
    truth = truth_of("accel", np.random.default_rng(3))
    assert np.count_nonzero(truth.speed == 0) > 80
    assert np.max(truth.speed) == pytest.approx(8 / 3.6)


def test_the_sweep_runs_at_sixty_degrees_from_east() -> None:
    truth = truth_of("sweep60", np.random.default_rng(3))
    assert np.degrees(truth.heading) == pytest.approx(30.0)


def test_a_straight_line_is_one_at_every_sample() -> None:
    truth = straight_line(0.6, 1.4, 200, start=(5.0, -2.0))
    across = (truth.east - 5.0) * math.cos(0.6) - (truth.north + 2.0) * math.sin(0.6)
    assert np.max(np.abs(across)) < 1e-9


def test_rounding_is_to_the_nearest_grid_point() -> None:
    random = np.random.default_rng(4)
    position = random.uniform(-50, 50, (2000, 2))
    fixes = rounded(position, PAPER_CELL)
    assert np.all(np.abs(fixes - position) <= np.array(PAPER_CELL) / 2 + 1e-12)
    assert np.max(np.abs(np.round(fixes / PAPER_CELL) - fixes / PAPER_CELL)) < 1e-9


def test_rounding_error_has_the_variance_of_a_uniform_one() -> None:
    random = np.random.default_rng(4)
    position = random.uniform(-50, 50, (20000, 2))
    error = rounded(position, PAPER_CELL) - position
    assert np.std(error, axis=0) == pytest.approx(np.array(PAPER_CELL) / math.sqrt(12), rel=0.02)


def test_more_sensors_see_the_same_run() -> None:
    truth = truth_of("uturn", np.random.default_rng(1))
    bare = record(truth, np.random.default_rng(9))
    full = record(truth, np.random.default_rng(9), Sensors(velocity=True, gyro=True))
    assert np.array_equal(bare.position, full.position)
    assert bare.velocity is None
    assert bare.yaw_rate is None
    assert full.velocity is not None
    assert full.yaw_rate is not None


def test_sensor_noise_is_as_large_as_said() -> None:
    truth = straight_line(0.6, 1.4, 5000)
    seen = record(truth, np.random.default_rng(9), Sensors(velocity=True, gyro=True))
    assert seen.velocity is not None
    assert seen.yaw_rate is not None
    assert np.std(seen.velocity - truth.velocity) == pytest.approx(DOPPLER_SIGMA, rel=0.03)
    assert np.std(np.diff(seen.yaw_rate)) == pytest.approx(math.sqrt(2) * GYRO_NOISE, rel=0.05)


def test_drift_is_stationary_with_its_sigma() -> None:
    random = np.random.default_rng(9)
    last = np.array([gauss_markov(40, 1.0, 0.16, 20.0, random)[[0, -1]] for _ in range(3000)])
    assert np.std(last, axis=0) == pytest.approx(0.16, rel=0.05)


def test_steps_have_their_size_and_go_away() -> None:
    error = steps(20000, 0.1, 0.25, 40.0, np.random.default_rng(3))
    length = np.hypot(*error.T)
    assert np.all((length < 1e-9) | (np.abs(length - 0.25) < 1e-9))
    assert 0.05 < np.mean(length > 0) < 0.5


def test_outliers_are_as_many_and_as_far_as_said() -> None:
    error = np.hypot(*outliers(50000, 0.01, np.random.default_rng(3)).T)
    hit = error > 0
    assert np.mean(hit) == pytest.approx(0.01, rel=0.1)
    assert error[hit].min() >= 1.0
    assert error[hit].max() <= 5.0
