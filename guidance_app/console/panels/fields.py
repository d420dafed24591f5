"""The fields panel: the list, four ways to a new field, and what can be done with one that is stored."""

import mimetypes
from collections.abc import Callable
from typing import ClassVar

import viser

from guidance_app.boundary import CheckedField, checked_boundary
from guidance_app.console.card import Card
from guidance_app.console.desk import Desk, Hands
from guidance_app.console.files import Download, link_html
from guidance_app.console.registering.atelier import Atelier, Way, area_words
from guidance_app.console.registering.by_driving import Driving
from guidance_app.console.registering.by_file import FromFile
from guidance_app.console.registering.by_photo import OnPhoto
from guidance_app.console.registering.by_tapping import Tapping
from guidance_app.console.registering.by_typing import Typing
from guidance_app.console.registering.editing import Editing
from guidance_app.console.registering.photo_layer import PhotoLayer
from guidance_app.console.registering.preview import Preview
from guidance_app.console.widgets import Shown, buttons, notice_html, rows_html
from guidance_app.documents import FieldDocument, Operation
from guidance_app.exchange import WRITERS, written_as
from guidance_app.language import message
from guidance_app.store import Removed, Stored
from guidance_app.view.camera import ViewMode
from guidance_app.view.units import distance_text

__all__ = ["Fields"]

WAYS: dict[str, Callable[[Atelier], Way]] = {
    message("Tap"): Tapping,
    message("Drive"): Driving,
    message("Type"): Typing,
    message("File"): FromFile,
    message("Photo"): OnPhoto,
}


KINDS = {".zip": "Shapefile", ".xml": "ISOXML", ".geojson": "GeoJSON"}
"""What people call a file by its ending, where that is not the ending."""


class Fields:
    """One card: the list, a way to a new field, its preview, or the changes to one."""

    title: ClassVar[str] = message("Fields")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._gui = gui
        self._hands = hands
        self._words = hands.words
        self._way: Way | None = None
        self._removed: Removed | None = None
        self._chosen: str | None = None
        self._atelier = Atelier(gui, hands, self._offer, self._list, PhotoLayer(hands.sketch))
        self._card = Card(gui)
        self._list()

    def show(self, desk: Desk) -> None:
        """Brings the way in hand up to now."""
        del desk
        self._atelier.layer.show(self._atelier.frame())
        if self._way is not None:
            self._way.show()

    # --- from one card to the next ---------------------------------------------------------------------------------

    def _leave(self) -> None:
        way, self._way = self._way, None
        if way is not None:
            way.close()

    def _list(self) -> None:
        self._leave()
        self._card.fill(self._build_list)

    def _begin(self, way: Callable[[Atelier], Way]) -> None:
        self._leave()

        def build() -> None:
            self._way = way(self._atelier)

        self._card.fill(build)

    def _offer(self, fields: tuple[CheckedField, ...], origin: str) -> None:
        self._begin(lambda atelier: Preview(atelier, fields, origin, self._was_stored))

    def _was_stored(self, name: str) -> None:
        self._chosen = name
        self._hands.tell(self._words("Field stored"), name)
        self._list()

    # --- the list --------------------------------------------------------------------------------------------------

    def _build_list(self) -> None:
        store = self._hands.house.store
        stored = () if store is None else store.list(FieldDocument)
        names = tuple(one.document.name for one in stored)
        new = tuple((self._words(name), lambda way=way: self._begin(way)) for name, way in WAYS.items())
        if not stored:
            self._gui.add_html(
                notice_html(
                    [
                        self._words(
                            "No field is registered yet. Tap its corners, drive around it, type it, or take a file."
                        )
                    ]
                )
            )
        buttons(self._gui, self._words("New field"), new)
        if self._removed is not None:
            undo = self._gui.add_button(self._words("Bring '{name}' back", name=self._removed.name), color="gray")

            @undo.on_click
            async def _(_: object) -> None:
                self._hands.later(self._bring_back)

        if stored:
            if self._chosen not in names:
                self._chosen = names[0]
            which = self._gui.add_dropdown(self._words("Field"), names, initial_value=self._chosen)

            @which.on_update
            async def _(_: object) -> None:
                self._chosen = which.value
                self._list()

            self._build_one(next(one for one in stored if one.document.name == self._chosen))

    def _build_one(self, stored: Stored[FieldDocument]) -> None:
        document, words, gui = stored.document, self._words, self._gui
        checked = checked_boundary(document.boundary.coordinates)
        units = self._hands.desk().units
        store = self._hands.house.store
        operations = () if store is None else store.list(Operation, document.name)
        rows = [
            (words("area"), area_words(checked.area, units, words)),
            (words("around"), distance_text(checked.perimeter, units, words)),
            (words("exclusions"), str(len(document.boundary.coordinates) - 1)),
            (words("operations"), ", ".join(one.document.name for one in operations) or "–"),
        ]
        Shown(gui).show(rows_html(rows))
        buttons(
            gui,
            "",
            (
                (words("Show"), lambda: self._hands.later(lambda: self._show_on_map(document))),
                (words("Change"), lambda: self._hands.later(lambda: self._edit(stored))),
                (words("Delete"), lambda: self._hands.later(lambda: self._delete(document))),
            ),
        )
        name = gui.add_text(words("Name"), document.name)
        rename = gui.add_button(words("Rename"), color="gray")

        @rename.on_click
        async def _(_: object) -> None:
            self._hands.later(lambda: self._rename(document.name, name.value))

        with gui.add_folder(words("Export"), expand_by_default=False):
            for suffix in WRITERS:
                gui.add_html(self._export_link(document, suffix))

    def _export_link(self, document: FieldDocument, suffix: str) -> str:
        def make() -> Download:
            media_type = mimetypes.guess_type(f"field{suffix}")[0] or "application/octet-stream"
            return Download(f"{document.name}{suffix}", media_type, written_as(suffix, document))

        return link_html(self._hands.house.files.offer(make), KINDS.get(suffix, suffix.removeprefix(".").upper()))

    def _show_on_map(self, document: FieldDocument) -> None:
        if self._hands.house.show_field(document):
            self._hands.look(ViewMode.WHOLE_FIELD)
        else:
            words = self._words("A drive is under way: end it to look at other fields.")
            self._hands.tell(self._words("Not shown"), words, bad=True)

    def _edit(self, stored: Stored[FieldDocument]) -> None:
        self._show_on_map(stored.document)
        self._begin(lambda atelier: Editing(atelier, stored.document, stored.revision, self._changed))

    def _changed(self) -> None:
        """Nothing to do until the list is shown again, which reads it anew."""

    def _rename(self, name: str, new_name: str) -> None:
        store = self._hands.house.store
        assert store is not None
        store.rename(FieldDocument, name, new_name)
        self._chosen = " ".join(new_name.split())
        self._list()

    def _delete(self, document: FieldDocument) -> None:
        store = self._hands.house.store
        assert store is not None
        self._removed = store.delete(FieldDocument, document.name)
        self._chosen = None
        self._list()

    def _bring_back(self) -> None:
        store, removed = self._hands.house.store, self._removed
        if store is None or removed is None:
            return
        store.undo(removed)
        self._removed = None
        self._chosen = None
        self._list()
