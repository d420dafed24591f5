"""The filter of Gomez-Gil et al.: its arithmetic against the printed matrices, and where it is known to fail."""

import math
from dataclasses import replace

import numpy as np
import pytest
from support.drives_of_filters import Kit, Moment, drive, heading_error, measured, position_error, rms, straight

from guidance_app.angles import wrap_pi
from guidance_app.estimation.filter import FilterSettings, QuantisationSettings
from guidance_app.estimation.filters import make_filter
from guidance_app.estimation.quantisation_kernels import correct, predict
from guidance_app.evaluation.quantisation import quantisation_track
from guidance_app.evaluation.signals import PAPER_CELL, rounded
from guidance_app.evaluation.tracks import Recording, measurements, track_from_poses
from guidance_app.model import FixQuality, FloatArray, Pose

TINY = 1e-10
CENTIMETRE = 0.01
SETTINGS = QuantisationSettings()


def as_matrices(s: FloatArray) -> tuple[FloatArray, FloatArray]:
    p = np.array([[s[4], s[5], 0, s[6]], [s[5], s[7], 0, s[8]], [0, 0, s[10], 0], [s[6], s[8], 0, s[9]]])
    return s[:4].copy(), p


def test_it_is_the_printed_recursion_of_four_by_four_matrices():
    """Eqs 8 to 12 with full matrices and a matrix inverse, over a random walk of measurements."""
    random = np.random.default_rng(1)
    Q, R = np.diag(SETTINGS.process_noise), np.diag(SETTINGS.measurement_noise)
    p0 = SETTINGS.start_covariance
    state = np.array([1.0, 2.0, 3.0, 1.4, p0[0], 0.0, 0.0, p0[1], 0.0, p0[3], p0[2]])
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
        predict(state, dt, np.diag(Q))
        correct(state, tuple(z.tolist()), np.diag(R))
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


# --- a whole recording at once -------------------------------------------------------------------------------------


def full_recording(random: np.random.Generator) -> Recording:
    """Driving, standing, backing up, two gaps (one too long), a compass that stays and a lever arm that swings."""
    truth = drive(
        lambda t: 2.0 if t < 40 else 0.0 if t < 50 else -1.0 if t < 70 else 1.5, lambda t: 0.1 * (t > 90), 120
    )
    kept = [m for m in truth if not (20 < m.t < 23 or 100 < m.t < 107)]
    count = len(kept)
    velocity = np.array([(m.speed * math.sin(m.heading), m.speed * math.cos(m.heading)) for m in kept])
    return Recording(
        t=np.array([m.t for m in kept]),
        position=rounded(np.array([(m.east, m.north) for m in kept]), PAPER_CELL),
        cell=PAPER_CELL,
        velocity=velocity + random.normal(0, 0.05, (count, 2)),
        heading=np.array([m.heading for m in kept]) + random.normal(0, 0.03, count),
        antenna=random.normal(0, 0.3, (count, 3)),
        quality=FixQuality.DGPS,
    )


@pytest.mark.parametrize("without", [(), ("velocity",), ("heading",), ("velocity", "heading", "antenna")])
def test_a_whole_recording_at_once_gives_the_same_poses_to_the_last_bit(without: tuple[str, ...]):
    recording = replace(full_recording(np.random.default_rng(5)), **dict.fromkeys(without))
    estimator = make_filter("quantisation_kf")
    stepped = track_from_poses(pose for z in measurements(recording) if (pose := estimator.step(z)) is not None)
    at_once = quantisation_track(recording, FilterSettings())
    assert len(stepped) == len(recording)
    assert stepped.covariance is not None
    for name in ("t", "east", "north", "heading", "speed", "curvature", "heading_known", "covariance"):
        assert np.array_equal(getattr(at_once, name), getattr(stepped, name)), name


def test_no_recording_gives_no_poses():
    empty = Recording(t=np.zeros(0), position=np.zeros((0, 2)), cell=None)
    assert len(quantisation_track(empty, FilterSettings())) == 0
