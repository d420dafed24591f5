"""The settings panel: units, language, light bar, day and night, the guided point; backup, restore and the trash."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import ClassVar

import viser
from pydantic import Field

from guidance_app.console.backups import backup_of, contents_of, in_trash, put_back, restored_from
from guidance_app.console.desk import Desk, Hands
from guidance_app.console.files import Download, link_html, upload_html
from guidance_app.console.forms import Form, heading_html, hint_html
from guidance_app.console.pages import Pages, Still, press
from guidance_app.console.widgets import Shown, buttons, notice_html
from guidance_app.documents import Settings as SettingsDocument
from guidance_app.language import Words, message
from guidance_app.store import Store, StoreConflictError, StoreError
from guidance_app.view.lamp_steps import PRESETS, steps_from_text, steps_text, steps_unit

__all__ = ["Settings"]

LARGEST_BACKUP = 256 * 1024 * 1024
"""Bytes that a restore takes over the network; a larger archive is unpacked into the data folder by hand."""


class _Entries(SettingsDocument):
    """The settings as they are typed."""

    steps: str = Field("", title="Light bar steps", max_length=120)


class Settings:
    """The form, and the care for the data folder."""

    title: ClassVar[str] = message("Settings")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._pages: Pages | None = None
        self._hands = hands
        if hands.house.store is None:
            gui.add_html(notice_html([hands.words("This console has no data folder: nothing can be stored.")]))
            return
        self._pages = Pages(gui, hands)
        self._care = _Care(self._pages, hands, hands.house.store, self._open)
        self._open()

    def _open(self, said: str = "") -> None:
        assert self._pages is not None, "there is a data folder"
        self._pages.turn(lambda gui: _SettingsPage(gui, self._hands, self._care, said))

    def show(self, desk: Desk) -> None:
        """Brings the open page up to what is."""
        if self._pages is not None:
            self._pages.show(desk)


class _SettingsPage:
    def __init__(self, gui: viser.GuiApi, hands: Hands, care: "_Care", said: str) -> None:
        assert hands.house.store is not None, "there is a data folder"
        self._hands, self._words, self._store = hands, hands.words, hands.house.store
        stored = self._store.settings()
        self._revision = None if stored is None else stored.revision
        self._before = hands.house.settings()
        if said:
            gui.add_html(notice_html([said]))
        words, units = hands.words, self._before.units
        initial = {**self._before.model_dump(), "steps": steps_text(self._before.light_bar_steps, units, words)}
        self._form = Form(
            gui,
            _Entries,
            initial,
            words,
            units,
            members=("units", "language", "steps", "night", "sounds", "guide_implement"),
            after={"steps": lambda: self._offer_presets(gui)},
            touched=hands.soon,
        )
        press(gui, words("Save"), lambda: hands.later(self._save), "green")
        self._said = Shown(gui)
        care.offer(gui)

    def _offer_presets(self, gui: viser.GuiApi) -> None:
        words, units = self._words, self._before.units
        named = {"fine": words("Fine"), "usual": words("Usual"), "coarse": words("Coarse")}

        def take(name: str) -> None:
            self._form.set("steps", steps_text(PRESETS[name], units, words))

        gui.add_html(hint_html(words("Eight numbers in {unit}, from the middle outward", unit=steps_unit(units))))
        buttons(gui, words("Take"), tuple((label, partial(take, name)) for name, label in named.items()))

    def _save(self) -> None:
        typed = self._form.read()
        if typed is None:
            return
        try:
            steps = steps_from_text(typed.steps, self._before.units, self._words)
            values = typed.model_dump(exclude={"steps"}) | {"light_bar_steps": steps}
            settings = SettingsDocument.model_validate(values)
        except ValueError as error:
            self._form.say({"steps": _first_sentence(error, self._words)})
            return
        try:
            self._store.save(settings, self._revision)
        except StoreConflictError as error:
            self._revision = None if error.current is None else error.current.revision
            self._form.say(
                {"": self._words("Another console has changed the settings meanwhile. Press Save again to keep yours.")}
            )
            return
        self._apply(settings)

    def _apply(self, settings: SettingsDocument) -> None:
        """What can change at once does; the rest is said."""
        words, before, hands = self._words, self._before, self._hands
        later = hands.house.driving and settings.guide_implement != before.guide_implement
        hands.house.manager.show_as(settings)
        hands.set_night(settings.night)
        if later:
            point = words("implement") if settings.guide_implement else words("tractor")
            hands.tell(words("Stored"), words("The {point} is guided from the next drive on.", point=point))
        else:
            hands.tell(words("Stored"))
        stored = self._store.settings()
        self._revision = None if stored is None else stored.revision
        self._before = settings
        if (settings.units, settings.language) != (before.units, before.language):
            hands.renew()

    def show(self, desk: Desk) -> None:
        """Brings the form up to what was touched."""
        self._form.show(desk)


def _first_sentence(error: ValueError, words: Words) -> str:
    """Of a document's check, or of the typed numbers."""
    errors: Callable[[], list[Mapping[str, str]]] | None = getattr(error, "errors", None)
    return words.say(str(error)) if errors is None else words.say(errors()[0]["msg"])


class _Care:
    """Backup, restore and trash. Restoring replaces everything, so it asks with what is in the archive."""

    def __init__(self, pages: Pages, hands: Hands, store: Store, back: Callable[[str], None]) -> None:
        self._pages, self._hands, self._words = pages, hands, hands.words
        self._store, self._back = store, back
        self._before: Path | None = None

    def offer(self, gui: viser.GuiApi) -> None:
        """Its part of the settings page."""
        words, house = self._words, self._hands.house
        gui.add_html(heading_html(words("Data")))
        address = house.files.offer(self._backup, "backup.zip")
        gui.add_html(link_html(address, words("Download a backup of everything")))
        token = house.files.awaits(self._taken, LARGEST_BACKUP)
        gui.add_html(upload_html(token, words("Restore a backup"), ".zip"))
        if self._before is not None:
            press(gui, words("Undo the restore"), lambda: self._hands.later(self._undo), "orange")
        count = in_trash(self._store.root)
        if count:
            label = words("Empty the trash ({count})", count=count)
            press(gui, label, lambda: self._pages.turn(partial(_TrashPage, self, count)))

    def _backup(self) -> Download | None:
        try:
            return backup_of(self._store.root)
        except StoreError as error:
            self._hands.tell(self._words("Not done"), self._words.say(str(error)), bad=True)
            return None

    def _taken(self, name: str, archive: bytes) -> None:
        self._hands.later(lambda: self._ask(name, archive))

    def _ask(self, name: str, archive: bytes) -> None:
        counts = contents_of(archive)
        self._pages.turn(lambda gui: _RestorePage(gui, self, name, counts, archive))

    def restore(self, archive: bytes) -> None:
        """Replaces what is stored, unless it is being driven by it."""

        def work() -> None:
            if self._hands.house.driving:
                raise StoreError(self._words("A drive is recorded into this data: end it first, then restore."))
            self._before = restored_from(self._store.root, archive)
            self._renewed(self._words("The backup is restored."))

        self._hands.later(work)

    def _undo(self) -> None:
        before, self._before = self._before, None
        if before is not None:
            put_back(self._store.root, before)
            self._renewed(self._words("Everything is as it was before the restore."))

    def _renewed(self, said: str) -> None:
        """Settings may have changed with the rest."""
        settings = self._hands.house.settings()
        self._hands.house.manager.show_as(settings)
        self._hands.set_night(settings.night)
        self._back(said)

    def empty_trash(self) -> None:
        """For good."""

        def work() -> None:
            self._store.empty_trash()
            self._back(self._words("The trash is empty."))

        self._hands.later(work)

    def leave(self) -> None:
        """Nothing is done."""
        self._back("")

    @property
    def words(self) -> Words:
        """The driver's language."""
        return self._words


class _RestorePage(Still):
    def __init__(self, gui: viser.GuiApi, care: _Care, name: str, counts: Mapping[str, int], archive: bytes) -> None:
        words = care.words
        held = ", ".join(f"{words(what)}: {count}" for what, count in counts.items() if count)
        gui.add_html(heading_html(words("Restore {name}?", name=name)))
        gui.add_html(notice_html([words("It holds {held}.", held=held)]))
        gui.add_html(notice_html([words("It replaces all that is stored now, which is kept aside and can be undone.")]))
        press(gui, words("Yes, replace everything"), lambda: care.restore(archive), "red")
        press(gui, words("No, leave it"), care.leave)


class _TrashPage(Still):
    def __init__(self, care: _Care, count: int, gui: viser.GuiApi) -> None:
        words = care.words
        gui.add_html(heading_html(words("Empty the trash?")))
        said = words.plural(
            "{n} deleted document can then never be brought back.",
            "{n} deleted documents can then never be brought back.",
            count,
        )
        gui.add_html(notice_html([said]))
        press(gui, words("Yes, forget them for good"), care.empty_trash, "red")
        press(gui, words("No, leave it"), care.leave)
