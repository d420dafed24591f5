"""A part of a panel whose content changes as a whole: one step of a form, then the next."""

from collections.abc import Callable

import viser

__all__ = ["Card"]


class Card:
    """Keeps its place in the panel; what is in it is made anew by each ``fill``. Made where it shall stand."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._gui = gui
        self._place = gui.add_folder(None)
        self._content: viser.GuiFolderHandle | None = None

    def fill(self, build: Callable[[], None]) -> None:
        """Takes the old content away and lets ``build`` add the new."""
        self.clear()
        with self._place:
            self._content = self._gui.add_folder(None)
        with self._content:
            build()

    def clear(self) -> None:
        """Leaves it empty."""
        content, self._content = self._content, None
        if content is not None:
            content.remove()
