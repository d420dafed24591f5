"""A drive as the receiver's own sentences, byte for byte as they came: any program that reads NMEA reads it."""

from guidance_app.exchange.drives.record import DriveExport

__all__ = ["written"]


def written(drive: DriveExport) -> bytes:
    """The sentences."""
    return drive.sentences
