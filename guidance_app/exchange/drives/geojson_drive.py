"""A drive as GeoJSON: a point with attributes for each epoch, the track as lines, worked area, skips and field."""

import json
from typing import Any

from guidance_app.exchange.drives.csv_table import COLUMNS, cells_of
from guidance_app.exchange.drives.record import DriveExport, tracks_of

__all__ = ["written"]

TEXTS = frozenset({"time_utc"})


def written(drive: DriveExport) -> bytes:
    """A FeatureCollection; the property ``kind`` is field, worked, skips, track or epoch."""
    features = []
    if drive.field is not None:
        features.append(_feature("field", drive.field.boundary.model_dump(), {"name": drive.field.name}))
    for kind, polygons, area in (
        ("worked", drive.worked, drive.worked_area),
        ("skips", drive.skips, drive.skipped_area),
    ):
        if polygons:
            geometry: dict[str, Any] = {"type": "MultiPolygon", "coordinates": polygons}
            features.append(_feature(kind, geometry, {"area_m2": None if area is None else round(area, 1)}))
    lines = [
        [(epoch.filtered.longitude_deg, epoch.filtered.latitude_deg) for epoch in track if epoch.filtered]
        for track in tracks_of(drive)
        if len(track) > 1
    ]
    if lines:
        features.append(_feature("track", {"type": "MultiLineString", "coordinates": lines}, {"name": drive.name}))
    for epoch in drive.epochs:
        place = epoch.filtered or epoch.raw
        values = {name: _value(name, text) for name, text in zip(COLUMNS, cells_of(epoch), strict=True)}
        point: dict[str, Any] = {"type": "Point", "coordinates": (place.longitude_deg, place.latitude_deg)}
        features.append(_feature("epoch", point, values))
    collection = {"type": "FeatureCollection", "features": features}
    return (json.dumps(collection, ensure_ascii=False) + "\n").encode()


def _feature(kind: str, geometry: dict[str, Any], properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "properties": {"kind": kind, **properties}, "geometry": geometry}


def _value(name: str, text: str) -> str | float | None:
    if name in TEXTS:
        return text
    return float(text) if text else None
