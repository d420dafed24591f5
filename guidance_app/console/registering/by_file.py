"""Fields from a file of another program."""

from guidance_app.console.files import upload_html
from guidance_app.console.registering.atelier import Atelier
from guidance_app.console.registering.outside import fields_in
from guidance_app.console.widgets import buttons, notice_html
from guidance_app.exchange import READERS

__all__ = ["FromFile"]


class FromFile:
    """Awaits one file and offers every field in it."""

    def __init__(self, atelier: Atelier) -> None:
        self._atelier = atelier
        self._hands = atelier.hands
        words = atelier.hands.words
        self._token = self._hands.house.files.awaits(self._take)
        kinds = ", ".join(sorted(READERS))
        atelier.gui.add_html(
            notice_html([words("Taken: {kinds}. Nothing is stored before you have seen it.", kinds=kinds)])
        )
        atelier.gui.add_html(upload_html(self._token, words("Choose a file"), ",".join(sorted(READERS))))
        buttons(atelier.gui, "", ((words("Cancel"), atelier.cancel),))

    def _take(self, name: str, content: bytes) -> None:
        def read() -> None:
            self._atelier.offer(fields_in(content, name), name)

        self._hands.later(read)

    def show(self) -> None:
        """Nothing here changes by itself."""

    def close(self) -> None:
        """Awaits the file no longer."""
        self._hands.house.files.forget(self._token)
