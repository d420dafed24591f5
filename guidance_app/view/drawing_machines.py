"""Pictures of tractor and implement with the numbers that a form asks for, made from the values as they are typed."""

import itertools
import math
from collections.abc import Callable, Mapping
from typing import Any

from guidance_app.language import Words
from guidance_app.view.drawing import ACCENT, Box, Drawing

__all__ = ["PICTURES", "Picture", "antenna_picture", "implement_picture", "turning_picture"]

Values = Mapping[str, Any]
Say = Callable[[float], str]
"""A length in metres as the screen says it."""

Picture = Callable[[Values, Words, Say], str]

REAR_WHEEL, FRONT_WHEEL = 0.8, 0.5
BONNET = 0.8
CAB_TOP = 2.7
WIDE, HIGH = 440.0, 190.0


def antenna_picture(values: Values, words: Words, say: Say) -> str:
    """The tractor from its left side and from behind, with the antenna where the form says."""
    drawing = Drawing(WIDE, HIGH, words("Where the antenna sits"))
    _from_the_side(drawing, values, say)
    _from_behind(drawing, values, say)
    drawing.words((140, HIGH - 7), words("side"), size=11)
    drawing.words((365, HIGH - 7), words("from behind"), size=11)
    return drawing.svg()


def _from_the_side(drawing: Drawing, values: Values, say: Say) -> None:
    base, forward, height = _number(values, "wheelbase"), _number(values, "antenna_forward"), _antenna_height(values)
    front = base + BONNET
    box = Box(
        (min(-2.1, forward - 1.2), -0.55), (max(front, forward) + 0.4, max(CAB_TOP, height) + 0.5), 4, 4, 268, 160
    )
    at = box.at
    _ground(drawing, box)
    body = [(-0.9, 0.7), (-0.9, 1.5), (0.75, 1.5), (0.75, 1.45), (front, 1.35), (front, 0.7)]
    drawing.shape([at(*one) for one in body])
    drawing.shape([at(*one) for one in ((-0.8, 1.5), (-0.65, CAB_TOP), (0.65, CAB_TOP), (0.8, 1.5))], opacity="0.15")
    _wheel(drawing, box, 0.0, REAR_WHEEL)
    _wheel(drawing, box, base, FRONT_WHEEL)
    drawing.line([at(0, 0), at(0, height)], dashed=True, opacity="0.5", thick=1)
    drawing.measure(at(0, height + 0.22), at(forward, height + 0.22), say(abs(forward)))
    drawing.measure(at(box.low[0] + 0.2, 0), at(box.low[0] + 0.2, height), say(height))
    drawing.measure(at(0, -0.3), at(base, -0.3), say(base), beside=-9)
    drawing.circle(at(forward, height), 6, fill=ACCENT)


def _from_behind(drawing: Drawing, values: Values, say: Say) -> None:
    track, right, height = _number(values, "track_width"), _number(values, "antenna_right"), _antenna_height(values)
    reach = max(track / 2 + 0.5, abs(right) + 0.4)
    box = Box((-reach, -0.55), (reach, max(CAB_TOP, height) + 0.5), 292, 4, 144, 160)
    at = box.at
    _ground(drawing, box)
    for middle in (-track / 2, track / 2):
        tyre = ((-0.22, 0.0), (0.22, 0.0), (0.22, 2 * REAR_WHEEL), (-0.22, 2 * REAR_WHEEL))
        drawing.shape([at(middle + x, y) for x, y in tyre], opacity="0.6")
    drawing.shape([at(*one) for one in ((-0.7, 0.9), (-0.6, CAB_TOP), (0.6, CAB_TOP), (0.7, 0.9))], opacity="0.2")
    drawing.line([at(0, 0), at(0, height)], dashed=True, opacity="0.5", thick=1)
    drawing.measure(at(0, height + 0.22), at(right, height + 0.22), say(abs(right)))
    drawing.measure(at(-track / 2, -0.3), at(track / 2, -0.3), say(track), beside=-9)
    drawing.circle(at(right, height), 6, fill=ACCENT)


def implement_picture(values: Values, words: Words, say: Say) -> str:
    """Tractor and implement from above, the tractor heading up."""
    width, right, length = (_number(values, one) for one in ("working_width", "offset_right", "length"))
    trailed = str(values.get("hitch")) == "trailed"
    hitch, drawbar = _number(values, "hitch_back"), _number(values, "drawbar")
    back = hitch + drawbar if trailed else _number(values, "offset_back")
    reach = max(abs(right) + width / 2, 1.2) * 1.05
    low = min(-back - length / 2 - 0.5, -1.5) - 0.08 * reach
    high = max(-back + length / 2, 3.4) + 0.5
    drawing = Drawing(WIDE, HIGH + 40, words("The implement from above"))
    box = Box((-reach, low), (reach, high), 24, 6, WIDE - 100, HIGH + 24)
    at = box.at
    _tractor_from_above(drawing, box)
    corners = [(right + x * width / 2, -back + y * length / 2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    drawing.shape([at(*one) for one in corners], fill=ACCENT, opacity="0.35")
    if trailed:
        drawing.line([at(0, 0), at(0, -hitch)], thick=3)
        drawing.line([at(0, -hitch), at(right, -back)], thick=2)
        drawing.circle(at(0, -hitch), 4, fill=ACCENT)
    else:
        drawing.line([at(0, 0), at(right, -back)], thick=3)
    drawing.line([at(0, 0), at(0, -back)], dashed=True, opacity="0.5", thick=1)
    edge = at(0, low)[1] - 4
    drawing.measure((at(right - width / 2, 0)[0], edge), (at(right + width / 2, 0)[0], edge), say(width), beside=10)
    beside = at(max(right + width / 2, 1.0), 0)[0] + 10
    _measure_back(drawing, box, beside, (0.0, hitch, back) if trailed else (0.0, back), say)
    if abs(right) > 0:
        drawing.measure(at(0, -back), at(right, -back), say(abs(right)))
    return drawing.svg()


def _measure_back(drawing: Drawing, box: Box, beside: float, marks: tuple[float, ...], say: Say) -> None:
    """Distances behind the axle, one after the other, on one upright line."""
    for first, second in itertools.pairwise(marks):
        drawing.measure((beside, box.at(0, -first)[1]), (beside, box.at(0, -second)[1]), say(abs(second - first)))


def turning_picture(values: Values, words: Words, say: Say) -> str:
    """The tightest circle of the rear axle's centre, from above."""
    radius = _number(values, "turning_radius")
    drawing = Drawing(WIDE, HIGH, words("The turning circle"))
    box = Box((-radius - 1.5, -radius - 0.5), (radius + 1.5, max(radius, 3.4) + 0.5), 4, 4, WIDE - 8, HIGH - 8)
    at = box.at
    drawing.circle(at(0, 0), radius * box.scale, stroke=ACCENT)
    moved = Box((box.low[0] + radius, box.low[1]), (box.high[0] + radius, box.high[1]), 4, 4, WIDE - 8, HIGH - 8)
    _tractor_from_above(drawing, moved)
    drawing.measure(at(0, 0), at(-radius, 0), say(radius))
    drawing.circle(at(0, 0), 3, fill=ACCENT)
    return drawing.svg()


def _tractor_from_above(drawing: Drawing, box: Box) -> None:
    """Its rear axle at the origin, heading up."""
    at = box.at
    for x, y, half_width, half_length in ((-0.9, 0, 0.22, 0.8), (0.9, 0, 0.22, 0.8), (-0.75, 2.4, 0.15, 0.5)):
        _rectangle(drawing, box, (x, y), (half_width, half_length), "0.6")
    _rectangle(drawing, box, (0.75, 2.4), (0.15, 0.5), "0.6")
    drawing.shape([at(*one) for one in ((-0.45, -0.5), (0.45, -0.5), (0.4, 3.2), (-0.4, 3.2))], opacity="0.3")
    drawing.line([at(-0.9, 0), at(0.9, 0)], thick=2)


def _rectangle(
    drawing: Drawing, box: Box, middle: tuple[float, float], half: tuple[float, float], opacity: str
) -> None:
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    points = [box.at(middle[0] + x * half[0], middle[1] + y * half[1]) for x, y in corners]
    drawing.shape(points, opacity=opacity)


def _ground(drawing: Drawing, box: Box) -> None:
    drawing.line([box.at(box.low[0], 0), box.at(box.high[0], 0)], opacity="0.4", thick=1)


def _wheel(drawing: Drawing, box: Box, x: float, radius: float) -> None:
    drawing.circle(box.at(x, radius), radius * box.scale, fill="var(--mantine-color-body)", stroke="currentColor")
    drawing.circle(box.at(x, radius), 2.5, fill="currentColor")


def _antenna_height(values: Values) -> float:
    return max(0.0, _number(values, "antenna_height"))


def _number(values: Values, member: str) -> float:
    """The value, kept within what can be drawn while somebody types."""
    value = float(values.get(member) or 0.0)
    return min(max(value, -100.0), 100.0) if math.isfinite(value) else 0.0


PICTURES: Mapping[str, Picture] = {
    "antenna": antenna_picture,
    "turning": turning_picture,
    "implement": implement_picture,
}
"""By the name that a number's ``picture`` gives."""
