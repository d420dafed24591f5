"""The colours of the ground, by day and by night, and what a renderer must be given so that they appear as meant.

Colours are sRGB as they shall appear on the screen. three.js bends what it draws by a film curve (ACES, the fit by
Stephen Hill in three's ``tonemapping_pars_fragment``), so a value sent as it is comes out paler and darker; here the
curve is turned round. What the curve cannot reach (very bright, very saturated) comes as near as it can.

Three ways lead to the screen: a lit surface (its reflectance times the light), a line or a flat surface with one colour
(sRGB), and colours per vertex (linear). Each has its own function.
"""

from dataclasses import dataclass

import numpy as np

from guidance_app.model import FloatArray

__all__ = ["DAY", "NIGHT", "Palette", "Rgb", "appears", "flat_source", "lit_source", "palette_of", "vertex_source"]

Rgb = tuple[int, int, int]

_TO_FILM = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
_FROM_FILM = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
_EXPOSURE = 1 / 0.6
"""three.js scales by this before the curve."""


@dataclass(frozen=True, slots=True)
class Palette:
    """Every colour of the scene for one time of day; ``light`` is how much of a level surface's colour comes back."""

    light: float
    sky: Rgb
    horizon: Rgb
    meadow: Rgb
    grid: Rgb
    soil: Rgb
    exclusion: Rgb
    boundary: Rgb
    exclusion_edge: Rgb
    mainland: Rgb
    pass_to_do: Rgb
    pass_next: Rgb
    pass_done: Rgb
    pass_target: Rgb
    number: Rgb
    number_done: Rgb
    worked: Rgb
    track: Rgb
    ghost: Rgb
    predicted: Rgb
    uncertain: Rgb
    stale: Rgb
    turn: Rgb
    turn_soon: Rgb
    turn_now: Rgb
    working_edge: Rgb
    lifted_edge: Rgb


DAY = Palette(
    light=1.0,
    sky=(116, 166, 212),
    horizon=(208, 220, 224),
    meadow=(134, 152, 104),
    grid=(108, 127, 82),
    soil=(140, 118, 90),
    exclusion=(96, 122, 78),
    boundary=(233, 193, 60),
    exclusion_edge=(214, 92, 60),
    mainland=(214, 190, 142),
    pass_to_do=(212, 200, 180),
    pass_next=(226, 226, 218),
    pass_done=(122, 128, 122),
    pass_target=(84, 206, 84),
    number=(226, 226, 222),
    number_done=(150, 156, 150),
    worked=(62, 124, 148),
    track=(36, 82, 102),
    ghost=(196, 92, 168),
    predicted=(70, 190, 222),
    uncertain=(226, 168, 224),
    stale=(170, 172, 174),
    turn=(214, 224, 226),
    turn_soon=(231, 205, 72),
    turn_now=(236, 74, 52),
    working_edge=(84, 206, 84),
    lifted_edge=(206, 206, 202),
)
NIGHT = Palette(
    light=0.42,
    sky=(8, 12, 20),
    horizon=(24, 32, 42),
    meadow=(18, 25, 21),
    grid=(34, 45, 38),
    soil=(44, 37, 30),
    exclusion=(22, 38, 26),
    boundary=(178, 134, 42),
    exclusion_edge=(158, 66, 44),
    mainland=(98, 84, 60),
    pass_to_do=(112, 106, 96),
    pass_next=(168, 166, 160),
    pass_done=(58, 66, 68),
    pass_target=(44, 180, 76),
    number=(176, 176, 170),
    number_done=(84, 92, 92),
    worked=(22, 58, 74),
    track=(46, 84, 100),
    ghost=(164, 88, 148),
    predicted=(44, 164, 184),
    uncertain=(150, 104, 150),
    stale=(112, 114, 116),
    turn=(140, 150, 154),
    turn_soon=(206, 168, 44),
    turn_now=(200, 62, 44),
    working_edge=(44, 176, 80),
    lifted_edge=(116, 116, 114),
)


def palette_of(*, night: bool) -> Palette:
    """The colours for this time of day."""
    return NIGHT if night else DAY


def lit_source(colour: Rgb, light: float) -> Rgb:
    """What to give a surface that returns ``light`` of its colour, so that it appears as ``colour``."""
    return _bytes(_srgb(np.clip(_before_film(colour) / light, 0.0, 1.0)))


def flat_source(colour: Rgb) -> Rgb:
    """What to give a line of one colour, so that it appears as ``colour``."""
    return _bytes(_srgb(np.clip(_before_film(colour), 0.0, 1.0)))


def vertex_source(colour: Rgb) -> Rgb:
    """What to give as the colour of a vertex (linear, not sRGB), so that it appears as ``colour``."""
    return _bytes(np.clip(_before_film(colour), 0.0, 1.0))


def appears(linear: FloatArray) -> Rgb:
    """The colour on the screen of the linear light ``linear``, shape (3,)."""
    return _bytes(_srgb(_film(linear)))


def _film(linear: FloatArray) -> FloatArray:
    v = _TO_FILM @ (linear * _EXPOSURE)
    bent = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)
    return np.clip(_FROM_FILM @ bent, 0.0, 1.0)


def _before_film(colour: Rgb) -> FloatArray:
    """The linear light that the curve turns into ``colour``: the curve's quadratic solved for its positive root."""
    bent = np.linalg.solve(_FROM_FILM, _linear(colour))
    bent = np.clip(bent, 0.0, 0.999)
    a = 1.0 - 0.983729 * bent
    b = 0.0245786 - 0.4329510 * bent
    c = -0.000090537 - 0.238081 * bent
    v = (-b + np.sqrt(b * b - 4 * a * c)) / (2 * a)
    return np.asarray(np.linalg.solve(_TO_FILM, v) / _EXPOSURE)


def _linear(colour: Rgb) -> FloatArray:
    share = np.array(colour, dtype=float) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def _srgb(linear: FloatArray) -> FloatArray:
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055)


def _bytes(shares: FloatArray) -> Rgb:
    red, green, blue = (round(float(share) * 255) for share in shares)
    return red, green, blue
