"""The points of a field that a driver can stand on and knows: entrance, corners of the boundary, ends of its lines."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from guidance_app.angles import wrap_pi
from guidance_app.documents import FieldDocument
from guidance_app.geodesy import FieldFrame
from guidance_app.language import Words
from guidance_app.model import FloatArray, Snapshot

__all__ = ["KnownPoint", "distance_to", "known_points", "nearest_of"]

SHARP = math.radians(25)
"""A bend of a boundary from here on is a corner that can be found in the field."""

MOST_CORNERS = 40


@dataclass(frozen=True, slots=True)
class KnownPoint:
    """A point by its name, unique in its field."""

    name: str
    latitude_deg: float
    longitude_deg: float


def known_points(field: FieldDocument | None, words: Words) -> tuple[KnownPoint, ...]:
    """The field's known points: the entrance first, then the corners in their order, then ends of stored lines."""
    if field is None:
        return ()
    points: list[KnownPoint] = []
    if field.entrance is not None:
        points.append(KnownPoint(words("Entrance"), field.entrance[1], field.entrance[0]))
    ring = field.boundary.coordinates[0][:-1]
    for number, place in enumerate(_corners(np.array(ring)), start=1):
        points.append(KnownPoint(words("Corner {number}", number=number), ring[place][1], ring[place][0]))
    for number, line in enumerate(field.lines, start=1):
        ends = line.geometry.coordinates[0], line.geometry.coordinates[-1]
        for end, (longitude, latitude) in zip("AB", ends, strict=True):
            points.append(KnownPoint(f"{number}. {line.name} {end}", latitude, longitude))
    return tuple(points)


def _corners(lonlat: FloatArray) -> list[int]:
    """Places of the sharpest bends of an open ring (N, 2), in its order."""
    flat = lonlat * (math.cos(math.radians(float(lonlat[0, 1]))), 1.0)
    come, go = flat - np.roll(flat, 1, axis=0), np.roll(flat, -1, axis=0) - flat
    turns = np.arctan2(go[:, 0], go[:, 1]) - np.arctan2(come[:, 0], come[:, 1])
    bends = np.array([abs(wrap_pi(float(turn))) for turn in turns])
    sharpest = np.argsort(-bends, kind="stable")[:MOST_CORNERS]
    return sorted(int(place) for place in sharpest if bends[place] >= SHARP)


def distance_to(point: KnownPoint, snapshot: Snapshot) -> float | None:
    """Metres from the reference point; None while that is not known."""
    if snapshot.pose is None or snapshot.origin_deg is None:
        return None
    east, north = _frame(snapshot.origin_deg).east_north_from_degrees(point.latitude_deg, point.longitude_deg)
    return math.hypot(east - snapshot.pose.east, north - snapshot.pose.north)


def nearest_of(points: tuple[KnownPoint, ...], snapshot: Snapshot) -> KnownPoint | None:
    """The point nearest to the tractor."""
    away = [(metres, place) for place, one in enumerate(points) if (metres := distance_to(one, snapshot)) is not None]
    return points[min(away)[1]] if away else None


@lru_cache(maxsize=8)
def _frame(origin_deg: tuple[float, float]) -> FieldFrame:
    return FieldFrame(*origin_deg)
