"""Changes to a field that exists: its corners, its exclusions, its place, one field made two. Pure; nothing is stored.

Each function gives a new document that has passed the same checks as a new field, or raises ``BoundaryError``.
Points are east and north in metres in the frame that is passed in.
"""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely.ops import split as cut_along

from guidance_app.boundary import BoundaryError, checked_boundary
from guidance_app.documents import FieldDocument, Geometry, Position, ShiftRecord
from guidance_app.geodesy import FieldFrame
from guidance_app.language import sentence
from guidance_app.model import FloatArray

__all__ = [
    "Corner",
    "moved_corner",
    "nearest_corner",
    "rings_in",
    "shifted",
    "split",
    "unshifted",
    "with_corner",
    "with_exclusion",
    "without_corner",
    "without_exclusion",
]

Corner = tuple[int, int]
"""Number of the ring (0 the boundary) and of the corner in it, from 0."""

LARGEST_SHIFT = 200.0
"""A shift repairs a datum or a season's offset; more than this many metres is a wrong corner."""


def rings_in(frame: FieldFrame, document: FieldDocument) -> list[FloatArray]:
    """Each ring without its closing corner, shape (N, 2)."""
    return [frame.array_from_lonlat(ring)[:-1] for ring in document.boundary.coordinates]


def nearest_corner(frame: FieldFrame, document: FieldDocument, point: tuple[float, float]) -> tuple[Corner, float]:
    """The corner nearest to ``point``, and how far it is, in metres."""
    found = []
    for number, ring in enumerate(rings_in(frame, document)):
        away = np.hypot(*(ring - np.asarray(point)).T)
        best = int(np.argmin(away))
        found.append(((number, best), float(away[best])))
    return min(found, key=lambda one: one[1])


def moved_corner(frame: FieldFrame, document: FieldDocument, corner: Corner, to: tuple[float, float]) -> FieldDocument:
    """The field with one corner somewhere else."""
    rings = rings_in(frame, document)
    rings[corner[0]][corner[1]] = to
    return _with_rings(frame, document, rings)


def with_corner(frame: FieldFrame, document: FieldDocument, point: tuple[float, float]) -> FieldDocument:
    """The field with one more corner, put into the edge that is nearest to it."""
    rings = rings_in(frame, document)
    spot = shapely.Point(point)
    places = [
        (shapely.LineString([ring[i], ring[(i + 1) % len(ring)]]).distance(spot), number, i)
        for number, ring in enumerate(rings)
        for i in range(len(ring))
    ]
    _, number, edge = min(places)
    rings[number] = np.insert(rings[number], edge + 1, point, axis=0)
    return _with_rings(frame, document, rings)


def without_corner(frame: FieldFrame, document: FieldDocument, corner: Corner) -> FieldDocument:
    """The field without this corner."""
    rings = rings_in(frame, document)
    if len(rings[corner[0]]) <= 3:
        msg = sentence("a ring needs three corners; take the whole exclusion away instead")
        raise BoundaryError(msg)
    rings[corner[0]] = np.delete(rings[corner[0]], corner[1], axis=0)
    return _with_rings(frame, document, rings)


def with_exclusion(
    frame: FieldFrame, document: FieldDocument, ring: Sequence[tuple[float, float]] | FloatArray
) -> FieldDocument:
    """The field with one more inner ring."""
    return _with_rings(frame, document, [*rings_in(frame, document), np.asarray(ring, dtype=float).reshape(-1, 2)])


def without_exclusion(document: FieldDocument, number: int) -> FieldDocument:
    """The field without its inner ring of this number, from 1."""
    rings = list(document.boundary.coordinates)
    if not 1 <= number < len(rings):
        msg = sentence("there is no exclusion {number}; the field has {count}", number=number, count=len(rings) - 1)
        raise BoundaryError(msg)
    del rings[number]
    return document.model_copy(update={"boundary": Geometry(coordinates=rings)})


def split(
    frame: FieldFrame, document: FieldDocument, line: Sequence[tuple[float, float]]
) -> tuple[FieldDocument, FieldDocument]:
    """Two fields along a line, which is lengthened at both ends to cross the whole field."""
    outer, *holes = rings_in(frame, document)
    polygon = shapely.Polygon(outer, holes)
    pieces = [
        piece for piece in cut_along(polygon, _lengthened(line, polygon)).geoms if isinstance(piece, shapely.Polygon)
    ]
    if len(pieces) != 2:
        msg = sentence("the line cuts the field into {count} parts, not two: draw it elsewhere", count=len(pieces))
        raise BoundaryError(msg)
    pieces.sort(key=lambda piece: -piece.area)
    made = []
    for number, piece in enumerate(pieces, start=1):
        rings = [shapely.get_coordinates(ring)[:-1] for ring in (piece.exterior, *piece.interiors)]
        name = f"{document.name[:110]} {number}"
        alone = document.model_copy(update={"name": name, "entrance": None})
        made.append(_with_rings(frame, alone, rings))
    return made[0], made[1]


def shifted(document: FieldDocument, east: float, north: float, when: str, reason: str) -> FieldDocument:
    """The field moved as a whole, with its lines and entrance, and the move written into it. ``when`` is ISO 8601."""
    if not (math.isfinite(east) and math.isfinite(north)) or math.hypot(east, north) > LARGEST_SHIFT:
        msg = sentence(
            "a shift of {metres:.0f} m is more than {most:.0f} m: is this the right corner of the right field?",
            metres=math.hypot(east, north),
            most=LARGEST_SHIFT,
        )
        raise BoundaryError(msg)
    origin = document.boundary.coordinates[0][0]
    moved = _moved(document, origin, east, north)
    record = ShiftRecord(when=when, origin=origin, east=east, north=north, reason=reason)
    return moved.model_copy(update={"shifts": [*document.shifts, record]})


def unshifted(document: FieldDocument) -> FieldDocument:
    """The field without its last shift."""
    if not document.shifts:
        msg = sentence("the field has not been shifted")
        raise BoundaryError(msg)
    last = document.shifts[-1]
    moved = _moved(document, last.origin, -last.east, -last.north)
    return moved.model_copy(update={"shifts": document.shifts[:-1]})


def _moved(document: FieldDocument, origin: Position, east: float, north: float) -> FieldDocument:
    """Every position so many metres farther east and north, in a frame at ``origin`` (longitude, latitude)."""
    frame = FieldFrame(origin[1], origin[0])

    def move(positions: Sequence[Position]) -> list[Position]:
        lonlat = frame.lonlat_from_array(frame.array_from_lonlat(positions) + np.array([east, north]))
        return [(round(float(lon), 9), round(float(lat), 9)) for lon, lat in lonlat]

    checked = checked_boundary([move(ring) for ring in document.boundary.coordinates])
    lines = [
        line.model_copy(
            update={"geometry": line.geometry.model_copy(update={"coordinates": move(line.geometry.coordinates)})}
        )
        for line in document.lines
    ]
    entrance = None if document.entrance is None else move([document.entrance])[0]
    return document.model_copy(update={"boundary": checked.geometry, "lines": lines, "entrance": entrance})


def _with_rings(frame: FieldFrame, document: FieldDocument, rings: Sequence[FloatArray]) -> FieldDocument:
    degrees = []
    for ring in rings:
        lonlat = [(float(lon), float(lat)) for lon, lat in frame.lonlat_from_array(ring)]
        degrees.append([*lonlat, lonlat[0]])
    return document.model_copy(update={"boundary": checked_boundary(degrees).geometry})


def _lengthened(line: Sequence[tuple[float, float]], polygon: shapely.Polygon) -> shapely.LineString:
    points = np.asarray(line, dtype=float).reshape(-1, 2)
    if len(points) < 2 or np.hypot(*(points[-1] - points[0])) < 1.0:
        msg = sentence("the line to cut along needs two points at least 1 m apart")
        raise BoundaryError(msg)
    box = shapely.bounds(polygon)
    reach = 2.0 * float(np.hypot(box[2] - box[0], box[3] - box[1])) + 10.0
    first, last = points[0] - points[1], points[-1] - points[-2]
    begin = points[0] + first / np.hypot(*first) * reach
    end = points[-1] + last / np.hypot(*last) * reach
    return shapely.LineString([begin, *points, end])
