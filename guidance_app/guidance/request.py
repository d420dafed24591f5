"""What a plan is asked for, and the sentence when there is none.

A plan's lines are the path of the **working centre**: the point of the rear axle's line that lies ``offset_right`` of
the tractor's middle. On it a pass is worked from end to end; the tractor itself runs ``offset_right`` to its left, and
the working point ``offset_back`` behind. What is checked against the boundary is body and implement.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType
from typing import Literal

from guidance_app.documents import Direction, Method
from guidance_app.language import message, sentence

__all__ = ["Body", "LastPass", "PlanError", "PlanRequest", "StartCorner", "driven_over"]

FRONT_OVERHANG = 0.8
"""Metres of bonnet or weights ahead of the front axle."""

TYRE_HALF_WIDTH = 0.3
"""Metres from a rear tyre's middle to its outer side."""

MAX_LAPS = 400
"""More laps than this are a typing error."""

StartCorner = Literal["nearest", "first-left", "first-right", "last-left", "last-right"]


class PlanError(ValueError):
    """There is no plan; the message is one sentence with the reason, for the driver."""


class LastPass(StrEnum):
    """What becomes of the part of the mainland that is narrower than the swath spacing."""

    OVERLAP = "overlap"  # spacing kept; the last pass laps over the headland
    EVEN = "even"  # all passes a little closer, so that the last one fits
    GAP = "gap"  # spacing kept; a rest narrower than half of it stays unworked


@dataclass(frozen=True, slots=True)
class Body:
    """What must stay inside, in metres from the rear axle: forward, and to either side of the tractor's middle.

    The implement reaches from ``implement_rear`` to ``implement_front``, both measured forward, so negative behind the
    axle; its middle lies ``offset_right`` of the tractor's.
    """

    front: float
    half_width: float
    implement_front: float
    implement_rear: float
    implement_half_width: float
    offset_right: float = 0.0


@dataclass(frozen=True, slots=True)
class PlanRequest:
    """The wishes for one plan. Metres, radians, seconds; ``heading`` is that of the passes when it is typed.

    ``line`` is an AB line whose offset is kept, ``edge_near`` a point near the edge that ``Direction.EDGE`` follows.
    ``laps`` goes before ``turning_space``; with neither the headland is as deep as a turn needs. ``passable`` names
    holes, from 0, that may be driven and worked over; ``over_exclusions`` says so of all.
    """

    width: float
    overlap: float = 0.0
    radius: float = 5.0
    offset_back: float = 1.5
    offset_right: float = 0.0
    length: float = 1.5
    wheelbase: float = 2.45
    track_width: float = 1.8
    method: Method = Method.ROUND_TRIP
    options: Mapping[str, float | int | str | bool] = field(default_factory=lambda: MappingProxyType({}))
    laps: int | None = None
    turning_space: float | None = None
    direction: Direction = Direction.LONGEST_EDGE
    heading: float | None = None
    line: tuple[tuple[float, float], tuple[float, float]] | None = None
    edge_near: tuple[float, float] | None = None
    start: tuple[float, float] | None = None
    start_corner: StartCorner = "nearest"
    exit: tuple[float, float] | None = None
    laps_first: bool = False
    laps_clockwise: bool = True
    square_corners: bool = True
    reverse_allowed: bool = True
    lengthen: bool = True
    leftovers: bool = True
    last_pass: LastPass = LastPass.OVERLAP
    passable: frozenset[int] = frozenset()
    over_exclusions: bool = False
    work_speed: float = 2.2
    turn_speed: float = 1.4
    stop_s: float = 3.0

    def __post_init__(self) -> None:
        """Raises ``PlanError`` for a number that no machine has."""
        for name, low, high in _BOUNDS:
            value = getattr(self, name)
            if not (math.isfinite(value) and low <= value <= high):
                msg = sentence(
                    "{name} is {value:g}, but must be from {low:g} to {high:g}",
                    name=_named(name),
                    value=value,
                    low=low,
                    high=high,
                )
                raise PlanError(msg)
        self._check_choices()

    def _check_choices(self) -> None:
        if self.overlap >= self.width:
            msg = sentence(
                "the overlap of {overlap:g} m is not less than the working width of {width:g} m",
                overlap=self.overlap,
                width=self.width,
            )
            raise PlanError(msg)
        if self.laps is not None and not 0 <= self.laps <= MAX_LAPS:
            msg = sentence("{laps} headland laps cannot be planned; 0 to {most} can", laps=self.laps, most=MAX_LAPS)
            raise PlanError(msg)
        if self.turning_space is not None and not 0 <= self.turning_space <= 1000:
            msg = sentence(
                "a turning space of {metres:g} m cannot be planned; 0 to 1000 m can", metres=self.turning_space
            )
            raise PlanError(msg)
        if self.heading is not None and not math.isfinite(self.heading):
            msg = sentence("the direction of the passes is not a number")
            raise PlanError(msg)
        if self.direction is Direction.TYPED and self.heading is None:
            msg = sentence("the direction of the passes is to be typed, but no angle is given")
            raise PlanError(msg)
        self._check_line()

    def _check_line(self) -> None:
        if self.direction is Direction.LINE and self.line is None:
            msg = sentence("the passes are to follow a guidance line, but none is given")
            raise PlanError(msg)
        if self.direction is Direction.EDGE and self.edge_near is None:
            msg = sentence("the passes are to follow an edge of the field, but none is tapped")
            raise PlanError(msg)
        if self.line is not None and not math.dist(*self.line) > 0.1:
            msg = sentence("the guidance line's two points are the same place, so it has no direction")
            raise PlanError(msg)
        for name in ("start", "exit", "edge_near"):
            point = getattr(self, name)
            if point is not None and not all(math.isfinite(value) for value in point):
                msg = sentence("{name} is not a place", name=_named(name))
                raise PlanError(msg)

    @property
    def spacing(self) -> float:
        """Swath spacing: working width less overlap."""
        return self.width - self.overlap

    @property
    def body(self) -> Body:
        """Tractor and implement as one outline."""
        half = self.length / 2
        return Body(
            front=self.wheelbase + FRONT_OVERHANG,
            half_width=self.track_width / 2 + TYRE_HALF_WIDTH,
            implement_front=half - self.offset_back,
            implement_rear=-half - self.offset_back,
            implement_half_width=self.width / 2,
            offset_right=self.offset_right,
        )

    @property
    def path_radius(self) -> float:
        """The tightest circle of the working centre for which the axle's middle keeps to the turning radius."""
        return self.radius + abs(self.offset_right)


_BOUNDS = (
    ("width", 0.1, 100.0),
    ("overlap", -5.0, 50.0),
    ("radius", 0.1, 500.0),
    ("offset_back", -20.0, 40.0),
    ("offset_right", -30.0, 30.0),
    ("length", 0.0, 40.0),
    ("wheelbase", 0.1, 15.0),
    ("track_width", 0.1, 10.0),
    ("work_speed", 0.05, 20.0),
    ("turn_speed", 0.05, 20.0),
    ("stop_s", 0.0, 60.0),
)


def driven_over(holes: int, passable: frozenset[int], *, all_of_them: bool) -> frozenset[int]:
    """The numbers, from 0, of the holes of a field that are driven and worked over."""
    return frozenset(range(holes)) if all_of_them else passable


PARTS: Mapping[str, str] = {
    "width": message("the working width"),
    "overlap": message("the overlap"),
    "radius": message("the turning radius"),
    "offset_back": message("the implement's distance behind the axle"),
    "offset_right": message("the implement's offset to the right"),
    "length": message("the implement's length"),
    "wheelbase": message("the wheelbase"),
    "track_width": message("the track width"),
    "work_speed": message("the speed at work"),
    "turn_speed": message("the speed in turns"),
    "stop_s": message("the time of a stop"),
    "start": message("the start"),
    "exit": message("the exit"),
    "edge_near": message("the place near the edge"),
}


def _named(name: str) -> str:
    """What a person calls a number of the request."""
    return sentence(PARTS[name])
