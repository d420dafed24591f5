"""Worked stretches of a pass are merged whatever their order, and stay few."""

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.guidance.progress import JOINED, MOST_STRETCHES, Progress, enough

places = st.floats(-20.0, 500.0)
MILLIMETRE = 1e-3


def exact(stretches: list[tuple[float, float]], slack: float) -> float:
    """Length of the union, each stretch longer by ``slack`` at both ends."""
    lines = [shapely.LineString([(min(s) - slack, 0), (max(s) + slack, 0)]) for s in stretches]
    return float(shapely.unary_union(lines).length)


@given(st.lists(st.tuples(places, places), min_size=1, max_size=30))
def test_worked_is_the_union_with_small_gaps_closed(stretches: list[tuple[float, float]]) -> None:
    progress = Progress()
    for start, end in stretches:
        progress.add(7, start, end)
    assert progress.worked(7) >= exact(stretches, 0.0) - MILLIMETRE
    assert progress.worked(7) <= exact(stretches, 0.5 * JOINED) + MILLIMETRE
    assert progress.worked(8) == 0.0


def test_a_thousand_short_stretches_cost_no_more_than_a_few() -> None:
    progress = Progress()
    for i in range(1000):
        progress.add(1, 2.0 * i, 2.0 * i + 1.0)
    assert 1000.0 <= progress.worked(1) <= 2000.0
    assert progress.stretches(1) <= MOST_STRETCHES


def test_a_fork_goes_its_own_way() -> None:
    progress = Progress(frozenset({3}))
    progress.add(1, 0.0, 10.0)
    fork = progress.fork()
    fork.add(1, 10.0, 30.0)
    fork.finish(1)
    assert (progress.worked(1), progress.done) == (10.0, {3})
    assert (fork.worked(1), fork.done) == (30.0, {1, 3})


@pytest.mark.parametrize(("length", "needed"), [(100.0, 90.0), (30.0, 27.0), (10.0, 7.0), (4.0, 2.0)])
def test_nine_tenths_are_enough_and_on_a_short_pass_all_but_three_metres(length: float, needed: float) -> None:
    assert enough(length) == pytest.approx(needed)
