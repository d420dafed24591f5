"""Real recordings through filters and smoother: nobody leaves the log, and headings are calm."""

from pathlib import Path

import numpy as np
import pytest

from guidance_app.evaluation import Track, score
from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.metrics import errors_of
from guidance_app.evaluation.real import (
    fixes_of,
    frame_of,
    heading_consistency,
    recording_from_fixes,
    requantised,
    track_from_fixes,
)
from guidance_app.evaluation.smoothed import smooth_recording
from guidance_app.evaluation.tracks import Recording

CM = 100.0
CAR = "nmea/car_rtk_with_truth/MTV.Local1.SPAN.20200206-181434.gga"
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


def test_the_adaptive_filter_stays_on_a_fast_1_hz_log(car: tuple[Recording, Track]) -> None:
    recording, truth = car
    result = score(estimate_recording(recording, "adaptive"), truth)
    raw = score(estimate_recording(recording, "off"), truth)
    assert np.median(errors_of(estimate_recording(recording, "adaptive"), truth).distance) * CM < 8
    assert result.percentile_95 * CM < 40
    assert result.worst < 15
    assert result.heading_rms is not None
    assert raw.heading_rms is not None
    assert result.heading_rms < raw.heading_rms


def test_the_adaptive_filter_stays_on_a_tractors_log(tractor: tuple[Recording, Track]) -> None:
    """Its time stamps are wrong by a second now and then, and it backs up at the headland."""
    recording, truth = tractor
    errors = errors_of(estimate_recording(recording, "adaptive"), truth)
    assert np.median(errors.distance) * CM < 30
    assert np.percentile(errors.distance, 95) < 2.5
    assert errors.distance.max() < 20


@pytest.mark.parametrize("which", ["car", "tractor"])
def test_the_smoother_stays_on_real_logs(which: str, request: pytest.FixtureRequest) -> None:
    recording, truth = request.getfixturevalue(which)
    errors = errors_of(smooth_recording(recording), truth)
    assert np.all(np.isfinite(errors.distance))
    assert np.median(errors.distance) * CM < 40
    assert np.percentile(errors.distance, 95) < 2.5
    assert errors.distance.max() < 80


@pytest.mark.parametrize("log", [TRACTOR.format(4), "nmea/tractor_9m/impl9m_TLG00008_4dec.nmea"])
def test_headings_are_calmer_than_unfiltered_on_straight_stretches(log: str, real_data: Path) -> None:
    fixes = fixes_of((real_data / log).read_bytes())
    frame = frame_of(fixes)
    recording = recording_from_fixes(fixes, frame, with_velocity=False)
    adaptive, raw = (heading_consistency(recording, fixes, frame, name) for name in ("adaptive", "off"))
    assert adaptive < raw
