"""A plan drawn over one client's map: where it works, where it drives empty, and the turns that do not fit."""

from collections.abc import Sequence

from guidance_app.console.sketch import Sketch
from guidance_app.model import FloatArray, Segment
from guidance_app.view.colours import Rgb
from guidance_app.view.polyline import closed_ring

__all__ = ["draw_plan"]

WORKED: Rgb = (232, 89, 12)
EMPTY: Rgb = (112, 72, 190)
UNFIT: Rgb = (210, 20, 20)


def draw_plan(sketch: Sketch, segments: Sequence[Segment]) -> None:
    """Replaces what was drawn so before; no segments take it away."""
    sketch.strokes("worked", [_line(each) for each in segments if each.implement_down], WORKED, 3.0)
    sketch.strokes("empty", [_line(each) for each in segments if not each.implement_down and each.fits], EMPTY)
    sketch.strokes("unfit", [_line(each) for each in segments if not each.fits], UNFIT, 4.0)


def _line(segment: Segment) -> FloatArray:
    return closed_ring(segment.points) if segment.closed else segment.points
