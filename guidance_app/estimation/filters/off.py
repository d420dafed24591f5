"""No filtering: the reference point straight from the fix, heading from the way driven (Inoue et al., "filtering off").

The heading is that of a baseline of at least one metre, or the heading sensor's where there is one; the speed is the
receiver's, else that of the last two fixes. Standing (below 0.1 m/s) the heading stays. Backing up is read from a
baseline that turns round. Time: a gap needs nothing, for nothing is predicted. Outliers pass through.
"""

from dataclasses import dataclass

from guidance_app.estimation.filter import Filter, FilterSettings, Start
from guidance_app.estimation.receiver_noise import fix_covariance
from guidance_app.estimation.reference_point import offset_point
from guidance_app.estimation.travel import Travel
from guidance_app.model import Measurement, Pose
from guidance_app.model.making import made_quickly

__all__ = ["Off"]

STANDING = 0.1
"""Slower than this many metres a second is standing."""


@made_quickly
@dataclass(frozen=True, slots=True)
class _State:
    z: Measurement
    travel: Travel
    pose: Pose


class Off:
    """The fix as it comes, moved from the antenna to the ground."""

    def __init__(self, settings: FilterSettings) -> None:
        self._settings = settings
        self._state: _State | None = None
        self._scatter: tuple[float, float, float] | None = None

    def step(self, z: Measurement) -> Pose:
        """The pose of this fix; ``heading_known`` is False until one metre has been driven."""
        before = self._state
        if before is not None and z.t <= before.z.t:
            return before.pose
        travel = (before.travel if before else Travel()).to(z.east, z.north, z.heading)
        speed = _speed(before, z)
        pose = _pose(z, travel, speed, fix_covariance(z, self._scatter))
        self._state = _State(z, travel, pose)
        return pose

    def begin(self, start: Start) -> None:
        """The scatter of the fixes at the start point is what the ellipse shows. There is no gyro here."""
        self._scatter = start.covariance

    def fork(self) -> Filter:
        """An independent copy."""
        other = Off(self._settings)
        other._state, other._scatter = self._state, self._scatter
        return other


def _speed(before: _State | None, z: Measurement) -> float:
    """Metres a second, never negative: the receiver's, else from the last two fixes."""
    if z.speed is not None:
        return z.speed
    if before is None:
        return 0.0
    last = before.z
    return float(((z.east - last.east) ** 2 + (z.north - last.north) ** 2) ** 0.5 / (z.t - last.t))


def _pose(z: Measurement, travel: Travel, speed: float, covariance: tuple[float, float, float]) -> Pose:
    heading = travel.heading
    east, north = z.east, z.north
    if heading is not None:
        forward, right, _ = z.antenna
        east, north = offset_point(east, north, heading, -forward, -right)
    return Pose(
        t=z.t,
        arrival=z.arrival,
        east=east,
        north=north,
        heading=heading or 0.0,
        speed=-speed if travel.reverse else speed,
        covariance=covariance,
        heading_known=heading is not None,
        standing=speed < STANDING,
        reverse=travel.reverse,
        roll=z.roll,
        pitch=z.pitch,
    )
