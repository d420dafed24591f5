"""A drive for other programs: one format a file here, found by its name in ``DRIVE_WRITERS``.

A writer is pure: it takes one ``DriveExport`` and gives the bytes of one file (an archive where the format has many).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from guidance_app.exchange.drives import (
    csv_table,
    geojson_drive,
    gpx_track,
    isoxml_drive,
    kml_drive,
    nmea_log,
    shapefile_layers,
)
from guidance_app.exchange.drives.record import DriveEpoch, DriveExport
from guidance_app.language import message

__all__ = ["DRIVE_WRITERS", "DriveEpoch", "DriveExport", "DriveFormat"]


@dataclass(frozen=True, slots=True)
class DriveFormat:
    """How a drive is written, with the ending of its file and what a person finds in it."""

    ending: str
    words: str
    write: Callable[[DriveExport], bytes]


DRIVE_WRITERS: Mapping[str, DriveFormat] = MappingProxyType(
    {
        "csv": DriveFormat(".csv", message("every epoch as a row: raw, filtered and predicted"), csv_table.written),
        "gpx": DriveFormat(".gpx", message("the track, raw and filtered"), gpx_track.written),
        "kml": DriveFormat(".kml", message("track, worked area and skips for Google Earth"), kml_drive.written),
        "geojson": DriveFormat(
            ".geojson", message("track with attributes, worked area and skips"), geojson_drive.written
        ),
        "shapefile": DriveFormat(
            ".zip", message("points with attributes, worked area and skips"), shapefile_layers.written
        ),
        "isoxml": DriveFormat(
            ".zip", message("task data with field, guidance lines and time log"), isoxml_drive.written
        ),
        "nmea": DriveFormat(".nmea", message("what the receiver said, as it came"), nmea_log.written),
    }
)
"""By the name that a person chooses."""
