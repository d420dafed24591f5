"""A drive as GPX: the filtered track of the rear axle and the raw track of the antenna, cut where it was silent."""

from collections.abc import Callable

from guidance_app.exchange.drives.record import DriveEpoch, DriveExport, DrivePlace, time_text, tracks_of
from guidance_app.exchange.xml_tree import written_text

__all__ = ["written"]


def written(drive: DriveExport) -> bytes:
    """GPX 1.1 with two tracks."""
    tracks = tracks_of(drive)
    filtered = _track(f"{drive.name}, filtered", tracks, lambda epoch: epoch.filtered)
    raw = _track(f"{drive.name}, raw", tracks, lambda epoch: epoch.raw)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<gpx version="1.1" creator="guidance-app" xmlns="http://www.topografix.com/GPX/1/1">\n'
        f"{filtered}{raw}</gpx>\n"
    ).encode()


def _track(name: str, tracks: list[list[DriveEpoch]], place_of: Callable[[DriveEpoch], DrivePlace | None]) -> str:
    segments = "".join(
        "<trkseg>\n" + "".join(_point(epoch, place) for epoch in track if (place := place_of(epoch))) + "</trkseg>\n"
        for track in tracks
    )
    return f"<trk><name>{written_text(name)}</name>\n{segments}</trk>\n"


def _point(epoch: DriveEpoch, place: DrivePlace) -> str:
    height = "" if epoch.altitude is None else f"<ele>{epoch.altitude:.3f}</ele>"
    when = "" if epoch.utc is None else f"<time>{time_text(epoch)}</time>"
    return f'<trkpt lat="{place.latitude_deg:.9f}" lon="{place.longitude_deg:.9f}">{height}{when}</trkpt>\n'
