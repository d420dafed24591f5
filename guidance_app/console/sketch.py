"""The sketch of one client: lines and corners over the map while something is set up, and taps on the ground.

Everything is given and heard in the field frame (east, north in metres). Taps are listened to only while somebody
wants them: a stray finger while driving does nothing.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from guidance_app.model import FloatArray
from guidance_app.view.camera import WorldPose
from guidance_app.view.colours import Rgb, flat_source, vertex_source
from guidance_app.view.polyline import segments

__all__ = ["Sketch", "ground_point"]

Tapped = Callable[[float, float], None]

Z_SKETCH = 0.16
CORNER_PIXELS = 15.0
LINE_PIXELS = 5.0
SKETCHED: Rgb = (232, 89, 12)
"""Orange: nothing that is stored has this colour."""


def ground_point(
    origin: tuple[float, float, float], direction: tuple[float, float, float], world: WorldPose
) -> tuple[float, float] | None:
    """Where a ray of the scene meets the ground, in the field frame; None for a ray at or above the horizon."""
    if direction[2] >= -1e-6:
        return None
    reach = -origin[2] / direction[2]
    x, y = origin[0] + reach * direction[0] - world.x, origin[1] + reach * direction[1] - world.y
    cos, sin = math.cos(world.yaw), math.sin(world.yaw)
    return cos * x + sin * y, cos * y - sin * x


class Sketch:
    """Draws over one client's map. The redraw alone calls its methods; ``world`` tells how the map lies."""

    def __init__(self, client: viser.ClientHandle, world: Callable[[], WorldPose], root: str) -> None:
        self._client = client
        self._world = world
        self._root = f"{root}/sketch"
        self._nodes: dict[str, viser.SceneNodeHandle] = {}
        self._picture: viser.SceneNodeHandle | None = None
        self._tapped: Tapped | None = None
        self._listens = False
        self._scene_number = 0

    @property
    def scene_number(self) -> int:
        """Another one when the scene was made anew: then all that was drawn is gone."""
        return self._scene_number

    def line(self, name: str, points: FloatArray | Sequence[tuple[float, float]], colour: Rgb = SKETCHED) -> None:
        """A line through these points, shape (N, 2); fewer than two take it away."""
        way = np.asarray(points, dtype=float).reshape(-1, 2)
        if len(way) < 2:
            self.remove(name)
            return
        self._nodes[name] = self._client.scene.add_line_segments(
            f"{self._root}/{name}",
            segments(way, Z_SKETCH),
            flat_source(colour),
            thickness=LINE_PIXELS,
            thickness_units="screen",
        )

    def strokes(self, name: str, lines: Sequence[FloatArray], colour: Rgb = SKETCHED, pixels: float = 2.5) -> None:
        """Many lines at once, each of shape (N, 2); none take them away."""
        drawn = [segments(line, Z_SKETCH) for line in lines]
        if not drawn:
            self.remove(name)
            return
        self._nodes[name] = self._client.scene.add_line_segments(
            f"{self._root}/{name}",
            np.concatenate(drawn),
            flat_source(colour),
            thickness=pixels,
            thickness_units="screen",
        )

    def corners(self, name: str, points: FloatArray | Sequence[tuple[float, float]], colour: Rgb = SKETCHED) -> None:
        """A square of screen size on each of these points, shape (N, 2); none take them away."""
        spots = np.asarray(points, dtype=float).reshape(-1, 2)
        if len(spots) == 0:
            self.remove(name)
            return
        ground = np.column_stack([spots, np.full(len(spots), Z_SKETCH)])
        # A stroke of next to no length and a screen width is a square that keeps its size at every distance.
        strokes = np.stack([ground, ground + np.array([0.02, 0.0, 0.0])], axis=1).astype(np.float32)
        self._nodes[name] = self._client.scene.add_line_segments(
            f"{self._root}/{name}",
            strokes,
            flat_source(colour),
            thickness=CORNER_PIXELS,
            thickness_units="screen",
        )

    def coloured(self, name: str, strokes: FloatArray, colours: NDArray[np.uint8]) -> None:
        """Strokes of shape (N, 2, 2) with a colour each, shape (N, 3); none take them away."""
        if len(strokes) == 0:
            self.remove(name)
            return
        ground = np.full((len(strokes), 2, 3), Z_SKETCH, dtype=np.float32)
        ground[:, :, :2] = strokes
        self._nodes[name] = self._client.scene.add_line_segments(
            f"{self._root}/{name}",
            ground,
            np.repeat(_as_shown(colours)[:, None, :], 2, axis=1),
            thickness=LINE_PIXELS,
            thickness_units="screen",
        )

    def picture(self, glb: bytes | None) -> None:
        """A picture that lies on the ground below everything, until another or None; ``clear`` leaves it."""
        before, self._picture = self._picture, None
        if before is not None:
            before.remove()
        if glb is not None:
            self._picture = self._client.scene.add_glb(f"{self._root}/picture", glb, cast_shadow=False)

    def remove(self, name: str) -> None:
        """Takes one part away; one that is not there is no error."""
        node = self._nodes.pop(name, None)
        if node is not None:
            node.remove()

    def clear(self) -> None:
        """Takes everything away and listens no more."""
        for name in list(self._nodes):
            self.remove(name)
        self.hear_taps(None)

    def forget(self) -> None:
        """The scene was made anew: nothing of the sketch is left there."""
        self._scene_number += 1
        self._nodes.clear()
        self._picture = None

    def hear_taps(self, tapped: Tapped | None) -> None:
        """From now on each tap on the ground calls ``tapped``, on viser's loop, with east and north; None ends that."""
        self._tapped = tapped
        if tapped is not None and not self._listens:
            self._listens = True
            self._client.scene.on_click()(self._clicked)  # type: ignore[arg-type]  # viser runs coroutines on its own loop
        elif tapped is None and self._listens:
            self._listens = False
            self._client.scene.remove_click_callback()

    async def _clicked(self, event: viser.SceneClickEvent) -> None:
        tapped = self._tapped
        if tapped is None:
            return
        point = ground_point(event.ray_origin, event.ray_direction, self._world())
        if point is not None:
            tapped(*point)


def _as_shown(colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """What to send as colours of vertices so that the screen shows these; shape (N, 3)."""
    kinds, places = np.unique(colours, axis=0, return_inverse=True)
    sent = np.array([vertex_source((int(red), int(green), int(blue))) for red, green, blue in kinds], dtype=np.uint8)
    shown: NDArray[np.uint8] = sent[places.reshape(-1)]
    return shown
