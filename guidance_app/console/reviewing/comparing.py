"""A replay beside itself: the same inputs once more with another filter, look-ahead or place of the antenna.

What is changed here starts the replay again with a second engine; its track is drawn beside the drive's own.
"""

import html
from typing import Any

import viser
from pydantic import ValidationError

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.pages import press
from guidance_app.console.receiver_form import FILTER_WORDS
from guidance_app.console.widgets import Shown, note_html, rows_html
from guidance_app.documents import Receiver, Tractor
from guidance_app.language import Words
from guidance_app.model import Guidance
from guidance_app.runtime import Comparison, ReplaySession, cache_folder
from guidance_app.view.colours import Rgb, palette_of

__all__ = ["Comparing"]

ANTENNA = ("antenna_forward", "antenna_right", "antenna_height")


class Comparing:
    """A folder with what may be changed, and the legend while two tracks are drawn. Made inside the replay panel."""

    def __init__(self, gui: viser.GuiApi, hands: Hands, session: ReplaySession) -> None:
        self._hands = hands
        self._session = session
        self._words = words = hands.words
        now = session.compare or Comparison()
        job = session.job
        self._legend = Shown(gui)
        self._errors = Shown(gui)
        with gui.add_folder(words("Beside it, with another …"), expand_by_default=session.compare is not None):
            gui.add_html(note_html(words("The same drive once more, as it would have been. It begins from the start.")))
            self._names = [words(FILTER_WORDS[name][0]) for name in FILTER_WORDS]
            wanted = now.filter_name or session.filter_name
            self._filter: Any = gui.add_dropdown(
                words("Filter"), tuple(self._names), initial_value=words(FILTER_WORDS[wanted][0])
            )
            ahead = job.receiver.look_ahead if now.look_ahead is None else now.look_ahead
            self._ahead: Any = gui.add_number(words("Predict ahead (s)"), ahead, min=0.5, max=3.0, step=0.1)
            places = now.antenna or tuple(getattr(job.tractor, name) for name in ANTENNA)
            self._antenna: list[Any] = [
                gui.add_number(f"{words(Tractor.model_fields[name].title or name)} (m)", float(place), step=0.01)
                for name, place in zip(ANTENNA, places, strict=True)
            ]
            press(gui, words("Play again with both"), self._begin, "green")
            if session.compare is not None:
                press(gui, words("Play again without it"), lambda: self._play(None))

    def show(self, desk: Desk) -> None:
        """Which track is which, and how far each is from the pass now."""
        compare, ghost, words = self._session.compare, desk.snapshot.ghost, self._words
        if compare is None or ghost is None:
            self._legend.show("")
            self._errors.show("")
            return
        palette = palette_of(night=desk.night)
        own = words("as it was driven: {filter}", filter=self._filter_words(self._session.filter_name))
        lines = [(palette.track, own), (palette.ghost, self._changes(compare))]
        self._legend.show(_legend_html(lines))
        rows = [
            (words("Right of the pass"), _centimetres(desk.snapshot.guidance, words)),
            (words("Right of it, beside"), _centimetres(ghost.guidance, words)),
        ]
        self._errors.show(rows_html(rows))

    def _changes(self, compare: Comparison) -> str:
        words = self._words
        parts = [] if compare.filter_name is None else [self._filter_words(compare.filter_name)]
        if compare.look_ahead is not None:
            parts.append(words("{seconds} s ahead", seconds=words.number(compare.look_ahead, 1)))
        if compare.antenna is not None:
            forward, right, height = (words.number(one, 2) for one in compare.antenna)
            parts.append(
                words(
                    "antenna {forward} m forward, {right} m right, {height} m high",
                    forward=forward,
                    right=right,
                    height=height,
                )
            )
        return words("beside it: {changes}", changes=", ".join(parts))

    def _filter_words(self, name: str) -> str:
        return self._words(FILTER_WORDS[name][0])

    # --- on viser's loop -------------------------------------------------------------------------------------------

    def _begin(self) -> None:
        compare = self._wanted()
        if compare == Comparison():
            words = self._words
            self._hands.tell(words("Nothing to compare"), words("Change the filter or a number first."), bad=True)
        else:
            self._play(compare)

    def _wanted(self) -> Comparison:
        """What differs from the drive."""
        job = self._session.job
        name = list(FILTER_WORDS)[self._names.index(self._filter.value)]
        forward, right, height = (float(one.value) for one in self._antenna)
        own = tuple(getattr(job.tractor, each) for each in ANTENNA)
        ahead = float(self._ahead.value)
        return Comparison(
            filter_name=None if name == self._session.filter_name else name,
            look_ahead=None if ahead == job.receiver.look_ahead else ahead,
            antenna=None if (forward, right, height) == own else (forward, right, height),
        )

    def _play(self, compare: Comparison | None) -> None:
        self._hands.later(lambda: self._start(compare))

    def _start(self, compare: Comparison | None) -> None:
        try:
            session = self._session.again(compare)
        except ValidationError as error:
            first = error.errors()[0]
            title = _title_of(str(first["loc"][0]), self._words)
            self._hands.tell(self._words("Nothing to compare"), f"{title}: {first['msg']}", bad=True)
            return
        session.make_index(cache_folder())
        self._hands.house.take(session)


def _title_of(name: str, words: Words) -> str:
    field = Tractor.model_fields.get(name) or Receiver.model_fields[name]
    return words(field.title or name)


def _centimetres(guidance: Guidance | None, words: Words) -> str:
    return "–" if guidance is None else words("{n} cm", n=words.number(guidance.cross_track * 100, 1))


def _legend_html(lines: list[tuple[Rgb, str]]) -> str:
    spans = (f'<span><i style="background:rgb{colour}"></i>{html.escape(said)}</span>' for colour, said in lines)
    return f'<div class="g-legend">{"".join(spans)}</div>'
