"""In which state a session is, and how far its two procedures are: initialisation and the roll sensor's zero."""

from dataclasses import dataclass
from enum import StrEnum

__all__ = [
    "Initialised",
    "Initialising",
    "RollZeroFound",
    "RollZeroProgress",
    "RollZeroStage",
    "SessionState",
]


class SessionState(StrEnum):
    """What the driver is about.

    Idle until the first position; initialising while the tractor stands for the measuring time; driving; paused
    (guidance stays, nothing counts as worked); ended, for good.
    """

    IDLE = "idle"
    INITIALISING = "initialising"
    DRIVING = "driving"
    PAUSED = "paused"
    ENDED = "ended"


@dataclass(frozen=True, slots=True)
class Initialised:
    """What standing at the start point has taught.

    ``east``, ``north`` is the correction in metres, None when no start point was known; ``scatter`` the fixes'
    standard deviation (east, north); ``gyro_bias`` in rad/s, positive clockwise, None without a gyro.
    """

    arrival: float
    samples: int
    seconds: float
    east: float | None
    north: float | None
    scatter: tuple[float, float]
    gyro_bias: float | None


@dataclass(frozen=True, slots=True)
class Initialising:
    """How far the measuring time is: ``done`` from 0 to 1; ``refused`` says why it has begun again."""

    done: float
    samples: int
    refused: str | None = None


class RollZeroStage(StrEnum):
    """Where the calibration of the roll sensor stands."""

    THERE = "there"
    BACK = "back"
    FOUND = "found"


@dataclass(frozen=True, slots=True)
class RollZeroFound:
    """A new roll zero for the tractor, by how much it differs, how sure it is, and over how many metres."""

    roll_zero_deg: float
    correction_deg: float
    sigma_deg: float
    metres: float


@dataclass(frozen=True, slots=True)
class RollZeroProgress:
    """The stage, the metres driven in each of both drives, and what was found in the last stage."""

    stage: RollZeroStage
    there: float = 0.0
    back: float = 0.0
    found: RollZeroFound | None = None
