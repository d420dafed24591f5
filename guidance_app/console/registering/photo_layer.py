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
    """One photo at most. Until two points are matched it lies in the middle of the map, north up."""

    def __init__(self, sketch: Sketch) -> None:
        self._sketch = sketch
        self.photo: Photo | None = None
        self.points: list[MatchedPoint] = []
        self._drawn: object = None

    def lay(self, photo: Photo | None, points: tuple[MatchedPoint, ...] = ()) -> None:
        """Lays another photo, or takes it away."""
        self.photo = photo
        self.points = list(points)
        self._drawn = None
        if photo is None:
            self._sketch.picture(None)

    def frame(self) -> FieldFrame | None:
        """A frame at the first matched point, for a map that has no place of its own."""
        return None if not self.points else FieldFrame(self.points[0].latitude_deg, self.points[0].longitude_deg)

    def fit(self, frame: FieldFrame | None) -> Fit | None:
        """Where the photo lies in a frame by its points. Raises ``FitError``; None with fewer than two."""
        return None if frame is None or len(self.points) < 2 else fitted(self.points, frame)

    def placed(self, frame: FieldFrame | None) -> Fit | None:
        """Where it lies now: by its points, else in the middle; None without a photo."""
        if self.photo is None:
            return None
        try:
            fit = self.fit(frame)
        except FitError:
            fit = None
        return fit or _in_the_middle(self.photo)

    def show(self, frame: FieldFrame | None) -> None:
        """Draws it when it, its place, or the map has changed."""
        if self.photo is None:
            return
        key = (id(self.photo), tuple(self.points), frame, self._sketch.has_picture)
        if key == self._drawn:
            return
        fit = self.placed(frame)
        assert fit is not None
        self._sketch.picture(sheet(self.photo, fit.ground(_corners(self.photo))))
        self._drawn = (*key[:3], True)


def _corners(photo: Photo) -> FloatArray:
    width, height = photo.width, photo.height
    return np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])


def _in_the_middle(photo: Photo) -> Fit:
    scale = FIRST_SIZE / max(photo.width, photo.height)
    matrix = np.array([[scale, 0.0], [0.0, -scale]])
    return Fit(matrix, np.array([-photo.width, photo.height]) * scale / 2, ())
