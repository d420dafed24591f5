"""Where the tractor is, as measured and as estimated, and where it will be."""

from dataclasses import dataclass, field

from guidance_app.model.arrays import FloatArray
from guidance_app.model.making import made_quickly
from guidance_app.model.wire import FixQuality

__all__ = [
    "Measurement",
    "Pose",
    "Prediction",
]


@made_quickly
@dataclass(frozen=True, slots=True)
class Measurement:
    """What one epoch holds, in the field frame, as a filter takes it. Missing is None, never zero.

    ``east``, ``north`` is the antenna's position; ``antenna`` its lever arm (forward, right, height) seen from the
    reference point, already turned by roll and pitch. ``cell`` is (east, north) here: the frame's own order.
    ``yaw_rate`` is the gyro's, positive clockwise. ``heading_sigma`` is how far ``heading`` may drift; None is a dual
    antenna's, which does not.
    """

    t: float
    arrival: float
    east: float
    north: float
    quality: FixQuality
    cell: tuple[float, float] | None = None
    sigma: tuple[float, float] | None = None
    speed: float | None = None
    course: float | None = None
    heading: float | None = None
    yaw_rate: float | None = None
    roll: float | None = None
    pitch: float | None = None
    antenna: tuple[float, float, float] = (0.0, 0.0, 0.0)
    heading_sigma: float | None = None


@made_quickly
@dataclass(frozen=True, slots=True)
class Pose:
    """Where the reference point (centre of the rear axle, on the ground) is and how it moves.

    ``speed`` is negative in reverse. ``curvature`` is heading change per metre travelled forward, positive clockwise.
    ``covariance`` is (var east, cov, var north) in m2. ``heading_known`` is False until the tractor has moved enough
    for the heading to mean something; the screen then says "direction unknown: drive 2 m".
    """

    t: float
    arrival: float
    east: float
    north: float
    heading: float
    speed: float
    curvature: float = 0.0
    covariance: tuple[float, float, float] | None = None
    heading_sigma: float | None = None
    heading_known: bool = True
    standing: bool = False
    reverse: bool = False
    dead_reckoned: bool = False
    roll: float | None = None
    pitch: float | None = None

    @property
    def yaw_rate(self) -> float:
        """Heading change per second, positive clockwise."""
        return self.curvature * self.speed


@made_quickly
@dataclass(frozen=True, slots=True)
class Prediction:
    """The pose after the look-ahead, and the arc that leads there. ``arc`` has shape (K, 2): east, north."""

    look_ahead_s: float
    pose: Pose
    arc: FloatArray = field(compare=False)
    cross_track: float | None = None
    heading_error: float | None = None
