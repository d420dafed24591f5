"""Arrays in, poses out: the researcher's way to a filter."""

import doctest

import numpy as np
import pytest

from guidance_app.evaluation import estimate, estimating, score
from guidance_app.evaluation.scenarios import straight_line
from guidance_app.evaluation.signals import PAPER_CELL, rounded

CM = 100.0


def test_the_example_in_the_documentation_runs() -> None:
    result = doctest.testmod(estimating)
    assert result.attempted > 5
    assert result.failed == 0


@pytest.mark.parametrize("name", ["off", "quantisation_kf", "gyro_ekf", "adaptive"])
def test_every_filter_takes_arrays(name: str) -> None:
    truth = straight_line(0.5, 1.5, 200)
    poses = estimate(
        truth.t,
        rounded(truth.positions, PAPER_CELL),
        PAPER_CELL,
        velocity=truth.velocity,
        yaw_rate=np.zeros(200),
        heading=truth.heading,
        filter_name=name,
    )
    assert len(poses) > 190
    assert score(poses, truth).rms * CM < 8


def test_lists_do_as_well() -> None:
    poses = estimate([0.0, 1.0, 2.0], [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], None, filter_name="off")
    assert poses.positions.tolist() == [[0, 0], [1, 1], [2, 2]]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"position": np.zeros((3, 3))}, r"position has shape \(3, 3\); \(3, 2\) is needed"),
        ({"velocity": np.zeros((2, 2))}, "velocity has shape"),
        ({"yaw_rate": np.array([0, np.nan, 0])}, "yaw_rate holds numbers that are not finite"),
        ({"time": np.array([0.0, 1.0, 1.0])}, "time must grow; it does not after sample 1"),
        ({"filter_name": "magic"}, "magic"),
    ],
)
def test_bad_arrays_are_refused_with_the_reason(change: dict[str, object], sentence: str) -> None:
    arguments: dict[str, object] = {"time": np.arange(3.0), "position": np.zeros((3, 2)), "cell": None}
    with pytest.raises(ValueError, match=sentence):
        estimate(**(arguments | change))
