"""The boundary of a field, however it was drawn, typed, driven or read: repaired or refused, with the place named.

What is repaired, each with a remark: an open ring, the wrong orientation, repeated corners, spikes without width, an
exclusion without area. What is refused: a ring that crosses or touches itself, an exclusion outside the boundary or
across another one, corners that are not degrees, a field below 100 m2 or above 10,000 ha. Corners keep their place:
a repair drops corners, it never moves one. Every way to a field ends here, so that each gives the same preview.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from pydantic import ValidationError

from guidance_app.documents import MAX_VERTICES, FieldDocument, Geometry, GuidanceLineDocument, Position
from guidance_app.geodesy import FieldFrame
from guidance_app.language import message, sentence
from guidance_app.model import FloatArray

__all__ = [
    "BoundaryError",
    "CheckedBoundary",
    "CheckedField",
    "FieldDraft",
    "PolygonRings",
    "checked_boundary",
    "checked_field",
    "frame_of",
    "polygon_in",
]

PolygonRings = Sequence[Sequence[Position]]
"""Rings of (longitude, latitude) in degrees: the outer one, then the exclusions."""

HECTARE = 10_000.0
SMALLEST_FIELD = 100.0
LARGEST_FIELD = 10_000 * HECTARE
WIDEST_FIELD = 50_000.0
"""Corners farther apart than this (metres) cannot belong to one field."""
DECIMALS = 9
"""Of a stored degree: 0.1 mm."""
SAME_CORNER = 1e-3
"""Neighbouring corners nearer than this (metres) are one corner."""
SPIKE_WIDTH = 1e-3
"""A way out and back along a line no wider than this (metres) is a spike."""
NO_AREA = 1e-2
"""An exclusion of less than this (m2) excludes nothing."""
MAX_EXCLUSIONS = 999


class BoundaryError(ValueError):
    """What was given cannot be the boundary of a field; the message is one sentence for the person who gave it."""


@dataclass(frozen=True, slots=True)
class FieldDraft:
    """A field as a file, a finger or a drive gave it, not yet checked. ``parts`` holds the rings of each polygon.

    ``remarks`` say what was repaired or left out, ``assumptions`` what was guessed and may be asked for otherwise.
    """

    name: str | None
    parts: tuple[PolygonRings, ...]
    lines: tuple[GuidanceLineDocument, ...] = ()
    entrance: Position | None = None
    notes: str = ""
    remarks: tuple[str, ...] = ()
    assumptions: tuple[str, ...] = ()

    def remarked(self, remark: str) -> "FieldDraft":
        """The same with one more remark."""
        return replace(self, remarks=(*self.remarks, remark))

    def with_extras(self, lines: Sequence[GuidanceLineDocument], entrance: Position | None) -> "FieldDraft":
        """The same with guidance lines and an entrance."""
        return replace(self, lines=(*self.lines, *lines), entrance=entrance or self.entrance)


@dataclass(frozen=True, slots=True)
class CheckedBoundary:
    """A boundary that may be stored. ``area`` in m2 is without the exclusions, ``perimeter`` is the outer ring's."""

    geometry: Geometry
    area: float
    perimeter: float
    remarks: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CheckedField:
    """A field that may be stored, with what its preview shows."""

    document: FieldDocument
    area: float
    perimeter: float
    remarks: tuple[str, ...]


def frame_of(geometry: Geometry) -> FieldFrame:
    """The field frame with its origin in the middle of the boundary's box, rounded to 1e-6 degree."""
    return _frame_around(np.asarray(geometry.coordinates[0], dtype=float))


def polygon_in(frame: FieldFrame, geometry: Geometry) -> shapely.Polygon:
    """The field's ground in metres, exclusions cut out."""
    outer, *holes = (frame.array_from_lonlat(ring) for ring in geometry.coordinates)
    return shapely.Polygon(outer, holes)


def checked_field(draft: FieldDraft, fallback_name: str) -> CheckedField:
    """The field of a draft, its largest part if it has several. Raises ``BoundaryError``."""
    if not draft.parts:
        raise BoundaryError(sentence("there is no polygon in it"))
    boundaries = [checked_boundary(part) for part in draft.parts]
    boundary = max(boundaries, key=lambda each: each.area)
    remarks = [*draft.remarks, *boundary.remarks]
    if len(boundaries) > 1:
        pattern = message("the field has {count} parts; only the largest, {area:.2f} ha, is taken")
        remarks.append(sentence(pattern, count=len(boundaries), area=boundary.area / HECTARE))
    try:
        document = FieldDocument(
            name=draft.name or fallback_name,
            boundary=boundary.geometry,
            entrance=draft.entrance,
            lines=list(draft.lines),
            notes=draft.notes,
        )
    except ValidationError as error:
        first = error.errors()[0]
        msg = sentence(
            "the field cannot be stored: {where}: {reason}", where=".".join(map(str, first["loc"])), reason=first["msg"]
        )
        raise BoundaryError(msg) from error
    return CheckedField(document, boundary.area, boundary.perimeter, tuple(remarks))


def checked_boundary(rings: PolygonRings) -> CheckedBoundary:
    """The boundary of these rings, repaired where that moves no corner. Raises ``BoundaryError``."""
    degrees = _degrees(rings)
    frame = _frame_around(degrees[0])
    remarks: list[str] = []
    kept: list[FloatArray] = []
    for number, lonlat in enumerate(degrees):
        what = sentence("the boundary") if number == 0 else sentence("exclusion {number}", number=number)
        ring = _repaired(lonlat, frame, what, remarks)
        if ring is None and number == 0:
            raise BoundaryError(sentence("the boundary has no three corners that enclose ground"))
        if ring is not None:
            kept.append(ring)
    polygon = _polygon(kept, frame)
    _check_size(polygon)
    geometry = Geometry(coordinates=[_closed(ring, clockwise=number > 0) for number, ring in enumerate(kept)])
    return CheckedBoundary(geometry, float(polygon.area), float(polygon.exterior.length), tuple(remarks))


# --- numbers ---------------------------------------------------------------------------------------------------------


def _degrees(rings: PolygonRings) -> list[FloatArray]:
    """Each ring of shape (N, 2): longitude, latitude, rounded as it will be stored."""
    if not rings:
        raise BoundaryError(sentence("there is no ring in it"))
    if len(rings) - 1 > MAX_EXCLUSIONS:
        msg = sentence("it has {count} exclusions; {most} are possible", count=len(rings) - 1, most=MAX_EXCLUSIONS)
        raise BoundaryError(msg)
    arrays = []
    for ring in rings:
        if len(ring) > MAX_VERTICES - 1:
            msg = sentence(
                "a ring of it has {count} corners; {most} are possible", count=len(ring), most=MAX_VERTICES - 1
            )
            raise BoundaryError(msg)
        for number, (longitude, latitude) in enumerate(ring, start=1):
            _check_degrees(number, longitude, latitude)
        arrays.append(np.round(np.asarray(ring, dtype=float).reshape(-1, 2), DECIMALS))
    return arrays


def _check_degrees(number: int, longitude: float, latitude: float) -> None:
    if not (math.isfinite(longitude) and math.isfinite(latitude)):
        msg = sentence("corner {number} is not a number", number=number)
        raise BoundaryError(msg)
    if abs(longitude) <= 180 and abs(latitude) <= 89:
        return
    if abs(longitude) <= 180 and abs(latitude) <= 90:
        msg = sentence("corner {number} is less than a degree from a pole", number=number)
    elif abs(longitude) <= 89 and abs(latitude) <= 180:
        msg = sentence(
            "corner {number} has a latitude of {latitude:g} degrees, which is not on earth: latitude and "
            "longitude look swapped",
            number=number,
            latitude=latitude,
        )
    else:
        msg = sentence(
            "corner {number} at {longitude:g}, {latitude:g} is not a longitude and latitude in degrees; "
            "these look like metres, whose projection the file does not name",
            number=number,
            longitude=longitude,
            latitude=latitude,
        )
    raise BoundaryError(msg)


def _frame_around(lonlat: FloatArray) -> FieldFrame:
    """A frame in the middle of the box of a ring, which may lie across the 180th meridian."""
    if len(lonlat) == 0:
        raise BoundaryError(sentence("the boundary has no corner"))
    longitudes = _unwrapped(lonlat[:, 0])
    longitude = (longitudes.min() + longitudes.max()) / 2
    latitude = (lonlat[:, 1].min() + lonlat[:, 1].max()) / 2
    wrapped = (float(longitude) + 180.0) % 360.0 - 180.0
    return FieldFrame(round(float(latitude), 6), round(wrapped, 6))


def _unwrapped(longitudes: FloatArray) -> FloatArray:
    turns: FloatArray = longitudes - 360.0 * np.round((longitudes - longitudes[0]) / 360.0)
    return turns


# --- rings -----------------------------------------------------------------------------------------------------------


def _repaired(lonlat: FloatArray, frame: FieldFrame, what: str, remarks: list[str]) -> FloatArray | None:
    """The ring's corners without the closing one, shape (N, 2) in degrees; None when it encloses nothing."""
    points = frame.array_from_lonlat(lonlat)
    if not np.all(np.isfinite(points)) or np.abs(points).max() > WIDEST_FIELD / 2:
        msg = sentence(
            "the corners of {what} are more than {widest:g} km apart: one of them must be wrong",
            what=what,
            widest=WIDEST_FIELD / 1000,
        )
        raise BoundaryError(msg)
    if len(points) > 1 and math.dist(points[0], points[-1]) < SAME_CORNER:
        keep = list(range(len(points) - 1))
    else:
        keep = list(range(len(points)))
        remarks.append(sentence("{what} was open; its last corner is joined to its first", what=what))
    distinct = _without_repeats(points, keep)
    if len(distinct) < len(keep):
        lost = len(keep) - len(distinct)
        remarks.append(sentence("{what} had {count} repeated corners; they are dropped", what=what, count=lost))
    pointed = _without_spikes(points, distinct)
    if len(pointed) < len(distinct):
        lost = len(distinct) - len(pointed)
        remarks.append(sentence("{what} had spikes without width; {count} corners are dropped", what=what, count=lost))
    if len(pointed) < 3 or _is_nothing(shapely.Polygon(points[pointed])):
        if what != "the boundary":
            remarks.append(sentence("{what} encloses nothing and is dropped", what=what))
        return None
    corners: FloatArray = lonlat[pointed]
    return corners


def _is_nothing(polygon: shapely.Polygon) -> bool:
    """Whether the ring encloses no ground; one that crosses itself may have no area and yet be much."""
    return bool(polygon.is_valid) and polygon.area < NO_AREA


def _without_repeats(points: FloatArray, keep: list[int]) -> list[int]:
    """Of each run of corners in one place the first."""
    distinct: list[int] = []
    for index in keep:
        if not distinct or math.dist(points[index], points[distinct[-1]]) >= SAME_CORNER:
            distinct.append(index)
    while len(distinct) > 1 and math.dist(points[distinct[0]], points[distinct[-1]]) < SAME_CORNER:
        distinct.pop()
    return distinct


def _without_spikes(points: FloatArray, keep: list[int]) -> list[int]:
    """Without the tips of ways out and back. A tip that goes may lay bare another one, so it looks back each time."""
    ring = list(keep)
    index = 0
    clean = 0
    while len(ring) > 2 and clean < len(ring):
        before, tip, after = ring[index - 1], ring[index], ring[(index + 1) % len(ring)]
        if not _is_spike(points[before], points[tip], points[after]):
            index = (index + 1) % len(ring)
            clean += 1
            continue
        del ring[index]
        if math.dist(points[before], points[after]) < SAME_CORNER:
            ring.remove(after)
        index = (index - 2) % len(ring) if ring else 0
        clean = 0
    return ring


def _is_spike(before: FloatArray, tip: FloatArray, after: FloatArray) -> bool:
    """Whether the way to ``tip`` and the way on lie on each other."""
    back, on = before - tip, after - tip
    if float(back @ on) <= 0:
        return False
    longer = back if back @ back > on @ on else on
    shorter = on if longer is back else back
    across = abs(float(longer[0] * shorter[1] - longer[1] * shorter[0])) / math.hypot(*longer)
    return across < SPIKE_WIDTH


def _closed(ring: FloatArray, *, clockwise: bool) -> list[Position]:
    """The ring in the orientation of RFC 7946, its first corner repeated at the end."""
    unwrapped = np.column_stack([_unwrapped(ring[:, 0]), ring[:, 1]])
    turned = ring[::-1] if shapely.LinearRing(unwrapped).is_ccw == clockwise else ring
    corners = [(float(longitude), float(latitude)) for longitude, latitude in turned]
    return [*corners, corners[0]]


# --- the polygon -----------------------------------------------------------------------------------------------------


def _polygon(rings: list[FloatArray], frame: FieldFrame) -> shapely.Polygon:
    outer, *holes = (frame.array_from_lonlat(ring) for ring in rings)
    for number, ring in enumerate([outer, *holes]):
        what = sentence("the boundary") if number == 0 else sentence("exclusion {number}", number=number)
        alone = shapely.Polygon(ring)
        if not alone.is_valid:
            raise BoundaryError(_crossing(alone, ring, frame, what))
    ground = shapely.Polygon(outer)
    exclusions = [shapely.Polygon(hole) for hole in holes]
    for number, exclusion in enumerate(exclusions, start=1):
        if not ground.covers(exclusion):
            place = _place(exclusion.difference(ground).representative_point(), frame)
            msg = sentence(
                "exclusion {number} reaches outside the boundary at {place}: move it inside", number=number, place=place
            )
            raise BoundaryError(msg)
    _check_apart(exclusions, frame)
    polygon = shapely.Polygon(outer, holes)
    if not polygon.is_valid:
        place = _place(_invalid_point(polygon), frame)
        msg = sentence("the boundary and its exclusions cut the field apart at {place}: move one of them", place=place)
        raise BoundaryError(msg)
    return polygon


def _check_apart(exclusions: list[shapely.Polygon], frame: FieldFrame) -> None:
    if len(exclusions) < 2:
        return
    firsts, seconds = shapely.STRtree(exclusions).query(exclusions, predicate="intersects")
    for first, second in zip(firsts.tolist(), seconds.tolist(), strict=True):
        if first < second:
            shared = exclusions[first].intersection(exclusions[second])
            if shared.area > 0:
                place = _place(shared.representative_point(), frame)
                msg = sentence(
                    "exclusions {one} and {other} lie on each other at {place}: make them one",
                    one=first + 1,
                    other=second + 1,
                    place=place,
                )
                raise BoundaryError(msg)


def _crossing(polygon: shapely.Polygon, ring: FloatArray, frame: FieldFrame, what: str) -> str:
    point = _invalid_point(polygon)
    edges = shapely.linestrings(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1))
    nearest = np.argsort(shapely.distance(edges, point), kind="stable")[:2]
    names = " and ".join(f"{edge + 1}-{(edge + 1) % len(ring) + 1}" for edge in sorted(nearest.tolist()))
    return sentence(
        "{what} crosses itself at {place}, where the edges between corners {names} meet: move one",
        what=what,
        place=_place(point, frame),
        names=names,
    )


def _invalid_point(polygon: shapely.Polygon) -> shapely.Point:
    """Where GEOS says that the polygon is not one; it writes the place in brackets."""
    reason = shapely.is_valid_reason(polygon)
    east, north = reason[reason.rindex("[") + 1 : reason.rindex("]")].split()
    return shapely.Point(float(east), float(north))


def _place(point: shapely.Point, frame: FieldFrame) -> str:
    latitude, longitude = frame.degrees_from_east_north(point.x, point.y)
    return sentence("latitude {latitude:.6f}, longitude {longitude:.6f}", latitude=latitude, longitude=longitude)


def _check_size(polygon: shapely.Polygon) -> None:
    if polygon.area < SMALLEST_FIELD:
        msg = sentence(
            "a field of {area:.1f} m2 is too small; {smallest:g} m2 are the least",
            area=polygon.area,
            smallest=SMALLEST_FIELD,
        )
        raise BoundaryError(msg)
    if polygon.area > LARGEST_FIELD:
        msg = sentence(
            "a field of {area:,.0f} ha is too large; {largest:,.0f} ha are the most: is a corner wrong?",
            area=polygon.area / HECTARE,
            largest=LARGEST_FIELD / HECTARE,
        )
        raise BoundaryError(msg)
