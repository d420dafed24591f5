"""The field: its boundary with exclusions, its guidance lines, and where it is entered."""

import math
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from guidance_app.documents.base import Document, Name

__all__ = [
    "MAX_VERTICES",
    "FieldDocument",
    "Geometry",
    "GuidanceLineDocument",
    "LineGeometry",
    "Place",
    "Position",
    "Ring",
    "ShiftRecord",
]

Position = tuple[float, float]
MAX_VERTICES = 100_000


def _place(position: Position) -> Position:
    longitude, latitude = position
    if not (math.isfinite(longitude) and math.isfinite(latitude)):
        msg = "a corner is not a number"
        raise ValueError(msg)
    if not (-180 <= longitude <= 180 and -90 <= latitude <= 90):
        msg = (
            f"corner {longitude:g}, {latitude:g} is not a longitude and latitude in degrees"
            " (metres belong into the plane coordinate form)"
        )
        raise ValueError(msg)
    return position


Place = Annotated[Position, AfterValidator(_place)]
"""A position that is checked to be one."""


def _ring(ring: list[Position]) -> list[Position]:
    if len(ring) < 4 or ring[0] != ring[-1]:
        msg = "a ring needs at least three corners and ends where it began"
        raise ValueError(msg)
    return [_place(position) for position in ring]


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
