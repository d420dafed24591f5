"""The preview that every way to a field ends in: the field on the map, its size, what was repaired, take it or not."""

from collections.abc import Callable
from typing import Any

import viser

from guidance_app.boundary import CheckedField
from guidance_app.console.desk import Desk
from guidance_app.console.registering.atelier import Atelier
from guidance_app.console.widgets import Shown, notice_html, rows_html
from guidance_app.documents import Units
from guidance_app.geodesy import FieldFrame
from guidance_app.store import StoreError
from guidance_app.view.camera import ViewMode
from guidance_app.view.units import area_text, distance_text

__all__ = ["Preview"]

RING = "preview"


class Preview:
    """Shows fields that are not stored yet, one at a time. ``stored`` is called with the name of the last one taken."""

    def __init__(
        self,
        gui: viser.GuiApi,
        atelier: Atelier,
        fields: tuple[CheckedField, ...],
        origin: str,
        stored: Callable[[str], None],
    ) -> None:
        self._atelier = atelier
        self._hands = atelier.hands
        self._words = words = atelier.hands.words
        self._fields = fields
        self._origin = origin
        self._stored = stored
        self._chosen = 0
        self._drawn: object = None
        self._which = None
        if len(fields) > 1:
            self._which = gui.add_dropdown(words("Field in the file"), self._options())

            @self._which.on_update
            async def _(_: object) -> None:
                self._choose()

        self._name: Any = gui.add_text(words("Name"), fields[0].document.name)
        self._rows = Shown(gui)
        self._remarks = Shown(gui)
        take = gui.add_button(words("Store this field"), color="green")
        if len(fields) > 1:
            every = gui.add_button(words("Store all {count}", count=len(fields)), color="green")

            @every.on_click
            async def _(_: object) -> None:
                self._hands.later(self._take_all)

        leave = gui.add_button(words("Cancel"), color="gray")

        @take.on_click
        async def _(_: object) -> None:
            self._hands.later(self._take)

        @leave.on_click
        async def _(_: object) -> None:
            atelier.cancel()

        self._hands.later(self._show_on_map)

    def _options(self) -> tuple[str, ...]:
        return tuple(f"{number}: {one.document.name}" for number, one in enumerate(self._fields, start=1))

    def _choose(self) -> None:
        """On viser's loop, the name at once: the next press may already store this field."""
        assert self._which is not None
        self._chosen = self._options().index(self._which.value)
        self._name.value = self._fields[self._chosen].document.name
        self._hands.soon()
        self._hands.later(self._show_on_map)

    def _tell(self, units: Units) -> None:
        field = self._fields[self._chosen]
        words = self._words
        rings = field.document.boundary.coordinates
        rows = [
            (words("area"), area_text(field.area, units, words)),
            (words("around"), distance_text(field.perimeter, units, words)),
            (words("corners"), str(len(rings[0]) - 1)),
            (words("from"), self._origin),
        ]
        if len(rings) > 1:
            rows.insert(3, (words("exclusions"), str(len(rings) - 1)))
        self._rows.show(rows_html(rows))
        self._remarks.show(notice_html(words.say(one) for one in field.remarks))

    def _show_on_map(self) -> None:
        """On the map by itself; while something is driven, as a line over its map."""
        document = self._fields[self._chosen].document
        if self._hands.house.show_field(document):
            self._hands.look(ViewMode.WHOLE_FIELD)

    def _take(self) -> None:
        self._store(self._chosen, self._name.value)
        self._stored(self._name.value)

    def _take_all(self) -> None:
        for number, field in enumerate(self._fields):
            self._store(number, self._atelier.unique_name(field.document.name))
        self._stored(self._fields[-1].document.name)

    def _store(self, number: int, name: str) -> None:
        store = self._hands.house.store
        if store is None:
            raise StoreError(self._words("This console has no data folder: start it with --data."))
        document = self._fields[number].document
        try:
            renamed = type(document).model_validate({**document.model_dump(), "name": name})
        except ValueError as error:
            raise StoreError(self._words("A name needs 1 to 120 letters.")) from error
        store.save(renamed)

    def show(self, desk: Desk) -> None:
        """Tells the size; over the map of a drive the ring is drawn as soon as that map has a place."""
        self._tell(desk.units)
        if not self._hands.house.driving:
            return
        snapshot = desk.snapshot
        key = (self._chosen, snapshot.ground_version, self._hands.sketch.scene_number)
        if snapshot.origin_deg is None or key == self._drawn:
            return
        self._drawn = key
        frame = FieldFrame(*snapshot.origin_deg)
        for number, ring in enumerate(self._fields[self._chosen].document.boundary.coordinates):
            self._hands.sketch.line(f"{RING}{number}", frame.array_from_lonlat(ring))

    def close(self) -> None:
        """Takes the drawing away."""
        self._hands.sketch.clear()
