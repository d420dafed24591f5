"""The four views: how the world lies under the camera, and where the camera is at home.

The world is moved, not the camera, so that a finger's orbit and zoom stay. In the root frame x points up the screen
(ahead, or north) and y to its left; the tractor is at the root's origin in the views that follow it, the middle of the
field in the one that does not. A home is where a view begins and where one button brings it back.
"""

import math
from dataclasses import dataclass
from enum import StrEnum

from guidance_app.angles import wrap_pi, yaw_from_heading
from guidance_app.model import FloatArray

__all__ = [
    "FIELD_OF_VIEW",
    "CameraHome",
    "Extent",
    "ViewMode",
    "WorldPose",
    "camera_home",
    "eased_heading",
    "extent_of",
    "world_pose",
]

FIELD_OF_VIEW = math.radians(50)
"""Vertical, of every view."""

NEAR, FAR = 0.3, 3000.0
HEADING_EASE = 0.35
"""Time constant in seconds by which the world's direction follows the tractor's: the ground does not shake."""


class ViewMode(StrEnum):
    """How the driver looks at the field."""

    DRIVER = "Driver"
    HEADING_UP = "Heading up"
    NORTH_UP = "North up"
    WHOLE_FIELD = "Whole field"

    @property
    def turns_with_tractor(self) -> bool:
        """True when the tractor's heading is up."""
        return self in {ViewMode.DRIVER, ViewMode.HEADING_UP}

    @property
    def follows(self) -> bool:
        """True when the tractor stays in place on the screen."""
        return self is not ViewMode.WHOLE_FIELD


@dataclass(frozen=True, slots=True)
class Extent:
    """A box in the field frame."""

    west: float
    south: float
    east: float
    north: float

    @property
    def middle(self) -> tuple[float, float]:
        """(east, north)."""
        return (self.west + self.east) / 2, (self.south + self.north) / 2

    @property
    def size(self) -> tuple[float, float]:
        """Metres (east to west, north to south), at least 20 m each."""
        return max(self.east - self.west, 20.0), max(self.north - self.south, 20.0)

    def with_point(self, east: float, north: float) -> "Extent":
        """The box that also holds this point."""
        return Extent(min(self.west, east), min(self.south, north), max(self.east, east), max(self.north, north))

    def holds(self, other: "Extent") -> bool:
        """True when ``other`` lies inside."""
        return (
            self.west <= other.west
            and self.south <= other.south
            and self.east >= other.east
            and self.north >= other.north
        )

    def grown(self, share: float) -> "Extent":
        """The box, larger by this share of its longer side on every side."""
        margin = share * max(self.size)
        return Extent(self.west - margin, self.south - margin, self.east + margin, self.north + margin)


def extent_of(points: FloatArray) -> Extent:
    """The box around points of shape (N, 2), N at least 1."""
    west, south = points.min(axis=0)
    east, north = points.max(axis=0)
    return Extent(float(west), float(south), float(east), float(north))


@dataclass(frozen=True, slots=True)
class WorldPose:
    """Where the world's frame stands in the root: turned by ``yaw`` counter-clockwise, then moved."""

    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True)
class CameraHome:
    """A camera in the root frame; z is up in every view."""

    position: tuple[float, float, float]
    look_at: tuple[float, float, float]
    near: float = NEAR
    far: float = FAR


def world_pose(mode: ViewMode, centre: tuple[float, float], heading: float) -> WorldPose:
    """The world so that ``centre`` (east, north) is at the root's origin and what is up in this view points along x."""
    yaw = -yaw_from_heading(heading if mode.turns_with_tractor else 0.0)
    east, north = centre
    cosine, sine = math.cos(yaw), math.sin(yaw)
    return WorldPose(-(cosine * east - sine * north), -(sine * east + cosine * north), yaw)


def eased_heading(shown: float | None, heading: float, seconds: float) -> float:
    """The direction the world shows, ``seconds`` after it showed ``shown``: it follows with a lag of 0.35 s."""
    if shown is None or seconds < 0:
        return heading
    return wrap_pi(shown + wrap_pi(heading - shown) * -math.expm1(-seconds / HEADING_EASE))


def camera_home(mode: ViewMode, *, width: float, extent: Extent, aspect: float) -> CameraHome:
    """Where the camera begins: ``width`` is the implement's, ``extent`` the field's, ``aspect`` the picture's w / h."""
    up = math.tan(FIELD_OF_VIEW / 2)
    across = up * aspect
    match mode:
        case ViewMode.DRIVER:
            return _behind(max(15.0, (0.62 * width + 3.5) / across))
        case ViewMode.HEADING_UP:
            height = max(26.0 / up, (0.9 * width + 8.0) / across)
            return _above(height, ahead=0.36 * height * up)
        case ViewMode.NORTH_UP:
            height = max(34.0 / up, (1.2 * width + 10.0) / across)
            return _above(height, ahead=0.0)
        case ViewMode.WHOLE_FIELD:
            across_m, up_m = extent.size
            height = 1.16 * max(up_m / up, across_m / across) / 2
            return _above(height, ahead=0.0)


def _behind(distance: float) -> CameraHome:
    """Over the driver's shoulder, ``distance`` from the tractor."""
    back, height = 0.88 * distance, 0.48 * distance
    return CameraHome((-back, 0.0, height), (0.62 * distance, 0.0, 0.0), 0.06 * distance, FAR)


def _above(height: float, *, ahead: float) -> CameraHome:
    """From above; a hair from behind, so that up on the screen is never in doubt."""
    near = max(NEAR, 0.05 * height)
    return CameraHome((ahead - 0.01 * height, 0.0, height), (ahead, 0.0, 0.0), near, max(FAR, 3 * height))
