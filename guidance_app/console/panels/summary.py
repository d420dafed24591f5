"""The head of the panels, always in sight: the numbers, the fix in words, and the button that works or lifts."""

from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.wheel_strip import WheelStrip
from guidance_app.console.widgets import STYLE, Shown, notice_line_html, tiles_html, words_html
from guidance_app.language import message
from guidance_app.view.drive import work_press
from guidance_app.view.status import work_view

__all__ = ["Summary"]


class Summary:
    """Numbers and the work button."""

    title: ClassVar[str] = message("Summary")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._words = words = hands.words
        gui.add_html(STYLE)
        self._wheel = WheelStrip(gui, hands)
        self._notices = Shown(gui)
        self._tiles = Shown(gui)
        self._fix = Shown(gui)
        self._work = gui.add_button(words("Work"), color="gray", hint=words("Lower or lift the implement"))

        @self._work.on_click
        async def _(_: object) -> None:
            command = work_press(hands.desk().snapshot, words).command
            if command is not None:
                hands.post(command)

    def show(self, desk: Desk) -> None:
        """Brings the numbers up to now."""
        self._wheel.show()
        view = work_view(desk.snapshot, desk.now, desk.units, self._words)
        self._notices.show(notice_line_html(view.notices, self._words))
        self._tiles.show(tiles_html(view.figures))
        self._fix.show(words_html(view.fix, view.fix_level))
        self._work.label = view.work.words
        self._work.color = "green" if view.work.lit else "gray"
        self._work.disabled = view.work.command is None
