"""The fields panel: the list, five ways to a new field, and what can be done with one that is stored."""

import mimetypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import viser

from guidance_app.boundary import CheckedField, checked_boundary
from guidance_app.console.desk import Desk, Hands
from guidance_app.console.files import Download, link_html
from guidance_app.console.pages import Page, Pages, Still, press
from guidance_app.console.registering.atelier import Atelier
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
from guidance_app.store import Removed, Store, Stored, StoreError
from guidance_app.view.camera import ViewMode
from guidance_app.view.units import area_text, distance_text

__all__ = ["Fields"]

WAYS: dict[str, Callable[[viser.GuiApi, Atelier], Page]] = {
    message("Tap"): Tapping,
    message("Drive"): Driving,
    message("Type"): Typing,
    message("File"): FromFile,
    message("Photo"): OnPhoto,
}


KINDS = {".zip": "Shapefile", ".xml": "ISOXML", ".geojson": "GeoJSON"}
"""What people call a file by its ending, where that is not the ending."""


@dataclass(frozen=True, slots=True)
class _Found:
    """What the list shows: the names of all fields, and one of them with its size and its operations."""

    names: tuple[str, ...]
    chosen: Stored[FieldDocument] | None
    area: float = 0.0
    perimeter: float = 0.0
    operations: tuple[str, ...] = ()


class Fields:
    """One page at a time: the list, a way to a new field, its preview, or the changes to one."""

    title: ClassVar[str] = message("Fields")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._words = hands.words
        self._removed: Removed | None = None
        self._chosen: str | None = None
        self._pages = Pages(gui, hands)
        self._atelier = Atelier(hands, self._offer, self._open_list, PhotoLayer(hands.sketch))
        self._open_list()

    def show(self, desk: Desk) -> None:
        """Brings photo and page up to now."""
        self._atelier.layer.show(self._atelier.frame())
        self._pages.show(desk)

    # --- from one page to the next ---------------------------------------------------------------------------------

    def _open_list(self) -> None:
        self._hands.later(self._list)

    def _list(self) -> None:
        """On a worker: reads the fields, then turns to their list."""
        found = self._found()
        self._pages.turn(lambda gui: _ListPage(gui, self, found))

    def _found(self) -> _Found:
        store = self._hands.house.store
        stored = () if store is None else store.list(FieldDocument)
        names = tuple(one.document.name for one in stored)
        if store is None or not stored:
            return _Found((), None)
        if self._chosen not in names:
            self._chosen = names[0]
        chosen = stored[names.index(self._chosen)]
        checked = checked_boundary(chosen.document.boundary.coordinates)
        operations = tuple(one.document.name for one in store.list(Operation, chosen.document.name))
        return _Found(names, chosen, checked.area, checked.perimeter, operations)

    def choose(self, name: str) -> None:
        """Another field of the list."""
        self._chosen = name
        self._open_list()

    def begin(self, way: Callable[[viser.GuiApi, Atelier], Page]) -> None:
        """One way to a new field."""
        self._pages.turn(lambda gui: way(gui, self._atelier))

    def _offer(self, fields: tuple[CheckedField, ...], origin: str) -> None:
        self._pages.turn(lambda gui: Preview(gui, self._atelier, fields, origin, self._was_stored))

    def _was_stored(self, name: str) -> None:
        self._chosen = " ".join(name.split())
        self._hands.tell(self._words("Field stored"), self._chosen)
        self._list()

    # --- what is done with one; each on a worker -------------------------------------------------------------------

    @property
    def hands(self) -> Hands:
        """For the list."""
        return self._hands

    @property
    def removed(self) -> Removed | None:
        """What was deleted last."""
        return self._removed

    def show_on_map(self, document: FieldDocument) -> None:
        """The whole of it, unless something is driven."""
        if self._hands.house.show_field(document):
            self._hands.look(ViewMode.WHOLE_FIELD)
        else:
            words = self._words("A drive is under way: end it to look at other fields.")
            self._hands.tell(self._words("Not shown"), words, bad=True)

    def edit(self, stored: Stored[FieldDocument]) -> None:
        """Its corners, on the map."""
        self.show_on_map(stored.document)
        self._pages.turn(lambda gui: Editing(gui, self._atelier, stored.document, stored.revision))

    def rename(self, name: str, new_name: str) -> None:
        """Its operations go along."""
        self._store.rename(FieldDocument, name, new_name)
        self._chosen = " ".join(new_name.split())
        self._list()

    def delete(self, document: FieldDocument) -> None:
        """Into the trash, with its operations; the list then offers to bring it back."""
        self._removed = self._store.delete(FieldDocument, document.name)
        self._chosen = None
        self._list()

    def bring_back(self) -> None:
        """What was deleted last."""
        removed, self._removed = self._removed, None
        if removed is not None:
            try:
                self._store.undo(removed)
            except StoreError:
                self._removed = removed
                raise
        self._chosen = None
        self._list()

    @property
    def _store(self) -> Store:
        store = self._hands.house.store
        assert store is not None, "a field comes from a store"
        return store


class _ListPage(Still):
    """The ways to a new field, and one that is stored."""

    def __init__(self, gui: viser.GuiApi, fields: Fields, found: _Found) -> None:
        self._gui, self._fields, self._found = gui, fields, found
        self._hands, self._words = fields.hands, fields.hands.words
        self._addresses: list[str] = []
        words, later = self._words, self._hands.later
        new = tuple((words(name), partial(fields.begin, way)) for name, way in WAYS.items())
        if found.chosen is None:
            said = words("No field is registered yet. Tap its corners, drive around it, type it, or take a file.")
            gui.add_html(notice_html([said]))
        buttons(gui, words("New field"), new)
        removed = fields.removed
        if removed is not None:
            press(gui, words("Bring '{name}' back", name=removed.name), lambda: later(fields.bring_back))
        if found.chosen is not None:
            self._add_choice(found.chosen.document.name)
            self._add_one(found.chosen)

    def close(self) -> None:
        """Its exports are not offered any more."""
        for address in self._addresses:
            self._hands.house.files.forget(address)

    def _add_choice(self, chosen: str) -> None:
        which = self._gui.add_dropdown(self._words("Field"), self._found.names, initial_value=chosen)

        @which.on_update
        async def _(_: object) -> None:
            self._fields.choose(which.value)

    def _add_one(self, stored: Stored[FieldDocument]) -> None:
        document, words, gui, fields = stored.document, self._words, self._gui, self._fields
        later, units = self._hands.later, self._hands.desk().units
        rows = [
            (words("area"), area_text(self._found.area, units, words)),
            (words("around"), distance_text(self._found.perimeter, units, words)),
            (words("exclusions"), str(len(document.boundary.coordinates) - 1)),
            (words("operations"), ", ".join(self._found.operations) or "–"),
        ]
        Shown(gui).show(rows_html(rows))
        actions = (
            (words("Show"), lambda: later(partial(fields.show_on_map, document))),
            (words("Change"), lambda: later(partial(fields.edit, stored))),
            (words("Delete"), lambda: later(partial(fields.delete, document))),
        )
        buttons(gui, "", actions)
        name = gui.add_text(words("Name"), document.name)
        press(gui, words("Rename"), lambda: later(lambda: fields.rename(document.name, name.value)))
        with gui.add_folder(words("Export"), expand_by_default=False):
            for suffix in WRITERS:
                gui.add_html(self._export_link(document, suffix))

    def _export_link(self, document: FieldDocument, suffix: str) -> str:
        def make() -> Download:
            media_type = mimetypes.guess_type(f"field{suffix}")[0] or "application/octet-stream"
            return Download(f"{document.name}{suffix}", media_type, written_as(suffix, document))

        address = self._hands.house.files.offer(make)
        self._addresses.append(address)
        return link_html(address, KINDS.get(suffix, suffix.removeprefix(".").upper()))
