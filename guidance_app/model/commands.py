"""The driver's commands, and every event that an engine takes."""

from dataclasses import dataclass
from enum import StrEnum

from guidance_app.model.wire import RECEIVER, Chunk

__all__ = [
    "Command",
    "Commanded",
    "DropOffset",
    "Event",
    "LineHere",
    "Nudge",
    "OffsetKind",
    "OnTheMark",
    "ReverseDirection",
    "SetLookAhead",
    "SetWork",
    "SetWorkMode",
    "SkipPass",
    "SourceDown",
    "SourceUp",
    "TakePass",
    "WorkMode",
]


class WorkMode(StrEnum):
    """Who says when the implement works: the tractor on its pass, the driver's button, speed, or its own switch."""

    AUTO = "auto"
    BUTTON = "button"
    SPEED = "speed"
    SWITCH = "switch"


@dataclass(frozen=True, slots=True)
class SetWork:
    """Implement down or up, by the button."""

    down: bool


@dataclass(frozen=True, slots=True)
class SetWorkMode:
    """Who says when the implement works."""

    mode: WorkMode


@dataclass(frozen=True, slots=True)
class TakePass:
    """Guide along this pass next."""

    number: int


@dataclass(frozen=True, slots=True)
class SkipPass:
    """Leave the target pass for later and guide along the next."""


@dataclass(frozen=True, slots=True)
class ReverseDirection:
    """Drive the target pass the other way round."""


class OffsetKind(StrEnum):
    """The named offsets: of the line (nudge, shift, line here) and of the position (mark)."""

    NUDGE = "nudge"
    SHIFT = "shift"
    LINE_HERE = "line here"
    MARK = "mark"


@dataclass(frozen=True, slots=True)
class Nudge:
    """Move the guidance lines sideways by ``metres``, positive to the right in the direction of travel."""

    metres: float
    kind: OffsetKind = OffsetKind.NUDGE


@dataclass(frozen=True, slots=True)
class LineHere:
    """Move the guidance lines so that the target pass runs through the guided point."""


@dataclass(frozen=True, slots=True)
class OnTheMark:
    """The antenna's reference point stands on this known point: shift positions until told otherwise."""

    latitude_deg: float
    longitude_deg: float


@dataclass(frozen=True, slots=True)
class DropOffset:
    """Take back every offset of this kind."""

    kind: OffsetKind


@dataclass(frozen=True, slots=True)
class SetLookAhead:
    """Predict this many seconds ahead, 0.5 to 3; anything else raises ``ValueError``."""

    seconds: float

    def __post_init__(self) -> None:
        """Checks the bounds of Inoue et al."""
        if not 0.5 <= self.seconds <= 3.0:
            msg = f"look-ahead: {self.seconds:g} s is not from 0.5 to 3 s"
            raise ValueError(msg)


Command = (
    SetWork
    | SetWorkMode
    | TakePass
    | SkipPass
    | ReverseDirection
    | Nudge
    | LineHere
    | OnTheMark
    | DropOffset
    | SetLookAhead
)


@dataclass(frozen=True, slots=True)
class Commanded:
    """A command and when it was given, on the session clock."""

    arrival: float
    command: Command


@dataclass(frozen=True, slots=True)
class SourceDown:
    """A source broke or ended; failure is data. ``ended`` is the normal end of a file."""

    arrival: float
    reason: str
    link: str = RECEIVER
    ended: bool = False


@dataclass(frozen=True, slots=True)
class SourceUp:
    """A source has opened what it reads from."""

    arrival: float
    what: str
    link: str = RECEIVER


Event = Chunk | Commanded | SourceDown | SourceUp
