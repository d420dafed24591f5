"""A field by tapping its corners on the map, or by standing on each of them."""

import numpy as np
import viser

from guidance_app.boundary import BoundaryError, FieldDraft, checked_field
from guidance_app.console.desk import Desk
from guidance_app.console.registering.atelier import Atelier
from guidance_app.console.widgets import Shown, buttons, notice_html
from guidance_app.geodesy import FieldFrame
from guidance_app.view.units import area_text

__all__ = ["Tapping"]

CORNERS, EDGES = "corners", "edges"
FEWEST = 3


class Tapping:
    """Collects corners: each tap on the ground is one, and each press while standing on one."""

    def __init__(self, gui: viser.GuiApi, atelier: Atelier) -> None:
        self._atelier = atelier
        self._hands = atelier.hands
        self._words = atelier.hands.words
        self._points: list[tuple[float, float]] = []
        self._drawn: object = None
        self._frame = atelier.frame()
        self._notice = Shown(gui)
        self._count = Shown(gui)
        self._here = gui.add_button(self._words("Corner where I stand"), color="green")
        buttons(gui, "", ((self._words("Undo corner"), self._undo), (self._words("Cancel"), atelier.cancel)))
        self._done = gui.add_button(self._words("Preview"), color="green")

        @self._here.on_click
        async def _(_: object) -> None:
            self._stand()

        @self._done.on_click
        async def _(_: object) -> None:
            self._hands.later(self._finish)

        if self._frame is not None:
            self._hands.sketch.hear_taps(self._tap)

    def _tap(self, east: float, north: float) -> None:
        self._points.append((east, north))
        self._hands.soon()

    def _stand(self) -> None:
        pose = self._hands.desk().snapshot.pose
        if pose is None:
            self._hands.tell(
                self._words("No position"),
                self._words("The receiver gives no position: start one under Start."),
                bad=True,
            )
            return
        if self._frame is None:
            self._frame = self._atelier.frame()
        self._tap(pose.east, pose.north)

    def _undo(self) -> None:
        if self._points:
            self._points.pop()
        self._hands.soon()

    def _draw(self, points: tuple[tuple[float, float], ...]) -> None:
        sketch = self._hands.sketch
        sketch.corners(CORNERS, points)
        sketch.line(EDGES, [*points, points[0]] if len(points) > 2 else points)

    def _finish(self) -> None:
        if self._frame is None or len(self._points) < FEWEST:
            raise BoundaryError(self._words("A field needs at least three corners: tap on the ground."))
        ring = draft_ring(self._frame, self._points)
        name = self._atelier.unique_name(self._words("New field"))
        checked = checked_field(FieldDraft(name, (([*ring, ring[0]],),)), name)
        self._atelier.offer((checked,), self._words("tapped on the map"))

    def show(self, desk: Desk) -> None:
        """Brings sketch and count up to the corners."""
        points = tuple(self._points)
        key = (self._hands.sketch.scene_number, points)
        if key != self._drawn:
            self._drawn = key
            self._draw(points)
        if self._frame is None and self._atelier.frame() is None:
            words = self._words("The map has no place on earth yet: show a field first, or start the receiver.")
            self._notice.show(notice_html([words]))
        else:
            if self._frame is None:
                self._frame = self._atelier.frame()
                self._hands.sketch.hear_taps(self._tap)
            self._notice.show(notice_html([self._words("Tap each corner in turn on the ground.")]))
        self._here.visible = desk.snapshot.pose is not None
        area = area_text(_area(points), desk.units, self._words)
        self._count.show(notice_html([self._words("{count} corners, {area}", count=len(points), area=area)]))
        self._done.disabled = len(points) < FEWEST

    def close(self) -> None:
        """Stops listening to taps and takes the sketch away."""
        self._hands.sketch.clear()


def draft_ring(frame: FieldFrame, points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points as longitude and latitude in degrees."""
    lonlat = frame.lonlat_from_array(np.asarray(points, dtype=float).reshape(-1, 2))
    return [(float(lon), float(lat)) for lon, lat in lonlat]


def _area(points: tuple[tuple[float, float], ...]) -> float:
    """By the shoelace formula, in square metres."""
    if len(points) < FEWEST:
        return 0.0
    east, north = np.asarray(points).T
    return float(abs(east @ np.roll(north, -1) - north @ np.roll(east, -1)) / 2)
