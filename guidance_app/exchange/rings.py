"""Loose rings to polygons by who lies inside whom, and driven tracks to rings; for formats that leave this to readers.

Whether a ring is an exclusion is never taken from its orientation, which programs get wrong, but from its place.
"""

import math
from collections.abc import Sequence

import numpy as np
import shapely

from guidance_app.boundary import BoundaryError, PolygonRings
from guidance_app.documents import Position
from guidance_app.geodesy import FieldFrame
from guidance_app.language import sentence
from guidance_app.model import FloatArray

__all__ = ["closed", "polygons_of", "ring_of_track"]

INSIDE_SHARE = 0.5
"""A ring lies inside another when more of its corners than this do; shared edges count as neither."""
MAX_RINGS = 5000
LEAST_STEP = 0.3
"""Metres; a driven point nearer than this to the last one is left out."""
WIDEST_GAP = 0.2
"""Part of the length; a track whose ends are farther apart does not go round anything."""
END_PART = 0.25
"""Part of the length at either end in which a track may cross itself: it was driven past its beginning."""


def polygons_of(rings: Sequence[Sequence[Position]]) -> tuple[PolygonRings, ...]:
    """Polygons of outer ring and exclusions: a ring inside an odd number of others is an exclusion."""
    if len(rings) > MAX_RINGS:
        msg = sentence("one shape in it has {rings:,} rings; {most:,} are the most", rings=len(rings), most=MAX_RINGS)
        raise BoundaryError(msg)
    usable = [closed(ring) for ring in rings if len(ring) >= 3]
    if not all(math.isfinite(value) for ring in usable for corner in ring for value in corner):
        msg = sentence("a corner in it is not a number")
        raise BoundaryError(msg)
    shapes = [shapely.Polygon(ring) for ring in usable]
    around = [_around(number, usable, shapes) for number in range(len(usable))]
    polygons: dict[int, list[list[Position]]] = {
        number: [usable[number]] for number, outside in enumerate(around) if len(outside) % 2 == 0
    }
    for number, outside in enumerate(around):
        if len(outside) % 2:
            holder = max((one for one in outside if one in polygons), key=lambda one: len(around[one]), default=None)
            if holder is not None:
                polygons[holder].append(usable[number])
    return tuple(polygons.values())


def closed(ring: Sequence[Position]) -> list[Position]:
    """The ring with its first corner at its end, for formats that leave it out."""
    return [*ring] if ring[0] == ring[-1] else [*ring, ring[0]]


def _around(number: int, rings: list[list[Position]], shapes: list[shapely.Polygon]) -> list[int]:
    """The rings that this one lies inside of."""
    corners = np.asarray(rings[number], dtype=float)
    west, south = corners.min(axis=0)
    east, north = corners.max(axis=0)
    found = []
    for other, shape in enumerate(shapes):
        box = shape.bounds
        if other == number or box[0] > west or box[1] > south or box[2] < east or box[3] < north:
            continue
        if np.mean(shapely.contains_xy(shape, corners[:, 0], corners[:, 1])) > INSIDE_SHARE:
            found.append(other)
    return found


def ring_of_track(track: Sequence[Position]) -> tuple[list[Position], tuple[str, ...]]:
    """The ring that was driven, with remarks. Raises ``BoundaryError`` for a track that does not come back."""
    if len(track) < 3 or not all(math.isfinite(x) and math.isfinite(y) for x, y in track):
        msg = sentence("the track in it has no three positions")
        raise BoundaryError(msg)
    try:
        frame = FieldFrame(track[0][1], track[0][0])
    except ValueError as error:
        msg = sentence(
            "the track in it begins at {latitude:g}, {longitude:g}, which is not latitude and longitude",
            latitude=track[0][1],
            longitude=track[0][0],
        )
        raise BoundaryError(msg) from error
    points = frame.array_from_lonlat(track)
    kept = _stepped(points)
    driven = points[kept]
    remarks: list[str] = []
    first, last = _own_crossing(driven)
    if (first, last) != (0, len(driven) - 1):
        remarks.append(sentence("the track was driven past its beginning; what lies beyond the crossing is left out"))
    driven = driven[first : last + 1]
    if len(driven) < 3:
        msg = sentence("the track in it has no three positions apart from each other")
        raise BoundaryError(msg)
    length = float(np.hypot(*np.diff(driven, axis=0).T).sum())
    gap = math.dist(driven[0], driven[-1])
    if gap > WIDEST_GAP * length:
        msg = sentence(
            "the track in it does not come back to where it began: its ends are {gap:,.0f} m apart after "
            "{length:,.0f} m; drive round the field once",
            gap=gap,
            length=length,
        )
        raise BoundaryError(msg)
    chosen = kept[first : last + 1]
    return closed([track[index] for index in chosen]), tuple(remarks)


def _stepped(points: FloatArray) -> list[int]:
    """Indexes of positions that are a step apart."""
    kept = [0]
    for index in range(1, len(points)):
        if math.dist(points[index], points[kept[-1]]) >= LEAST_STEP:
            kept.append(index)
    return kept


def _own_crossing(driven: FloatArray) -> tuple[int, int]:
    """First and last index of the loop: what lies between the points next to the crossing of the track's two ends."""
    count = len(driven)
    if count < 8:
        return 0, count - 1
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(driven, axis=0).T))])
    edges = np.asarray(shapely.linestrings(np.stack([driven[:-1], driven[1:]], axis=1)))
    head = np.flatnonzero(along[1:] <= END_PART * along[-1])
    tail = np.flatnonzero(along[:-1] >= (1 - END_PART) * along[-1])
    if len(head) == 0 or len(tail) == 0:
        return 0, count - 1
    later, earlier = shapely.STRtree(edges[head]).query(edges[tail], predicate="intersects")
    if len(later) == 0:
        return 0, count - 1
    nearest = np.lexsort((earlier, later))[0]
    return int(head[earlier[nearest]]) + 1, int(tail[later[nearest]])
