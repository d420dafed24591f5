"""The ground to plan on: a valid, oriented polygon from whatever boundary was registered, or the reason why not."""

import numpy as np
import shapely
from shapely import Polygon

from guidance_app.guidance.clearance import parts_of
from guidance_app.guidance.request import PlanError, PlanRequest, driven_over
from guidance_app.language import sentence

__all__ = ["SMALLEST_FIELD", "ground_of"]

SMALLEST_FIELD = 10.0
"""Square metres; less is not a field."""

CRUMB = 1e-3
"""A second part smaller than this share of the field is a slip of the pen."""

VERTEX_TOLERANCE = 0.02
"""Metres by which a boundary may be smoothed before planning: below what a driver can hold."""

WIDEST = 1e5
"""Metres from the origin beyond which a place is not in the field frame."""


def ground_of(polygon: Polygon, request: PlanRequest) -> Polygon:
    """One polygon, outer ring counter-clockwise, without the holes that may be driven over. Raises ``PlanError``."""
    if polygon.is_empty:
        msg = sentence("the field has no boundary")
        raise PlanError(msg)
    corners = shapely.get_coordinates(polygon)
    if not (np.isfinite(corners).all() and np.abs(corners).max() < WIDEST):
        msg = sentence("the field's boundary has a corner that is not a place in the field")
        raise PlanError(msg)
    over = driven_over(len(polygon.interiors), request.passable, all_of_them=request.over_exclusions)
    holes = [ring for place, ring in enumerate(polygon.interiors) if place not in over]
    ground = _largest(Polygon(polygon.exterior, holes))
    smooth = shapely.simplify(ground, VERTEX_TOLERANCE)
    return shapely.orient_polygons(smooth if smooth.is_valid else ground)


def _largest(polygon: Polygon) -> Polygon:
    valid = polygon if polygon.is_valid else shapely.make_valid(polygon, method="structure")
    parts = sorted(parts_of(valid, 0.0), key=lambda part: part.area, reverse=True)
    if not parts or parts[0].area < SMALLEST_FIELD:
        msg = sentence("the field of {area:.1f} m2 is too small to work", area=valid.area)
        raise PlanError(msg)
    large = [part for part in parts if part.area > max(SMALLEST_FIELD, CRUMB * parts[0].area)]
    if len(large) > 1:
        sizes = " and ".join(f"{part.area / 1e4:.2f} ha" for part in large[:3])
        msg = sentence(
            "the field is in {count} parts ({sizes}): plan each as a field of its own", count=len(large), sizes=sizes
        )
        raise PlanError(msg)
    return parts[0]
