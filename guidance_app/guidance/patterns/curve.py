"""Curve: passes at a constant distance of a line that was driven."""

import numpy as np
import shapely

from guidance_app.guidance.family import GuidanceLineError, OffsetCurves
from guidance_app.guidance.line_type import LineType
from guidance_app.language import sentence
from guidance_app.model import FloatArray

__all__ = ["LINE", "curves_beside"]

SHORTEST = 5.0
"""Metres; less says no direction."""

THINNED = 0.01
"""How far the line that is followed may stay from the points that were driven."""


def curves_beside(points: FloatArray, spacing: float) -> OffsetCurves:
    """Beside the line through all points, thinned to 1 cm so that 10,000 points cost no more than their shape."""
    if len(points) < 2 or not np.isfinite(points).all():
        msg = sentence("a curve needs the points that were driven")
        raise GuidanceLineError(msg)
    line = shapely.LineString(points)
    if line.length < SHORTEST:
        msg = sentence(
            "the curve is {length:.1f} m long: drive at least {shortest:g} m", length=line.length, shortest=SHORTEST
        )
        raise GuidanceLineError(msg)
    return OffsetCurves(shapely.get_coordinates(shapely.simplify(line, THINNED, preserve_topology=False)), spacing)


LINE = LineType(
    name="curve",
    title="Curve",
    explanation="Passes beside a line that you drive, each at the same distance of the one before.",
    family=curves_beside,
)
