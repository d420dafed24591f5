"""Passes cut from a mainland: lengthened they work all of it, not lengthened they stay beside the laps."""

import math

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from support.star_fields import stars

from guidance_app.guidance.cells import BESIDE, Strips, cut, cut_inside, strips_over
from guidance_app.guidance.request import LastPass

SPACING = 6.0
ROUNDING = 1e-6


def strips_of(mainland: shapely.Polygon, heading: float) -> Strips:
    return strips_over([mainland], heading, SPACING, LastPass.GAP, None)


@pytest.mark.parametrize("slant", [0.0, 10.0, 40.0])
def test_passes_that_are_not_lengthened_lap_over_slanting_ends_by_a_small_corner(slant: float) -> None:
    mainland = shapely.Polygon([(0, 0), (60, slant), (60, 100 + slant), (0, 100)])
    strips = strips_of(mainland, 0.0)
    pieces = cut_inside([mainland], strips)
    assert len(pieces) == 10
    beyond = 0.0
    for piece in pieces:
        across = strips.middle(piece.row)
        swath = shapely.box(across - SPACING / 2, piece.low, across + SPACING / 2, piece.high)
        beyond += swath.difference(mainland).area
    corner = ((0.5 - BESIDE) * SPACING) ** 2 * (slant / 60) / 2
    assert beyond == pytest.approx(20 * corner, abs=ROUNDING)


def test_an_obstacle_parts_a_pass_that_is_not_lengthened() -> None:
    mainland = shapely.box(0, 0, 6, 100).difference(shapely.box(4.0, 40, 8, 50))
    (low, high) = cut_inside([mainland], strips_of(shapely.box(0, 0, 6, 100), 0.0))
    assert (low.low, low.high, high.low, high.high) == pytest.approx((0, 40, 50, 100))


@settings(max_examples=30, deadline=None)
@given(stars(), st.floats(0.0, math.pi))
def test_a_piece_that_is_not_lengthened_lies_in_one_that_is(mainland: shapely.Polygon, heading: float) -> None:
    strips = strips_of(mainland, heading)
    long = cut([mainland], strips)
    for short in cut_inside([mainland], strips):
        assert any(
            each.row == short.row and each.low - ROUNDING <= short.low and short.high <= each.high + ROUNDING
            for each in long
        )
