"""The menu panel: from driving to setting up, and the end of the drive, which asks once."""

from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands, Place
from guidance_app.console.widgets import Shown, notice_html, rows_html

__all__ = ["Menu"]


class Menu:
    """Leads out of the drive."""

    title: ClassVar[str] = "Menu"

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._sure = False
        self._rows = Shown(gui)
        setup = gui.add_button("Fields, machines, recordings", color="gray")
        self._end = gui.add_button("End the drive", color="red")
        self._stay = gui.add_button("No, drive on", color="gray", visible=False)
        self._words = Shown(gui)

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
        self._hands.house.end()
        self._hands.go(Place.SETUP)

    def show(self, desk: Desk) -> None:
        """Brings the words up to what is driven."""
        job = self._hands.house.manager.job
        rows = [
            ("Tractor", job.tractor.name),
            ("Implement", f"{job.implement.name}, {job.implement.working_width:g} m"),
        ]
        if job.field is not None:
            rows.insert(0, ("Field", job.field.name))
        self._rows.show(rows_html(rows))
        what = "replay" if desk.replay is not None else "drive"
        self._end.label = f"Yes, end the {what} now" if self._sure else f"End the {what}"
        self._stay.visible = self._sure
        warning = f"The {what} ends and cannot be resumed by a press; everything recorded stays." if self._sure else ""
        self._words.show(notice_html([warning]) if warning else "")
