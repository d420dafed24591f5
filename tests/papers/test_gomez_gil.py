"""The numbers of Gomez-Gil et al., Sensors 13 (2013), reproduced with the filters of the console."""

import pytest

from guidance_app.evaluation.comparisons import Case, run_case
from guidance_app.evaluation.gomez_gil import (
    Reading,
    adaptive_filter,
    eighteen_lines,
    headings_of,
    paper_filter,
    score_lines,
    unfiltered,
)

CM = 100.0
PAPER_BEFORE, PAPER_AFTER = 6.56, 3.74
PAPER_COURSE_STD, PAPER_COURSE_RANGE = 1.83, 7.27


def test_rounding_to_the_nearest_point_gives_the_rmse_before_filtering() -> None:
    assert score_lines(eighteen_lines(250), unfiltered).rms * CM == pytest.approx(PAPER_BEFORE, abs=0.25)


@pytest.mark.parametrize("reading", [Reading.TWO_STEP, Reading.CENTRAL])
def test_table_1_after_filtering(reading: Reading) -> None:
    after = score_lines(eighteen_lines(), paper_filter, reading)
    assert 3.5 <= after.rms * CM <= 4.0
    assert after.rms * CM == pytest.approx(PAPER_AFTER, abs=0.1)


def test_one_step_differences_miss_table_1() -> None:
    """Why two steps are the default: course and speed between successive rounded fixes are biased."""
    assert score_lines(eighteen_lines(), paper_filter, Reading.ONE_STEP).rms * CM > 4.5


def test_table_2_after_filtering() -> None:
    after = headings_of(paper_filter, Reading.TWO_STEP)
    assert after.course_std == pytest.approx(PAPER_COURSE_STD, abs=0.15)
    assert after.course_range == pytest.approx(PAPER_COURSE_RANGE, abs=0.8)


def test_the_heading_state_is_calmer_than_the_course_of_the_track() -> None:
    """Why the screen shows the state: never the course between filtered positions."""
    after = headings_of(paper_filter, Reading.TWO_STEP)
    assert after.state_std < 0.4 * after.course_std


def test_the_adaptive_filter_beats_the_paper_on_its_own_lines() -> None:
    ours = score_lines(eighteen_lines(250), adaptive_filter)
    assert ours.rms * CM <= 3.5
    headings = headings_of(adaptive_filter, None, settling=15)
    assert headings.state_std <= 0.35
    assert headings.course_std <= 1.1


def test_the_paper_filter_does_not_turn() -> None:
    """It is offered with this warning, and is not the default."""
    turn = run_case(Case("paper", "uturn", range(3))).score
    assert turn.rms * CM > 15
    assert turn.heading_lag is not None
    assert turn.heading_lag > 1.5
    ours = run_case(Case("position", "uturn", range(3))).score
    assert ours.rms * CM < 6
