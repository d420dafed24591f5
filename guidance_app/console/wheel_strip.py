"""The line in the head that says who has the wheel, with the buttons to ask for it, give it and keep it.

One browser alone sees nothing of it.
"""

import viser

from guidance_app.console.desk import Hands
from guidance_app.console.wheel import WheelView
from guidance_app.console.widgets import Shown, buttons, notice_line_html
from guidance_app.language import Words

__all__ = ["WheelStrip", "wheel_words"]


def wheel_words(view: WheelView, words: Words) -> str:
    """One sentence for this browser; empty when it is the only one."""
    if view.alone:
        return ""
    if view.mine and view.asking is not None:
        return words(
            "Tablet {number} wants the wheel; it has it in {seconds} s.",
            number=view.asking,
            seconds=words.number(view.seconds),
        )
    if view.mine:
        return words.plural(
            "You have the wheel; {n} tablet follows.", "You have the wheel; {n} tablets follow.", view.others
        )
    if view.asking == view.number:
        return words("Asked for the wheel: {seconds} s.", seconds=words.number(view.seconds))
    if view.holder is None:
        return words("Nobody has the wheel.")
    return words("Tablet {number} has the wheel; this one follows.", number=view.holder)


class WheelStrip:
    """Made inside the head."""

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        words, wheel = hands.words, hands.wheel
        self._said = Shown(gui)
        self._ask = buttons(gui, "", ((words("Ask for the wheel"), wheel.ask),))
        self._answer = buttons(gui, "", ((words("Give it"), wheel.give), (words("Keep it"), wheel.keep)))
        self.show()

    def show(self) -> None:
        """Brings the line up to who is there."""
        view = self._hands.wheel.view()
        said = wheel_words(view, self._hands.words)
        self._said.show(notice_line_html([said], self._hands.words) if said else "")
        self._ask.visible = not view.alone and not view.mine and view.asking is None
        self._answer.visible = view.mine and view.asking is not None
