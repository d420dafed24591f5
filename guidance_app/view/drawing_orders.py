"""Pictures of the operation methods: a small field with its passes numbered in the order in which they are driven.

The order is the method's own, with the options of the form; nothing here knows what a method means.
"""

import math
from itertools import pairwise

from guidance_app.guidance.pattern import OperationMethod, PassOrder, PatternOptions
from guidance_app.language import Words
from guidance_app.view.drawing import ACCENT, Drawing

__all__ = ["PASSES", "line_picture", "method_picture"]

PASSES = 12
LAPS = 4
WIDE, HIGH = 220.0, 120.0
MARGIN, ENDS = 10.0, 24.0
"""Beside the passes, and above and below them for numbers and turns."""


def method_picture(method: OperationMethod, options: PatternOptions, words: Words) -> str:
    """How this method drives a field of ``PASSES`` passes, or of ``LAPS`` laps."""
    drawing = Drawing(WIDE, HIGH, words(method.title))
    if method.inward is not None:
        _laps(drawing, inward=method.laps_inward(options))
    else:
        _passes(drawing, method.pass_order(PASSES, options))
    return drawing.svg()


def line_picture(words: Words) -> str:
    """One line, and others beside it as they are needed."""
    drawing = Drawing(WIDE, HIGH, words("Line without a plan"))
    for number in range(-2, 3):
        x = WIDE / 2 + 34.0 * number
        drawing.line([(x - 10, HIGH - 14), (x + 10, 14)], dashed=number != 0, opacity="1" if number == 0 else "0.5")
    drawing.arrow((WIDE / 2 - 10, HIGH - 14), (WIDE / 2 + 10, 14))
    return drawing.svg()


def _passes(drawing: Drawing, order: PassOrder) -> None:
    drawing.shape([(2, 2), (WIDE - 2, 2), (WIDE - 2, HIGH - 2), (2, HIGH - 2)], opacity="0.08")
    count = len(order.sequence)
    apart = (WIDE - 2 * MARGIN) / count
    low, high = HIGH - ENDS, ENDS
    across = [MARGIN + apart * (number + 0.5) for number in order.sequence]
    for place, x in enumerate(across):
        up = order.one_way or place % 2 == 0
        start, end = ((x, low), (x, high)) if up else ((x, high), (x, low))
        drawing.arrow(start, end, stroke="currentColor")
        drawing.words((x, HIGH - 7 if up else 7), str(place + 1), size=11, fill=ACCENT)
    for place, (first, second) in enumerate(pairwise(across)):
        if order.one_way:
            drawing.line([(first, high), (second, low)], dashed=True, stroke=ACCENT, thick=1)
        else:
            _turn(drawing, first, second, high if place % 2 == 0 else low)


def _turn(drawing: Drawing, first: float, second: float, end: float) -> None:
    """From one pass to the next around the end of the field; wide ones reach a little farther out."""
    out = math.copysign(min(4.0 + abs(second - first) / 12.0, 11.0), end - HIGH / 2)
    middle = (first + second) / 2
    half = abs(second - first) / 2
    bow = [(middle + math.copysign(half, first - second) * math.cos(t), end + out * math.sin(t)) for t in _HALF_CIRCLE]
    drawing.line(bow, stroke=ACCENT, thick=1)


_HALF_CIRCLE = tuple(math.pi * step / 12 for step in range(13))


def _laps(drawing: Drawing, *, inward: bool) -> None:
    drawing.shape([(2, 2), (WIDE - 2, 2), (WIDE - 2, HIGH - 2), (2, HIGH - 2)], opacity="0.08")
    step = (HIGH - 8) / 2 / LAPS
    for lap in range(LAPS):
        inset = 4 + step * (lap + 0.5)
        left, right, top, bottom = inset, WIDE - inset, inset, HIGH - inset
        drawing.line([(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)])
        drawing.arrow((right - 30, top), (left + 60, top), stroke="currentColor")
        place = lap + 1 if inward else LAPS - lap
        drawing.circle((left, HIGH / 2), 7, fill="var(--mantine-color-body)")
        drawing.words((left, HIGH / 2), str(place), size=11, fill=ACCENT)
