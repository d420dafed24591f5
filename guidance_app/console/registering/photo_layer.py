"""The photo that lies on the map of one client while fields are registered: where it lies, and when to draw it anew."""

import numpy as np

from guidance_app.console.photo import Photo, sheet
from guidance_app.console.sketch import Sketch
from guidance_app.documents import MatchedPoint
from guidance_app.geodesy import FieldFrame
from guidance_app.map_fitting import Fit, FitError, fitted
from guidance_app.model import FloatArray

__all__ = ["PhotoLayer"]

FIRST_SIZE = 200.0
"""Metres of the longer side while nothing is matched yet."""


class PhotoLayer:
    """One photo at most. Until two points are matched it lies in the middle of the map, north up.

    It may be laid and matched from any thread; ``show``, at the redraw, draws it.
    """

    def __init__(self, sketch: Sketch) -> None:
        self._sketch = sketch
        self.photo: Photo | None = None
        self.points: list[MatchedPoint] = []
        self._drawn: tuple[Photo, object] | None = None
        self._taken_away = False

    def lay(self, photo: Photo | None, points: tuple[MatchedPoint, ...] = ()) -> None:
        """Lays another photo, or takes it away."""
        self.points = list(points)
        self.photo = photo
        self._taken_away = photo is None

    def match(self, point: MatchedPoint, frame: FieldFrame | None) -> None:
        """One more point of the photo is known. Raises ``FitError``, and is not taken, when no fit goes through it."""
        if frame is not None and self.points:
            fitted([*self.points, point], frame)
        self.points.append(point)

    def frame(self) -> FieldFrame | None:
        """A frame at the first matched point, for a map that has no place of its own."""
        return None if not self.points else FieldFrame(self.points[0].latitude_deg, self.points[0].longitude_deg)

    def fit(self, frame: FieldFrame | None) -> Fit | None:
        """Where the photo lies in a frame by its points. Raises ``FitError``; None with fewer than two."""
        return None if frame is None or len(self.points) < 2 else fitted(self.points, frame)

    def placed(self, frame: FieldFrame | None) -> Fit | None:
        """Where it lies now: by its points, else in the middle; None without a photo."""
        photo = self.photo
        return None if photo is None else self._placed(photo, frame)

    def _placed(self, photo: Photo, frame: FieldFrame | None) -> Fit:
        try:
            fit = self.fit(frame)
        except FitError:
            fit = None
        return fit or _in_the_middle(photo)

    def show(self, frame: FieldFrame | None) -> None:
        """Draws it when it, its place, or the map has changed; takes it away when that was asked for."""
        photo = self.photo
        if photo is None:
            if self._taken_away:
                self._taken_away, self._drawn = False, None
                self._sketch.picture(None)
            return
        key = (tuple(self.points), frame, self._sketch.scene_number)
        if self._drawn is not None and self._drawn[0] is photo and self._drawn[1] == key:
            return
        self._drawn = photo, key
        self._sketch.picture(sheet(photo, self._placed(photo, frame).ground(_corners(photo))))


def _corners(photo: Photo) -> FloatArray:
    width, height = photo.width, photo.height
    return np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])


def _in_the_middle(photo: Photo) -> Fit:
    scale = FIRST_SIZE / max(photo.width, photo.height)
    matrix = np.array([[scale, 0.0], [0.0, -scale]])
    return Fit(matrix, np.array([-photo.width, photo.height]) * scale / 2, ())
