"""A plan as JSON for other programs and as GeoJSON for a map; written, never read."""

from typing import Any

from guidance_app.geodesy import FieldFrame
from guidance_app.model import Plan, Segment

__all__ = ["plan_as_geojson", "plan_as_json"]

DECIMALS = 9


def plan_as_json(plan: Plan, frame: FieldFrame, cpu_s: float) -> dict[str, Any]:
    """Segments in driving order with their points (longitude, latitude in degrees), costs, and warnings in words."""
    costs = plan.costs
    return {
        "method": plan.method,
        "segments": [
            {
                "kind": segment.kind.value,
                "number": segment.number,
                "implement_down": segment.implement_down,
                "fits": segment.fits,
                "missing_m": round(segment.missing, 3),
                "reverse": segment.reverse,
                "length_m": round(segment.length, 3),
                "points_lonlat": _lonlat(segment, frame),
            }
            for segment in plan.segments
        ],
        "costs": {
            "work_m": costs.work_m,
            "idle_m": costs.idle_m,
            "turns": costs.turns,
            "tight_turns": costs.tight_turns,
            "minutes": costs.minutes,
            "worked_fraction": costs.worked_fraction,
            "overlap_fraction": costs.overlap_fraction,
            "missed_m2": costs.missed_m2,
        },
        "warnings": list(plan.warnings),
        "cpu_s": cpu_s,
    }


def plan_as_geojson(plan: Plan, frame: FieldFrame) -> dict[str, Any]:
    """One line feature a segment, in driving order."""
    return {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "properties": {
                    "order": order,
                    "kind": segment.kind.value,
                    "number": segment.number,
                    "implement_down": segment.implement_down,
                    "fits": segment.fits,
                },
                "geometry": {"type": "LineString", "coordinates": _lonlat(segment, frame)},
            }
            for order, segment in enumerate(plan.segments)
        ],
    }


def _lonlat(segment: Segment, frame: FieldFrame) -> list[list[float]]:
    """The points; a closed lap ends where it began."""
    points = [[round(x, DECIMALS), round(y, DECIMALS)] for x, y in frame.lonlat_from_array(segment.points).tolist()]
    return [*points, points[0]] if segment.closed else points
