"""The list of recordings: a few at a time with a small map each, the newest first."""

import datetime
import html
import queue
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import viser

from guidance_app.batch.reviewing import Review, opened_review
from guidance_app.console.desk import Desk, Hands
from guidance_app.console.files import upload_html
from guidance_app.console.pages import press
from guidance_app.console.widgets import Shown, buttons, note_html, notice_html
from guidance_app.language import Words
from guidance_app.store import StoreError
from guidance_app.store.recordings_list import ListedRecording
from guidance_app.view.review import thumbnail_svg
from guidance_app.view.status import clock
from guidance_app.view.units import area_text

__all__ = ["ListWays", "RecordingList"]

AT_ONCE = 5
SHORT = 3 * 3600.0
"""Maps of recordings up to this long (s) are made unasked."""


@dataclass(frozen=True, slots=True)
class ListWays:
    """Where the list leads: to a recording, to another page of the list, to the ledger of several.

    ``take`` keeps a file that comes in; ``undo`` brings back what was deleted last, None when nothing was.
    """

    look: Callable[[Path], None]
    go_to: Callable[[int], None]
    ledger: Callable[[], None]
    take: Callable[[str, bytes], None]
    undo: Callable[[], None] | None


class RecordingList:
    """One page of the recordings ``found``, with sentences ``said`` on what was just done."""

    def __init__(
        self,
        gui: viser.GuiApi,
        hands: Hands,
        found: tuple[ListedRecording, ...],
        page: int,
        ways: ListWays,
        said: tuple[str, ...] = (),
    ) -> None:
        self._hands = hands
        self._words = words = hands.words
        self._maps: dict[Path, Shown] = {}
        self._drawn: queue.SimpleQueue[tuple[ListedRecording, str]] = queue.SimpleQueue()
        if said:
            gui.add_html(notice_html(said))
        if ways.undo is not None:
            press(gui, words("Undo"), ways.undo, "orange")
        if not found:
            gui.add_html(
                notice_html(
                    [words("No drive is recorded yet. Every drive records itself and is found here afterwards.")]
                )
            )
        first = page * AT_ONCE
        shown = found[first : first + AT_ONCE]
        for one in shown:
            self._add(gui, one, ways.look)
        if len(found) > AT_ONCE:
            pages = (len(found) - 1) // AT_ONCE
            label = words("{first} to {last} of {count}", first=first + 1, last=first + len(shown), count=len(found))
            turns = (
                (words("Newer"), lambda: ways.go_to(max(page - 1, 0))),
                (words("Older"), lambda: ways.go_to(min(page + 1, pages))),
            )
            buttons(gui, label, turns)
        if found:
            press(gui, words("Ledger of several"), ways.ledger)
        self._token = hands.house.files.awaits(ways.take)
        with gui.add_folder(words("Take in a recording"), expand_by_default=False):
            kinds = words(
                "A zip of a recording, or of ISOXML task data: each of its time logs becomes a recording here."
            )
            gui.add_html(note_html(kinds) + upload_html(self._token, words("Choose a file"), ".zip"))
        hands.later(lambda: self._draw_maps(shown))

    def close(self) -> None:
        """No file is awaited any more."""
        self._hands.house.files.forget(self._token)

    def _add(self, gui: viser.GuiApi, one: ListedRecording, look: Callable[[Path], None]) -> None:
        picture = Shown(gui)
        self._maps[one.path] = picture
        picture.show(_card(one, "", self._words, self._hands))
        if one.summary is not None:
            press(gui, self._words("Look at {name}", name=_short_name(one, self._words)), lambda: look(one.path))

    def _draw_maps(self, shown: tuple[ListedRecording, ...]) -> None:
        """Beside the words; one that cannot be opened keeps its words alone. A drive goes before."""
        store = self._hands.house.store
        for one in shown:
            if (
                store is None
                or self._hands.house.driving
                or one.summary is None
                or one.summary.duration_s > SHORT
                or one.being_written
            ):
                continue
            try:
                review = opened_review(one.path, store.root)
            except StoreError:
                continue
            self._drawn.put((one, _map_of(review)))

    def show(self, desk: Desk) -> None:
        """Puts in the maps that have been drawn meanwhile."""
        del desk
        while not self._drawn.empty():
            one, picture = self._drawn.get()
            self._maps[one.path].show(_card(one, picture, self._words, self._hands))


def _map_of(review: Review) -> str:
    return thumbnail_svg(review.log, review.boundary)


def _short_name(one: ListedRecording, words: Words) -> str:
    summary = one.summary
    return one.path.name if summary is None else _moment(summary.started_utc, words)


def _moment(iso: str, words: Words) -> str:
    """The machine's local time of an ISO 8601 moment; the text itself where it is none."""
    try:
        return words.moment(datetime.datetime.fromisoformat(iso).astimezone())
    except ValueError:
        return iso


def _card(one: ListedRecording, picture: str, words: Words, hands: Hands) -> str:
    """Small map and words side by side; all text is escaped, the picture is our own."""
    summary = one.summary
    if summary is None:
        return notice_html([f"{one.path.name}: {words.say(one.problem or words('cannot be opened'))}"])
    units = hands.desk().units
    lines = [
        _moment(summary.started_utc, words),
        " · ".join(part for part in (summary.field, summary.operation) if part) or words("No field"),
        clock(summary.duration_s)
        + ("" if summary.worked_m2 is None else f" · {area_text(summary.worked_m2, units, words)}"),
    ]
    if one.being_written:
        lines.append(words("is being recorded"))
    elif summary.truncated:
        lines.append(words("cut off: {where}", where=words.say(summary.truncated)))
    said = "".join(f"<div>{html.escape(line)}</div>" for line in lines)
    return f'<div class="g-recording"><div class="g-map">{picture}</div><div>{said}</div></div>'
