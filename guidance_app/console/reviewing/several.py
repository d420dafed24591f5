"""The ledger of several drives: of a day, a season, a field; made beside the picture, then offered as sheets."""

import datetime
from collections.abc import Callable
from pathlib import Path
from typing import Any

import viser

from guidance_app.batch.ledgers import Choice, Gathered, day_of, ledger_entries
from guidance_app.console.desk import Desk, Hands
from guidance_app.console.files import Download, link_html, note_said
from guidance_app.console.house import SENTENCES
from guidance_app.console.pages import press
from guidance_app.console.reviewing.sheets import MEDIA_TYPES
from guidance_app.console.widgets import Shown, buttons, notice_html, progress_html
from guidance_app.reports import SHEETS
from guidance_app.store.recordings_list import ListedRecording
from guidance_app.view.units import area_text

__all__ = ["LedgerOfSeveral"]

ANY = 0


class LedgerOfSeveral:
    """Choices of days and field of the recordings ``found``, a button, progress, and the sheets."""

    def __init__(
        self,
        gui: viser.GuiApi,
        hands: Hands,
        data: Path,
        found: tuple[ListedRecording, ...],
        back: Callable[[], None],
    ) -> None:
        self._hands = hands
        self._words = words = hands.words
        self._data = data
        self._found = [one for one in found if one.summary is not None and not one.being_written]
        self._days = sorted({day for one in self._found if (day := day_of(one)) is not None}, reverse=True)
        self._fields = sorted({one.summary.field for one in self._found if one.summary and one.summary.field})
        self._addresses: list[str] = []
        self._done: float | None = None
        self._said = ""
        press(gui, words("Back to the list"), back)
        self._shown = Shown(gui)
        names = [words.date(day) for day in self._days]
        any_day = words("Any day")
        quick = ((words("Newest day"), self._newest_day), (words("This season"), self._season), (any_day, self._all))
        buttons(gui, words("Drives of"), quick)
        self._first: Any = gui.add_dropdown(words("From"), (any_day, *names))
        self._last: Any = gui.add_dropdown(words("To"), (any_day, *names))
        self._field: Any = gui.add_dropdown(words("Field"), (words("every field"), *self._fields))
        self._title = gui.add_text(words("Above the sheet"), words("Ledger"))
        press(gui, words("Make the ledger"), self._make, "green")
        self._newest_day()

    def show(self, desk: Desk) -> None:
        """How far it is, then the sheets."""
        del desk
        done = self._done
        self._shown.show(self._said if done is None else progress_html(done))

    def close(self) -> None:
        """The sheets are not offered any more."""
        addresses, self._addresses = self._addresses, []
        for address in addresses:
            self._hands.house.files.forget(address)

    # --- the choice ------------------------------------------------------------------------------------------------

    def _newest_day(self) -> None:
        self._choose(self._days[:1])

    def _season(self) -> None:
        """The year of the newest drive."""
        self._choose([day for day in self._days if day.year == self._days[0].year])

    def _all(self) -> None:
        self._choose([])

    def _choose(self, days: list[datetime.date]) -> None:
        options = self._first.options
        self._first.value = options[self._days.index(days[-1]) + 1] if days else options[ANY]
        self._last.value = options[self._days.index(days[0]) + 1] if days else options[ANY]

    def _chosen(self) -> Choice:
        def day(handle: Any) -> datetime.date | None:
            place = handle.options.index(handle.value)
            return None if place == ANY else self._days[place - 1]

        place = self._field.options.index(self._field.value)
        return Choice(day(self._first), day(self._last), None if place == ANY else self._fields[place - 1])

    # --- making it -------------------------------------------------------------------------------------------------

    def _make(self) -> None:
        if self._done is not None:
            return
        self._done = 0.0
        self._hands.later(self._gather)

    def _gather(self) -> None:
        choice = self._chosen()
        paths = [one.path for one in self._found if choice.takes(one)]
        self.close()
        try:
            found = ledger_entries(paths, self._data, lambda number, done: self._tell(number, done, len(paths)))
            self._said = self._sheets(found)
        except SENTENCES as error:
            self._said = notice_html([note_said(error, self._words)])
        finally:
            self._done = None
            self._hands.soon()

    def _tell(self, number: int, done: float, count: int) -> None:
        self._done = (number + done) / count

    def _sheets(self, found: Gathered) -> str:
        words = self._words
        left_out = notice_html(words("Left out: {reason}", reason=words.say(one)) for one in found.left_out)
        if not found.entries:
            return left_out + notice_html([words("No drive fits: choose other days or another field.")])
        area = area_text(found.worked, self._hands.desk().units, words)
        count = words.plural("{n} drive", "{n} drives", len(found.entries))
        return left_out + notice_html([f"{count} · {area}"]) + "".join(self._link(one, found) for one in SHEETS)

    def _link(self, ending: str, found: Gathered) -> str:
        title = self._title.value or self._words("Ledger")

        def make() -> Download:
            content = SHEETS[ending](found.entries, title, self._words)
            return Download(f"{title}{ending}", MEDIA_TYPES[ending], content)

        address = self._hands.house.files.offer(make)
        self._addresses.append(address)
        return link_html(address, self._words("Ledger as {kind}", kind=ending[1:].upper()))
