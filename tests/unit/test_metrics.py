"""How an estimate is scored."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.evaluation import Track, score, track_from_poses
from guidance_app.evaluation.metrics import ELLIPSE_95, errors_of, geometric_mean, heading_spread, pool, summarise
from guidance_app.evaluation.scenarios import drive, straight_line, truth_of
from guidance_app.model import Pose

MICROMETRE = 1e-6
MICRORADIAN = 1e-6


def moved(track: Track, east: float = 0.0, north: float = 0.0, turned: float = 0.0, **more: object) -> Track:
    known = track.heading_known
    return Track(
        track.t,
        track.east + east,
        track.north + north,
        (track.heading + turned) % math.tau,
        track.speed,
        track.curvature,
        known,
        **more,  # type: ignore[arg-type]
    )


def circle(side: int = 1) -> Track:
    return drive(
        lambda t: np.full_like(t, 2.0), lambda s: np.full_like(s, side / 20), 40.0, heading=1.0, start=(3.0, 4.0)
    )


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_a_shifted_track_is_off_by_the_shift(east: float, north: float) -> None:
    result = score(moved(circle(), east, north), circle())
    assert result.rms == pytest.approx(math.hypot(east, north), abs=MICROMETRE)
    assert result.percentile_95 == pytest.approx(math.hypot(east, north), abs=MICROMETRE)
    assert result.worst == pytest.approx(math.hypot(east, north), abs=MICROMETRE)


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_a_constant_offset_is_removed_when_asked(east: float, north: float) -> None:
    result = score(moved(circle(), east, north), circle(), remove_offset=True)
    assert result.rms == pytest.approx(0, abs=MICROMETRE)
    assert result.offset == pytest.approx((east, north), abs=MICROMETRE)


@given(st.floats(-3.1, 3.1))
def test_heading_errors_wrap(turned: float) -> None:
    result = score(moved(circle(), turned=turned), circle())
    assert result.heading_rms == pytest.approx(abs(turned), abs=MICRORADIAN)


@pytest.mark.parametrize("side", [1, -1])
def test_an_estimate_inside_the_turn_has_a_positive_bias(side: int) -> None:
    truth = circle(side)
    right = side * 0.1
    inside = Track(
        truth.t,
        truth.east + right * np.cos(truth.heading),
        truth.north - right * np.sin(truth.heading),
        truth.heading,
        truth.speed,
        truth.curvature,
        truth.heading_known,
    )
    assert score(inside, truth).turn_bias == pytest.approx(0.1, abs=MICROMETRE)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("lag", [0.4, 1.0])
def test_a_late_heading_shows_as_its_lag(side: int, lag: float) -> None:
    truth = circle(side)
    late = moved(truth, turned=-side * lag * 2.0 / 20)
    assert score(late, truth).heading_lag == pytest.approx(lag, abs=1e-6)


def test_a_straight_line_has_neither_lag_nor_bias() -> None:
    truth = straight_line(0.3, 2.0, 100)
    result = score(moved(truth, 0.1), truth)
    assert result.heading_lag is None
    assert result.turn_bias is None


def test_honest_covariance_holds_95_percent() -> None:
    random = np.random.default_rng(5)
    truth = straight_line(0.3, 2.0, 4000)
    sigma_east, sigma_north = 0.02, 0.05
    covariance = np.tile([sigma_east**2, 0.0, sigma_north**2], (4000, 1))
    noisy = Track(
        truth.t,
        truth.east + random.normal(0, sigma_east, 4000),
        truth.north + random.normal(0, sigma_north, 4000),
        truth.heading,
        truth.speed,
        truth.curvature,
        truth.heading_known,
        covariance,
    )
    assert score(noisy, truth).within_ellipse == pytest.approx(0.95, abs=0.015)


def test_the_ellipse_is_the_chi_square_of_two_at_95_percent() -> None:
    assert pytest.approx(-2 * math.log(0.05), abs=1e-3) == ELLIPSE_95


def test_a_singular_covariance_holds_nothing() -> None:
    truth = straight_line(0.3, 2.0, 10)
    certain = moved(truth, 0.01, covariance=np.zeros((10, 3)))
    assert score(certain, truth).within_ellipse == 0.0


def test_truth_at_other_times_is_interpolated() -> None:
    dense, sparse = straight_line(0.7, 2.0, 201, rate=20), straight_line(0.7, 2.0, 11, rate=1)
    result = score(dense, sparse)
    assert result.samples == 201
    assert result.rms == pytest.approx(0, abs=MICROMETRE)
    assert result.heading_rms == pytest.approx(0, abs=MICRORADIAN)


def test_headings_are_interpolated_the_short_way_over_north() -> None:
    truth = straight_line(0.0, 1.0, 20, rate=1)
    swinging = Track(
        truth.t,
        truth.east,
        truth.north,
        np.where(np.arange(20) % 2, 0.1, math.tau - 0.1),
        truth.speed,
        truth.curvature,
        truth.heading_known,
    )
    middle = straight_line(0.0, 1.0, 37, rate=2)
    assert score(middle, swinging).heading_rms is not None
    assert score(middle, swinging).heading_rms < 0.11


def test_times_without_truth_are_left_out() -> None:
    long, short = straight_line(0.7, 2.0, 100), straight_line(0.7, 2.0, 50)
    assert score(long, short).samples == 50


def test_a_gap_in_the_truth_is_not_bridged() -> None:
    truth = straight_line(0.7, 2.0, 30, rate=1)
    kept = np.r_[0:10, 20:30]
    holed = Track(
        truth.t[kept],
        truth.east[kept],
        truth.north[kept],
        truth.heading[kept],
        truth.speed[kept],
        truth.curvature[kept],
        truth.heading_known[kept],
    )
    assert score(truth, holed).samples == 20


def test_no_common_time_is_refused_in_a_sentence() -> None:
    early, late = straight_line(0.7, 2.0, 10), straight_line(0.7, 2.0, 10)
    shifted = Track(late.t + 100, late.east, late.north, late.heading, late.speed, late.curvature, late.heading_known)
    with pytest.raises(ValueError, match="no common time"):
        score(early, shifted)


def test_unknown_headings_are_not_scored() -> None:
    truth = circle()
    blind = Track(
        truth.t,
        truth.east,
        truth.north,
        truth.heading + 2.0,
        truth.speed,
        truth.curvature,
        np.zeros(len(truth), dtype=bool),
    )
    assert score(blind, truth).heading_rms is None


def test_runs_are_pooled_sample_by_sample() -> None:
    truth = straight_line(0.3, 2.0, 100)
    one, other = errors_of(moved(truth, 0.03), truth), errors_of(moved(truth, 0.04), truth)
    assert summarise(pool([one, other])).rms == pytest.approx(math.sqrt((0.03**2 + 0.04**2) / 2))
    assert summarise(pool([one, other])).samples == 200


def test_the_range_is_centred_on_the_truth() -> None:
    std, spread = heading_spread(np.full(1000, 2.0))
    assert (std, spread) == pytest.approx((0.0, 4.0))


def test_a_factor_of_two_counts_alike_everywhere() -> None:
    assert geometric_mean([1.0, 8.0]) == pytest.approx(geometric_mean([2.0, 4.0]))


def test_poses_become_a_track() -> None:
    poses = [
        Pose(t=float(k), arrival=0.0, east=k, north=2.0 * k, heading=1.0, speed=2.0, covariance=(1.0, 0.0, 1.0))
        for k in range(3)
    ]
    track = track_from_poses(poses)
    assert track.positions.tolist() == [[0, 0], [1, 2], [2, 4]]
    assert track.covariance is not None
    assert len(track_from_poses([])) == 0


def test_one_pose_without_covariance_leaves_the_track_without() -> None:
    with_it = Pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, covariance=(1.0, 0.0, 1.0))
    without = Pose(1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert track_from_poses([with_it, without]).covariance is None


def test_a_mirrored_scene_has_the_mirrored_score() -> None:
    random = np.random.default_rng(2)
    truth = truth_of("uturn", random)
    estimate = moved(truth, 0.03, -0.02, 0.01)

    def mirrored(track: Track) -> Track:
        return Track(
            track.t,
            -track.east,
            track.north,
            -track.heading % math.tau,
            track.speed,
            -track.curvature,
            track.heading_known,
        )

    one, other = score(estimate, truth), score(mirrored(estimate), mirrored(truth))
    assert other.rms == pytest.approx(one.rms)
    assert other.heading_lag == pytest.approx(one.heading_lag)
    assert other.turn_bias == pytest.approx(one.turn_bias)
