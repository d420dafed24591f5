"""The receiver's form: where positions come from, chosen from what is plugged in or typed, and what is made of them."""

import html
from collections.abc import Callable, Mapping
from typing import Any

import viser

from guidance_app.console.desk import Hands
from guidance_app.console.forms import Form
from guidance_app.console.widgets import Shown
from guidance_app.documents import Receiver
from guidance_app.estimation.filters import FILTERS
from guidance_app.language import message
from guidance_app.sources import SOURCES

__all__ = ["FILTER_WORDS", "ReceiverForm", "source_problem"]

FILTER_WORDS: Mapping[str, tuple[str, str]] = {
    "adaptive": (
        message("Adaptive"),
        message("For any receiver: weighs positions, speed and sensors by how good they prove to be."),
    ),
    "gyro_ekf": (
        message("Gyro (Inoue)"),
        message("For a receiver with a gyro beside it: the heading comes from the gyro, the place from the fixes."),
    ),
    "quantisation_kf": (
        message("Rounded positions (Gomez-Gil)"),
        message("For a cheap receiver that writes few decimals: smooths the steps of its rounding."),
    ),
    "off": (message("None"), message("Positions are used as they come, with their jumps.")),
}
"""By filter: its name and one sentence on when to choose it."""


def source_problem(source: str) -> str | None:
    """Why this cannot be a source, as an English pattern with ``{known}``; None when its scheme is known."""
    scheme, colon, _ = source.partition(":")
    if colon and scheme.lower() in SOURCES:
        return None
    return message("Write where positions come from with one of {known} in front.")


class ReceiverForm:
    """The plain form with a list of ports above it and a sentence on the chosen filter below."""

    def __init__(
        self, hands: Hands, gui: viser.GuiApi, initial: Mapping[str, Any], touched: Callable[[], None]
    ) -> None:
        self._words = hands.words
        filters = [(name, words[0]) for name, words in FILTER_WORDS.items() if name in FILTERS]
        self._form = Form(
            gui,
            Receiver,
            initial,
            hands.words,
            hands.house.settings().units,
            options={"filter": filters},
            touched=touched,
        )
        self._about = Shown(gui)
        self.show()

    @property
    def changed(self) -> bool:
        """Whether something was typed."""
        return self._form.changed

    def read(self) -> Receiver | None:
        """The receiver; a source of no known kind is refused here, before a drive."""
        receiver = self._form.read()
        if receiver is None:
            return None
        problem = source_problem(receiver.source)
        if problem is None:
            return receiver
        known = ", ".join(f"{scheme}:" for scheme in SOURCES)
        self._form.say({"source": self._words(problem, known=known)})
        return None

    def say(self, wrong: Mapping[str, str]) -> None:
        """Puts sentences under entries."""
        self._form.say(wrong)

    def show(self) -> None:
        """The sentence follows the chosen filter."""
        self._form.show()
        about = FILTER_WORDS.get(str(self._form.draft["filter"]))
        self._about.show("" if about is None else f'<div class="g-said">{html.escape(self._words(about[1]))}</div>')
