"""Colours: what is sent appears as meant, by day and by night, whatever the way to the screen."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.view.colours import (
    DAY,
    NIGHT,
    Palette,
    Rgb,
    appears,
    flat_source,
    lit_source,
    palette_of,
    vertex_source,
)

HARDLY_SEEN = 3
"""A difference of a colour's part, of 255, that nobody sees."""

REACHABLE = 14
"""The film curve cannot make the brightest and most saturated colours."""

SOFT = st.integers(30, 190)


def linear_from_srgb(colour: Rgb) -> np.ndarray:
    share = np.array(colour) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def far(one: Rgb, other: Rgb) -> int:
    return max(abs(a - b) for a, b in zip(one, other, strict=True))


@given(st.tuples(SOFT, SOFT, SOFT).filter(lambda rgb: max(rgb) - min(rgb) < 90))
def test_a_flat_colour_appears_as_meant(colour: Rgb) -> None:
    assert far(appears(linear_from_srgb(flat_source(colour))), colour) <= HARDLY_SEEN


@given(st.tuples(SOFT, SOFT, SOFT).filter(lambda rgb: max(rgb) - min(rgb) < 90))
def test_a_vertex_colour_appears_as_meant(colour: Rgb) -> None:
    assert far(appears(np.array(vertex_source(colour)) / 255), colour) <= 3 * HARDLY_SEEN


@given(st.tuples(SOFT, SOFT, SOFT).filter(lambda rgb: max(rgb) - min(rgb) < 60), st.sampled_from([1.0, 0.42]))
def test_a_lit_surface_appears_as_meant_where_the_light_suffices(colour: Rgb, light: float) -> None:
    reflected = linear_from_srgb(lit_source(colour, light))
    if reflected.max() < 1.0:
        assert far(appears(reflected * light), colour) <= HARDLY_SEEN


@pytest.mark.parametrize("palette", [DAY, NIGHT], ids=["day", "night"])
def test_every_colour_of_a_palette_can_be_shown(palette: Palette) -> None:
    for field in dataclasses.fields(palette):
        colour = getattr(palette, field.name)
        if isinstance(colour, tuple):
            assert far(appears(linear_from_srgb(flat_source(colour))), colour) <= REACHABLE, field.name


@pytest.mark.parametrize("palette", [DAY, NIGHT], ids=["day", "night"])
def test_what_must_be_told_apart_differs_in_lightness(palette: Palette) -> None:
    def lightness(colour: Rgb) -> float:
        return float(linear_from_srgb(colour) @ (0.2126, 0.7152, 0.0722))

    def contrast(one: Rgb, other: Rgb) -> float:
        high, low = sorted((lightness(one), lightness(other)), reverse=True)
        return (high + 0.05) / (low + 0.05)

    assert contrast(palette.pass_target, palette.soil) > 1.8
    assert contrast(palette.pass_target, palette.worked) > 1.8
    assert contrast(palette.pass_next, palette.soil) > contrast(palette.pass_done, palette.soil)
    assert contrast(palette.boundary, palette.soil) > 1.8
    assert contrast(palette.boundary, palette.meadow) > 1.5


def test_the_night_is_darker_in_every_colour_of_the_ground() -> None:
    for name in ("sky", "horizon", "meadow", "soil", "worked", "pass_to_do", "number"):
        assert sum(getattr(NIGHT, name)) < sum(getattr(DAY, name))
    assert palette_of(night=True) is NIGHT
    assert palette_of(night=False) is DAY
