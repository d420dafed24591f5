"""The info panel: what the receiver's link does, what came in, and how it is filtered."""

from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.widgets import Shown, notice_html, rows_html, words_html
from guidance_app.language import message
from guidance_app.view.links import beside_notices
from guidance_app.view.status import info_view

__all__ = ["Info"]


class Info:
    """Words only."""

    title: ClassVar[str] = message("Info")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._words = hands.words
        self._notices = Shown(gui)
        self._link = Shown(gui)
        self._rows = Shown(gui)

    def show(self, desk: Desk) -> None:
        """Brings the words up to now."""
        view = info_view(desk.snapshot, desk.now, desk.units, self._words)
        beside = beside_notices(desk.snapshot, desk.now, self._words)
        self._notices.show(notice_html((*beside, *(self._words.say(one) for one in desk.snapshot.notices))))
        self._link.show(words_html(view.link, view.link_level))
        self._rows.show(rows_html(view.rows))
