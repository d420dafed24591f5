"""The operations panel: what is registered to be done on the fields, and the form to register more."""

from functools import partial
from typing import Any, ClassVar

import viser

from guidance_app.console.desk import Desk, Hands, Place
from guidance_app.console.operation_form import Gathered, OperationForm, gathered_from
from guidance_app.console.pages import Pages
from guidance_app.console.shelf import Shelf, ShelfWords, Shelves
from guidance_app.console.widgets import notice_html
from guidance_app.documents import Operation
from guidance_app.language import message
from guidance_app.store import load_job

__all__ = ["Operations"]


class Operations:
    """One shelf."""

    title: ClassVar[str] = message("Jobs")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._pages: Pages | None = None
        words, store = hands.words, hands.house.store
        if store is None:
            gui.add_html(notice_html([words("This console has no data folder: nothing can be stored.")]))
            return
        self._pages = Pages(gui, hands)
        shelf = Shelf(
            Operation,
            ShelfWords(
                words("New operation"),
                words("Operation"),
                words("No operation yet. It takes a field, a tractor and an implement; then press New operation."),
            ),
            lambda one: one.field,
            partial(OperationForm, hands),
            self._fresh,
            partial(gathered_from, store),
            self._missing,
            (words("Start this operation"), self._start),
        )
        Shelves(self._pages, hands, shelf).open_list()

    def _fresh(self) -> dict[str, Any]:
        """The first of everything, without a name."""
        assert self._hands.house.store is not None, "there is a shelf"
        found = gathered_from(self._hands.house.store)
        shown = self._hands.house.manager.job.field
        field = shown.name if shown is not None and shown.name in found.fields else _first(found.fields)
        operation = Operation(
            name="-",
            field=field,
            tractor=_first(found.tractors),
            implement=_first(found.implements),
            receiver=_first(found.receivers) or None,
        )
        return operation.model_dump() | {"name": ""}

    def _missing(self, gathered: Gathered) -> str | None:
        words = self._hands.words
        if not gathered.fields:
            return words("There is no field yet: register one under Fields first.")
        if not gathered.tractors:
            return words("There is no tractor yet: register one under Machines first.")
        if not gathered.implements:
            return words("There is no implement yet: register one under Machines first.")
        return None

    def _start(self, operation: Operation) -> None:
        def work() -> None:
            if not self._hands.wheel.mine():
                return
            store = self._hands.house.store
            assert store is not None, "an operation comes from a store"
            self._hands.house.drive(load_job(store, operation.name, operation.field))
            self._hands.go(Place.DRIVE)

        self._hands.later(work)

    def show(self, desk: Desk) -> None:
        """Brings the open page up to what is."""
        if self._pages is not None:
            self._pages.show(desk)


def _first(names: tuple[str, ...]) -> str:
    return names[0] if names else ""
