"""The rest panel: what of the plan is done and left, which pass comes next, and planning the rest again."""

from functools import partial
from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.widgets import Shown, buttons, notice_html, rows_html
from guidance_app.language import message
from guidance_app.model import ReplanRest, ReverseDirection, SkipPass, TakePass
from guidance_app.view.rest import rest_view

__all__ = ["Rest"]


class Rest:
    """Posts commands; everything it says comes from the snapshot."""

    title: ClassVar[str] = message("Rest")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._words = words = hands.words
        post = hands.post
        self._none = Shown(gui)
        self._rows = Shown(gui)
        self._number = gui.add_number(words("Pass"), 1, min=1, step=1)
        self._take = gui.add_button(words("Take this pass"), color="green")
        self._turn = buttons(
            gui,
            words("Present pass"),
            ((words("Skip"), partial(post, SkipPass())), (words("Other way"), partial(post, ReverseDirection()))),
        )
        self._again = gui.add_button(words("Plan the rest again from here"), color="gray")

        @self._take.on_click
        async def _(_: object) -> None:
            post(TakePass(int(self._number.value)))

        @self._again.on_click
        async def _(_: object) -> None:
            post(ReplanRest())

    def show(self, desk: Desk) -> None:
        """Brings rows and buttons up to what is; without a plan there is nothing to press."""
        view = rest_view(desk.snapshot, desk.units, self._words)
        planned = bool(view.rows)
        nothing = self._words("There is no plan: lines are followed one after the other.")
        self._none.show("" if planned else notice_html([nothing]))
        self._rows.show(rows_html(view.rows))
        for handle in (self._number, self._take, self._turn, self._again):
            handle.visible = planned
        self._take.disabled = int(self._number.value) not in view.numbers
        self._again.disabled = not view.left
