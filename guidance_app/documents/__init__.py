"""What is saved: frozen pydantic models with a title, a unit and bounds on every number. No files here.

Every document carries ``schema_version`` of its kind; a newer one than this program knows is refused by the store.
Units stand in ``json_schema_extra`` so that a form can be made from the model alone, with ``labels`` for what may be
chosen and ``when`` for a member that matters only if another has a certain value. Lengths are metres, angles degrees
(this is a boundary), positions WGS 84 longitude and latitude in degrees as GeoJSON (RFC 7946) orders them.
"""

from pydantic import BaseModel, ConfigDict

from guidance_app.documents.base import Document, Name, choice, quantity
from guidance_app.documents.ground import (
    MAX_VERTICES,
    FieldDocument,
    Geometry,
    GuidanceLineDocument,
    LineGeometry,
    Place,
    Position,
    Ring,
    ShiftRecord,
)
from guidance_app.documents.machines import HitchKind, Implement, Receiver, Tractor
from guidance_app.documents.maps import MatchedPoint, PhotoMap
from guidance_app.documents.operations import Direction, Method, Operation
from guidance_app.documents.settings import LightBarSteps, Settings, Units

__all__ = [
    "MAX_VERTICES",
    "Direction",
    "Document",
    "FieldDocument",
    "Geometry",
    "GuidanceLineDocument",
    "HitchKind",
    "Implement",
    "Job",
    "LightBarSteps",
    "LineGeometry",
    "MatchedPoint",
    "Method",
    "Name",
    "Operation",
    "PhotoMap",
    "Place",
    "Position",
    "Receiver",
    "Ring",
    "Settings",
    "ShiftRecord",
    "Tractor",
    "Units",
    "choice",
    "quantity",
]


class Job(BaseModel):
    """The documents of one session, as they are when it starts. ``field`` is None when none is chosen."""

    model_config = ConfigDict(frozen=True)

    tractor: Tractor
    implement: Implement
    receiver: Receiver
    field: FieldDocument | None = None
    operation: Operation | None = None
    settings: Settings = Settings()
