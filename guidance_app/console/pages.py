"""One tab whose content changes: a list, a form, a question. Pages are turned from any thread, and made on one.

viser's callbacks run on its own loop and long work on a thread of its own; both only leave the wish for another page.
"""

import threading
from collections.abc import Callable
from typing import Literal, Protocol

import viser

from guidance_app.console.desk import Desk, Hands

__all__ = ["MakePage", "Page", "Pages", "Still", "press"]


class Page(Protocol):
    """What a tab holds for a while. It is made inside the tab. One that leaves something outside has a ``close``."""

    def show(self, desk: Desk) -> None:
        """Brings its words and widgets up to what is."""
        ...


class Still:
    """A page on which nothing changes by itself."""

    def show(self, desk: Desk) -> None:
        """It stands still."""
        del desk


Color = Literal["gray", "green", "red", "orange"]
MakePage = Callable[[viser.GuiApi], Page]


class Pages:
    """Holds the page that is open. Made inside its tab."""

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._gui = gui
        self._hands = hands
        self._outer = gui.add_folder(None)
        self._inner: viser.GuiFolderHandle | None = None
        self._page: Page | None = None
        self._wished: MakePage | None = None
        self._lock = threading.Lock()
        hands.at_leaving(self._leave)

    def turn(self, make: MakePage) -> None:
        """Opens another page at the next redraw."""
        with self._lock:
            self._wished = make
        self._hands.soon()

    def show(self, desk: Desk) -> None:
        """Turns to the page that is wished for, and brings the open one up to what is."""
        with self._lock:
            make, self._wished = self._wished, None
        if make is not None:
            self._open(make)
        if self._page is not None:
            self._page.show(desk)

    def _leave(self) -> None:
        leave = getattr(self._page, "close", None)
        self._page = None
        if leave is not None:
            leave()

    def _open(self, make: MakePage) -> None:
        self._leave()
        if self._inner is not None:
            self._inner.remove()
        with self._outer:
            self._inner = self._gui.add_folder(None)
        with self._inner:
            self._page = make(self._gui)


def press(gui: viser.GuiApi, label: str, pressed: Callable[[], None], color: Color = "gray") -> viser.GuiButtonHandle:
    """A button as wide as the panel; ``pressed`` is called on viser's loop and returns at once."""
    handle = gui.add_button(label, color=color)

    @handle.on_click
    async def _(_: object) -> None:
        pressed()

    return handle
