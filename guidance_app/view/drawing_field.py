"""A small picture of a field from above, north up: its boundary, and its exclusions, numbered.

An exclusion that is driven around is filled, a passable one is only an outline with dashes: it is not the colour alone.
"""

import math
from collections.abc import Collection, Mapping, Sequence

import shapely

from guidance_app.language import Words
from guidance_app.model import FloatArray
from guidance_app.view.drawing import Box, Drawing

__all__ = ["AROUND", "PASSABLE", "field_picture"]

WIDE, HIGH, MARGIN = 220.0, 150.0, 8.0
AROUND, PASSABLE = "#e03131", "#2f9e44"
DOT = 4.0
"""Pixels: a smaller exclusion is drawn as a dot of this radius, with its number beside it."""
ROOM = 12.0
"""Pixels from a number's middle to the next number's or dot's."""
BESIDE = tuple(
    (radius * math.sin(math.radians(turn)), -radius * math.cos(math.radians(turn)))
    for radius in (12.0, 22.0, 34.0, 46.0)
    for turn in range(60, 420, 30)
)
"""Where a number may stand beside its dot, the best place first."""
DIGITS = 12.0


_Spot = tuple[float, float]


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
    small: dict[int, _Spot] = {}
    for number, ring in enumerate(rings[1:]):
        spot = _exclusion(drawing, box, ring, number, over=number in passable)
        if spot is not None:
            small[number] = spot
    _numbers_beside(drawing, small)
    drawing.arrow((WIDE - 10, 34), (WIDE - 10, 16), stroke="currentColor")
    drawing.words((WIDE - 10, 9), words.within("north", "N"), size=11)
    return drawing.svg()


def _exclusion(drawing: Drawing, box: Box, ring: FloatArray, number: int, *, over: bool) -> _Spot | None:
    """Draws it; where its dot is, if it is too small to hold its number."""
    colour = PASSABLE if over else AROUND
    outline = [box.at(east, north) for east, north in ring]
    middle = shapely.Polygon(ring).representative_point()
    place = box.at(middle.x, middle.y)
    span = min(max(side) - min(side) for side in zip(*outline, strict=True))
    if span < 1.5 * DIGITS:
        drawing.circle(place, DOT, fill="none" if over else colour, stroke=colour)
        return place
    if not over:
        drawing.shape(outline, fill=colour, opacity="0.8")
    drawing.line([*outline, outline[0]], stroke=colour, dashed=over)
    drawing.words(place, str(number + 1), size=DIGITS, fill="currentColor" if over else "white")
    return None


def _numbers_beside(drawing: Drawing, dots: Mapping[int, _Spot]) -> None:
    """Each number beside its dot, where it covers no other; a line leads to one that stands farther off."""
    taken = list(dots.values())
    for number, (x, y) in dots.items():
        free = (
            (x + right, y + down)
            for right, down in BESIDE
            if MARGIN < x + right < WIDE - MARGIN
            and MARGIN < y + down < HIGH - MARGIN
            and all(math.dist((x + right, y + down), one) >= ROOM - 1e-9 for one in taken)
        )
        place = next(free, (x, y))
        taken.append(place)
        if math.dist(place, (x, y)) > ROOM + 1.0:
            part = DIGITS / 2 / math.dist(place, (x, y))
            drawing.line([(x, y), (place[0] + part * (x - place[0]), place[1] + part * (y - place[1]))], thick=0.7)
        drawing.words(place, str(number + 1), size=DIGITS)
