"""Plans as a picture: field, passes, laps, turns; what does not fit is red. Needs matplotlib (extra ``figures``)."""

import io
import math
from collections.abc import Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from shapely import Polygon

from guidance_app.model import Plan, SegmentKind

__all__ = ["picture_of_plans"]

COLOURS = {
    SegmentKind.PASS: "#1d7a3a",
    SegmentKind.LAP: "#2b5fa8",
    SegmentKind.TURN: "#c98a1b",
    SegmentKind.TRANSFER: "#8a5aa8",
}
UNFIT = "#d21f1f"
SIZE = 3.4


def picture_of_plans(plans: Sequence[tuple[str, Polygon, Plan]], kind: str) -> bytes:
    """The plans with their titles as a ``png`` or ``svg``, in a grid."""
    columns = max(1, math.ceil(math.sqrt(len(plans))))
    rows = max(1, math.ceil(len(plans) / columns))
    size = SIZE if len(plans) > 1 else 2.5 * SIZE
    with mpl.rc_context({"font.size": 7}):
        figure = Figure(figsize=(size * columns, size * rows), layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        for axis, (title, polygon, plan) in zip(axes, plans, strict=False):
            _draw(axis, title, polygon, plan)
        for axis in axes:
            axis.set_axis_off()
            axis.set_aspect("equal")
        file = io.BytesIO()
        figure.savefig(file, format=kind, dpi=150)
    return file.getvalue()


def _draw(axis: Axes, title: str, polygon: Polygon, plan: Plan) -> None:
    axis.fill(*polygon.exterior.xy, facecolor="#efe6d8", edgecolor="black", linewidth=0.6)
    for hole in polygon.interiors:
        axis.fill(*hole.xy, facecolor="white", edgecolor="black", linewidth=0.6)
    for segment in plan.segments:
        east, north = segment.points.T
        if segment.closed:
            east, north = [*east, east[0]], [*north, north[0]]
        colour = COLOURS[segment.kind] if segment.fits else UNFIT
        axis.plot(east, north, color=colour, linewidth=0.6)
    worked = 100 * plan.costs.worked_fraction
    axis.set_title(f"{title}: {worked:.1f} %, {plan.costs.turns} turns")
