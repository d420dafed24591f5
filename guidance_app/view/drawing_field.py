"""A small picture of a field from above, north up: its boundary, and its exclusions, numbered.

An exclusion that is driven around is filled, a passable one is only an outline with dashes: it is not the colour alone.
"""

from collections.abc import Collection, Sequence

import shapely

from guidance_app.language import Words
from guidance_app.model import FloatArray
from guidance_app.view.drawing import Box, Drawing

__all__ = ["AROUND", "PASSABLE", "field_picture"]

WIDE, HIGH, MARGIN = 220.0, 150.0, 8.0
AROUND, PASSABLE = "#e03131", "#2f9e44"
DOT = 8.0
"""Pixels: a smaller exclusion is drawn as a dot of this radius."""
DIGITS = 12.0


def field_picture(rings: Sequence[FloatArray], passable: Collection[int], words: Words) -> str:
    """The field of these rings in metres, the outer one first; ``passable`` counts from 0, the picture from 1."""
    drawing = Drawing(WIDE, HIGH, words("The field and its exclusions"))
    low, high = rings[0].min(axis=0), rings[0].max(axis=0)
    box = Box(
        (float(low[0]), float(low[1])),
        (float(high[0]), float(high[1])),
        *(MARGIN, MARGIN, WIDE - 2 * MARGIN, HIGH - 2 * MARGIN),
    )
    boundary = [box.at(east, north) for east, north in rings[0]]
    drawing.shape(boundary, opacity="0.12")
    drawing.line([*boundary, boundary[0]])
    for number, ring in enumerate(rings[1:]):
        _exclusion(drawing, box, ring, number, over=number in passable)
    drawing.arrow((WIDE - 10, 34), (WIDE - 10, 16), stroke="currentColor")
    drawing.words((WIDE - 10, 9), words.within("north", "N"), size=11)
    return drawing.svg()


def _exclusion(drawing: Drawing, box: Box, ring: FloatArray, number: int, *, over: bool) -> None:
    colour = PASSABLE if over else AROUND
    outline = [box.at(east, north) for east, north in ring]
    middle = shapely.Polygon(ring).representative_point()
    place = box.at(middle.x, middle.y)
    span = min(max(side) - min(side) for side in zip(*outline, strict=True))
    if span < 2 * DOT:
        drawing.circle(place, DOT, fill="var(--mantine-color-body)" if over else colour, stroke=colour)
    else:
        if not over:
            drawing.shape(outline, fill=colour, opacity="0.8")
        drawing.line([*outline, outline[0]], stroke=colour, dashed=over)
    drawing.words(place, str(number + 1), size=DIGITS, fill="currentColor" if over else "white")
