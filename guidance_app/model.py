"""The vocabulary: frozen records that travel from the wire to the pixel, and the driver's commands. No behaviour.

Frames and units, once for all: lengths in metres, times in seconds, angles in radians unless the name says
otherwise. Positions are (east, north) in the field frame (``geodesy.FieldFrame``). Headings turn clockwise from true
north. Roll is positive right side down, pitch positive nose up, yaw rate positive clockwise. Cross-track error is
positive when the guided point is right of the pass in the direction of travel. What may be missing is None.

Two clocks appear. ``arrival`` is the session clock: seconds since the session began, stamped by the source when the
bytes came in. ``t`` of a fix is the receiver's clock: seconds since midnight UTC of the day the stream began,
continuous over midnight; every ``dt`` of a filter is a difference of these.
"""

from dataclasses import dataclass, field
from enum import IntEnum, StrEnum

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Attitude",
    "Chunk",
    "Command",
    "Commanded",
    "CoverageTotals",
    "DropOffset",
    "Event",
    "Fix",
    "FixQuality",
    "FloatArray",
    "Guidance",
    "LineHere",
    "LinkState",
    "LinkStatus",
    "Measurement",
    "NoFix",
    "Nudge",
    "Observation",
    "OffsetKind",
    "OffsetRecord",
    "OnTheMark",
    "Pass",
    "Plan",
    "PlanCosts",
    "Pose",
    "Prediction",
    "Rejected",
    "ReverseDirection",
    "Segment",
    "SegmentKind",
    "SetLookAhead",
    "SetWork",
    "SetWorkMode",
    "SkipPass",
    "Snapshot",
    "SourceDown",
    "SourceUp",
    "Strip",
    "TakePass",
    "Trail",
    "TurnGuide",
    "WorkMode",
]

FloatArray = NDArray[np.float64]


# --- from the wire -------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Chunk:
    """Bytes as they came in. Empty bytes only tell the time, so that a half-received epoch can close."""

    arrival: float
    data: bytes
    link: str = "receiver"


class FixQuality(IntEnum):
    """GGA field 6. The numbers are those of the sentence."""

    NONE = 0
    AUTONOMOUS = 1
    DGPS = 2
    PPS = 3
    RTK_FIXED = 4
    RTK_FLOAT = 5
    DEAD_RECKONING = 6
    MANUAL = 7
    SIMULATED = 8


@dataclass(frozen=True, slots=True)
class Fix:
    """One position of one epoch, with everything else the receiver said about that instant.

    ``cell`` is the receiver's rounding (north, east) in metres, from the number of decimals in the sentence;
    ``sigma`` the receiver's own estimate (north, east) from GST. ``course`` and ``speed`` are over ground, ``speed``
    never negative. ``heading`` is where the body points (dual antenna or compass), ``height`` is above the ellipsoid.
    ``utc`` is POSIX time, None until the stream has told its date.
    """

    t: float
    arrival: float
    latitude_deg: float
    longitude_deg: float
    quality: FixQuality
    utc: float | None = None
    cell: tuple[float, float] | None = None
    altitude: float | None = None
    geoid_separation: float | None = None
    satellites: int | None = None
    hdop: float | None = None
    sigma: tuple[float, float] | None = None
    speed: float | None = None
    course: float | None = None
    heading: float | None = None
    roll: float | None = None
    pitch: float | None = None
    yaw_rate: float | None = None
    correction_age: float | None = None
    second_antenna_deg: tuple[float, float] | None = None
    implement_down: bool | None = None

    @property
    def height(self) -> float | None:
        """Above the ellipsoid; None when altitude or geoid separation is unknown."""
        if self.altitude is None or self.geoid_separation is None:
            return None
        return self.altitude + self.geoid_separation


@dataclass(frozen=True, slots=True)
class Attitude:
    """One reading of an attitude sensor. ``t`` is the sensor's own UTC second of the day where it gives one."""

    arrival: float
    t: float | None = None
    heading: float | None = None
    roll: float | None = None
    pitch: float | None = None
    roll_rate: float | None = None
    pitch_rate: float | None = None
    yaw_rate: float | None = None
    link: str = "receiver"


@dataclass(frozen=True, slots=True)
class NoFix:
    """An epoch in which the receiver said that it has no position."""

    arrival: float
    t: float | None
    reason: str


@dataclass(frozen=True, slots=True)
class Rejected:
    """A line or an epoch that was not believed, and why. ``reason`` is one of few phrases, to be counted."""

    arrival: float
    line: str
    reason: str


Observation = Fix | Attitude | NoFix | Rejected


# --- estimation ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Measurement:
    """What one epoch holds, in the field frame, as a filter takes it. Missing is None, never zero.

    ``east``, ``north`` is the antenna's position; ``antenna`` its lever arm (forward, right, height) seen from the
    reference point, already turned by roll and pitch. ``cell`` is (east, north) here: the frame's own order.
    ``yaw_rate`` is the gyro's, positive clockwise. ``heading_sigma`` is how far ``heading`` may drift; None is a dual
    antenna's, which does not.
    """

    t: float
    arrival: float
    east: float
    north: float
    quality: FixQuality
    cell: tuple[float, float] | None = None
    sigma: tuple[float, float] | None = None
    speed: float | None = None
    course: float | None = None
    heading: float | None = None
    yaw_rate: float | None = None
    roll: float | None = None
    pitch: float | None = None
    antenna: tuple[float, float, float] = (0.0, 0.0, 0.0)
    heading_sigma: float | None = None


@dataclass(frozen=True, slots=True)
class Pose:
    """Where the reference point (centre of the rear axle, on the ground) is and how it moves.

    ``speed`` is negative in reverse. ``curvature`` is heading change per metre travelled forward, positive clockwise.
    ``covariance`` is (var east, cov, var north) in m2. ``heading_known`` is False until the tractor has moved enough
    for the heading to mean something; the screen then says "direction unknown: drive 2 m".
    """

    t: float
    arrival: float
    east: float
    north: float
    heading: float
    speed: float
    curvature: float = 0.0
    covariance: tuple[float, float, float] | None = None
    heading_sigma: float | None = None
    heading_known: bool = True
    standing: bool = False
    reverse: bool = False
    dead_reckoned: bool = False
    roll: float | None = None
    pitch: float | None = None

    @property
    def yaw_rate(self) -> float:
        """Heading change per second, positive clockwise."""
        return self.curvature * self.speed


@dataclass(frozen=True, slots=True)
class Prediction:
    """The pose after the look-ahead, and the arc that leads there. ``arc`` has shape (K, 2): east, north."""

    look_ahead_s: float
    pose: Pose
    arc: FloatArray = field(compare=False)
    cross_track: float | None = None
    heading_error: float | None = None


# --- guidance ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Pass:
    """One numbered line to drive. ``points`` has shape (N, 2): east, north, in the direction it was planned.

    ``number`` is the geometric number: with a plan 1..n from the starting side, without one 0 for the guidance line
    and positive to its right. ``order`` is the place in the driving order, from 0, None without a plan. A closed pass
    (a lap) returns to its first point, which is not repeated.
    """

    number: int
    points: FloatArray
    closed: bool = False
    endless: bool = False
    order: int | None = None
    lap: bool = False


@dataclass(frozen=True, slots=True)
class TurnGuide:
    """The turn that follows the target pass: how far away, and its path of shape (N, 2)."""

    distance: float
    seconds: float | None
    points: FloatArray = field(compare=False)
    fits: bool = True


@dataclass(frozen=True, slots=True)
class Guidance:
    """The guided point against the target pass. ``cross_track`` is positive right of the pass in travel direction.

    ``along_track`` runs from where the pass is entered in the present direction of travel; ``remaining`` is what is
    left to its end, None on an endless line. ``against`` says that the pass is driven against its points' order.
    """

    target: Pass
    cross_track: float
    heading_error: float
    along_track: float
    against: bool
    remaining: float | None = None
    next_number: int | None = None
    turn: TurnGuide | None = None
    on_pass: bool = False
    done: frozenset[int] = frozenset()
    count: int | None = None


class SegmentKind(StrEnum):
    """What a stretch of a plan is."""

    LAP = "lap"
    PASS = "pass"  # noqa: S105 - a pass of the field, not a password
    TURN = "turn"
    TRANSFER = "transfer"


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """One stretch of a plan in driving order. ``missing`` is by how many metres a turn does not fit, 0 if it fits.

    ``number`` is the geometric number of a pass or lap, unique over the plan: passes 1..n, then the laps and the sides
    of laps that are worked to a square corner; for turns and transfers it is that of the pass they lead to.
    ``reverse`` marks the backward leg of a fishtail.
    """

    kind: SegmentKind
    number: int
    points: FloatArray
    implement_down: bool
    length: float
    fits: bool = True
    missing: float = 0.0
    closed: bool = False
    reverse: bool = False


@dataclass(frozen=True, slots=True)
class PlanCosts:
    """What a plan costs. Lengths in metres, fractions of the field's (work fractions) or worked area (overlap)."""

    work_m: float
    idle_m: float
    turns: int
    tight_turns: int
    minutes: float
    worked_fraction: float
    overlap_fraction: float
    missed_m2: float


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """An operation's passes in driving order. ``mainland`` holds rings of shape (N, 2), outer first, a tuple a part."""

    method: str
    direction: float
    spacing: float
    segments: tuple[Segment, ...]
    mainland: tuple[tuple[FloatArray, ...], ...]
    costs: PlanCosts
    warnings: tuple[str, ...] = ()


# --- coverage and trail --------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Strip:
    """A bounded piece of worked ground: left and right edge of the implement, both of shape (N, 2), N at most 256.

    A strip with the same ``index`` only ever grows until it is ``sealed``; a sealed one never changes.
    """

    index: int
    left: FloatArray
    right: FloatArray
    pass_number: int | None
    sealed: bool


@dataclass(frozen=True, slots=True, eq=False)
class Trail:
    """What grows: sealed pieces in a shared append-only list, of which the first ``count`` belong to this snapshot.

    ``pieces`` are arrays of shape (N, 2) for the track and ``Strip`` for worked ground; ``open_piece`` is the one
    that still grows. A reader remembers how many it has seen and takes the rest.
    """

    pieces: list[FloatArray] | list[Strip]
    count: int
    open_piece: FloatArray | Strip | None


@dataclass(frozen=True, slots=True)
class CoverageTotals:
    """Areas in m2. ``left`` is None without a field. ``headland`` is the part of ``worked`` outside the mainland."""

    worked: float = 0.0
    overlap: float = 0.0
    left: float | None = None
    headland: float = 0.0
    distance: float = 0.0
    working_s: float = 0.0


# --- the driver's commands -----------------------------------------------------------------------------------------


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
    link: str = "receiver"
    ended: bool = False


@dataclass(frozen=True, slots=True)
class SourceUp:
    """A source has opened what it reads from."""

    arrival: float
    what: str
    link: str = "receiver"


Event = Chunk | Commanded | SourceDown | SourceUp


# --- all that is known now -----------------------------------------------------------------------------------------


class LinkStatus(StrEnum):
    """What the driver sees of a receiver's link."""

    CONNECTING = "connecting"
    NO_DATA = "no data"
    NO_SENTENCE = "data but no valid sentence"
    NO_FIX = "no fix"
    FIX = "fix"
    DOWN = "down"
    ENDED = "ended"


@dataclass(frozen=True, slots=True)
class LinkState:
    """The state of one link, since when, and in words why."""

    status: LinkStatus = LinkStatus.CONNECTING
    since: float = 0.0
    reason: str = ""
    last_data: float | None = None
    sentences: int = 0
    rejected: int = 0
    fixes: int = 0


@dataclass(frozen=True, slots=True)
class OffsetRecord:
    """An offset in force. ``east``, ``north`` for a position offset; ``metres`` to the right for a line offset."""

    kind: OffsetKind
    arrival: float
    metres: float = 0.0
    east: float = 0.0
    north: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """All that is known now. Replaced whole; reading one needs no lock.

    ``ground_version`` changes whenever field, passes or plan do, so that a reader compares numbers, not arrays.
    ``generation`` changes when time has jumped back (a seek): what was drawn of ``track`` and ``worked`` is void then.
    ``implement`` is the implement's own pose (east, north, heading) at its working point. ``origin_deg`` is the field
    frame's origin (latitude, longitude); ``field_rings`` the boundary and its exclusions, shape (N, 2) each, closed.
    """

    sequence: int
    arrival: float
    link: LinkState
    fix: Fix | None = None
    fix_interval: float | None = None
    attitude: Attitude | None = None
    pose: Pose | None = None
    implement: tuple[float, float, float] | None = None
    prediction: Prediction | None = None
    look_ahead_s: float = 1.5
    guidance: Guidance | None = None
    origin_deg: tuple[float, float] | None = None
    field_rings: tuple[FloatArray, ...] = ()
    passes: tuple[Pass, ...] = ()
    plan: Plan | None = None
    ground_version: int = 0
    generation: int = 0
    working: bool = False
    work_mode: WorkMode = WorkMode.AUTO
    totals: CoverageTotals = CoverageTotals()
    track: Trail | None = None
    worked: Trail | None = None
    offsets: tuple[OffsetRecord, ...] = ()
    filter_name: str = ""
    notices: tuple[str, ...] = ()
