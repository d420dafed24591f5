"""The ground that is left: what is worked and what is left make up the field, whatever the swaths are."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from support.star_fields import stars

from guidance_app.guidance.swaths import swath, united, unworked
from guidance_app.guidance.task import Task

SQUARE_DECIMETRE = 0.01
PLACES = st.tuples(st.floats(-60.0, 60.0), st.floats(-60.0, 60.0))


@settings(max_examples=40, deadline=None)
@given(stars(), st.lists(st.tuples(PLACES, PLACES), min_size=1, max_size=12), st.sampled_from([3.0, 12.0]))
def test_worked_and_left_make_up_the_field(
    ground: shapely.Polygon, lines: list[tuple[tuple[float, float], tuple[float, float]]], width: float
) -> None:
    swaths = [swath(Task.along(np.array(line)), width) for line in lines if np.hypot(*np.subtract(*line)) > 1.0]
    if not swaths:
        return
    worked = united(swaths)
    left = unworked(ground, worked)
    assert left.is_valid
    assert left.area + worked.intersection(ground).area == pytest.approx(ground.area, abs=SQUARE_DECIMETRE * len(lines))


def test_swaths_that_only_touch_leave_nothing_between() -> None:
    ground = shapely.box(0.0, 0.0, 30.0, 100.0)
    swaths = [swath(Task.along(np.array([(east, 0.0), (east, 100.0)])), 6.0) for east in (3.0, 9.0, 15.0, 21.0, 27.0)]
    assert unworked(ground, united(swaths)).area == pytest.approx(0.0, abs=SQUARE_DECIMETRE)
