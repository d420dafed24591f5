"""A drive as KML: the field, the track, the worked area and the skips."""

from collections.abc import Sequence

from guidance_app.documents import Position
from guidance_app.exchange.drives.record import DriveExport, tracks_of
from guidance_app.exchange.kml import coordinates_text, document_of, placemark

__all__ = ["written"]


def written(drive: DriveExport) -> bytes:
    """A placemark each for the field, the track, the worked area and the skips, as far as there are any."""
    lines = []
    for track in tracks_of(drive):
        corners = [(epoch.filtered.longitude_deg, epoch.filtered.latitude_deg) for epoch in track if epoch.filtered]
        if len(corners) > 1:
            lines.append(f"<LineString>{coordinates_text(corners)}</LineString>")
    marks = []
    if drive.field is not None:
        marks.append(placemark(drive.field.name, _polygon(drive.field.boundary.coordinates), {"kind": "field"}))
    if drive.worked:
        data = {"kind": "worked", "area_ha": f"{drive.worked_area / 1e4:.4f}"}
        marks.append(placemark("Worked area", _several([_polygon(one) for one in drive.worked]), data))
    if drive.skips and drive.skipped_area is not None:
        data = {"kind": "skips", "area_ha": f"{drive.skipped_area / 1e4:.4f}"}
        marks.append(placemark("Skips", _several([_polygon(one) for one in drive.skips]), data))
    if lines:
        marks.append(placemark("Track", _several(lines), {"kind": "track"}))
    return document_of(drive.name, marks)


def _polygon(rings: Sequence[Sequence[Position]]) -> str:
    outer, *holes = [f"<LinearRing>{coordinates_text(ring)}</LinearRing>" for ring in rings]
    inner = "".join(f"<innerBoundaryIs>{hole}</innerBoundaryIs>" for hole in holes)
    return f"<Polygon><outerBoundaryIs>{outer}</outerBoundaryIs>{inner}</Polygon>"


def _several(geometries: Sequence[str]) -> str:
    return geometries[0] if len(geometries) == 1 else f"<MultiGeometry>{''.join(geometries)}</MultiGeometry>"
