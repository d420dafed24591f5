"""Small pictures for forms, as SVG text: drawn in metres, in the colour of the words around them. Pure.

What is drawn are numbers and words of our own; words are escaped. Colours are the theme's, so that day and night need
nothing here; what a form asks for is drawn in ``ACCENT``.
"""

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

__all__ = ["ACCENT", "Box", "Drawing"]

ACCENT = "#e8590c"
"""Orange, as whatever is not stored yet."""
FAINT = "0.45"
HEAD = 5.0
"""Length of an arrow's head, in the picture's own pixels."""


@dataclass(frozen=True, slots=True)
class Box:
    """What of the world is to be seen, in metres, and where it goes in the picture, in pixels; y grows upward."""

    low: tuple[float, float]
    high: tuple[float, float]
    left: float
    top: float
    width: float
    height: float

    @property
    def scale(self) -> float:
        """Pixels to a metre, the same both ways."""
        across = max(self.high[0] - self.low[0], 1e-6)
        up = max(self.high[1] - self.low[1], 1e-6)
        return min(self.width / across, self.height / up)

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Where a place of the world is in the picture."""
        scale = self.scale
        spare_x = self.width - scale * (self.high[0] - self.low[0])
        return (
            self.left + spare_x / 2 + scale * (x - self.low[0]),
            self.top + self.height - scale * (y - self.low[1]),
        )


@dataclass(slots=True)
class Drawing:
    """Collects shapes; ``svg`` gives the picture. Every call takes pixels; ``Box.at`` makes them from metres."""

    width: float
    height: float
    label: str
    _parts: list[str] = field(default_factory=list)

    def line(
        self,
        points: Sequence[tuple[float, float]],
        *,
        stroke: str = "currentColor",
        thick: float = 1.6,
        dashed: bool = False,
        opacity: str = "1",
    ) -> None:
        """A line through all points."""
        way = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        dashes = ' stroke-dasharray="4 3"' if dashed else ""
        self._parts.append(
            f'<polyline points="{way}" fill="none" stroke="{stroke}" stroke-width="{thick:g}" opacity="{opacity}"'
            f' stroke-linejoin="round" stroke-linecap="round"{dashes}/>'
        )

    def shape(
        self, points: Sequence[tuple[float, float]], *, fill: str = "currentColor", opacity: str = "0.25"
    ) -> None:
        """A filled outline."""
        way = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self._parts.append(f'<polygon points="{way}" fill="{fill}" opacity="{opacity}"/>')

    def circle(self, centre: tuple[float, float], radius: float, *, fill: str = "none", stroke: str = "none") -> None:
        """A circle, filled or not."""
        self._parts.append(
            f'<circle cx="{centre[0]:.1f}" cy="{centre[1]:.1f}" r="{max(radius, 0.0):.1f}" fill="{fill}"'
            f' stroke="{stroke}" stroke-width="1.6"/>'
        )

    def words(
        self,
        at: tuple[float, float],
        text: str,
        *,
        size: float = 12,
        anchor: str = "middle",
        fill: str = "currentColor",
    ) -> None:
        """A word whose middle (or start, or end) is there."""
        self._parts.append(
            f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" font-size="{size:g}" text-anchor="{anchor}" fill="{fill}"'
            f' dominant-baseline="central">{html.escape(text)}</text>'
        )

    def arrow(self, start: tuple[float, float], end: tuple[float, float], *, stroke: str = ACCENT) -> None:
        """A line with a head at its end; none where both are the same place."""
        long = math.dist(start, end)
        if long < 1.0:
            return
        self.line([start, end], stroke=stroke)
        head = min(HEAD, long / 2)
        along = ((end[0] - start[0]) / long * head, (end[1] - start[1]) / long * head)
        base = (end[0] - along[0], end[1] - along[1])
        side = (-along[1] / 2, along[0] / 2)
        corners = [end, (base[0] + side[0], base[1] + side[1]), (base[0] - side[0], base[1] - side[1])]
        self.shape(corners, fill=stroke, opacity="1")

    def measure(self, start: tuple[float, float], end: tuple[float, float], text: str, *, beside: float = 9.0) -> None:
        """A measured distance: heads at both ends, the number beside its middle (above, or right of an upright one)."""
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        self.arrow(middle, start)
        self.arrow(middle, end)
        if abs(end[0] - start[0]) >= abs(end[1] - start[1]):
            self.words((middle[0], middle[1] - beside), text, fill=ACCENT)
        else:
            self.words((middle[0] + beside, middle[1]), text, anchor="start", fill=ACCENT)

    def svg(self) -> str:
        """The picture; as wide as where it stands, never wider than it was drawn."""
        name = html.escape(self.label, quote=True)
        return (
            f'<svg class="g-drawing" role="img" aria-label="{name}" viewBox="0 0 {self.width:g} {self.height:g}"'
            f' xmlns="http://www.w3.org/2000/svg">{"".join(self._parts)}</svg>'
        )
