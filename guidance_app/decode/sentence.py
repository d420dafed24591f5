"""What one sentence says, whatever its kind: a flat record in which everything that it does not say is None.

Only ``nmea.py`` makes these and only ``epoch.py`` joins them. Units are already ours (metres, seconds, radians,
metres a second) and signs too (roll right side down, pitch nose up, yaw rate clockwise).
"""

from dataclasses import dataclass

from guidance_app.model import FixQuality, Satellite
from guidance_app.model.making import made_quickly

__all__ = ["DecodeError", "InView", "Sentence"]


class DecodeError(Exception):
    """A line that is not believed; the text is the reason, one of few phrases, to be counted."""


@dataclass(frozen=True, slots=True)
class InView:
    """One of the ``count`` sentences in which a receiver tells a system's satellites, one round for each ``signal``."""

    system: str
    signal: str
    number: int
    count: int
    satellites: tuple[Satellite, ...]


@made_quickly
@dataclass(frozen=True, slots=True)
class Sentence:
    """One sentence, read strictly.

    ``kind`` is its key in the table of sentences. ``time`` is the UTC second of the day and ``date`` the days since
    1970. ``valid`` says whether the receiver stands by what it says: None when the sentence has no word for that.
    ``quality`` is None where the sentence leaves it empty or has no such field. ``cell`` (north, east) in metres
    comes from the number of decimals. ``magnetic_heading`` wants ``declination`` (magnetic north seen from true
    north, positive east) to become a heading. ``imu_heading`` has an arbitrary zero. ``attitude_valid`` and
    ``heading_valid`` speak of the attitude sentences that follow in the same stream.
    """

    kind: str
    time: float | None = None
    date: int | None = None
    valid: bool | None = None
    latitude_deg: float | None = None
    longitude_deg: float | None = None
    cell: tuple[float, float] | None = None
    quality: FixQuality | None = None
    altitude: float | None = None
    geoid_separation: float | None = None
    satellites: int | None = None
    hdop: float | None = None
    correction_age: float | None = None
    sigma: tuple[float, float] | None = None
    speed: float | None = None
    course: float | None = None
    heading: float | None = None
    magnetic_heading: float | None = None
    declination: float | None = None
    imu_heading: float | None = None
    roll: float | None = None
    pitch: float | None = None
    roll_rate: float | None = None
    pitch_rate: float | None = None
    yaw_rate: float | None = None
    heading_valid: bool | None = None
    attitude_valid: bool | None = None
    in_view: InView | None = None

    @property
    def has_position(self) -> bool:
        """Whether a position is said that the receiver does not call invalid."""
        return self.latitude_deg is not None and self.valid is not False
