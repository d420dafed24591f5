"""Numbers painted on the ground: strokes of digits, laid out along a direction.

Painted, not tags in the air: they take the colours of day and night, lie still on the field, and cost one node for all.
A glyph is drawn on a box 1 wide and 1.6 high, its origin bottom left.
"""

import math

import numpy as np

from guidance_app.model import FloatArray

__all__ = ["ADVANCE", "HEIGHT", "painted"]

HEIGHT = 1.6
ADVANCE = 1.45
"""From one glyph's left edge to the next."""

_Stroke = tuple[tuple[float, float], ...]


def _arc(centre: tuple[float, float], radii: tuple[float, float], begin_deg: float, end_deg: float) -> _Stroke:
    steps = max(2, math.ceil(abs(end_deg - begin_deg) / 40))
    angles = [math.radians(begin_deg + (end_deg - begin_deg) * k / steps) for k in range(steps + 1)]
    return tuple((centre[0] + radii[0] * math.cos(a), centre[1] + radii[1] * math.sin(a)) for a in angles)


_GLYPHS: dict[str, tuple[_Stroke, ...]] = {
    "0": (_arc((0.5, 0.8), (0.5, 0.8), 90, 450),),
    "1": (((0.15, 1.25), (0.55, 1.6), (0.55, 0.0)),),
    "2": ((*_arc((0.5, 1.12), (0.48, 0.48), 170, -40), (0.0, 0.0), (1.0, 0.0)),),
    "3": (_arc((0.48, 1.2), (0.44, 0.4), 155, -90), _arc((0.48, 0.42), (0.5, 0.42), 90, -150)),
    "4": (((0.72, 0.0), (0.72, 1.6), (0.0, 0.5), (1.0, 0.5)),),
    "5": (((0.9, 1.6), (0.16, 1.6), (0.1, 0.88)), _arc((0.46, 0.52), (0.5, 0.52), 128, -145)),
    "6": (_arc((0.5, 0.48), (0.48, 0.48), 90, 450), ((0.03, 0.5), (0.2, 1.1), (0.62, 1.6))),
    "7": (((0.0, 1.6), (1.0, 1.6), (0.36, 0.0)),),
    "8": (_arc((0.5, 1.21), (0.4, 0.39), -90, 270), _arc((0.5, 0.41), (0.5, 0.41), 90, 450)),
    "9": (_arc((0.5, 1.12), (0.48, 0.48), -90, 270), ((0.97, 1.1), (0.8, 0.5), (0.38, 0.0))),
    "-": (((0.15, 0.8), (0.85, 0.8)),),
    "+": (((0.1, 0.8), (0.9, 0.8)), ((0.5, 0.4), (0.5, 1.2))),
}


def _strokes(text: str) -> FloatArray:
    """Shape (M, 2, 2), the text's middle at the origin."""
    pieces = [
        np.add(stroke[k : k + 2], (place * ADVANCE, 0.0))
        for place, character in enumerate(text)
        for stroke in _GLYPHS[character]
        for k in range(len(stroke) - 1)
    ]
    if not pieces:
        return np.empty((0, 2, 2))
    width = (len(text) - 1) * ADVANCE + 1.0
    return np.array(pieces) - (width / 2, HEIGHT / 2)


def painted(
    number: int, place: tuple[float, float], up: tuple[float, float], *, size: float, stretch: float = 1.0
) -> FloatArray:
    """Strokes of ``number`` around ``place`` (east, north), its top towards the unit vector ``up``; shape (M, 2, 2).

    ``size`` is a digit's width in metres; ``stretch`` lengthens it along ``up``, as on roads, for a low eye.
    """
    flat = _strokes(str(number)) * (size, size * stretch)
    up_vector = np.array(up)
    right = np.array([up[1], -up[0]])
    return np.asarray(flat[..., :1] * right + flat[..., 1:] * up_vector + np.array(place))
