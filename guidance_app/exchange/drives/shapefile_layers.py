"""A drive as shapefiles in one archive: epochs as points with attributes, worked area, skips, and the field."""

import shapefile

from guidance_app.documents import Position
from guidance_app.exchange.drives.csv_table import cells_of
from guidance_app.exchange.drives.record import DriveExport, Rings
from guidance_app.exchange.shapefile_format import archive_of, layer, turned

__all__ = ["NAMES", "written"]

NAMES = (
    "time_utc", "arrival_s", "quality", "satellites", "hdop", "altitude", "raw_lat", "raw_lon", "raw_course",
    "raw_speed", "sens_head", "roll", "pitch", "yaw_rate", "filt_lat", "filt_lon", "filt_head", "filt_speed",
    "pred_lat", "pred_lon", "pred_head", "pred_speed", "pass", "cross_m", "pred_cross", "working",
)  # fmt: skip
"""The columns of the table in ten letters, which is all that a .dbf has room for."""


def written(drive: DriveExport) -> bytes:
    """The archive; layers without a shape are left out."""
    rows = []
    for epoch in drive.epochs:
        place = epoch.filtered or epoch.raw
        cells = zip(NAMES, cells_of(epoch), strict=True)
        record = {name: text if name == "time_utc" else float(text) if text else None for name, text in cells}
        rows.append(([[(place.longitude_deg, place.latitude_deg)]], record))
    files = layer("epochs", shapefile.POINT, rows)
    if drive.worked:
        files |= _area("worked", drive.worked, drive.worked_area)
    if drive.skips and drive.skipped_area is not None:
        files |= _area("skips", drive.skips, drive.skipped_area)
    if drive.field is not None:
        rings = _turned(drive.field.boundary.coordinates)
        files |= layer("field", shapefile.POLYGON, [(rings, {"name": drive.field.name})])
    return archive_of(files)


def _area(name: str, polygons: tuple[Rings, ...], area: float) -> dict[str, bytes]:
    rings = [ring for polygon in polygons for ring in _turned(polygon)]
    return layer(name, shapefile.POLYGON, [(rings, {"area_m2": round(area, 1)})])


def _turned(rings: "Rings | list[list[Position]]") -> list[list[Position]]:
    return [turned(list(ring), clockwise=number == 0) for number, ring in enumerate(rings)]
