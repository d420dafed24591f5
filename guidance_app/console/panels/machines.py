"""The machines panel: tractors, implements and receivers."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.forms import Form, heading_html
from guidance_app.console.pages import Pages, Still, press
from guidance_app.console.receiver_form import ReceiverForm
from guidance_app.console.shelf import Shelf, ShelfWords, Shelves
from guidance_app.console.widgets import notice_html
from guidance_app.documents import Implement, Receiver, Tractor
from guidance_app.language import message
from guidance_app.view.units import length_text

__all__ = ["Machines"]


class Machines:
    """Three shelves behind one page."""

    title: ClassVar[str] = message("Machines")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._pages = Pages(gui, hands)
        self._hands = hands
        if hands.house.store is None:
            self._pages.turn(lambda gui: _NoStore(gui, hands))
            return
        self._units = hands.house.settings().units
        self._tractors = Shelves(self._pages, hands, self._tractor_shelf(), self._open)
        self._implements = Shelves(self._pages, hands, self._implement_shelf(), self._open)
        self._receivers = Shelves(self._pages, hands, self._receiver_shelf(), self._open)
        self._open()

    def _say(self, metres: float) -> str:
        return length_text(metres, self._units, self._hands.words)

    def _open(self) -> None:
        self._pages.turn(self._first)

    def _first(self, gui: viser.GuiApi) -> Still:
        words = self._hands.words
        gui.add_html(heading_html(words("Machines")))
        press(gui, words("Tractors"), self._tractors.open_list)
        press(gui, words("Implements"), self._implements.open_list)
        press(gui, words("Receivers"), self._receivers.open_list)
        return Still()

    def _tractor_shelf(self) -> Shelf[Tractor]:
        words = self._hands.words
        return Shelf(
            Tractor,
            ShelfWords(
                words("New tractor"),
                words("Tractor"),
                words("No tractor yet. Press New tractor and measure where the antenna sits."),
            ),
            lambda one: self._say(one.wheelbase),
            partial(_plain_form, self._hands, Tractor),
            lambda: _fresh(Tractor(name="-")),
        )

    def _implement_shelf(self) -> Shelf[Implement]:
        words = self._hands.words
        return Shelf(
            Implement,
            ShelfWords(
                words("New implement"),
                words("Implement"),
                words("No implement yet. Press New implement; its working width is the number that counts."),
            ),
            lambda one: self._say(one.working_width),
            partial(_plain_form, self._hands, Implement),
            lambda: _fresh(Implement(name="-")),
        )

    def _receiver_shelf(self) -> Shelf[Receiver]:
        words = self._hands.words
        return Shelf(
            Receiver,
            ShelfWords(
                words("New receiver"),
                words("Receiver"),
                words("No receiver yet. Plug it in, then press New receiver and choose its port."),
            ),
            lambda one: one.source,
            partial(ReceiverForm, self._hands),
            lambda: _fresh(Receiver(name="-")),
        )

    def show(self, desk: Desk) -> None:
        """Brings the open page up to what is."""
        self._pages.show(desk)


class _NoStore(Still):
    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        gui.add_html(notice_html([hands.words("This console has no data folder: nothing can be stored.")]))


def _fresh(document: Tractor | Implement | Receiver) -> dict[str, Any]:
    """The defaults of a kind, without a name."""
    return document.model_dump() | {"name": ""}


def _plain_form(
    hands: Hands, kind: Any, gui: viser.GuiApi, initial: Mapping[str, Any], touched: Callable[[], None], _: None
) -> Form[Any]:
    return Form(gui, kind, initial, hands.words, hands.house.settings().units, touched=touched)
