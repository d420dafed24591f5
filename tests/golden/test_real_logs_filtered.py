"""Real recordings through filters and smoother: nobody leaves the log, and headings are calm."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from guidance_app.estimation.filters import make_filter
from guidance_app.evaluation import Track, score
from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.metrics import errors_of
from guidance_app.evaluation.real import (
    as_courses,
    fixes_of,
    frame_of,
    heading_consistency,
    recording_from_fixes,
    requantised,
    track_from_fixes,
)
from guidance_app.evaluation.smoothed import smooth_recording
from guidance_app.evaluation.tracks import Recording, measurements
from guidance_app.model import FixQuality

CM = 100.0
CAR = "nmea/car_rtk_with_truth/MTV.Local1.SPAN.20200206-181434.gga"
CAR_RECEIVER = "nmea/car_rtk_with_truth/MTV.Local1.ublox-F9K.20200206-181434.nmea"
TRACTOR = "nmea/tractor_9m/impl9m_TLG00001_{}dec.nmea"


@pytest.fixture(scope="module")
def car(real_data: Path) -> tuple[Recording, Track]:
    """A reference rounded to four decimals, 1 Hz, and itself."""
    fixes = fixes_of((real_data / CAR).read_bytes())
    frame = frame_of(fixes)
    return recording_from_fixes(requantised(fixes, 4), frame), track_from_fixes(fixes, frame)


@pytest.fixture(scope="module")
def tractor(real_data: Path) -> tuple[Recording, Track]:
    """A tractor's log with four decimals, 1 Hz with gaps, and the same with seven."""
    fine, coarse = (fixes_of((real_data / TRACTOR.format(decimals)).read_bytes()) for decimals in (7, 4))
    frame = frame_of(fine)
    return recording_from_fixes(coarse, frame), track_from_fixes(fine, frame)


def test_the_truth_of_a_log_is_the_log(car: tuple[Recording, Track]) -> None:
    recording, truth = car
    raw = score(estimate_recording(recording, "off"), truth)
    assert raw.rms * CM == pytest.approx(100 * np.hypot(0.1852, 0.147) / np.sqrt(12), rel=0.05)


@pytest.mark.parametrize("which", ["car", "tractor"])
@pytest.mark.parametrize("velocity", [False, True], ids=["position", "velocity"])
def test_filtering_a_1_hz_log_is_no_worse_than_leaving_it(
    which: str, velocity: bool, request: pytest.FixtureRequest
) -> None:
    """A car that brakes with 2 m/s2; a tractor that backs up, with time stamps wrong by a second in every twentieth."""
    recording, truth = request.getfixturevalue(which)
    if velocity and recording.velocity is None:
        pytest.skip("this log has no velocity")
    recording = replace(recording, velocity=recording.velocity if velocity else None, quality=FixQuality.RTK_FIXED)
    ours, raw = (score(as_courses(estimate_recording(recording, name)), truth) for name in ("adaptive", "off"))
    assert ours.rms <= raw.rms
    assert ours.worst < 0.5
    assert ours.within_ellipse is not None
    assert ours.within_ellipse > 0.9
    assert ours.heading_rms is not None
    assert raw.heading_rms is not None
    assert ours.heading_rms < raw.heading_rms


def test_a_dgps_receivers_slow_error_is_not_followed_far(tractor: tuple[Recording, Track]) -> None:
    """The same log as what it is: part of what the finer digits show is then held to be the receiver's drift."""
    recording, truth = tractor
    ours = score(estimate_recording(recording, "adaptive"), truth)
    assert ours.rms * CM < 12
    assert ours.worst < 0.5


def test_braking_hard_the_shown_position_stays_with_the_fix(car: tuple[Recording, Track]) -> None:
    """Every fix of the log is believed, so that no coasting pose ever runs ahead of the car."""
    recording, _ = car
    estimator = make_filter("adaptive")
    for z in measurements(recording):
        pose = estimator.step(z)
        assert pose is not None
        assert not pose.dead_reckoned
        assert math.hypot(pose.east - z.east, pose.north - z.north) < 0.3


def test_a_receiver_without_rtk_says_how_far_it_may_be_off(real_data: Path) -> None:
    """An RTK float receiver beside a reference: half a metre off for minutes, which no filter can see."""
    reference, fixes = (fixes_of((real_data / name).read_bytes()) for name in (CAR, CAR_RECEIVER))
    frame = frame_of(reference)
    recording, truth = recording_from_fixes(fixes, frame), track_from_fixes(reference, frame)
    ours, raw = (score(estimate_recording(recording, name), truth) for name in ("adaptive", "off"))
    assert ours.within_ellipse is not None
    assert ours.within_ellipse > 0.9
    assert ours.rms < 1.01 * raw.rms
    assert ours.heading_rms is not None
    assert ours.heading_rms < math.radians(5)


@pytest.mark.parametrize("which", ["car", "tractor"])
def test_smoothing_a_1_hz_log_is_better_than_leaving_it(which: str, request: pytest.FixtureRequest) -> None:
    recording, truth = request.getfixturevalue(which)
    recording = replace(recording, velocity=None, quality=FixQuality.RTK_FIXED)
    ours, raw = (score(as_courses(track), truth) for track in (smooth_recording(recording), estimated_raw(recording)))
    assert ours.rms < raw.rms
    assert ours.worst < 0.5
    assert ours.heading_rms is not None
    assert raw.heading_rms is not None
    assert ours.heading_rms < raw.heading_rms
    assert ours.within_ellipse is not None
    assert ours.within_ellipse > 0.88


def test_the_smoother_stays_on_a_log_with_velocity(tractor: tuple[Recording, Track]) -> None:
    recording, truth = tractor
    errors = errors_of(smooth_recording(recording), truth)
    assert np.all(np.isfinite(errors.distance))
    assert np.median(errors.distance) * CM < 15
    assert np.percentile(errors.distance, 95) * CM < 40
    assert errors.distance.max() < 3


def estimated_raw(recording: Recording) -> Track:
    """The fixes as they are."""
    return estimate_recording(recording, "off")


@pytest.mark.parametrize("log", [TRACTOR.format(4), "nmea/tractor_9m/impl9m_TLG00008_4dec.nmea"])
def test_headings_are_calmer_than_unfiltered_on_straight_stretches(log: str, real_data: Path) -> None:
    fixes = fixes_of((real_data / log).read_bytes())
    frame = frame_of(fixes)
    recording = recording_from_fixes(fixes, frame, with_velocity=False)
    adaptive, raw = (heading_consistency(recording, fixes, frame, name) for name in ("adaptive", "off"))
    assert adaptive < 0.5 * raw
