"""All that is known now: the state of the link, the offsets in force, and the snapshot."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from guidance_app.model.arrays import FloatArray
from guidance_app.model.commands import LineKind, OffsetKind, WorkMode
from guidance_app.model.lines import Guidance, Pass, Plan
from guidance_app.model.making import made_quickly
from guidance_app.model.motion import Pose, Prediction
from guidance_app.model.session import Initialised, Initialising, RollZeroProgress, SessionState
from guidance_app.model.wire import Attitude, Fix, Satellite
from guidance_app.model.worked import CoverageTotals, Trail

__all__ = [
    "Ghost",
    "LineBegun",
    "LinkState",
    "LinkStatus",
    "OffsetRecord",
    "Snapshot",
]


class LinkStatus(StrEnum):
    """What the driver sees of a receiver's link."""

    CONNECTING = "connecting"
    NO_DATA = "no data"
    NO_SENTENCE = "data but no valid sentence"
    NO_FIX = "no fix"
    FIX = "fix"
    ATTITUDE = "attitude"
    """Of an attitude sensor's own link: readings arrive."""

    CORRECTED = "corrections"
    """Of a caster's link: it is connected."""

    DOWN = "down"
    ENDED = "ended"
    UNUSED = "not in use"
    """Nothing is driven, so no receiver is read."""


@dataclass(frozen=True, slots=True)
class LineBegun:
    """A guidance line that is being drawn by driving: from where, and how many metres of it there are.

    ``start`` is None for the first pass that the next ones will follow: it begins where the implement is lowered.
    """

    kind: LineKind
    start: tuple[float, float] | None = None
    metres: float = 0.0


@made_quickly
@dataclass(frozen=True, slots=True)
class LinkState:
    """The state of one link, since when, and in words why. ``what`` is what was opened, as its source calls it."""

    status: LinkStatus = LinkStatus.CONNECTING
    since: float = 0.0
    reason: str = ""
    last_data: float | None = None
    sentences: int = 0
    rejected: int = 0
    fixes: int = 0
    what: str = ""


@dataclass(frozen=True, slots=True)
class OffsetRecord:
    """An offset in force. ``east``, ``north`` for a position offset; ``metres`` to the right for a line offset."""

    kind: OffsetKind
    arrival: float
    metres: float = 0.0
    east: float = 0.0
    north: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Ghost:
    """The same drive as another filter, look-ahead or place of the antenna would have it; a replay shows it beside."""

    track: Trail | None = None
    pose: Pose | None = None
    guidance: Guidance | None = None
    prediction: Prediction | None = None
    filter_name: str = ""


@made_quickly
@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """All that is known now. Replaced whole; reading one needs no lock.

    ``ground_version`` changes whenever field, passes or plan do, so that a reader compares numbers, not arrays.
    ``generation`` changes when time has jumped back (a seek): what was drawn of ``track`` and ``worked`` is void then.
    ``implement`` is the implement's own pose (east, north, heading) at its working point. ``origin_deg`` is the field
    frame's origin (latitude, longitude); ``field_rings`` the boundary and its exclusions, shape (N, 2) each, closed.
    ``link`` is the receiver's; ``links_beside`` are the others by their name, as an attitude sensor's on its own port.
    ``sky`` are the satellites in view.
    ``initialising`` is there in that state alone; ``initialised`` is its last result. ``sections`` says which are
    switched on, the leftmost first; ``pass_totals`` is the work on the target pass, where ``left`` is what was driven
    by and not worked. ``roll_zero`` is a calibration under way; ``roll_zero_deg`` the zero in use. ``ghost`` is there
    in a replay that compares.
    ``line_begun`` is the guidance line that is being drawn by driving, None while there is none.
    """

    sequence: int
    arrival: float
    link: LinkState
    links_beside: Mapping[str, LinkState] = field(default_factory=dict)
    sky: tuple[Satellite, ...] = ()
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
    totals: CoverageTotals = field(default_factory=CoverageTotals)
    track: Trail | None = None
    worked: Trail | None = None
    offsets: tuple[OffsetRecord, ...] = ()
    filter_name: str = ""
    state: SessionState = SessionState.IDLE
    initialising: Initialising | None = None
    initialised: Initialised | None = None
    sections: tuple[bool, ...] = (True,)
    line_begun: LineBegun | None = None
    pass_totals: CoverageTotals | None = None
    roll_zero: RollZeroProgress | None = None
    roll_zero_deg: float = 0.0
    notices: tuple[str, ...] = ()
    ghost: Ghost | None = None
