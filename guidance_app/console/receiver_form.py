"""The receiver's form: where positions come from, chosen from what is plugged in or typed, and what is made of them."""

import html
from collections.abc import Callable, Mapping
from typing import Any

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.forms import Form
from guidance_app.console.widgets import Shown
from guidance_app.documents import Receiver
from guidance_app.language import Words, message
from guidance_app.sources import SOURCES
from guidance_app.sources.ports import ListPorts

__all__ = ["FILTER_WORDS", "ReceiverForm", "source_problem", "sources_found"]

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

ELSEWHERE = (
    (message("Network, UDP port 9999"), "udp://:9999"),
    (message("gpsd on this machine"), "gpsd://localhost"),
    (message("Simulated receiver"), "sim:"),
)
"""Sources that need no port, by what a person reads."""


def source_problem(source: str) -> str | None:
    """Why this cannot be a source, as an English pattern with ``{known}``; None when its scheme is known."""
    scheme, colon, _ = source.partition(":")
    if colon and scheme.lower() in SOURCES:
        return None
    return message("Write where positions come from with one of {known} in front.")


def sources_found(words: Words, ports_now: ListPorts) -> dict[str, str]:
    """Addresses by what a person reads: the ports that are there now, and what needs none. Asks the system."""
    ports = {f"{port.path} {port.name}".strip(): f"serial://{port.path}" for port in ports_now()}
    return ports | {words(label): uri for label, uri in ELSEWHERE}


class ReceiverForm:
    """The plain form with a list of what is plugged in above it, and a sentence on the chosen filter below."""

    def __init__(
        self, hands: Hands, gui: viser.GuiApi, initial: Mapping[str, Any], touched: Callable[[], None], gathered: None
    ) -> None:
        del gathered
        self._words = hands.words
        self._hands = hands
        self._found: dict[str, str] | None = None
        """Addresses by what a person reads; None until the system was asked. The worker leaves them."""
        self._plugged: Any = gui.add_dropdown(hands.words("Take from"), (hands.words("looking …"),))
        filters = [(name, words[0]) for name, words in FILTER_WORDS.items() if name != "off"]
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
        hands.later(self._look)

        @self._plugged.on_update
        async def _(event: viser.GuiEvent[viser.GuiDropdownHandle[str]]) -> None:
            uri = (self._found or {}).get(event.target.value)
            if event.client_id is not None and uri is not None:
                self._form.set("source", uri)

        self.show()

    def _look(self) -> None:
        """The ports that are there now, and what needs none."""
        self._found = sources_found(self._words, self._hands.house.list_ports)
        self._hands.soon()

    def _offer(self) -> None:
        typed = self._words("as typed below")
        if self._found is not None and tuple(self._plugged.options) != (typed, *self._found):
            self._plugged.options = (typed, *self._found)
            self._plugged.value = typed

    @property
    def changed(self) -> bool:
        """Whether something was typed."""
        return self._form.changed

    def read(self) -> Receiver | None:
        """The receiver; a source of no known kind is refused here, before a drive."""
        receiver = self._form.read()
        if receiver is None:
            return None
        known = ", ".join(f"{scheme}:" for scheme in SOURCES)
        sources = {"source": receiver.source, "attitude_source": receiver.attitude_source or "sim:"}
        wrong = {member: source_problem(uri) for member, uri in sources.items()}
        said = {member: self._words(words, known=known) for member, words in wrong.items() if words is not None}
        self._form.say(said)
        return None if said else receiver

    def say(self, wrong: Mapping[str, str]) -> None:
        """Puts sentences under entries."""
        self._form.say(wrong)

    def close(self) -> None:
        """It draws nothing outside of its panel."""

    def show(self, desk: Desk | None = None) -> None:
        """The list follows what was found, the sentence the chosen filter."""
        self._offer()
        self._form.show(desk)
        about = FILTER_WORDS.get(str(self._form.draft["filter"]))
        self._about.show("" if about is None else f'<div class="g-said">{html.escape(self._words(about[1]))}</div>')
