"""The invented farm of the embedded sample: a field, a tractor, an implement, a receiver and an operation.

Nothing of it belongs to anybody. The field is made so that a round trip with the 6 m implement has eight passes.
"""

import math

from guidance_app.angles import east_north
from guidance_app.boundary import checked_boundary
from guidance_app.documents import (
    Direction,
    FieldDocument,
    Implement,
    Job,
    Method,
    Operation,
    Position,
    Receiver,
    Tractor,
)
from guidance_app.geodesy import FieldFrame

__all__ = ["sample_job"]

CORNER_DEG = (41.930, -4.870)
"""Latitude and longitude of the field's south-western corner."""

EDGE_HEADING = math.radians(24.0)
"""Of the long edges."""

OUTER = ((0, 0), (104, 1.7), (247, 0.3), (250, 83.6), (-4, 83.6), (5, 38))
"""Corners in metres: along the long edge, and to its right."""

TREES = ((238, 74), (241.5, 72.5), (244.5, 75), (244, 79), (240, 80), (237.5, 77.5))
"""A group of trees in the far right corner."""

ENTRANCE = (4.0, 10.0)


def sample_job() -> Job:
    """The sample's documents."""
    return Job(tractor=_tractor(), implement=_implement(), receiver=_receiver(), field=_field(), operation=_operation())


def _tractor() -> Tractor:
    return Tractor(
        name="Sample tractor",
        wheelbase=2.45,
        track_width=1.8,
        antenna_forward=0.3,
        antenna_height=2.6,
        turning_radius=5.0,
    )


def _implement() -> Implement:
    return Implement(name="Sample implement", working_width=6.0, overlap=0.0, offset_back=1.8, length=1.6, sections=4)


def _receiver() -> Receiver:
    return Receiver(name="Sample receiver", source="sim:")


def _field() -> FieldDocument:
    return FieldDocument(
        name="Sample field",
        boundary=checked_boundary([_ring(OUTER), _ring(TREES)]).geometry,
        entrance=_position(*ENTRANCE),
        notes="An invented field for the demonstration.",
    )


def _operation() -> Operation:
    return Operation(
        name="Round trip",
        field="Sample field",
        tractor="Sample tractor",
        implement="Sample implement",
        receiver="Sample receiver",
        method=Method.ROUND_TRIP,
        direction=Direction.LONGEST_EDGE,
        turning_space=18.0,
        reverse_allowed=False,
        product="Harrowing",
    )


def _ring(corners: tuple[tuple[float, float], ...]) -> list[Position]:
    ring = [_position(along, right) for along, right in corners]
    return [*ring, ring[0]]


def _position(along: float, right: float) -> Position:
    """Longitude and latitude in degrees, 9 decimals."""
    frame = FieldFrame(*CORNER_DEG)
    ahead, sideways = east_north(EDGE_HEADING), east_north(EDGE_HEADING + math.pi / 2)
    latitude, longitude = frame.degrees_from_east_north(
        along * ahead[0] + right * sideways[0], along * ahead[1] + right * sideways[1]
    )
    return round(longitude, 9), round(latitude, 9)
