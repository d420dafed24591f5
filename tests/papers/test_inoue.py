"""What Inoue et al. report of their field test and of their steering simulation."""

import math

import numpy as np
import pytest

from guidance_app.evaluation.inoue import field_run, score_field_run
from guidance_app.evaluation.scenarios import Purpose, generator
from guidance_app.evaluation.steering import Convergence, Steering, convergence, simulate

CM = 100.0
DRIVES = range(6)


def mean(filter_name: str, outlier_share: float = 0.0) -> dict[str, float]:
    scores = [score_field_run(field_run(seed, outlier_share), filter_name) for seed in DRIVES]
    names = ("rms", "heading", "change", "within_pass")
    return {name: float(np.mean([getattr(score, name) for score in scores])) for name in names}


@pytest.fixture(scope="module")
def raw() -> dict[str, float]:
    return mean("off")


@pytest.mark.parametrize("filter_name", ["gyro_ekf", "adaptive"])
def test_filtering_makes_the_display_calm(filter_name: str, raw: dict[str, float]) -> None:
    """The paper's own finding: little gain in position, much in smoothness."""
    filtered = mean(filter_name)
    assert filtered["change"] < 0.9 * raw["change"]
    assert filtered["heading"] < raw["heading"]


def test_the_adaptive_filter_is_never_worse_than_raw(raw: dict[str, float]) -> None:
    ours = mean("adaptive")
    assert ours["rms"] <= raw["rms"]
    assert ours["change"] * CM < 2.9
    assert ours["within_pass"] * CM < 5.0
    assert math.degrees(ours["heading"]) < 0.34


def test_outliers_do_not_reach_the_screen(raw: dict[str, float]) -> None:
    clean, spoiled = mean("adaptive"), mean("adaptive", outlier_share=0.01)
    assert spoiled["rms"] < 1.1 * clean["rms"]
    assert mean("off", outlier_share=0.01)["rms"] > 1.3 * raw["rms"]


def test_the_simulated_field_test_has_four_passes_after_ten_seconds_of_standing() -> None:
    run = field_run(0)
    assert sorted(set(run.passes.tolist())) == [-1, 0, 1, 2, 3]
    assert np.all(run.truth.speed[run.truth.t < 10] == 0)
    assert run.truth.speed.max() == pytest.approx(13 / 3.6)


# --- steering ------------------------------------------------------------------------------------------------------


def drives(speed: float, prediction_s: float) -> list[Convergence]:
    return [
        convergence(simulate(speed, Steering(prediction_s), generator(Purpose.REPORT, "steering test", seed)))
        for seed in range(8)
    ]


def overshoot(speed: float, prediction_s: float) -> float:
    return CM * float(np.mean([drive.overshoot for drive in drives(speed, prediction_s)]))


def settled(speed: float, prediction_s: float) -> float:
    return float(np.mean([drive.settled_s for drive in drives(speed, prediction_s)]))


def test_at_1_m_s_there_is_no_meandering() -> None:
    assert overshoot(1.0, 0.5) < 1.0
    assert overshoot(1.0, 1.5) < 1.0


def test_at_1_5_m_s_half_a_second_meanders_slightly() -> None:
    assert 2.0 < overshoot(1.5, 0.5) < 15.0
    assert np.mean([drive.crossings for drive in drives(1.5, 0.5)]) >= 1


def test_at_1_5_m_s_one_and_a_half_seconds_are_smooth() -> None:
    assert overshoot(1.5, 1.5) < 1.0


def test_half_a_second_is_quick_and_above_two_seconds_is_slow() -> None:
    assert settled(1.5, 0.5) < settled(1.5, 1.5) - 1 < settled(1.5, 2.5) - 2


def test_the_printed_rate_of_one_per_metre_contradicts_the_paper() -> None:
    """Why p is 0.45: at 1 the half second is unstable at 1.0 m/s, which the paper calls calm."""
    steering = Steering(0.5, convergence=1.0, limit=math.radians(35))
    wild = convergence(simulate(1.0, steering, generator(Purpose.REPORT, "steering test", 0)))
    assert wild.overshoot > 0.5
