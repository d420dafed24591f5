"""A plan as a driver drives it: stretches without a change of gear, each a polyline with what is done where."""

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from guidance_app.model import FloatArray, Segment, SegmentKind

__all__ = ["Part", "Place", "Stretch", "stretches_of"]

BEHIND = 3.0
AHEAD = 12.0
"""How far along the stretch (metres) a tractor's place is looked for, behind and ahead of where it was."""
JOINED = 0.05
"""Segments whose ends lie nearer (metres) are driven in one go."""


@dataclass(frozen=True, slots=True)
class Part:
    """One segment within a stretch, from ``start`` metres along it for ``length`` metres."""

    start: float
    length: float
    kind: SegmentKind
    number: int
    implement_down: bool


@dataclass(frozen=True, slots=True)
class Place:
    """Where a point is against a stretch: metres along, metres right of it, and the stretch's heading there."""

    along: float
    right: float
    heading: float


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """What is driven without a change of gear. ``points`` has shape (N, 2), ``along`` (N,) the way to each."""

    points: FloatArray
    along: FloatArray
    parts: tuple[Part, ...]
    reverse: bool

    @property
    def length(self) -> float:
        """Metres from end to end."""
        return float(self.along[-1])

    def part_at(self, along: float) -> Part:
        """The part in which this place lies."""
        return self.parts[max(0, bisect.bisect_right(self.parts, along, key=_start) - 1)]

    def parts_from(self, along: float) -> tuple[Part, ...]:
        """The parts that begin beyond this place."""
        return self.parts[bisect.bisect_right(self.parts, along, key=_start) :]

    def place_of(self, east: float, north: float, near: float) -> Place:
        """Where this point is, looked for around ``near`` metres along; beyond an end on the end's straight line."""
        first = max(0, int(np.searchsorted(self.along, near - BEHIND, side="right")) - 1)
        last = min(len(self.points) - 1, int(np.searchsorted(self.along, near + AHEAD)) + 1)
        starts, ends = self.points[first:last], self.points[first + 1 : last + 1]
        ways, lengths = ends - starts, self.along[first + 1 : last + 1] - self.along[first:last]
        rest = np.array([east, north]) - starts
        share = np.clip((rest * ways).sum(axis=1) / lengths**2, 0.0, 1.0)
        index = int(np.argmin(((rest - share[:, None] * ways) ** 2).sum(axis=1)))
        way_east, way_north = float(ways[index, 0]), float(ways[index, 1])
        length = float(lengths[index])
        rest_east, rest_north = float(rest[index, 0]), float(rest[index, 1])
        return Place(
            along=float(self.along[first + index]) + float(share[index]) * length,
            right=(rest_east * way_north - rest_north * way_east) / length,
            heading=math.atan2(way_east, way_north),
        )


def stretches_of(segments: Sequence[Segment]) -> tuple[Stretch, ...]:
    """The plan's segments joined wherever one goes on from another in the same gear."""
    groups: list[list[Segment]] = []
    for segment in segments:
        if len(segment.points) < 2:
            continue
        last = groups[-1][-1] if groups else None
        if last is not None and last.reverse == segment.reverse and _goes_on(last, segment):
            groups[-1].append(segment)
        else:
            groups.append([segment])
    return tuple(_stretch(group) for group in groups)


def _goes_on(last: Segment, segment: Segment) -> bool:
    return math.dist(_points_of(last)[-1], segment.points[0]) < JOINED


def _points_of(segment: Segment) -> FloatArray:
    """A lap comes back to its first point."""
    return np.vstack([segment.points, segment.points[:1]]) if segment.closed else segment.points


def _stretch(segments: Sequence[Segment]) -> Stretch:
    pieces: list[FloatArray] = []
    parts: list[Part] = []
    travelled = 0.0
    for segment in segments:
        points = _points_of(segment)
        length = float(np.hypot(*np.diff(points, axis=0).T).sum())
        parts.append(Part(travelled, length, segment.kind, segment.number, segment.implement_down))
        travelled += length
        pieces.append(points)
    points = np.vstack(pieces)
    steps = np.hypot(*np.diff(points, axis=0).T)
    kept = np.concatenate([[True], steps > 1e-6])
    points = points[kept]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    return Stretch(points, along, tuple(parts), segments[0].reverse)


def _start(part: Part) -> float:
    return part.start
