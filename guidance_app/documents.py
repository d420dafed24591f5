"""What is saved: frozen pydantic models with a title, a unit and bounds on every number. No files here.

Every document carries ``schema_version`` of its kind; a newer one than this program knows is refused by the store.
Units stand in ``json_schema_extra`` so that a form can be made from the model alone, with ``labels`` for what may be
chosen and ``when`` for a member that matters only if another has a certain value. Lengths are metres, angles degrees
(this is a boundary), positions WGS 84 longitude and latitude in degrees as GeoJSON (RFC 7946) orders them.
"""

import itertools
import math
from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from guidance_app.language import message, sentence

__all__ = [
    "Direction",
    "Document",
    "FieldDocument",
    "Geometry",
    "HitchKind",
    "Implement",
    "Job",
    "LightBarSteps",
    "Method",
    "Operation",
    "Receiver",
    "Settings",
    "ShiftRecord",
    "Tractor",
    "Units",
    "choice",
    "quantity",
]


def quantity(  # noqa: PLR0913 - a form needs all of these, and a call names each
    title: str,
    unit: str,
    low: float,
    high: float,
    default: Any = ...,
    *,
    help: str = "",  # noqa: A002 - the form's own word for it
    step: float = 0.01,
    picture: str | None = None,
    when: tuple[str, Any] | None = None,
) -> Any:
    """A number field with a title, a unit and inclusive bounds; the form and the checks both come from it."""
    extra: dict[str, Any] = {"unit": unit, "step": step}
    if picture is not None:
        extra["picture"] = picture
    if when is not None:
        extra["when"] = when
    return Field(
        default,
        title=title,
        description=help,
        ge=low,
        le=high,
        allow_inf_nan=False,
        json_schema_extra=extra,
    )


def choice(
    title: str,
    default: Any,
    labels: Mapping[str, str],
    *,
    help: str = "",  # noqa: A002 - the form's own word for it
    when: tuple[str, Any] | None = None,
) -> Any:
    """A field whose values are those of ``labels``, which hold what a person reads for each."""
    extra: dict[str, Any] = {"labels": dict(labels)}
    if when is not None:
        extra["when"] = when
    return Field(default, title=title, description=help, json_schema_extra=extra)


def _clean_name(name: str) -> str:
    cleaned = " ".join(name.split())
    if not cleaned:
        raise ValueError(sentence("A name needs at least one character."))
    if any(ord(character) < 32 or ord(character) == 127 for character in cleaned):
        raise ValueError(sentence("A name cannot hold control characters."))
    return cleaned


Name = Annotated[str, Field(title="Name", max_length=120), AfterValidator(_clean_name)]


class Document(BaseModel):
    """What every saved document shares. Unknown members are refused: a typing error must not pass silently."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)

    schema_version: Literal[1] = 1


class Tractor(Document):
    """The tractor: its size, and where the antenna sits, seen from the centre of the rear axle on the ground."""

    kind: Literal["tractor"] = "tractor"
    name: Name
    wheelbase: float = quantity("Wheelbase", "m", 0.5, 8, 2.45, help="Rear axle to front axle")
    track_width: float = quantity("Track width", "m", 0.5, 5, 1.8, help="Centre to centre of the rear tyres")
    antenna_forward: float = quantity(
        "Antenna forward",
        "m",
        -10,
        10,
        0.0,
        help="Ahead of the rear axle; negative behind it",
        picture="antenna",
    )
    antenna_right: float = quantity(
        "Antenna right", "m", -5, 5, 0.0, help="Right of the middle; negative left of it", picture="antenna"
    )
    antenna_height: float = quantity("Antenna height", "m", 0, 6, 2.6, help="Above the ground", picture="antenna")
    roll_zero_deg: float = quantity(
        "Roll zero", "deg", -15, 15, 0.0, help="What the sensor shows when the tractor stands level", step=0.1
    )
    pitch_zero_deg: float = quantity(
        "Pitch zero",
        "deg",
        -15,
        15,
        0.0,
        help="What the sensor shows when the tractor stands level",
        step=0.1,
    )
    turning_radius: float = quantity(
        "Turning radius",
        "m",
        0.5,
        30,
        5.0,
        help="The tightest circle of the rear axle's centre",
        step=0.1,
        picture="turning",
    )


class HitchKind(StrEnum):
    """How the implement hangs on."""

    MOUNTED = "mounted"
    TRAILED = "trailed"


class Implement(Document):
    """The implement: how wide it works and where, seen from the centre of the rear axle."""

    kind: Literal["implement"] = "implement"
    name: Name
    working_width: float = quantity("Working width", "m", 0.3, 60, 3.0, step=0.01, picture="implement")
    overlap: float = quantity(
        "Overlap", "m", -2, 10, 0.0, help="Neighbouring passes share this much; negative leaves a gap"
    )
    offset_back: float = quantity(
        "Distance behind the axle",
        "m",
        -10,
        20,
        1.5,
        help="Negative for a front implement",
        picture="implement",
    )
    offset_right: float = quantity(
        "Offset to the right", "m", -10, 10, 0.0, help="Negative to the left", picture="implement"
    )
    length: float = quantity("Length", "m", 0, 30, 1.5, help="Front to back, for the headland and the picture")
    hitch: HitchKind = choice(
        "Hitch",
        HitchKind.MOUNTED,
        {HitchKind.MOUNTED: message("Mounted"), HitchKind.TRAILED: message("Trailed")},
        help="Mounted on the three-point linkage, or trailed on its own wheels",
    )
    hitch_back: float = quantity(
        "Hitch point behind the axle",
        "m",
        -2,
        5,
        0.8,
        help="Only for a trailed implement",
        picture="implement",
        when=("hitch", "trailed"),
    )
    drawbar: float = quantity(
        "Hitch to implement axle",
        "m",
        0.3,
        20,
        4.0,
        help="Only for a trailed implement",
        picture="implement",
        when=("hitch", "trailed"),
    )
    sections: int = Field(1, title="Sections", ge=1, le=64, description="Parts that switch one by one")

    @model_validator(mode="after")
    def _overlap_below_width(self) -> "Implement":
        if self.overlap >= self.working_width:
            raise PydanticCustomError("overlap", message("The overlap must be less than the working width."))
        return self

    @property
    def spacing(self) -> float:
        """Swath spacing: working width less overlap, in metres."""
        return self.working_width - self.overlap


class Receiver(Document):
    """Where positions come from and what is done with them."""

    kind: Literal["receiver"] = "receiver"
    name: Name
    source: str = Field("sim:", title="Source", max_length=300, description="Where the positions come from")
    attitude_source: str | None = Field(
        None,
        title="Attitude sensor",
        max_length=300,
        description="Only when it has a port of its own, in the same words as the source",
    )
    filter: str = Field("adaptive", title="Filter", max_length=40)
    filter_on: bool = Field(default=True, title="Filtering", description="Off: raw positions are guided along")
    measuring_time: float = quantity(
        "Measuring time at the start",
        "s",
        0,
        120,
        10.0,
        help="Standing at the start point; 0 leaves it out",
        step=1,
    )
    look_ahead: float = quantity(
        "Predict ahead", "s", 0.5, 3.0, 1.5, help="How far ahead the prediction bar looks", step=0.1
    )
    datum: Literal["world", "tokyo"] = choice(
        "Datum",
        "world",
        {"world": message("World"), "tokyo": message("Tokyo")},
        help="For coordinates that are typed and read",
    )
    projection: Literal["geographic", "utm", "plane rectangular"] = choice(
        "Coordinates",
        "geographic",
        {
            "geographic": message("Latitude, longitude"),
            "utm": message("UTM"),
            "plane rectangular": message("Plane rectangular"),
        },
        help="As they are typed and read; the zone follows from the place",
    )


Position = tuple[float, float]
MAX_VERTICES = 100_000


def _ring(ring: list[Position]) -> list[Position]:
    if len(ring) < 4 or ring[0] != ring[-1]:
        msg = "a ring needs at least three corners and ends where it began"
        raise ValueError(msg)
    for longitude, latitude in ring:
        if not (math.isfinite(longitude) and math.isfinite(latitude)):
            msg = "a corner is not a number"
            raise ValueError(msg)
        if not (-180 <= longitude <= 180 and -90 <= latitude <= 90):
            msg = (
                f"corner {longitude:g}, {latitude:g} is not a longitude and latitude in degrees"
                " (metres belong into the plane coordinate form)"
            )
            raise ValueError(msg)
    return ring


def _drop_height(ring: Any) -> Any:
    """GeoJSON positions may carry a height; a field's boundary has none."""
    if isinstance(ring, (list, tuple)):
        return [tuple(point[:2]) if isinstance(point, (list, tuple)) else point for point in ring]
    return ring


Ring = Annotated[list[Position], BeforeValidator(_drop_height), Field(max_length=MAX_VERTICES), AfterValidator(_ring)]


class Geometry(BaseModel):
    """A GeoJSON polygon: outer ring first, then exclusions."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    type: Literal["Polygon"] = "Polygon"
    coordinates: list[Ring] = Field(min_length=1, max_length=1000)


class LineGeometry(BaseModel):
    """A GeoJSON line: A to B, or a curve."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    type: Literal["LineString"] = "LineString"
    coordinates: list[Position] = Field(min_length=2, max_length=MAX_VERTICES)


class GuidanceLineDocument(BaseModel):
    """A stored guidance line of a field."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    type: Literal["ab", "a-plus", "curve", "pivot"] = "ab"
    geometry: LineGeometry


class ShiftRecord(BaseModel):
    """A move of a whole field, with when (ISO 8601) and why.

    ``east`` and ``north`` in metres, in the frame of ``origin`` (longitude, latitude), so that it can be taken back.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    when: str = Field(max_length=40)
    origin: Position
    east: float = Field(ge=-1000, le=1000, allow_inf_nan=False)
    north: float = Field(ge=-1000, le=1000, allow_inf_nan=False)
    reason: str = Field("", max_length=200)


class FieldDocument(Document):
    """A field: its boundary with exclusions, and what a person calls it."""

    kind: Literal["field"] = "field"
    name: Name
    boundary: Geometry
    entrance: Position | None = Field(None, title="Entrance")
    lines: list[GuidanceLineDocument] = Field(default_factory=list, max_length=200)
    notes: str = Field("", title="Notes", max_length=4000)
    shifts: list[ShiftRecord] = Field(default_factory=list, max_length=1000)


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
        },
    )
    direction_deg: float = quantity(
        "Heading", "deg", 0, 360, 0.0, step=0.1, help="Clockwise from north", when=("direction", "typed")
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
    reverse_allowed: bool = Field(default=True, title="The tractor may back up in a turn")
    options: dict[str, float | int | str | bool] = Field(default_factory=dict, title="Options of the method")
    product: str = Field("", title="Product", max_length=200)
    driver: str = Field("", title="Driver", max_length=200)


class Units(StrEnum):
    """What the screen counts in; inside everything stays metric."""

    METRIC = "metric"
    IMPERIAL = "imperial"
    JAPANESE = "japanese"
    """Metric, areas in ares."""
    TAN = "tan"
    """Metric, areas in tan and chō."""


LightBarSteps = tuple[float, float, float, float, float, float, float, float]


class Settings(Document):
    """What the driver has chosen for the screen."""

    kind: Literal["settings"] = "settings"
    units: Units = choice(
        "Units",
        Units.METRIC,
        {
            Units.METRIC: message("Metric"),
            Units.IMPERIAL: message("Imperial"),
            Units.JAPANESE: message("Metric, areas in ares"),
            Units.TAN: message("Metric, areas in tan and chō"),
        },
    )
    language: Literal["en", "ja", "es"] = choice("Language", "en", {"en": "English", "ja": "日本語", "es": "Español"})
    light_bar_steps: LightBarSteps = Field((0.02, 0.05, 0.10, 0.20, 0.30, 0.50, 0.75, 1.00), title="Light bar steps")
    night: bool = Field(default=False, title="Night")
    sounds: bool = Field(default=True, title="Sounds")
    guide_implement: bool = Field(default=False, title="Guide the implement instead of the tractor")

    @model_validator(mode="after")
    def _steps_grow(self) -> "Settings":
        steps = self.light_bar_steps
        grows = all(low < high for low, high in itertools.pairwise(steps))
        if not grows or steps[0] < 0.005 or steps[-1] > 10:
            raise PydanticCustomError(
                "light_bar_steps",
                message("Each step of the light bar must be larger than the one before, from 0.5 cm to 10 m."),
            )
        return self


class Job(BaseModel):
    """The documents of one session, as they are when it starts. ``field`` is None when none is chosen."""

    model_config = ConfigDict(frozen=True)

    tractor: Tractor
    implement: Implement
    receiver: Receiver
    field: FieldDocument | None = None
    operation: Operation | None = None
    settings: Settings = Settings()
