"""The head of the panels while things are set up: what is driven meanwhile, and the way back to it."""

from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands, Place
from guidance_app.console.forms import FORM_STYLE
from guidance_app.console.wheel_strip import WheelStrip
from guidance_app.console.widgets import STYLE, Shown, notice_html
from guidance_app.language import message

__all__ = ["Yard"]

MOST_PROBLEMS = 2
"""More would leave no room for the forms."""


class Yard:
    """Says what goes on behind the forms."""

    title: ClassVar[str] = message("Setup")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        gui.add_html(STYLE + FORM_STYLE)
        self._hands = hands
        self._words = words = hands.words
        self._wheel = WheelStrip(gui, hands)
        self._problems = Shown(gui)
        self._back = gui.add_button(words("Back to the drive"), color="green")
        store = hands.house.store
        problems = [] if store is None else [words.say(one.sentence) for one in store.problems]
        if len(problems) > MOST_PROBLEMS:
            more = words("and {count} more files that cannot be read", count=len(problems) - MOST_PROBLEMS)
            problems = [*problems[:MOST_PROBLEMS], more]
        self._problems.show(notice_html(problems))

        @self._back.on_click
        async def _(_: object) -> None:
            hands.go(Place.DRIVE)

    def show(self, desk: Desk) -> None:
        """Brings the button up to what is driven."""
        self._wheel.show()
        self._back.visible = self._hands.house.driving
        self._back.label = self._words("Back to the replay" if desk.replay is not None else "Back to the drive")
