"""The map method of Inoue et al.: a photo on the ground, matched by points, and fields drawn over it."""

from typing import Any

import viser

from guidance_app.boundary import BoundaryError
from guidance_app.console.desk import Desk
from guidance_app.console.files import upload_html
from guidance_app.console.photo import Photo, PhotoError, opened_photo
from guidance_app.console.registering.atelier import Atelier
from guidance_app.console.widgets import Shown, buttons, notice_html, rows_html
from guidance_app.coordinates import CornerError, parse_corner
from guidance_app.documents import MatchedPoint, PhotoMap
from guidance_app.geodesy import CoordinateSystem, FieldFrame
from guidance_app.map_fitting import Fit, FitError
from guidance_app.store import StoreError
from guidance_app.store.photo_maps import StoredMap, delete_map, list_maps, picture_of, save_map

__all__ = ["OnPhoto"]

SPOT, MATCHED = "spot", "matched"
GREEN = (47, 158, 68)


class OnPhoto:
    """Lays a photo and matches it: a tap on the photo, then where that is."""

    def __init__(self, gui: viser.GuiApi, atelier: Atelier) -> None:
        self._atelier = atelier
        self._hands = atelier.hands
        self._words = words = atelier.hands.words
        self._layer = atelier.layer
        self._spot: tuple[float, float] | None = None
        self._drawn: object = None
        self._named = self._layer.photo
        """The photo whose name stands in the entry."""
        self._typed = self._typed_shown = 0
        """How many typed places were taken, and of how many the entry was emptied."""
        self._token = self._hands.house.files.awaits(self._take)
        self._maps = self._stored()
        if self._maps:
            self._which = gui.add_dropdown(words("Stored maps"), tuple(one.document.name for one in self._maps))
            actions = (
                (words("Lay"), lambda: self._hands.later(self._lay_stored)),
                (words("Delete"), lambda: self._hands.later(self._delete_stored)),
            )
            buttons(gui, "", actions)
        gui.add_html(upload_html(self._token, words("Choose a photo or a scanned map"), ".png,.jpg,.jpeg,.tif,.tiff"))
        self._notice = Shown(gui)
        self._place: Any = gui.add_text(words("Latitude, longitude of the spot"), "")
        self._match = buttons(
            gui,
            words("Match"),
            (
                (words("As typed"), lambda: self._hands.later(self._match_typed)),
                (words("I stand there"), lambda: self._hands.later(self._match_here)),
                (words("Undo"), self._undo),
            ),
        )
        self._rows = Shown(gui)
        self._name: Any = gui.add_text(words("Name of the map"), "")
        buttons(
            gui,
            "",
            (
                (words("Keep the map"), lambda: self._hands.later(self._keep)),
                (words("Take away"), self._take_away),
                (words("Done"), atelier.cancel),
            ),
        )
        self._hands.sketch.hear_taps(self._tap)

    # --- photos ----------------------------------------------------------------------------------------------------

    def _stored(self) -> tuple[StoredMap, ...]:
        store = self._hands.house.store
        return () if store is None else list_maps(store.root)

    def _take(self, name: str, content: bytes) -> None:
        def lay() -> None:
            try:
                photo = opened_photo(name, content)
            except PhotoError as error:
                raise BoundaryError(str(error)) from error
            self._lay(photo, photo.points)

        self._hands.later(lay)

    def _lay(self, photo: Photo, points: tuple[MatchedPoint, ...]) -> None:
        self._spot = None
        self._layer.lay(photo, points)
        self._hands.soon()

    def _chosen(self) -> StoredMap:
        return next(one for one in self._maps if one.document.name == self._which.value)

    def _lay_stored(self) -> None:
        stored = self._chosen()
        document = stored.document
        photo = Photo(document.name, picture_of(stored), document.width, document.height)
        self._lay(photo, tuple(document.points))

    def _delete_stored(self) -> None:
        store = self._hands.house.store
        assert store is not None
        delete_map(store.root, self._chosen())
        self._atelier.cancel()

    def _take_away(self) -> None:
        self._spot = None
        self._layer.lay(None)
        self._hands.soon()

    def _keep(self) -> None:
        store, photo = self._hands.house.store, self._layer.photo
        if store is None or photo is None or len(self._layer.points) < 2:
            raise StoreError(self._words("A map is kept once two of its points are matched."))
        try:
            document = PhotoMap(
                name=self._name.value, width=photo.width, height=photo.height, points=self._layer.points
            )
        except ValueError as error:
            raise StoreError(self._words("A name needs 1 to 120 letters.")) from error
        save_map(store.root, document, photo.picture)
        self._hands.tell(self._words("Map kept"), document.name)

    # --- matching --------------------------------------------------------------------------------------------------

    def _frame(self) -> FieldFrame | None:
        return self._atelier.frame()

    def _tap(self, east: float, north: float) -> None:
        """The spot of the photo under the finger."""
        fit = self._layer.placed(self._frame())
        if fit is not None:
            pixel = fit.pixels([(east, north)])[0]
            self._spot = float(pixel[0]), float(pixel[1])
            self._hands.soon()

    def _match_typed(self) -> None:
        try:
            corner = parse_corner(self._place.value, CoordinateSystem())
        except CornerError as error:
            raise BoundaryError(str(error)) from error
        self._add(corner.latitude_deg, corner.longitude_deg)
        self._typed += 1
        self._spot = None

    def _match_here(self) -> None:
        snapshot = self._hands.desk().snapshot
        if snapshot.pose is None or snapshot.origin_deg is None:
            raise BoundaryError(self._words("The receiver gives no position: start one under Start."))
        self._add(*FieldFrame(*snapshot.origin_deg).degrees_from_east_north(snapshot.pose.east, snapshot.pose.north))
        self._spot = None

    def _add(self, latitude: float, longitude: float) -> None:
        """One more point. Raises ``BoundaryError``, and everything stays as it is, when it fits with no other."""
        if self._spot is None:
            raise BoundaryError(self._words("Tap the spot on the photo first."))
        point = MatchedPoint(right=self._spot[0], down=self._spot[1], longitude_deg=longitude, latitude_deg=latitude)
        try:
            self._layer.match(point, self._frame())
        except FitError as error:
            raise BoundaryError(str(error)) from error

    def _undo(self) -> None:
        if self._spot is not None:
            self._spot = None
        elif self._layer.points:
            self._layer.points.pop()

    # --- what is shown ---------------------------------------------------------------------------------------------

    def show(self, desk: Desk) -> None:
        """Brings words, entries, spot and residuals up to the matching."""
        del desk
        frame, layer, words = self._frame(), self._layer, self._words
        self._show_entries()
        if layer.photo is None:
            self._notice.show(
                notice_html([words("Lay a photo or a scanned map on the ground, then draw fields over it.")])
            )
        elif len(layer.points) < 2:
            said = words("Tap a spot on the photo whose place you know, then say where it is. Two spots lay the photo.")
            self._notice.show(notice_html([said]))
        else:
            self._notice.show(notice_html([words("The photo lies. More spots make it better; then tap a new field.")]))
        spot, points = self._spot, list(layer.points)
        key = (frame, tuple(points), spot, id(layer.photo), self._hands.sketch.scene_number)
        if key == self._drawn:
            return
        self._drawn = key
        fit = layer.placed(frame)
        self._hands.sketch.corners(SPOT, [] if fit is None or spot is None else fit.ground([spot]))
        spots = [(one.right, one.down) for one in points]
        self._hands.sketch.corners(MATCHED, [] if fit is None or not spots else fit.ground(spots), GREEN)
        self._rows.show(rows_html(_rows(points, fit, self._words)))

    def _show_entries(self) -> None:
        """A new photo brings its name along; a typed place that was taken is typed no more."""
        photo, typed = self._layer.photo, self._typed
        if photo is not self._named:
            self._named = photo
            if photo is not None:
                self._name.value = photo.name
        if typed != self._typed_shown:
            self._typed_shown = typed
            self._place.value = ""

    def close(self) -> None:
        """Awaits no photo any longer; the photo stays on the map."""
        self._hands.house.files.forget(self._token)
        self._hands.sketch.clear()


def _rows(points: list[MatchedPoint], fit: Fit | None, words: Any) -> list[tuple[str, str]]:
    """Each matched point with its residual, and how large a pixel is."""
    rows = []
    for number, one in enumerate(points, start=1):
        away = ""
        if fit is not None and len(fit.residuals) == len(points) > 2:
            away = words("{metres} m off", metres=words.number(fit.residuals[number - 1], 2))
        rows.append((words("Spot {number}", number=number), f"{one.latitude_deg:.6f}, {one.longitude_deg:.6f} {away}"))
    if fit is not None and len(points) > 1:
        rows.append((words("a pixel is"), words("{metres} m", metres=words.number(fit.metres_per_pixel, 3))))
    return rows
