"""Documents of one kind at the screen: list, new, edit, copy, rename, archive, delete with undo, and conflicts.

A ``Shelf`` says what is special of a kind: how a document is described in the list, and its form. All reading and
writing of files is done on a thread of its own; a sentence of the store stands where it can be acted upon.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic, Protocol, TypeVar, cast

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.differences import differences_html
from guidance_app.console.forms import heading_html
from guidance_app.console.pages import Pages, Still, press
from guidance_app.console.widgets import buttons, notice_html
from guidance_app.documents import FieldDocument, Implement, Operation, Receiver, Tractor
from guidance_app.store import Removed, StoreConflictError, Stored, StoreError

__all__ = ["DocumentForm", "Shelf", "ShelfWords", "Shelves"]

N = TypeVar("N", Tractor, Implement, Receiver, FieldDocument, Operation)


class DocumentForm(Protocol):
    """A form that makes one document."""

    def read(self) -> Any:
        """The document, or None with the reasons shown."""
        ...

    def say(self, wrong: Mapping[str, str]) -> None:
        """Puts sentences under entries."""
        ...

    @property
    def changed(self) -> bool:
        """Whether something was typed."""
        ...

    def show(self, desk: Desk | None = None) -> None:
        """Brings it up to what was touched, and to what is."""
        ...

    def close(self) -> None:
        """Takes away what it has drawn outside of the panel."""
        ...


@dataclass(frozen=True, slots=True)
class ShelfWords:
    """What a kind is called, in the driver's language."""

    new: str
    edit: str
    empty: str


MakeForm = Callable[[viser.GuiApi, Mapping[str, Any], Callable[[], None], Any], DocumentForm]
"""From the values to begin with, whom to tell of a touch, and what the shelf has gathered."""


@dataclass(frozen=True, slots=True)
class Shelf(Generic[N]):
    """One kind of documents. ``line`` is what stands beside a name; ``form`` makes a form from values to begin with.

    ``gather`` reads what the form needs, on a thread of its own. ``missing`` says what must be registered before, None
    when nothing is. ``also`` is what else can be done with a stored document: its words, and what is then called.
    """

    kind: type[N]
    words: ShelfWords
    line: Callable[[N], str]
    form: MakeForm
    fresh: Callable[[], Mapping[str, Any]]
    gather: Callable[[], Any] = lambda: None
    missing: Callable[[Any], str | None] = lambda _: None
    also: tuple[str, Callable[[N], None]] | None = None


def _home(document: object) -> str | None:
    return document.field if isinstance(document, Operation) else None


class Shelves(Generic[N]):
    """The pages of one shelf. ``back`` leads to where the shelf was opened from, if anywhere."""

    def __init__(self, pages: Pages, hands: Hands, shelf: Shelf[N], back: Callable[[], None] | None = None) -> None:
        assert hands.house.store is not None, "without a store there is nothing to keep"
        self.pages = pages
        self.hands = hands
        self.shelf: Shelf[N] = shelf
        self.store = hands.house.store
        self.back = back
        self.removed: Removed | None = None

    # --- pages -----------------------------------------------------------------------------------------------------

    def open_list(self, said: str = "") -> None:
        """Reads the documents and shows the list, with a sentence on what was just done."""
        self.hands.later(lambda: self._list(said))

    def _list(self, said: str) -> None:
        found, archived = self.store.list(self.shelf.kind), self.store.archived(self.shelf.kind)
        self.pages.turn(lambda gui: _ListPage(gui, self, found, len(archived), said))

    def open_new(self, values: Mapping[str, Any] | None = None) -> None:
        """An empty form, or one that begins with these values."""

        def work() -> None:
            initial = self.shelf.fresh() if values is None else values
            gathered = self.shelf.gather()
            missing = self.shelf.missing(gathered)
            if missing is None:
                self.pages.turn(lambda gui: _EditPage(gui, self, (initial, gathered), None))
            else:
                self._list(missing)

        self.hands.later(work)

    def open_stored(self, stored: Stored[N]) -> None:
        """The form of a stored document."""

        def work() -> None:
            gathered = self.shelf.gather()
            self.pages.turn(lambda gui: _EditPage(gui, self, (stored.document.model_dump(), gathered), stored))

        self.hands.later(work)

    def open_archive(self) -> None:
        """What was archived."""

        def work() -> None:
            found = self.store.archived(self.shelf.kind)
            self.pages.turn(lambda gui: _ArchivePage(gui, self, found))

        self.hands.later(work)

    # --- what is done ----------------------------------------------------------------------------------------------

    def save(self, form: DocumentForm, stored: Stored[N] | None) -> None:
        """Checks and stores, on a thread of its own; what is wrong stands in the form."""
        self.hands.later(lambda: self._save(form, stored))

    def _save(self, form: DocumentForm, stored: Stored[N] | None) -> None:
        document = form.read()
        if document is None:
            return
        try:
            self._store(document, stored)
        except StoreConflictError as error:
            if stored is None:
                form.say({"name": self.hands.words.say(_said(error))})
                return
            theirs = cast("Stored[N] | None", error.current)
            self.pages.turn(lambda gui: _ConflictPage(gui, self, document, theirs))
        except StoreError as error:
            form.say({"name" if stored is None else "": self.hands.words.say(_said(error))})
        else:
            self._list(self.hands.words("'{name}' is stored.", name=document.name))

    def _store(self, document: N, stored: Stored[N] | None) -> None:
        """A new name is given first, so that whatever refers to the document goes along."""
        if stored is None:
            self.store.save(document)
            return
        revision, before = stored.revision, stored.document
        if document.name != before.name and _home(document) == _home(before):
            self._check_unchanged(stored)
            revision = self.store.rename(self.shelf.kind, before.name, document.name, _home(before))
        elif _home(document) != _home(before):
            self.store.save(document)
            self.store.delete(self.shelf.kind, before.name, _home(before))
            return
        self.store.save(document, revision)

    def _check_unchanged(self, stored: Stored[N]) -> None:
        """Raises ``StoreConflictError`` when another console has changed it: nothing may be renamed unseen."""
        name, words = stored.document.name, self.hands.words
        now = {one.document.name: one for one in self.store.list(self.shelf.kind, _home(stored.document))}.get(name)
        if now is None or now.revision != stored.revision:
            msg = words("'{name}' was changed by another console meanwhile.", name=name)
            raise StoreConflictError(msg, cast("Any", now))

    def keep_mine(self, document: N, theirs: Stored[N] | None) -> None:
        """After a conflict: what is stored there is replaced, knowingly."""

        def work() -> None:
            self._store(document, theirs)
            self._list(self.hands.words("'{name}' is stored.", name=document.name))

        self.hands.later(work)

    def delete(self, stored: Stored[N]) -> None:
        """Takes it away; the list then offers to undo that."""

        def work() -> None:
            name = stored.document.name
            self.removed = self.store.delete(self.shelf.kind, name, _home(stored.document))
            users = self._users(name)
            words = self.hands.words
            said = words("'{name}' is deleted.", name=name)
            if users:
                said += " " + words("It is missing in: {operations}.", operations=", ".join(users))
            self._list(said)

        self.hands.later(work)

    def _users(self, name: str) -> list[str]:
        """The operations that refer to a machine of this name."""
        member = {Tractor: "tractor", Implement: "implement", Receiver: "receiver"}.get(self.shelf.kind)
        if member is None:
            return []
        return [one.document.name for one in self.store.list(Operation) if getattr(one.document, member) == name]

    def archive(self, stored: Stored[N]) -> None:
        """Out of the list, into the archive."""

        def work() -> None:
            name = stored.document.name
            self.removed = self.store.archive(self.shelf.kind, name, _home(stored.document))
            self._list(self.hands.words("'{name}' is archived.", name=name))

        self.hands.later(work)

    def unarchive(self, stored: Stored[N]) -> None:
        """Back into the list."""

        def work() -> None:
            self.store.unarchive(stored)
            self._list(self.hands.words("'{name}' is back.", name=stored.document.name))

        self.hands.later(work)

    def undo(self) -> None:
        """Brings back what was taken away last."""
        removed, self.removed = self.removed, None

        def work() -> None:
            if removed is not None:
                self.store.undo(removed)
            self._list(self.hands.words("It is back."))

        self.hands.later(work)


def _said(error: StoreError) -> str:
    """The sentence of an error, as it knows its language."""
    first = error.args[0] if error.args else ""
    return first if isinstance(first, str) else str(error)


class _ListPage(Still):
    def __init__(
        self, gui: viser.GuiApi, pages: Shelves[N], found: tuple[Stored[N], ...], archived: int, said: str
    ) -> None:
        words, shelf = pages.hands.words, pages.shelf
        if said:
            gui.add_html(notice_html([said]))
        if pages.removed is not None:
            press(gui, words("Undo"), pages.undo, "orange")
        if not found:
            gui.add_html(notice_html([shelf.words.empty]))
        for stored in found:
            line = shelf.line(stored.document)
            label = f"{stored.document.name} · {line}" if line else stored.document.name
            press(gui, label, partial(pages.open_stored, stored))
        press(gui, shelf.words.new, pages.open_new, "green")
        if archived:
            press(gui, words("Archive ({count})", count=archived), pages.open_archive)
        if pages.back is not None:
            press(gui, words("Back"), pages.back)


class _EditPage:
    """A form with what can be done with its document."""

    def __init__(
        self, gui: viser.GuiApi, pages: Shelves[Any], begin: tuple[Mapping[str, Any], Any], stored: Stored[Any] | None
    ) -> None:
        words, shelf = pages.hands.words, pages.shelf
        self._pages, self._stored = pages, stored
        self._sure = False
        self._leave = press(gui, words("Back"), self._back)
        gui.add_html(heading_html(shelf.words.new if stored is None else shelf.words.edit))
        if stored is not None and shelf.also is not None:
            label, also = shelf.also
            press(gui, label, partial(also, stored.document), "green")
        self._form = shelf.form(gui, begin[0], pages.hands.soon, begin[1])
        press(gui, words("Save"), lambda: pages.save(self._form, stored), "green")
        if stored is not None:
            copy = (words("Copy"), self._copy)
            archive = (words("Archive"), lambda: pages.archive(stored))
            buttons(gui, "", (copy, archive, (words("Delete"), lambda: pages.delete(stored))))

    def _copy(self) -> None:
        assert self._stored is not None
        values = self._stored.document.model_dump()
        name = self._pages.hands.words("{name} (copy)", name=values["name"][:100])
        self._pages.open_new({**values, "name": name})

    def _back(self) -> None:
        """What was typed and not saved is only forgotten by a second press."""
        if self._form.changed and not self._sure:
            self._sure = True
            self._pages.hands.soon()
        else:
            self._pages.open_list()

    def show(self, desk: Desk) -> None:
        """Brings the form up to what was touched."""
        self._form.show(desk)
        words = self._pages.hands.words
        self._leave.label = words("Leave without saving") if self._sure else words("Back")

    def close(self) -> None:
        """What the form has drawn on the map goes with it."""
        self._form.close()


class _ArchivePage(Still):
    def __init__(self, gui: viser.GuiApi, pages: Shelves[N], found: tuple[Stored[N], ...]) -> None:
        words = pages.hands.words
        gui.add_html(heading_html(words("Archive")))
        gui.add_html(notice_html([words("A press brings a document back into the list.")]))
        for stored in found:
            press(gui, stored.document.name, partial(pages.unarchive, stored))
        press(gui, words("Back"), pages.open_list)


class _ConflictPage(Still):
    """Both versions side by side, and the choice."""

    def __init__(self, gui: viser.GuiApi, pages: Shelves[N], mine: N, theirs: Stored[N] | None) -> None:
        words = pages.hands.words
        units = pages.hands.house.settings().units
        if theirs is None:
            said = words("'{name}' was removed or renamed by another console meanwhile.", name=mine.name)
        else:
            said = words("'{name}' was changed by another console meanwhile.", name=mine.name)
        gui.add_html(heading_html(words("Two versions")))
        gui.add_html(notice_html([said]))
        if theirs is not None:
            gui.add_html(differences_html(mine, theirs.document, words, units))
        press(gui, words("Keep mine"), lambda: pages.keep_mine(mine, theirs), "green")
        if theirs is not None:
            press(gui, words("Take the other"), lambda: pages.open_stored(theirs))
        else:
            press(gui, words("Leave it removed"), pages.open_list)
