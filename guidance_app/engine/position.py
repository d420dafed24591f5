"""Where the position is put right: the driver's mark and the initialisation, each a named offset of its own.

Both are added to the filter's pose, so that one that is taken back leaves no trace. A mark is counted on top of an
initialisation in force; a new initialisation on a known point takes the place of both.
"""

import math
from dataclasses import dataclass, replace

from guidance_app.estimation.filter import Start
from guidance_app.estimation.initialisation import Initialisation
from guidance_app.geodesy import FieldFrame
from guidance_app.language import sentence
from guidance_app.model import Initialised, Initialising, Measurement, OffsetKind, OffsetRecord, Pose

__all__ = ["FARTHEST", "Measuring", "Position", "begun"]

FARTHEST = 30.0
"""Metres: no receiver is farther off. A mark or a start point beyond is another place, or a slip of the finger."""

Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Position:
    """The position offsets in force, at most one of each kind. A value: each change gives the next one."""

    records: tuple[OffsetRecord, ...] = ()

    def of(self, pose: Pose | None) -> Pose | None:
        """The pose with all offsets."""
        if pose is None or not self.records:
            return pose
        east, north = self.total
        return replace(pose, east=pose.east + east, north=pose.north + north)

    @property
    def total(self) -> Place:
        """Metres (east, north) by all offsets together."""
        return sum(one.east for one in self.records), sum(one.north for one in self.records)

    def on_the_mark(self, at: float, place: Place, raw: Pose | None) -> "Position | str":
        """Moved so that the reference point is at ``place``; a sentence when that cannot be."""
        if raw is None:
            return sentence("Not yet: there is no position that a mark could put right.")
        before = self.without(OffsetKind.MARK)
        east, north = (metres[0] - metres[1] for metres in zip(place, before.total, strict=True))
        record = OffsetRecord(OffsetKind.MARK, at, east=east - raw.east, north=north - raw.north)
        far = math.hypot(record.east, record.north)
        if far > FARTHEST:
            return sentence(
                "The mark is {far:.0f} m away: more than {most:.0f} m is another point. Choose the one you are on.",
                far=far,
                most=FARTHEST,
            )
        return Position((*before.records, record))

    def initialised(self, at: float, start: Start) -> "Position | str":
        """With the correction of a known start point, instead of all that was; a sentence when it is too far."""
        far = math.hypot(start.east, start.north)
        if far > FARTHEST:
            return sentence(
                "The start point is {far:.0f} m away: more than {most:.0f} m is another point. Choose yours.",
                far=far,
                most=FARTHEST,
            )
        return Position((OffsetRecord(OffsetKind.INITIALISATION, at, east=start.east, north=start.north),))

    def without(self, kind: OffsetKind) -> "Position":
        """All but the offset of one kind."""
        return Position(tuple(one for one in self.records if one.kind is not kind))


@dataclass(frozen=True, slots=True)
class Measuring:
    """The measuring time at the start point under way. ``known`` is whether the start point is."""

    run: Initialisation
    known: bool

    def with_measurement(self, z: Measurement) -> "Measuring":
        """After one more epoch."""
        return Measuring(self.run.with_measurement(z), self.known)

    @property
    def shown(self) -> Initialising:
        """How far it is."""
        progress = self.run.progress
        return Initialising(progress.done, progress.samples, progress.refused)

    @property
    def start(self) -> Start | None:
        """What it has taught, once it is over."""
        return self.run.progress.start if self.run.finished else None

    def result(self, at: float, start: Start) -> Initialised:
        """The result in words' reach."""
        return Initialised(
            arrival=at,
            samples=start.samples,
            seconds=start.seconds,
            east=start.east if self.known else None,
            north=start.north if self.known else None,
            scatter=(math.sqrt(start.covariance[0]), math.sqrt(start.covariance[2])),
            gyro_bias=start.gyro_bias,
        )


def begun(seconds: float, degrees: Place | None, frame: FieldFrame, pose: Pose | None) -> Measuring:
    """The measuring time from now on. ``degrees`` is the known start point as (latitude, longitude)."""
    known = None if degrees is None else frame.east_north_from_degrees(*degrees)
    heading = pose.heading if pose is not None and pose.heading_known else None
    return Measuring(Initialisation(seconds, known, heading), degrees is not None)
