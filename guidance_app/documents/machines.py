"""The machines: tractor, implement and receiver."""

from enum import StrEnum
from typing import Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from guidance_app.documents.base import Document, Name, choice, quantity
from guidance_app.language import message

__all__ = ["HitchKind", "Implement", "Receiver", "Tractor"]


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
