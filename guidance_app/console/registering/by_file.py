"""Fields from a file of another program. What the file leaves open is asked, and the same bytes are read again."""

import viser

from guidance_app.boundary import BoundaryError, CheckedField
from guidance_app.console.desk import Desk
from guidance_app.console.files import upload_html
from guidance_app.console.registering.atelier import Atelier
from guidance_app.console.registering.choosing import SystemChoice
from guidance_app.console.widgets import Shown, buttons, notice_html
from guidance_app.exchange import READERS, ExchangeError, QuestionError, ReadOptions, read_fields

__all__ = ["FromFile"]

ARCHIVES = (".zip",)


class FromFile:
    """Awaits one file and offers every field in it."""

    def __init__(self, gui: viser.GuiApi, atelier: Atelier) -> None:
        self._atelier = atelier
        self._hands = atelier.hands
        self._words = words = atelier.hands.words
        self._held: tuple[str, bytes] | None = None
        self._said = ""
        """What the file leaves open; the worker leaves it, the redraw shows it."""
        self._token = self._hands.house.files.awaits(self._take)
        kinds = (*sorted(READERS), *ARCHIVES)
        gui.add_html(
            notice_html([words("Taken: {kinds}. Nothing is stored before you have seen it.", kinds=", ".join(kinds))])
        )
        gui.add_html(upload_html(self._token, words("Choose a file"), ",".join(kinds)))
        self._question = Shown(gui)
        with gui.add_folder(words("What the file does not say"), expand_by_default=False):
            self._choice = SystemChoice(gui, atelier)
            self._encoding = gui.add_text(
                words("Encoding of names"), "", hint=words("For example cp932; empty: find out")
            )
            self._given = gui.add_checkbox(words("Use these"), initial_value=False)
            self._again = gui.add_button(words("Read the file again"), color="gray", disabled=True)
        buttons(gui, "", ((words("Cancel"), atelier.cancel),))

        @self._again.on_click
        async def _(_: object) -> None:
            self._hands.later(self._read)

    def _take(self, name: str, content: bytes) -> None:
        self._held = name, content
        self._hands.later(self._read)

    def _options(self) -> ReadOptions:
        if not self._given.value:
            return ReadOptions()
        return ReadOptions(
            system=self._choice.system(),
            order=self._choice.order,
            encoding=self._encoding.value.strip() or None,
            inexact=self._choice.inexact,
        )

    def _read(self) -> None:
        if self._held is None:
            return
        name, content = self._held
        try:
            fields = read_fields(content, name, self._options())
        except QuestionError as question:
            if question.option == "inexact":
                self._choice.ask_for_consent()
            asks = self._words("Answer below under 'What the file does not say', then read it again.")
            self._say(self._words.say(str(question)), asks)
            return
        except (ExchangeError, BoundaryError) as error:
            self._say(self._words.say(str(error)))
            return
        checked = tuple(CheckedField(one.document, one.area, one.perimeter, one.remarks) for one in fields)
        self._atelier.offer(checked, name)

    def _say(self, *said: str) -> None:
        self._said = notice_html(said)
        self._hands.soon()

    def show(self, desk: Desk) -> None:
        """Brings the questions up to the file that was read."""
        del desk
        self._choice.show()
        self._again.disabled = self._held is None
        self._question.show(self._said)

    def close(self) -> None:
        """Awaits the file no longer."""
        self._hands.house.files.forget(self._token)
