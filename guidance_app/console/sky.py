"""The round sky of a receiver's page as SVG: north up, the zenith in the middle, rings at 30 and 60 degrees."""

import html
from collections.abc import Sequence

from guidance_app.view.receiver import SkyDot

__all__ = ["SKY_STYLE", "sky_svg"]

RADIUS = 100
MARGIN = 16
DOT = 8.5

SKY_STYLE = """<style>
.g-sky{display:block;width:min(100%,19em);margin:.2em auto .1em}
.g-sky circle.ring,.g-sky path{fill:none;stroke:var(--mantine-color-default-border);stroke-width:1}
.g-sky text{font-size:9px;text-anchor:middle;dominant-baseline:central;fill:var(--mantine-color-dimmed)}
.g-sky .dot text{font-size:6.6px;font-weight:650;fill:#fff}
.g-sky .good circle{fill:#2b8a3e}.g-sky .fair circle{fill:#b35c00}.g-sky .bad circle{fill:#c92a2a}
.g-sky .off circle{fill:none;stroke:#868e96;stroke-width:1.2;stroke-dasharray:2 1.5}
.g-sky .dot.off text{fill:var(--mantine-color-dimmed);font-weight:400}
</style>"""
"""Signal by colour; a satellite that is not tracked is an empty, dashed ring, so that it is not the colour alone."""


def sky_svg(dots: Sequence[SkyDot]) -> str:
    """The sky with its satellites; nothing without any."""
    if not dots:
        return ""
    box = RADIUS + MARGIN
    rings = "".join(f'<circle class="ring" r="{RADIUS * part / 3:.1f}"/>' for part in (1, 2, 3))
    cross = f'<path d="M-{RADIUS} 0H{RADIUS}M0 -{RADIUS}V{RADIUS}"/>'
    letters = "".join(
        f'<text x="{x * (RADIUS + 8)}" y="{y * (RADIUS + 8)}">{letter}</text>'
        for letter, x, y in (("N", 0, -1), ("E", 1, 0), ("S", 0, 1), ("W", -1, 0))
    )
    marks = "".join(_dot(dot) for dot in dots)
    view = f"{-box} {-box} {2 * box} {2 * box}"
    return f'<svg class="g-sky" viewBox="{view}" role="img">{rings}{cross}{letters}{marks}</svg>'


def _dot(dot: SkyDot) -> str:
    place = f"translate({dot.x * RADIUS:.1f} {dot.y * RADIUS:.1f})"
    return (
        f'<g class="dot {dot.level}" transform="{place}"><circle r="{DOT}"/><text>{html.escape(dot.label)}</text></g>'
    )
