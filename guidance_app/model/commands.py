"""The driver's commands, and every event that an engine takes."""

import math
from dataclasses import dataclass
from enum import StrEnum

from guidance_app.model.wire import RECEIVER, Chunk

__all__ = [
    "POSITION_OFFSETS",
    "ApplyRollZero",
    "BeginInitialisation",
    "BeginLine",
    "BeginRollZero",
    "CancelRollZero",
    "Command",
    "Commanded",
    "DropLine",
    "DropOffset",
    "EndDrive",
    "EndLine",
    "Event",
    "FinishRollZero",
    "LineHere",
    "LineKind",
    "NextRollZeroDrive",
    "Nudge",
    "OffsetKind",
    "OnTheMark",
    "Pause",
    "ReplanRest",
    "Resume",
    "ReverseDirection",
    "SetLookAhead",
    "SetSection",
    "SetWork",
    "SetWorkMode",
    "SkipInitialisation",
    "SkipPass",
    "SourceDown",
    "SourceUp",
    "TakePass",
    "WorkMode",
]


class LineKind(StrEnum):
    """Guidance lines for driving without a plan, by their names in the table of line types."""

    AB = "ab"
    A_PLUS = "a-plus"
    CURVE = "curve"
    PIVOT = "pivot"
    FOLLOW = "last-pass"


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
    """The named offsets: of the line (nudge, shift, line here) and of the position (mark, initialisation)."""

    NUDGE = "nudge"
    SHIFT = "shift"
    LINE_HERE = "line here"
    MARK = "mark"
    INITIALISATION = "initialisation"


POSITION_OFFSETS = frozenset({OffsetKind.MARK, OffsetKind.INITIALISATION})


@dataclass(frozen=True, slots=True)
class Nudge:
    """Move the guidance lines sideways by ``metres``, positive to the right in the direction of travel."""

    metres: float
    kind: OffsetKind = OffsetKind.NUDGE

    def __post_init__(self) -> None:
        """Checks that it moves lines, by a number."""
        if self.kind in POSITION_OFFSETS or not math.isfinite(self.metres):
            msg = f"nudge: {self.metres:g} m ({self.kind}) does not move a line"
            raise ValueError(msg)


@dataclass(frozen=True, slots=True)
class LineHere:
    """Move the guidance lines so that the target pass runs through the guided point."""


@dataclass(frozen=True, slots=True)
class OnTheMark:
    """The antenna's reference point stands on this known point: shift positions until told otherwise."""

    latitude_deg: float
    longitude_deg: float

    def __post_init__(self) -> None:
        """Checks that it is a place on earth."""
        _check_place(self.latitude_deg, self.longitude_deg)


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


@dataclass(frozen=True, slots=True)
class BeginInitialisation:
    """The tractor stands: measure for the receiver's measuring time, on a known point where one is given."""

    latitude_deg: float | None = None
    longitude_deg: float | None = None

    def __post_init__(self) -> None:
        """Checks that it is a place on earth, or none."""
        if self.latitude_deg is None and self.longitude_deg is None:
            return
        if self.latitude_deg is None or self.longitude_deg is None:
            msg = "start point: give latitude and longitude, or neither"
            raise ValueError(msg)
        _check_place(self.latitude_deg, self.longitude_deg)


@dataclass(frozen=True, slots=True)
class SkipInitialisation:
    """Drive without waiting for the measuring time."""


@dataclass(frozen=True, slots=True)
class Pause:
    """Nothing counts as worked until ``Resume``; guidance stays."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Go on after a pause."""


@dataclass(frozen=True, slots=True)
class EndDrive:
    """End the drive for good: nothing counts from now on and nothing is guided."""


MOST_SECTIONS = 64


@dataclass(frozen=True, slots=True)
class SetSection:
    """Switch one section of the implement; 1 is the leftmost. A number below 1 or above 64 raises ``ValueError``."""

    number: int
    on: bool

    def __post_init__(self) -> None:
        """Checks the bounds of the implement document."""
        if not 1 <= self.number <= MOST_SECTIONS:
            msg = f"section: {self.number} is not from 1 to {MOST_SECTIONS}"
            raise ValueError(msg)


@dataclass(frozen=True, slots=True)
class ReplanRest:
    """Plan what is left again, from where the tractor is."""


@dataclass(frozen=True, slots=True)
class BeginLine:
    """A guidance line begins where the tractor is: ``ab``, ``curve`` and ``pivot`` are driven until ``EndLine``.

    ``a-plus`` (through here, in ``heading_deg`` or where the tractor points) and ``last-pass`` are there at once.
    """

    kind: LineKind
    heading_deg: float | None = None

    def __post_init__(self) -> None:
        """Checks the heading."""
        if self.heading_deg is not None and not 0 <= self.heading_deg <= 360:
            msg = f"heading: {self.heading_deg:g} degrees is not from 0 to 360"
            raise ValueError(msg)


@dataclass(frozen=True, slots=True)
class EndLine:
    """The guidance line that is driven ends here, and guides from now on."""


@dataclass(frozen=True, slots=True)
class DropLine:
    """The guidance line that is driven is given up; what guided before guides on."""


@dataclass(frozen=True, slots=True)
class BeginRollZero:
    """The first drive along a line begins, to find the roll sensor's zero."""


@dataclass(frozen=True, slots=True)
class NextRollZeroDrive:
    """The first drive is over; the second goes back along the same line."""


@dataclass(frozen=True, slots=True)
class FinishRollZero:
    """The second drive is over: compare both."""


@dataclass(frozen=True, slots=True)
class ApplyRollZero:
    """Use what was found from now on."""


@dataclass(frozen=True, slots=True)
class CancelRollZero:
    """Forget the drives and what was found."""


def _check_place(latitude_deg: float, longitude_deg: float) -> None:
    if not (-90.0 <= latitude_deg <= 90.0 and -180.0 <= longitude_deg <= 180.0):
        msg = f"{latitude_deg:g}, {longitude_deg:g} is not a latitude from -90 to 90 and a longitude from -180 to 180"
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
    | BeginInitialisation
    | SkipInitialisation
    | Pause
    | Resume
    | EndDrive
    | SetSection
    | ReplanRest
    | BeginLine
    | EndLine
    | DropLine
    | BeginRollZero
    | NextRollZeroDrive
    | FinishRollZero
    | ApplyRollZero
    | CancelRollZero
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
