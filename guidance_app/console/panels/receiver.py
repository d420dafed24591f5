"""The receiver panel: which port is read, what comes over it, and how good it is."""

import html
from typing import Any, ClassVar
from urllib.parse import quote

import viser

from guidance_app.console.corrections_form import CorrectionsForm
from guidance_app.console.desk import Desk, Hands
from guidance_app.console.forms import FORM_STYLE
from guidance_app.console.sky import SKY_STYLE, sky_svg
from guidance_app.console.widgets import Shown, notice_html, rows_html, words_html
from guidance_app.language import message
from guidance_app.view.links import beside_notices
from guidance_app.view.receiver import ReceiverView, raw_text, receiver_view, sent_words
from guidance_app.view.status import Level

__all__ = ["Receiver"]

LINES = 14
WORDS_EVERY = 4
"""Everything is brought up to now once a second: this page is read, not driven by."""

RAW_STYLE = """<style>
.g-raw{margin:.2em .6em .5em;padding:.4em .6em;font:.62em/1.5 ui-monospace,monospace;white-space:pre;overflow-x:auto;
 border-radius:.3em;background:var(--mantine-color-default-hover)}
.g-long .g-words{white-space:normal}
.g-plain{padding:0 .85em .4em;font-size:.7em;line-height:1.35}
</style>"""


class Receiver:
    """Shows the receiver in use, and takes another one."""

    title: ClassVar[str] = message("Receiver")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._words = words = hands.words
        self._paths: dict[str, str] | None = None
        """Addresses by what a person reads; None until the ports are listed. The worker leaves them."""
        self._raw_wanted = False
        self._asked: str | None = None
        self._round = 0
        gui.add_html(SKY_STYLE + RAW_STYLE + FORM_STYLE)
        self._link = Shown(gui)
        self._notices = Shown(gui)
        self._grid = Shown(gui)
        self._rows = Shown(gui)
        self._sky = Shown(gui)
        self._raw_button = gui.add_button(words("Show what it sends"), color="gray")
        self._kinds = Shown(gui)
        self._raw = Shown(gui)
        with gui.add_folder(words("Another receiver")):
            self._ports = gui.add_dropdown(words("Port"), (words("looking for ports"),))
            self._look = gui.add_button(words("Look again"), color="gray")
            self._address: Any = gui.add_text(words("Address"), hands.house.manager.job.receiver.source)
            self._use = gui.add_button(words("Use this receiver"), color="green")
            self._stay = gui.add_button(words("No, keep this one"), color="gray", visible=False)
            self._warning = Shown(gui)
        self._corrections = CorrectionsForm(gui, hands)
        self._listen()
        hands.later(self._find)

    def _listen(self) -> None:
        @self._raw_button.on_click
        async def _(_: object) -> None:
            self._raw_wanted = not self._raw_wanted
            self._round = 0

        @self._look.on_click
        async def _(_: object) -> None:
            self._hands.later(self._find)

        @self._ports.on_update
        async def _(event: viser.GuiEvent[viser.GuiDropdownHandle[str]]) -> None:
            address = (self._paths or {}).get(self._ports.value)
            if event.client_id is not None and address is not None:
                self._address.value = address

        @self._use.on_click
        async def _(_: object) -> None:
            self._pressed()

        @self._stay.on_click
        async def _(_: object) -> None:
            self._asked = None

    def _find(self) -> None:
        """Lists the ports of this machine; takes a moment on some systems."""
        found = self._hands.house.list_ports()
        self._paths = {
            f"{port.path} · {port.name}" if port.name else port.path: f"serial://{quote(port.path)}" for port in found
        }
        self._hands.soon()

    def _offer(self) -> None:
        """The ports that were found; a choice among the same ones stays."""
        words, found = self._words, self._paths
        if found is None:
            return
        nothing = (words("no port found: plug the receiver in"),)
        options = (words("choose one of {n}", n=len(found)), *found) if found else nothing
        if tuple(self._ports.options) != options:
            self._ports.options = options

    def _pressed(self) -> None:
        """Takes the address; while something is driven the first press asks, because the drive begins anew."""
        uri = self._address.value.strip()
        if self._hands.house.driving and self._asked != uri:
            self._asked = uri
            return
        self._asked = None
        if self._hands.wheel.mine():
            self._hands.later(lambda: self._hands.house.use_source(uri))

    def show(self, desk: Desk) -> None:
        """Brings everything up to now, once a second."""
        self._ask()
        self._offer()
        self._corrections.show(desk)
        self._round += 1
        if self._round % WORDS_EVERY != 1:
            return
        words = self._words
        stream = self._hands.house.manager.tap.look(desk.now)
        view = receiver_view(desk.snapshot, stream.rate, desk.now, words)
        self._link.show(f'<div class="g-long">{words_html(*self._link_words(view))}</div>')
        self._notices.show(notice_html(beside_notices(desk.snapshot, desk.now, words)))
        self._grid.show(_plain_html(view.grid))
        self._rows.show(rows_html(view.rows) if self._in_use else "")
        self._sky.show(sky_svg(view.sky) + _plain_html(view.sky_words))
        self._raw_button.label = words("Hide what it sends" if self._raw_wanted else "Show what it sends")
        self._kinds.show(rows_html(sent_words(stream.kinds, words)) if self._raw_wanted else "")
        self._raw.show(self._raw_html(stream.lines) if self._raw_wanted else "")

    @property
    def _in_use(self) -> bool:
        return self._hands.house.driving

    def _link_words(self, view: ReceiverView) -> tuple[str, Level]:
        if self._in_use:
            return view.link, view.link_level
        return self._words(
            "No receiver is in use: choose a port or write an address, and press the green button."
        ), "off"

    def _raw_html(self, lines: tuple[bytes, ...]) -> str:
        said = html.escape(raw_text(lines, LINES)) or html.escape(self._words("nothing has come yet"))
        return f'<div class="g-raw">{said}</div>'

    def _ask(self) -> None:
        words = self._words
        asks = self._asked is not None
        self._use.label = words("Yes, begin anew with it") if asks else words("Use this receiver")
        self._stay.visible = asks
        warning = words("The drive ends and a new one begins with the other receiver; everything recorded stays.")
        self._warning.show(notice_html([warning]) if asks else "")


def _plain_html(text: str) -> str:
    """A sentence that may need two lines; nothing for none."""
    return f'<div class="g-plain">{html.escape(text)}</div>' if text else ""
