"""The compiled arithmetic of the estimation, against textbooks, scipy and numeric derivatives."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy import stats

from guidance_app.estimation.imm_kernels import (
    BEHIND,
    MODELS,
    WITH_POSITION,
    WITHOUT_POSITION,
    combined,
    imm_step,
    summary,
)
from guidance_app.estimation.kernels import (
    CURVATURE,
    DRIFT_EAST,
    EAST,
    HEADING,
    NORTH,
    SPEED,
    STATES,
    TRANSITION,
    add_process_noise,
    gaussian_update,
    interval_update,
    predict,
    robust_update,
    spread,
    transition,
    truncated_moments,
)
from guidance_app.estimation.observation_kernels import (
    ARM_FORWARD,
    ARM_RIGHT,
    CELL_EAST,
    COMPASS,
    GATE,
    GYRO,
    GYRO_SD,
    HEADING_SD,
    MEASUREMENTS,
    NO_COURSE,
    READINGS,
    SPEED_SD,
    STANDING_SD,
    VELOCITY_ACROSS,
    VELOCITY_ALONG,
    WHITE,
    antenna_velocity,
    observe,
)
from guidance_app.estimation.smoothing_kernels import SITE, backward, forward
from guidance_app.model import FloatArray

TINY = 1e-9
DERIVATIVE = 1e-6
"""How well a central difference of a smooth function of order one is known."""

COMMON = np.array([2e-5, 0.02, 30.0, 0.2, 80.0, 0.002])
MODEL = np.array([0.2, 0.05, 2.0])


def numeric_jacobian(f: Callable[[FloatArray], FloatArray], x: FloatArray, step: float = 1e-6) -> FloatArray:
    columns = []
    for i in range(x.size):
        up, down = x.copy(), x.copy()
        up[i] += step
        down[i] -= step
        columns.append((f(up) - f(down)) / (2 * step))
    return np.array(columns).T


def some_state(random: np.random.Generator) -> FloatArray:
    x = random.normal(0, 1, STATES)
    x[SPEED], x[CURVATURE], x[HEADING] = random.uniform(-2, 4), random.uniform(-0.2, 0.2), random.uniform(-6, 6)
    return x


def some_covariance(random: np.random.Generator, n: int = STATES) -> FloatArray:
    root = random.normal(0, 0.3, (n, n))
    return np.asarray(root @ root.T + 0.01 * np.eye(n))


def some_reading(random: np.random.Generator) -> FloatArray:
    z = random.normal(0, 1, READINGS)
    z[CELL_EAST : WHITE + 1] = 0.14, 0.18, 0.01
    z[[SPEED_SD, GYRO_SD, HEADING_SD, STANDING_SD]] = 0.05, 0.003, 0.01, 0.01
    z[ARM_FORWARD], z[ARM_RIGHT], z[GATE] = random.uniform(-2, 2), random.uniform(-1, 1), 15.0
    return z


def full_transition(f: FloatArray) -> FloatArray:
    """The sparse F as a matrix."""
    F = np.eye(STATES)
    F[EAST, HEADING], F[EAST, SPEED], F[EAST, CURVATURE] = f[0], f[1], f[2]
    F[NORTH, HEADING], F[NORTH, SPEED], F[NORTH, CURVATURE] = f[3], f[4], f[5]
    F[HEADING, SPEED], F[HEADING, CURVATURE], F[CURVATURE, CURVATURE] = f[6], f[7], f[8]
    F[6, 6], F[7, 7], F[8, 8] = f[9], f[10], f[10]
    return F


# --- derivatives ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_the_transitions_derivative_is_the_numeric_one(seed: int):
    x = some_state(np.random.default_rng(seed))
    f = np.empty(TRANSITION)

    def move(state: FloatArray) -> FloatArray:
        moved = state.copy()
        transition(moved, 0.4, MODEL[2], COMMON, np.empty(TRANSITION))
        return moved

    transition(x.copy(), 0.4, MODEL[2], COMMON, f)
    assert full_transition(f) == pytest.approx(numeric_jacobian(move, x), abs=DERIVATIVE)


@pytest.mark.parametrize("which", range(MEASUREMENTS))
@pytest.mark.parametrize("seed", range(3))
def test_every_measurements_derivative_is_the_numeric_one(which: int, seed: int):
    random = np.random.default_rng(seed)
    x, z, h = some_state(random), some_reading(random), np.empty(STATES)

    def expected(state: FloatArray) -> FloatArray:
        return np.array([-observe(state, z, which, np.empty(STATES))[0]])

    assert observe(x, z, which, h)[1] > 0
    numeric = numeric_jacobian(expected, x)[0]
    if which in (VELOCITY_ALONG, VELOCITY_ACROSS):  # along and across the body as it was, not as it would be
        numeric[HEADING] = rotated_velocity_slope(x, z, which)
    if which == GYRO:
        assert numeric[SPEED] == pytest.approx(x[CURVATURE])
        numeric[SPEED] = 0.0  # left out on purpose
    assert h == pytest.approx(numeric, abs=DERIVATIVE)


def rotated_velocity_slope(x: FloatArray, z: FloatArray, which: int) -> float:
    direction = x[HEADING] + (0.5 * math.pi if which == VELOCITY_ACROSS else 0.0)

    def expected(heading: float) -> float:
        turned = x.copy()
        turned[HEADING] = heading
        return antenna_velocity(turned, z, direction, np.empty(STATES))

    return (expected(x[HEADING] + 1e-6) - expected(x[HEADING] - 1e-6)) / 2e-6


def test_the_sparse_covariance_step_is_f_p_f_transposed():
    random = np.random.default_rng(3)
    x, p, f = some_state(random), some_covariance(random), np.empty(TRANSITION)
    transition(x, 0.2, MODEL[2], COMMON, f)
    F = full_transition(f)
    expected = F @ p @ F.T
    spread(p, f, STATES)
    assert p == pytest.approx(expected, abs=TINY)


@pytest.mark.parametrize("n", [6, 7, 9])
def test_a_smaller_state_is_the_corner_of_the_larger(n: int):
    random = np.random.default_rng(4)
    x = some_state(random)
    x[n:] = 0
    small = some_covariance(random, n)
    large = np.zeros((STATES, STATES))
    large[:n, :n] = small
    y = x.copy()
    predict(x, small, n, 0.7, MODEL, COMMON)
    predict(y, large, n, 0.7, MODEL, COMMON)
    assert large[:n, :n] == pytest.approx(small, abs=TINY)
    assert y == pytest.approx(x, abs=TINY)


def test_process_noise_is_positive_and_long_steps_are_cut():
    x = np.zeros(STATES)
    x[SPEED] = 3.0
    noise = np.zeros((STATES, STATES))
    add_process_noise(x, noise, 0.2, MODEL, COMMON)
    assert np.linalg.eigvalsh(noise).min() > -TINY
    once, twice = (np.eye(STATES) * 1e-4 for _ in range(2))
    y, z = x.copy(), x.copy()
    predict(y, once, STATES, 1.0, MODEL, COMMON)
    for _ in range(2):
        predict(z, twice, STATES, 0.5, MODEL, COMMON)
    assert once == pytest.approx(twice, abs=TINY)


# --- updates -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("low", "high"), [(-1, 1), (0.5, 0.6), (-3, -1), (2.0, 9.0), (-9, 9)])
def test_truncated_moments_are_scipys(low: float, high: float):
    mean, sd = 0.3, 1.7
    peer = stats.truncnorm((low - mean) / sd, (high - mean) / sd, loc=mean, scale=sd)
    ours = truncated_moments(mean, sd, low, high)
    assert ours[0] == pytest.approx(peer.mean(), abs=1e-9)
    assert ours[1] == pytest.approx(peer.var(), abs=1e-9)
    assert math.exp(ours[2]) == pytest.approx(stats.norm.cdf(high, mean, sd) - stats.norm.cdf(low, mean, sd), rel=1e-9)


def test_the_gaussian_update_is_the_textbooks():
    random = np.random.default_rng(5)
    x, p, h = random.normal(0, 1, 6), some_covariance(random, 6), random.normal(0, 1, 6)
    S = h @ p @ h + 0.04
    K = p @ h / S
    expected = x + K * 0.3, p - np.outer(K, K) * S
    likelihood = gaussian_update(x, p, h, 0.3, 0.04)
    assert x == pytest.approx(expected[0], abs=TINY)
    assert p == pytest.approx(expected[1], abs=TINY)
    assert likelihood == pytest.approx(stats.norm.logpdf(0.3, 0, math.sqrt(S)), abs=TINY)


def test_the_robust_update_is_the_gaussians_within_three_sigma_and_bounded_beyond():
    random = np.random.default_rng(6)
    p, h = some_covariance(random, 6), random.normal(0, 1, 6)
    near, far = np.zeros(6), np.zeros(6)
    same = np.zeros(6)
    sd = math.sqrt(h @ p @ h + 0.04)
    robust_update(near, p.copy(), h, 2.9 * sd, 0.04)
    gaussian_update(same, p.copy(), h, 2.9 * sd, 0.04)
    robust_update(far, p.copy(), h, 1000 * sd, 0.04)
    assert near == pytest.approx(same, abs=TINY)
    assert np.abs(far).max() < 4 * np.abs(near).max()


def test_a_cells_update_is_the_integral_over_the_cell():
    """Against a particle cloud: the mean and covariance of those that lie in the cell."""
    random = np.random.default_rng(7)
    p, h = some_covariance(random, 3) * 0.02, np.array([1.0, 0.0, 0.4])
    cloud = random.multivariate_normal(np.zeros(3), p, 2_000_000)
    inside = cloud[np.abs(cloud @ h - 0.05) < 0.07]
    x = np.zeros(3)
    interval_update(x, p, h, 0.05, 0.14, 0.0)
    assert x == pytest.approx(inside.mean(axis=0), abs=1e-3)
    assert p == pytest.approx(np.cov(inside.T), abs=3e-4)


def test_a_fine_or_distant_cell_is_a_gaussian():
    for innovation, cell in ((0.1, 0.001), (30.0, 0.14)):
        x, y = np.zeros(3), np.zeros(3)
        p, q, h = np.eye(3), np.eye(3), np.array([1.0, 0.0, 0.0])
        interval_update(x, p, h, innovation, cell, 0.01)
        gaussian_update(y, q, h, innovation, 0.01 + cell**2 / 12)
        assert x == pytest.approx(y, abs=TINY)
        assert p == pytest.approx(q, abs=TINY)


def test_a_compass_wraps_and_a_speed_alone_is_taken_once():
    random = np.random.default_rng(8)
    x, z, h = some_state(random), some_reading(random), np.empty(STATES)
    x[HEADING], x[6] = 3.1, 0.0
    z[HEADING_SD - 1] = -3.1
    assert observe(x, z, COMPASS, h)[0] == pytest.approx(math.tau - 6.2)
    z[SPEED_SD - 1] = NO_COURSE
    assert observe(x, z, 2, h)[1] > 0
    assert observe(x, z, 3, h)[1] == 0


# --- the three models together -------------------------------------------------------------------------------------


def some_belief(random: np.random.Generator) -> tuple[FloatArray, FloatArray, FloatArray]:
    x = np.tile(some_state(random), (MODELS, 1)) + random.normal(0, 0.01, (MODELS, STATES))
    p = np.array([some_covariance(random) * 0.01 for _ in range(MODELS)])
    return x, p, np.array([0.5, 0.3, 0.15, 0.05])


MOTION = (
    np.tile(MODEL, (MODELS, 1)),
    np.full((MODELS, MODELS), 1 / MODELS),
    COMMON,
    np.array([0.0, 0.0, 0.3, 1.5, 0.2]),
)


def test_a_step_leaves_its_input_alone_and_its_weights_sum_to_one():
    random = np.random.default_rng(9)
    belief, z = some_belief(random), some_reading(random)
    before = [part.copy() for part in belief]
    (x, p, w), _ = imm_step(belief, STATES, 0.2, z, WITH_POSITION, MOTION)
    for part, kept in zip(belief, before, strict=True):
        assert np.array_equal(part, kept)
    assert w.sum() == pytest.approx(1)
    assert all(np.linalg.eigvalsh(each).min() > -TINY for each in p)
    assert np.isfinite(x).all()


def test_without_a_position_the_uncertainty_of_the_position_grows():
    random = np.random.default_rng(10)
    belief, z = some_belief(random), np.zeros(READINGS)
    before = combined(belief, STATES)[1]
    after, report = imm_step(belief, STATES, 0.2, z, WITHOUT_POSITION, MOTION)
    assert report[0] == 0
    assert np.trace(combined(after, STATES)[1][:2, :2]) > np.trace(before[:2, :2])


def test_the_combined_covariance_holds_the_models_disagreement():
    x = np.zeros((MODELS, STATES))
    x[:, EAST] = -1.0, 0.0, 0.0, 1.0
    mean, covariance = combined((x, np.zeros((MODELS, STATES, STATES)), np.full(MODELS, 1 / MODELS)), STATES)
    assert mean[EAST] == pytest.approx(0)
    assert covariance[EAST, EAST] == pytest.approx(1 / 2)


def test_what_is_shown_grows_with_how_far_the_fixes_lie_off_to_one_side():
    random = np.random.default_rng(11)
    belief, z = some_belief(random), some_reading(random)
    still, behind = (summary(belief, STATES, z, np.array([lag, 0.0]), fresh=False) for lag in (0.0, 0.1))
    assert behind[:5] == pytest.approx(still[:5])
    assert behind[5] > still[5] + 0.1**2
    assert behind[7] == still[7]
    fresh = summary(belief, STATES, z, np.zeros(2), fresh=True)
    assert np.any(fresh[9:] != 0.0)


def test_at_rest_the_whole_covariance_is_shown_and_driving_less():
    random = np.random.default_rng(12)
    x, p, w = some_belief(random)
    z = some_reading(random)
    x[:, SPEED] = 0.0
    whole = summary((x, p, w), STATES, z, np.zeros(2), fresh=True)
    whole[5] -= BEHIND * whole[9] ** 2
    assert whole[5] == pytest.approx(combined((x, p, w), STATES)[1][EAST, EAST])
    standing = summary((x, p, w), STATES, z, np.zeros(2), fresh=False)
    assert standing[5] <= whole[5]
    x[:, SPEED] = 2.0
    assert summary((x, p, w), STATES, z, np.zeros(2), fresh=False)[5] < whole[5]


# --- the smoother --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [6, 9])
def test_the_backward_pass_is_rauch_tung_striebels(n: int):
    """The same smoothed means and covariances as the form with the inverse of the predicted covariance."""
    random = np.random.default_rng(11)
    count = 12
    t = np.arange(count) * 0.2
    z = np.array([some_reading(random) for _ in range(count)])
    z[:, :2] = np.outer(t, [0.4, 1.2])
    z[:, ARM_FORWARD + 3] = 1.3
    sites = np.concatenate([z[:, :2], np.full((count, SITE - 2), 0.003)], axis=1)
    x = np.zeros(STATES)
    x[SPEED] = 1.3
    models, common = np.tile(MODEL, (count, 1)), np.tile(COMMON, (count, 1))
    tape = forward(x.copy(), np.eye(n) * 0.05, t, z, (models, common, np.zeros((0, STATES))), sites)
    smooth, spreads = backward(tape)

    means, covariances, transitions, rows, taken = tape
    filtered = [filtered_epoch(means[k][:n], covariances[k], rows[k], taken[k]) for k in range(count)]
    mean, covariance = filtered[-1]
    for k in range(count - 2, -1, -1):
        F = full_transition(transitions[k + 1])[:n, :n]
        gain = filtered[k][1] @ F.T @ np.linalg.inv(covariances[k + 1])
        mean = filtered[k][0] + gain @ (mean - means[k + 1][:n])
        covariance = filtered[k][1] + gain @ (covariance - covariances[k + 1]) @ gain.T
        assert smooth[k][:n] == pytest.approx(mean, abs=1e-7)
        assert spreads[k] == pytest.approx(covariance, abs=1e-7)


def filtered_epoch(
    mean: FloatArray, covariance: FloatArray, rows: FloatArray, taken: FloatArray
) -> tuple[FloatArray, FloatArray]:
    for h, (innovation, total) in zip(rows, taken, strict=True):
        if total > 0:
            K = covariance @ h / total
            mean = mean + K * innovation
            covariance = covariance - np.outer(K, K) * total
    return mean, covariance


def test_drift_is_only_seen_where_there_is_one():
    random = np.random.default_rng(12)
    x, z = some_state(random), some_reading(random)
    short, long = np.empty(6), np.empty(STATES)
    observe(x, z, EAST, short)
    observe(x, z, EAST, long)
    assert long[DRIFT_EAST] == 1.0
    assert np.array_equal(short, long[:6])
