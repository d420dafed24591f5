"""One recording looked at: its map in colours, the quality of its passes, charts, the ledger, and its files."""

import html
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import viser

from guidance_app.batch.reviewing import Review, additions_of, entry_of, keep_additions
from guidance_app.console.desk import Desk, Hands
from guidance_app.console.files import Download, link_html
from guidance_app.console.pages import press
from guidance_app.console.reviewing.handing_on import HandingOn
from guidance_app.console.reviewing.sheets import MEDIA_TYPES
from guidance_app.console.widgets import Choice, Shown, notice_html, rows_html
from guidance_app.geodesy import FieldFrame
from guidance_app.language import Words
from guidance_app.model import FloatArray
from guidance_app.reports import SHEETS
from guidance_app.reports.ledger import Additions, columns, heading_of, row_of
from guidance_app.reports.quality import PassQuality, histogram, overall, pass_qualities, spacings
from guidance_app.view.camera import ViewMode
from guidance_app.view.review import COLOURINGS, ColourBy, Coloured, coloured_track, error_along

__all__ = ["Looking", "Ways"]

TRACK, OTHER = "review", "review-other"
GREEN, VIOLET = "#2f9e44", "#7048e8"
OTHER_COLOUR = (112, 72, 232)


@dataclass(frozen=True, slots=True)
class Ways:
    """Where the page of one recording leads."""

    back: Callable[[], None]
    replay: Callable[[], None]


class Looking:
    """The page of one recording, beside another one when two are compared."""

    def __init__(
        self,
        gui: viser.GuiApi,
        hands: Hands,
        path: Path,
        review: Review,
        ways: "Ways",
    ) -> None:
        self._gui = gui
        self._hands = hands
        self._words = words = hands.words
        self._path = path
        self._review = review
        self._other: Review | None = None
        self._by = ColourBy.ERROR
        self._drawn: object = None
        self._pass: int | None = None
        press(gui, words("Back to the list"), ways.back)
        press(gui, words("Replay"), ways.replay, "green")
        if review.truncated:
            gui.add_html(notice_html([words.say(review.truncated)]))
        self._colouring = Choice(gui, words("Colours"), tuple(words(name) for name in COLOURINGS), self._colour_by)
        self._legend = Shown(gui)
        self._table = Shown(gui)
        self._add_charts()
        self._addresses: list[str] = []
        self._add_ledger()
        self._handing_on = HandingOn(gui, hands, path)
        hands.later(self._show_on_map)

    def close(self) -> None:
        """Nothing of this page is offered any more, and the map is as it was."""
        for name in (TRACK, OTHER):
            self._hands.sketch.remove(name)
        self._handing_on.close()
        for address in self._addresses:
            self._hands.house.files.forget(address)

    # --- the map ---------------------------------------------------------------------------------------------------

    def _colour_by(self, name: str) -> None:
        names = {self._words(one): by for one, by in COLOURINGS.items()}
        self._by = names[name]
        self._hands.soon()

    def _show_on_map(self) -> None:
        if self._hands.house.show_field(self._review.job.field):
            self._hands.look(ViewMode.WHOLE_FIELD)

    def show(self, desk: Desk) -> None:
        """Draws the track when colours or the map's frame have changed."""
        names = {by: self._words(one) for one, by in COLOURINGS.items()}
        self._colouring.show(names[self._by])
        other, sketch = self._other, self._hands.sketch
        key = (self._by, desk.snapshot.origin_deg, sketch.scene_number, id(other))
        if key == self._drawn:
            return
        self._drawn = key
        width = self._review.job.implement.working_width
        made = coloured_track(self._review.log, self._by, self._words, width)
        shown = desk.snapshot.origin_deg
        sketch.coloured(TRACK, _placed(made, self._review, shown), made.colours)
        if other is None:
            sketch.remove(OTHER)
        else:
            beside = coloured_track(other.log, self._by, self._words, width)
            plain = np.tile(np.array(OTHER_COLOUR, np.uint8), (len(beside.strokes), 1))
            sketch.coloured(OTHER, _placed(beside, other, shown), plain)
        self._legend.show(_legend_html(made, self._words("the other drive") if other is not None else ""))
        self._table.show(_table_html(self._review, other, self._words))

    def compare_with(self, other: Review | None) -> None:
        """Another recording beside this one; None for none."""
        self._other = other
        self._hands.soon()

    # --- charts ----------------------------------------------------------------------------------------------------

    def _add_charts(self) -> None:
        words, log = self._words, self._review.log
        numbers = [one.number for one in pass_qualities(log)]
        if not numbers:
            self._gui.add_html(notice_html([words("Nothing was driven on a pass with the implement down.")]))
            return
        names = (words("All passes"), *(words("Pass {number}", number=number) for number in numbers))
        which = self._gui.add_dropdown(words("Error along"), names)
        self._chart: Any = self._gui.add_uplot(**_error_chart(*error_along(log, None), words))

        @which.on_update
        async def _(_: object) -> None:
            place = names.index(which.value)
            along, error = error_along(log, None if place == 0 else numbers[place - 1])
            self._chart.data = (along, error)

        shares = histogram(log)
        middles = (shares.edges[:-1] + shares.edges[1:]) * 50.0
        self._gui.add_html(f'<div class="g-rows"><i>{html.escape(words("How often each error was driven"))}</i></div>')
        self._gui.add_uplot(**_histogram_chart(middles, shares.share * 100.0, words))

    # --- the ledger ------------------------------------------------------------------------------------------------

    def _add_ledger(self) -> None:
        words, gui = self._words, self._gui
        kept = additions_of(self._path) if self._path.is_dir() else Additions()
        with gui.add_folder(words("Ledger"), expand_by_default=False):
            entry = entry_of(self._review, kept)
            rows = [
                (heading_of(name, unit, words), cell if isinstance(cell, str) else words.number(cell, 2))
                for (name, unit), cell in zip(columns(), row_of(entry), strict=True)
                if cell not in (None, "")
            ]
            gui.add_html(rows_html(rows))
            entries = {
                "product": gui.add_text(words("Product"), kept.product),
                "rate": gui.add_text(words("Rate"), kept.rate),
                "fuel": gui.add_text(words("Fuel"), kept.fuel),
                "driver": gui.add_text(words("Driver"), kept.driver),
                "notes": gui.add_text(words("Notes"), kept.notes, multiline=True),
            }

            def keep() -> None:
                additions = Additions(**{name: str(one.value) for name, one in entries.items()})
                keep_additions(self._path, additions)
                self._hands.tell(words("Kept"), words("The sheets have it from now on."))

            if self._path.is_dir():
                press(gui, words("Keep"), lambda: self._hands.later(keep), "green")
            for ending in SHEETS:
                gui.add_html(self._sheet_link(ending))

    def _sheet_link(self, ending: str) -> str:
        def make() -> Download:
            additions = additions_of(self._path) if self._path.is_dir() else None
            entry = entry_of(self._review, additions)
            content = SHEETS[ending]([entry], self._words("Ledger"), self._words)
            return Download(f"{self._review.name}{ending}", MEDIA_TYPES[ending], content)

        address = self._hands.house.files.offer(make)
        self._addresses.append(address)
        return link_html(address, self._words("Ledger as {kind}", kind=ending[1:].upper()))


def _placed(made: Coloured, review: Review, shown: tuple[float, float] | None) -> FloatArray:
    """The strokes in the frame of the map; where the map has no place yet, the recording's own is it."""
    origin = review.log.origin_deg
    if origin is None or shown is None or origin == shown or not len(made.strokes):
        return made.strokes
    there, here = FieldFrame(*origin), FieldFrame(*shown)
    moved = here.array_from_lonlat(there.lonlat_from_array(made.strokes.reshape(-1, 2)))
    return moved.reshape(-1, 2, 2)


def _legend_html(made: Coloured, other: str) -> str:
    lines = [(one.colour, one.words) for one in made.legend]
    if other:
        lines.append((OTHER_COLOUR, other))
    return (
        '<div class="g-legend">'
        + "".join(f'<span><i style="background:rgb{colour}"></i>{html.escape(words)}</span>' for colour, words in lines)
        + "</div>"
    )


def _table_html(review: Review, other: Review | None, words: Words) -> str:
    """Each pass in a row; beside it the rms of the other drive when two are compared."""
    rest = {} if other is None else {one.number: one for one in pass_qualities(other.log)}
    every = overall(review.log)
    if every is None:
        return ""
    heads = [words("Pass"), "m", words("mean"), "rms", "95 %", words("most")]
    heads += [words("other rms")] if other is not None else []
    rows = [_quality_cells(one, words) for one in pass_qualities(review.log)]
    rows.append(_quality_cells(every, words))
    if other is not None:
        others = overall(other.log)
        keys = [one.number for one in pass_qualities(review.log)]
        for row, number in zip(rows, [*keys, None], strict=True):
            there = others if number is None else rest.get(number)
            row.append("–" if there is None else words.number(there.rms * 100, 1))
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    head = "".join(f"<th>{html.escape(name)}</th>" for name in heads)
    note = words("Errors in centimetres; mean positive right of the pass.")
    return f'<table class="g-table"><tr>{head}</tr>{body}</table>{notice_html([note])}{_spacing_html(review, words)}'


def _quality_cells(one: PassQuality, words: Words) -> list[str]:
    name = words("all") if one.number is None else str(one.number)
    sizes = [words.number(value * 100, 1) for value in (one.mean, one.rms, one.p95, one.largest)]
    return [name, f"{one.length:.0f}", *sizes]


def _spacing_html(review: Review, words: Words) -> str:
    """How far neighbouring passes were driven apart."""
    wanted = review.job.implement.spacing
    found = spacings(review.log, wanted)
    if not found:
        return ""
    rows = [
        (
            words("Passes {first} and {second}", first=one.first, second=one.second),
            words(
                "{metres} m apart, wanted {wanted} m", metres=words.number(one.mean, 2), wanted=words.number(wanted, 2)
            ),
        )
        for one in found
    ]
    return rows_html(rows)


def _error_chart(along: FloatArray, error: FloatArray, words: Words) -> dict[str, Any]:
    return {
        "data": (along, error),
        "series": (
            {"label": words("m on the pass")},
            {"label": words("cm right of it"), "stroke": GREEN, "width": 2},
        ),
        "scales": {"x": {"time": False}},
        "aspect": 1.7,
    }


def _histogram_chart(middles: FloatArray, shares: FloatArray, words: Words) -> dict[str, Any]:
    return {
        "data": (middles, shares),
        "series": (
            {"label": words("cm right of the pass")},
            {"label": words("% of the fixes"), "stroke": VIOLET, "width": 2, "fill": f"{VIOLET}33"},
        ),
        "scales": {"x": {"time": False}},
        "aspect": 2.0,
    }
