"""Passes, the guidance along them, and whole plans."""

from dataclasses import dataclass, field
from enum import StrEnum

from guidance_app.model.arrays import FloatArray
from guidance_app.model.making import made_quickly

__all__ = [
    "Guidance",
    "Pass",
    "Plan",
    "PlanCosts",
    "Segment",
    "SegmentKind",
    "TurnGuide",
]


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


@made_quickly
@dataclass(frozen=True, slots=True)
class TurnGuide:
    """The turn that follows the target pass: how far away, and its path of shape (N, 2).

    ``driven`` marks the turn that leads to the target pass while the tractor is in it. It has a ``cross_track`` and a
    ``heading_error`` of the guided point against the path, seen the way the tractor points, and metres ``to_go``.
    """

    distance: float
    seconds: float | None
    points: FloatArray = field(compare=False)
    fits: bool = True
    driven: bool = False
    cross_track: float | None = None
    heading_error: float | None = None
    to_go: float | None = None


@made_quickly
@dataclass(frozen=True, slots=True)
class Guidance:
    """The guided point against the target pass. ``cross_track`` is positive right of the pass in travel direction.

    ``along_track`` runs from where the pass is entered in the present direction of travel; ``remaining`` is what is
    left to its end, None on an endless line. ``against`` says that the pass is driven against its points' order,
    ``mirrored`` that the right of line offsets (that of the guidance line) is the left in the direction of travel.
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
    mirrored: bool = False


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
    """An operation's passes in driving order. ``mainland`` holds rings of shape (N, 2), outer first, a tuple a part.

    ``finished`` holds the passes and laps that were done before the rest was planned again; they are not driven, and
    neither are they in the costs' distances.
    """

    method: str
    direction: float
    spacing: float
    segments: tuple[Segment, ...]
    mainland: tuple[tuple[FloatArray, ...], ...]
    costs: PlanCosts
    warnings: tuple[str, ...] = ()
    finished: tuple[Segment, ...] = ()
