"""What a person picks from a field with a finger: one of its edges, or some of its exclusions.

Operations keep places on earth, not numbers: an exclusion that is added or taken away later changes none of the others.
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import shapely
from shapely import Polygon

from guidance_app.angles import heading_between
from guidance_app.boundary import frame_of, polygon_in
from guidance_app.documents import FieldDocument, Position
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.direction import edges_of, nearest_edge
from guidance_app.model import FloatArray

__all__ = ["Picking", "edge_words", "picking_of", "places_in"]

DIGITS = 9
"""Of a degree: a tenth of a millimetre."""

LEAST_EDGE = 0.04
"""Part of the field's span from which on an edge is one to drive along."""


@dataclass(frozen=True, slots=True, eq=False)
class Picking:
    """A field in its own frame: ``rings`` without their closing corner, and ``edges`` of shape (N, 2, 2)."""

    frame: FieldFrame
    polygon: Polygon
    edges: FloatArray

    @property
    def rings(self) -> list[FloatArray]:
        """The boundary, then the exclusions; shape (N, 2) each."""
        return [shapely.get_coordinates(ring)[:-1] for ring in (self.polygon.exterior, *self.polygon.interiors)]

    @property
    def span(self) -> float:
        """Metres from corner to corner of the field's box."""
        west, south, east, north = self.polygon.bounds
        return math.hypot(east - west, north - south)

    def edge_at(self, east: float, north: float) -> Position:
        """Longitude and latitude of the middle of the edge nearest to this place: how an operation names an edge."""
        middle = self.edges[nearest_edge(self.edges, (east, north))].mean(axis=0)
        (lon, lat), *_ = self.frame.lonlat_from_array(middle.reshape(1, 2))
        return round(float(lon), DIGITS), round(float(lat), DIGITS)

    def edge_of(self, place: Position) -> FloatArray:
        """Both ends of the edge that an operation names so; shape (2, 2)."""
        at = self.frame.east_north_from_degrees(place[1], place[0])
        edge: FloatArray = self.edges[nearest_edge(self.edges, at)]
        return edge

    def longest_edges(self) -> list[Position]:
        """The edges along which one might drive, as operations name them, the longest first."""
        lengths = [math.dist(*edge) for edge in self.edges]
        least = min(LEAST_EDGE * self.span, max(lengths))
        long = (number for number, length in enumerate(lengths) if length >= least)
        order = sorted(long, key=lambda number: -lengths[number])
        return [self.edge_at(*self.edges[number].mean(axis=0)) for number in order]

    def exclusion_at(self, east: float, north: float, reach: float) -> int | None:
        """The number, from 0, of the exclusion that lies here or nearest within ``reach`` metres."""
        spot = shapely.Point(east, north)
        away = [Polygon(ring).distance(spot) for ring in self.polygon.interiors]
        nearest = min(range(len(away)), key=away.__getitem__, default=None)
        return nearest if nearest is not None and away[nearest] <= reach else None

    def exclusion_areas(self) -> list[float]:
        """Square metres of each exclusion."""
        return [Polygon(ring).area for ring in self.polygon.interiors]


def picking_of(field: FieldDocument) -> Picking:
    """The field as it is to be picked from."""
    frame = frame_of(field.boundary)
    polygon = polygon_in(frame, field.boundary)
    return Picking(frame, polygon, edges_of(polygon))


def edge_words(edge: FloatArray) -> tuple[float, float]:
    """Length in metres and heading in degrees, 0 to 180, of an edge: an edge has no way round."""
    first, second = ((float(east), float(north)) for east, north in edge)
    return math.dist(first, second), math.degrees(heading_between(first, second)) % 180.0


def places_in(field: FieldDocument, numbers: Collection[int], known: Sequence[Position]) -> list[Position]:
    """A place inside each of these exclusions: one of the ``known`` ones where there is one."""
    places = []
    for number in sorted(numbers):
        hole = Polygon(field.boundary.coordinates[number + 1])
        middle = hole.representative_point()
        made = (round(middle.x, DIGITS), round(middle.y, DIGITS))
        places.append(next((one for one in known if hole.covers(shapely.Point(one))), made))
    return places
