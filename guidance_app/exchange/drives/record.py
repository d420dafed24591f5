"""What a drive hands to other programs: every epoch as received, as filtered and as predicted, and the ground worked.

Angles are radians, lengths metres, speeds m/s, as everywhere inside; only latitudes and longitudes are degrees. What
is unknown is None.
"""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from guidance_app.documents import FieldDocument, Position

__all__ = ["LONGEST_GAP", "DriveEpoch", "DriveExport", "DrivePlace", "time_text", "tracks_of"]

LONGEST_GAP = 10.0
"""Seconds; a longer silence breaks a drawn track in two."""
Rings = tuple[tuple[Position, ...], ...]


@dataclass(frozen=True, slots=True)
class DrivePlace:
    """A position with the direction and speed there; ``heading`` is the body's, clockwise from true north."""

    latitude_deg: float
    longitude_deg: float
    heading: float | None = None
    speed: float | None = None


@dataclass(frozen=True, slots=True)
class DriveEpoch:
    """One epoch. ``raw`` is the antenna as received, with its course; ``filtered`` and ``predicted`` the rear axle.

    ``utc`` is POSIX time, None while the receiver had not told its date; ``t`` is the receiver's second. ``roll`` is
    positive right side down, ``pitch`` nose up, ``yaw_rate`` clockwise, each as the sensor said; ``cross_track`` is
    positive right of the pass in the direction of travel.
    """

    arrival: float
    t: float
    utc: float | None
    raw: DrivePlace
    filtered: DrivePlace | None
    predicted: DrivePlace | None
    quality: int
    satellites: int | None = None
    hdop: float | None = None
    altitude: float | None = None
    heading: float | None = None
    roll: float | None = None
    pitch: float | None = None
    yaw_rate: float | None = None
    pass_number: int | None = None
    cross_track: float | None = None
    predicted_cross_track: float | None = None
    working: bool = False


@dataclass(frozen=True, slots=True)
class DriveExport:
    """A drive for the writers. ``worked`` and ``skips`` are polygons of rings in degrees, as GeoJSON orders them.

    ``skips`` is empty without a field. Areas are in m2; ``overlap`` is what was worked twice. ``sentences`` are the
    receiver's own bytes.
    """

    name: str
    epochs: tuple[DriveEpoch, ...]
    sentences: bytes
    field: FieldDocument | None
    worked: tuple[Rings, ...]
    skips: tuple[Rings, ...]
    worked_area: float
    skipped_area: float | None
    overlap: float
    working_width: float
    tractor: str
    implement: str
    look_ahead_s: float


def time_text(epoch: DriveEpoch) -> str:
    """ISO 8601 with Z and milliseconds; only the time of day while the receiver had not told its date."""
    seconds = epoch.t if epoch.utc is None else epoch.utc
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(milliseconds=round(seconds * 1000))
    text = moment.isoformat(timespec="milliseconds")[: -len("+00:00")]
    return text.partition("T")[2] if epoch.utc is None else text + "Z"


def tracks_of(drive: DriveExport) -> list[list[DriveEpoch]]:
    """The epochs with a filtered position, cut where the drive was silent."""
    tracks: list[list[DriveEpoch]] = []
    for epoch in drive.epochs:
        if epoch.filtered is None:
            continue
        if not tracks or epoch.arrival - tracks[-1][-1].arrival > LONGEST_GAP:
            tracks.append([])
        tracks[-1].append(epoch)
    return tracks
