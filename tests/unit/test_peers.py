"""The peers do what our filter does, so that the comparison of times is one of programs, not of filters."""

import numpy as np
import pytest

from guidance_app.evaluation.comparisons import Case, run_case
from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.gomez_gil import Reading, rounding_only
from guidance_app.evaluation.peers import filterpy_four_state, four_state_input, stonesoup_four_state
from guidance_app.evaluation.scenarios import straight_line

MICROMETRE = 1e-6


@pytest.mark.parametrize(("package", "peer"), [("filterpy", filterpy_four_state), ("stonesoup", stonesoup_four_state)])
def test_a_peer_gives_the_same_positions(package: str, peer: object) -> None:
    pytest.importorskip(package)
    line = rounding_only(straight_line(0.5, 1.4, 120), Reading.TWO_STEP)
    ours = estimate_recording(line, "quantisation_kf")
    theirs = peer(four_state_input(line), 0.2)
    assert np.max(np.abs(theirs[:, :2] - ours.positions)) < MICROMETRE
    assert np.max(np.abs(np.sin(theirs[:, 2] - ours.heading))) < MICROMETRE


def test_the_constant_velocity_peer_beats_no_filter() -> None:
    pytest.importorskip("filterpy")
    case = Case("peer", "arc50", range(3))
    assert run_case(case).score.rms < 0.9 * run_case(Case("off", "arc50", range(3))).score.rms
