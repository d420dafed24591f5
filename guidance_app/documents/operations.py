"""The operation: how a field is worked, with which machines."""

from enum import StrEnum
from typing import Literal

from pydantic import Field, JsonValue

from guidance_app.documents.base import Document, Name, choice, quantity
from guidance_app.documents.ground import Place
from guidance_app.language import message

__all__ = ["Direction", "Method", "Operation"]


class Method(StrEnum):
    """The operation methods of Inoue et al., and none for driving along a line without a plan."""

    ROUND_TRIP = "round-trip"
    TRANSFER = "transfer"
    INTERMEDIATE_DIVISION = "intermediate-division"
    SURROUNDING = "surrounding"
    LINE = "line"


class Direction(StrEnum):
    """How the direction of the passes is found when it is not typed."""

    BEST = "best"
    LONGEST_EDGE = "longest-edge"
    TYPED = "typed"
    LINE = "line"
    EDGE = "edge"


_WITH_PASSES: list[JsonValue] = [str(Method.ROUND_TRIP), str(Method.TRANSFER), str(Method.INTERMEDIATE_DIVISION)]
_PLANNED: list[JsonValue] = [*_WITH_PASSES, str(Method.SURROUNDING)]


class Operation(Document):
    """A saved job on a field."""

    kind: Literal["operation"] = "operation"
    name: Name
    field: str = Field(title="Field", max_length=120)
    tractor: str = Field(title="Tractor", max_length=120)
    implement: str = Field(title="Implement", max_length=120)
    receiver: str | None = Field(None, title="Receiver", max_length=120)
    method: Method = choice(
        "Method",
        Method.ROUND_TRIP,
        {
            Method.ROUND_TRIP: message("Round trip"),
            Method.TRANSFER: message("Transfer"),
            Method.INTERMEDIATE_DIVISION: message("Intermediate division"),
            Method.SURROUNDING: message("Surrounding"),
            Method.LINE: message("Line without a plan"),
        },
    )
    direction: Direction = choice(
        "Direction of the passes",
        Direction.LONGEST_EDGE,
        {
            Direction.BEST: message("Best found"),
            Direction.LONGEST_EDGE: message("Longest edge"),
            Direction.TYPED: message("Typed"),
            Direction.LINE: message("Guidance line"),
            Direction.EDGE: message("Tapped edge"),
        },
    )
    direction_deg: float = quantity(
        "Heading", "deg", 0, 360, 0.0, step=0.1, help="Clockwise from north", when=("direction", "typed")
    )
    guidance_line: str = Field(
        "",
        title="Guidance line",
        max_length=120,
        description="Its name; empty: the field's first AB or A+ line",
        json_schema_extra={"when": ["direction", "line"]},
    )
    edge_at: Place | None = Field(
        None,
        title="Edge",
        description="A place on it; followed is the straight stretch of boundary or exclusion that is nearest",
        json_schema_extra={"when": ["direction", "edge"]},
    )
    last_pass: Literal["overlap", "even", "gap"] = choice(
        "Last pass",
        "overlap",
        {
            "overlap": message("Overlaps"),
            "even": message("All a little closer"),
            "gap": message("Left out when narrow"),
        },
        help="What becomes of a rest that is narrower than a pass",
        when=("method", _WITH_PASSES),
    )
    laps: int | None = Field(None, title="Headland laps", ge=0, le=20, description="Empty: as many as a turn needs")
    turning_space: float | None = Field(
        None,
        title="Turning space",
        ge=0,
        le=200,
        allow_inf_nan=False,
        description="Depth of the headland; empty: as deep as a turn needs",
        json_schema_extra={"unit": "m", "step": 0.5},
    )
    start_corner: Literal["nearest", "first-left", "first-right", "last-left", "last-right"] = choice(
        "Start corner",
        "nearest",
        {
            "nearest": message("Nearest to the entrance"),
            "first-left": message("First pass, left end"),
            "first-right": message("First pass, right end"),
            "last-left": message("Last pass, left end"),
            "last-right": message("Last pass, right end"),
        },
    )
    laps_first: bool = Field(default=False, title="Drive the headland first")
    laps_clockwise: bool = Field(
        default=True, title="Headland laps clockwise", json_schema_extra={"when": ["method", _PLANNED]}
    )
    end_at_entrance: bool = Field(
        default=False, title="End near the entrance", json_schema_extra={"when": ["method", _WITH_PASSES]}
    )
    over_exclusions: bool = Field(
        default=False, title="Drive and work over the exclusions", json_schema_extra={"when": ["method", _PLANNED]}
    )
    passable: list[Place] = Field(
        default_factory=list,
        max_length=1000,
        title="Passable exclusions",
        description="A place inside each exclusion that is driven and worked over; all others are driven around",
    )
    reverse_allowed: bool = Field(default=True, title="The tractor may back up in a turn")
    options: dict[str, float | int | str | bool] = Field(default_factory=dict, title="Options of the method")
    product: str = Field("", title="Product", max_length=200)
    driver: str = Field("", title="Driver", max_length=200)
