"""A motion as arrays: the common form of a true path, a raw recording and a filter's estimate.

Everything that is scored is a :class:`Track`; everything that is filtered is a :class:`Recording`. Both hold plain
arrays, so that a researcher can bring any trajectory. Frames and signs are those of ``guidance_app.model``: east and
north in metres, headings in radians clockwise from north, curvature positive clockwise.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from guidance_app.model import FixQuality, FloatArray, Measurement, Pose

__all__ = ["BoolArray", "Recording", "Track", "course_and_speed", "measurements", "track_from_poses"]

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """A true or estimated motion; every array has shape (N,), times grow.

    ``covariance`` has shape (N, 3): var east, cov, var north in m2; rows of NaN never occur, a track either has it for
    every sample or not at all. ``heading_known`` is False where the heading is a place-holder that must not be scored.
    """

    t: FloatArray
    east: FloatArray
    north: FloatArray
    heading: FloatArray
    speed: FloatArray
    curvature: FloatArray
    heading_known: BoolArray
    covariance: FloatArray | None = None

    def __len__(self) -> int:
        """How many samples there are."""
        return len(self.t)

    @property
    def positions(self) -> FloatArray:
        """Shape (N, 2): east, north."""
        return np.column_stack([self.east, self.north])

    @property
    def yaw_rate(self) -> FloatArray:
        """Shape (N,), positive clockwise."""
        return self.speed * self.curvature

    @property
    def velocity(self) -> FloatArray:
        """Shape (N, 2): east, north in m/s."""
        return np.column_stack([self.speed * np.sin(self.heading), self.speed * np.cos(self.heading)])


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """What a receiver, and perhaps a gyro, said along a path; times grow. What is None was not measured.

    ``position`` and ``velocity`` have shape (N, 2): east, north; ``cell`` is the rounding (east, north) of all
    positions in metres, None when they are not rounded to speak of; ``yaw_rate`` the gyro's, shape (N,), positive
    clockwise. ``antenna`` has shape (N, 3): the lever arm forward, right, height, as turned by roll and pitch, zero
    when the positions are the reference point's already. ``heading`` is a compass's, shape (N,), with its
    standard deviation. ``sigma`` is the receiver's own (east, north) standard deviation.
    """

    t: FloatArray
    position: FloatArray
    cell: tuple[float, float] | None
    velocity: FloatArray | None = None
    yaw_rate: FloatArray | None = None
    heading: FloatArray | None = None
    heading_sigma: float | None = None
    antenna: FloatArray | None = None
    sigma: tuple[float, float] | None = None
    quality: FixQuality = FixQuality.RTK_FIXED

    def __len__(self) -> int:
        """How many epochs there are."""
        return len(self.t)


def measurements(recording: Recording) -> Iterator[Measurement]:
    """The recording's epochs one after the other, as a filter takes them.

    A velocity becomes speed and course over ground, as a receiver's VTG sentence says it.
    """
    count = len(recording)
    nothing: list[None] = [None] * count
    speed: Iterable[float | None] = nothing
    course: Iterable[float | None] = nothing
    if recording.velocity is not None:
        course, speed = (values.tolist() for values in course_and_speed(recording.velocity))
    yaw_rate = nothing if recording.yaw_rate is None else recording.yaw_rate.tolist()
    heading = nothing if recording.heading is None else recording.heading.tolist()
    antenna = np.zeros((count, 3)) if recording.antenna is None else recording.antenna
    columns = zip(
        recording.t.tolist(),
        recording.position.tolist(),
        speed,
        course,
        yaw_rate,
        heading,
        antenna.tolist(),
        strict=True,
    )
    for t, (east, north), ground_speed, ground_course, rate, compass, (forward, right, height) in columns:
        yield Measurement(
            t=t,
            arrival=t,
            east=east,
            north=north,
            quality=recording.quality,
            cell=recording.cell,
            sigma=recording.sigma,
            speed=ground_speed,
            course=ground_course,
            heading=compass,
            heading_sigma=recording.heading_sigma,
            yaw_rate=rate,
            antenna=(forward, right, height),
        )


def course_and_speed(velocity: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Course over ground in [0, 2 pi) and speed, both (N,), of velocities (N, 2)."""
    course = np.arctan2(velocity[:, 0], velocity[:, 1]) % math.tau
    return course, np.hypot(velocity[:, 0], velocity[:, 1])


def track_from_poses(poses: Iterable[Pose]) -> Track:
    """The poses as arrays. Covariances are kept when every pose has one. No poses give a track of length 0."""
    listed = list(poses)
    table = np.array([(p.t, p.east, p.north, p.heading, p.speed, p.curvature) for p in listed], dtype=float)
    table = table.reshape(-1, 6)
    covariances = [pose.covariance for pose in listed if pose.covariance is not None]
    return Track(
        t=table[:, 0],
        east=table[:, 1],
        north=table[:, 2],
        heading=table[:, 3],
        speed=table[:, 4],
        curvature=table[:, 5],
        heading_known=np.array([pose.heading_known for pose in listed], dtype=bool),
        covariance=np.array(covariances, dtype=float) if listed and len(covariances) == len(listed) else None,
    )
