"""Photos and scanned maps that lie on the ground: where points of them are on earth."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from guidance_app.documents.base import Document, Name

__all__ = ["MatchedPoint", "PhotoMap"]


class MatchedPoint(BaseModel):
    """A point of the photo, in pixels right and down from its upper left corner, and its WGS 84 place in degrees."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    right: float = Field(ge=-100_000, le=100_000, allow_inf_nan=False)
    down: float = Field(ge=-100_000, le=100_000, allow_inf_nan=False)
    longitude_deg: float = Field(ge=-180, le=180, allow_inf_nan=False)
    latitude_deg: float = Field(ge=-89, le=89, allow_inf_nan=False)


class PhotoMap(Document):
    """A photo with its matched points; the picture itself lies beside it. Sizes are in pixels."""

    kind: Literal["map"] = "map"
    name: Name
    width: int = Field(ge=1, le=100_000)
    height: int = Field(ge=1, le=100_000)
    points: list[MatchedPoint] = Field(min_length=2, max_length=200)
