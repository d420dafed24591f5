"""The menu panel: from driving to setting up, and the end of the drive, which asks once."""

from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands, Place
from guidance_app.console.widgets import Shown, notice_html, rows_html
from guidance_app.language import message

__all__ = ["Menu"]


class Menu:
    """Leads out of the drive."""

    title: ClassVar[str] = message("Menu")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._words = words = hands.words
        self._sure = False
        self._rows = Shown(gui)
        setup = gui.add_button(words("Fields, machines, recordings"), color="gray")
        self._end = gui.add_button(words("End the drive"), color="red")
        self._stay = gui.add_button(words("No, drive on"), color="gray", visible=False)
        self._warning = Shown(gui)

        @setup.on_click
        async def _(_: object) -> None:
            hands.go(Place.SETUP)

        @self._end.on_click
        async def _(_: object) -> None:
            self._pressed()

        @self._stay.on_click
        async def _(_: object) -> None:
            self._sure = False

    def _pressed(self) -> None:
        """The first press asks, the second ends."""
        if self._sure:
            self._hands.later(self._leave)
        self._sure = not self._sure

    def _leave(self) -> None:
        if not self._hands.wheel.mine():
            return
        self._hands.house.end()
        self._hands.go(Place.SETUP)

    def show(self, desk: Desk) -> None:
        """Brings the words up to what is driven."""
        words = self._words
        job = self._hands.house.manager.job
        rows = [
            (words("Tractor"), job.tractor.name),
            (words("Implement"), f"{job.implement.name}, {words.digits(f'{job.implement.working_width:g}')} m"),
        ]
        if job.field is not None:
            rows.insert(0, (words("Field"), job.field.name))
        self._rows.show(rows_html(rows))
        self._ask(replays=desk.replay is not None)

    def _ask(self, *, replays: bool) -> None:
        words = self._words
        end = words("End the replay" if replays else "End the drive")
        yes = words("Yes, end the replay now" if replays else "Yes, end the drive now")
        warning = (
            words("The replay ends; the recording stays.")
            if replays
            else words("The drive ends and cannot be resumed by a press; everything recorded stays.")
        )
        self._end.label = yes if self._sure else end
        self._stay.visible = self._sure
        self._warning.show(notice_html([warning]) if self._sure else "")
