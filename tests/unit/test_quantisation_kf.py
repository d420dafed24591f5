"""The filter of Gomez-Gil et al.: its arithmetic against the printed matrices, and where it is known to fail."""

import math

import numpy as np
import pytest
from support.drives_of_filters import Kit, Moment, drive, heading_error, measured, position_error, rms, straight

from guidance_app.angles import wrap_pi
from guidance_app.estimation.filter import FilterSettings, QuantisationSettings
from guidance_app.estimation.filters import make_filter
from guidance_app.estimation.filters.quantisation_kf import FourStates, correct, predict
from guidance_app.model import FloatArray, Pose

TINY = 1e-10
CENTIMETRE = 0.01
SETTINGS = QuantisationSettings()


def as_matrices(s: FourStates) -> tuple[FloatArray, FloatArray]:
    p = np.array([[s[4], s[5], 0, s[6]], [s[5], s[7], 0, s[8]], [0, 0, s[10], 0], [s[6], s[8], 0, s[9]]])
    return np.array(s[:4]), p


def test_it_is_the_printed_recursion_of_four_by_four_matrices():
    """Eqs 8 to 12 with full matrices and a matrix inverse, over a random walk of measurements."""
    random = np.random.default_rng(1)
    Q, R = np.diag(SETTINGS.process_noise), np.diag(SETTINGS.measurement_noise)
    p0 = SETTINGS.start_covariance
    state: FourStates = (1.0, 2.0, 3.0, 1.4, p0[0], 0.0, 0.0, p0[1], 0.0, p0[3], p0[2])
    x, P = as_matrices(state)
    for _ in range(200):
        dt = float(random.uniform(0.05, 1.0))
        z = x + random.normal(0, 0.5, 4)
        F = np.eye(4)
        F[0, 3], F[1, 3] = dt * math.sin(x[2]), dt * math.cos(x[2])
        x = F @ x
        P = F @ P @ F.T + Q
        innovation = z - x
        innovation[2] = wrap_pi(innovation[2])
        K = P @ np.linalg.inv(P + R)
        x, P = x + K @ innovation, (np.eye(4) - K) @ P
        x[2] = wrap_pi(x[2])
        state = correct(predict(state, dt, SETTINGS.process_noise), tuple(z.tolist()), SETTINGS.measurement_noise)
        ours = as_matrices(state)
        assert ours[0] == pytest.approx(x, abs=TINY)
        assert ours[1] == pytest.approx(P, abs=TINY)


COARSE = Kit()


def poses(truth: list[Moment], kit: Kit = COARSE) -> list[Pose]:
    estimator = make_filter("quantisation_kf")
    found = [estimator.step(z) for z in measured(truth, kit)]
    return [pose for pose in found if pose is not None]


def test_only_the_ratio_of_q_to_r_matters():
    z = measured(straight())
    tenfold = make_filter("quantisation_kf", settings_scaled(10.0))
    plain = make_filter("quantisation_kf")
    for each in z:
        one, other = plain.step(each), tenfold.step(each)
        assert one is not None
        assert other is not None
        assert (one.east, one.north, one.heading) == pytest.approx((other.east, other.north, other.heading), abs=1e-9)


def settings_scaled(factor: float) -> FilterSettings:
    return FilterSettings(
        quantisation_kf=QuantisationSettings(
            process_noise=tuple(factor * q for q in SETTINGS.process_noise),
            measurement_noise=tuple(factor * r for r in SETTINGS.measurement_noise),
            start_covariance=tuple(factor * p for p in SETTINGS.start_covariance),
        )
    )


def test_it_is_a_filter_for_straight_lines():
    """18 cm out on an arc of 50 m, its heading more than 2 s late: this is what the console says of it."""
    truth = drive(lambda _: 8 / 3.6, lambda _: 1 / 50, 60)
    late = [(pose, m) for pose, m in zip(poses(truth), truth, strict=True) if m.t > 20]
    assert 0.15 < rms(position_error(pose, m) for pose, m in late) < 0.22
    lag = rms(heading_error(pose, m) for pose, m in late) / (8 / 3.6 / 50)
    assert 2.0 < lag < 3.2


def test_the_receivers_course_and_speed_are_used_where_given():
    truth = straight(duration=30)
    kit = Kit(cell=(1.4, 1.8), velocity=True)
    late = [(pose, m) for pose, m in zip(poses(truth, kit), truth, strict=True) if m.t > 15]
    assert rms(heading_error(pose, m) for pose, m in late) < math.radians(1.5)


def test_before_heading_and_speed_are_there_it_is_the_fix():
    first, second, third = poses(straight(duration=2))[:3]
    assert not first.heading_known
    assert not second.heading_known
    assert third.heading_known
    assert (first.east, first.north) == (measured(straight())[0].east, measured(straight())[0].north)
