"""Changing a field that is stored: corners, exclusions, a cut in two, a shift onto a known point.

Each change is one tap or two, is stored at once and can be taken back; nothing is stored that the checks refuse.
"""

import datetime

import shapely
import viser

from guidance_app.boundary import BoundaryError, frame_of
from guidance_app.console.desk import Desk
from guidance_app.console.registering.atelier import Atelier
from guidance_app.console.widgets import Shown, buttons, notice_html, rows_html
from guidance_app.documents import FieldDocument
from guidance_app.field_editing import (
    Corner,
    moved_corner,
    nearest_corner,
    rings_in,
    shifted,
    split,
    unshifted,
    with_corner,
    with_exclusion,
    without_corner,
    without_exclusion,
)
from guidance_app.geodesy import FieldFrame
from guidance_app.language import message
from guidance_app.model import FloatArray
from guidance_app.store import Store, StoreError
from guidance_app.view.units import area_text

__all__ = ["Editing"]

CORNERS, CHOSEN, LINE = "corners", "chosen", "line"
GREEN = (47, 158, 68)
MODES = (
    message("Move a corner"),
    message("Add a corner"),
    message("Remove a corner"),
    message("Add an exclusion"),
    message("Cut in two"),
)
MOVE, ADD, REMOVE, EXCLUDE, CUT = MODES
HELP = {
    MOVE: message("Tap a corner, then where it belongs."),
    ADD: message("Tap where the new corner belongs; it goes into the nearest edge."),
    REMOVE: message("Tap the corner that goes."),
    EXCLUDE: message("Tap around the obstacle, then press Finish."),
    CUT: message("Tap two or more points along the cut, then press Finish."),
}


class Editing:
    """Works on one stored field, at the revision that was read."""

    def __init__(self, gui: viser.GuiApi, atelier: Atelier, document: FieldDocument, revision: str) -> None:
        self._atelier = atelier
        self._hands = atelier.hands
        self._words = words = atelier.hands.words
        self._document = document
        self._revision = revision
        self._history: list[FieldDocument] = []
        self._mode = MOVE
        self._chosen: Corner | None = None
        self._taps: list[tuple[float, float]] = []
        self._drawn: object = None
        self._modes = gui.add_dropdown(words("Change"), tuple(words(mode) for mode in MODES))
        self._help = Shown(gui)
        self._rows = Shown(gui)
        self._finish = gui.add_button(words("Finish"), color="green", visible=False)
        self._shift = gui.add_button(words("I stand on the nearest corner"), color="gray", visible=False)
        buttons(gui, "", ((words("Undo"), lambda: self._hands.later(self._undo)), (words("Done"), atelier.cancel)))
        buttons(
            gui,
            words("Take back"),
            (
                (words("Last shift"), lambda: self._hands.later(self._unshift)),
                (words("Last exclusion"), lambda: self._hands.later(self._drop_exclusion)),
            ),
        )

        @self._modes.on_update
        async def _(_: object) -> None:
            self._change_mode()

        @self._finish.on_click
        async def _(_: object) -> None:
            self._hands.later(self._finish_line)

        @self._shift.on_click
        async def _(_: object) -> None:
            self._hands.later(self._shift_here)

        self._hands.sketch.hear_taps(self._tap)

    # --- what is on the map ----------------------------------------------------------------------------------------

    def _frame(self) -> FieldFrame:
        """The frame of the map, else the field's own."""
        return self._atelier.frame() or frame_of(self._document.boundary)

    def _change_mode(self) -> None:
        self._mode = MODES[self._modes.options.index(self._modes.value)]
        self._chosen, self._taps = None, []
        self._hands.soon()

    def show(self, desk: Desk) -> None:
        """Draws the corners on the map as it lies now, tells the field's size, and what to do next."""
        self._help.show(notice_html([self._words(HELP[self._mode])]))
        self._finish.visible = self._mode in (EXCLUDE, CUT)
        self._shift.visible = desk.snapshot.pose is not None
        sketch, document, chosen, taps = self._hands.sketch, self._document, self._chosen, tuple(self._taps)
        key = (desk.snapshot.origin_deg, sketch.scene_number, document, chosen, taps)
        if key == self._drawn:
            return
        self._drawn = key
        rings = rings_in(self._frame(), document)
        sketch.corners(CORNERS, [tuple(point) for ring in rings for point in ring.tolist()])
        marked = [] if chosen is None else [tuple(rings[chosen[0]][chosen[1]].tolist())]
        sketch.corners(CHOSEN, [*marked, *taps], GREEN)
        sketch.line(LINE, taps, GREEN)
        area = float(_polygon_area(rings))
        rows = [
            (self._words("area"), area_text(area, desk.units, self._words)),
            (self._words("corners"), str(sum(len(ring) for ring in rings))),
            (self._words("shifts"), str(len(document.shifts))),
        ]
        self._rows.show(rows_html(rows))

    # --- taps ------------------------------------------------------------------------------------------------------

    def _tap(self, east: float, north: float) -> None:
        point = (east, north)
        match self._mode:
            case "Move a corner" if self._chosen is None:
                self._chosen = nearest_corner(self._frame(), self._document, point)[0]
            case "Move a corner":
                self._hands.later(lambda: self._move_chosen(point))
            case "Add a corner":
                self._hands.later(lambda: self._store(with_corner(self._frame(), self._document, point)))
            case "Remove a corner":
                self._hands.later(lambda: self._remove_near(point))
            case _:
                self._taps.append(point)
        self._hands.soon()

    def _move_chosen(self, to: tuple[float, float]) -> None:
        corner, self._chosen = self._chosen, None
        if corner is not None:
            self._store(moved_corner(self._frame(), self._document, corner, to))

    def _remove_near(self, point: tuple[float, float]) -> None:
        frame = self._frame()
        self._store(without_corner(frame, self._document, nearest_corner(frame, self._document, point)[0]))

    def _finish_line(self) -> None:
        taps, self._taps = self._taps, []
        if self._mode == EXCLUDE:
            if len(taps) < 3:
                raise BoundaryError(self._words("An exclusion needs three taps around the obstacle."))
            self._store(with_exclusion(self._frame(), self._document, taps))
        elif self._mode == CUT:
            self._cut(taps)

    def _cut(self, taps: list[tuple[float, float]]) -> None:
        """The field becomes two new ones; the whole one goes to the trash, from where it comes back."""
        first, second = split(self._frame(), self._document, taps)
        store = self._stored_in()
        for part in (first, second):
            store.save(part.model_copy(update={"name": self._atelier.unique_name(part.name)}))
        store.delete(FieldDocument, self._document.name)
        self._hands.tell(
            self._words("Cut in two"),
            self._words("The whole field is in the trash; its operations with it."),
        )
        self._atelier.cancel()

    # --- shifts ----------------------------------------------------------------------------------------------------

    def _shift_here(self) -> None:
        pose = self._hands.desk().snapshot.pose
        if pose is None:
            return
        frame = self._frame()
        here = (pose.east, pose.north)
        corner, _ = nearest_corner(frame, self._document, here)
        there = rings_in(frame, self._document)[corner[0]][corner[1]]
        east, north = here[0] - float(there[0]), here[1] - float(there[1])
        when = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        reason = self._words("stood on corner {number}", number=corner[1] + 1)
        self._store(shifted(self._document, east, north, when, reason))
        self._hands.tell(
            self._words("Field shifted"),
            self._words("{east:.2f} m east, {north:.2f} m north. Undo takes it back.", east=east, north=north),
        )

    def _unshift(self) -> None:
        self._store(unshifted(self._document))

    def _drop_exclusion(self) -> None:
        self._store(without_exclusion(self._document, len(self._document.boundary.coordinates) - 1))

    # --- storing ---------------------------------------------------------------------------------------------------

    def _stored_in(self) -> Store:
        store = self._hands.house.store
        if store is None:
            raise StoreError(self._words("This console has no data folder: start it with --data."))
        return store

    def _store(self, document: FieldDocument, *, remember: bool = True) -> None:
        revision = self._stored_in().save(document, self._revision)
        if remember:
            self._history.append(self._document)
        self._document, self._revision = document, revision
        self._hands.house.show_field(document)

    def _undo(self) -> None:
        if self._taps:
            self._taps.pop()
        elif self._chosen is not None:
            self._chosen = None
        elif self._history:
            self._store(self._history.pop(), remember=False)

    def close(self) -> None:
        """Stops listening and takes the sketch away."""
        self._hands.sketch.clear()


def _polygon_area(rings: list[FloatArray]) -> float:
    return float(shapely.Polygon(rings[0], rings[1:]).area)
