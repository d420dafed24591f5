"""What panels are made of: HTML that is escaped, and widgets that follow what is without answering themselves.

A value that the program sets fires the widget's callback like a finger does, and a finger on a slider fights with the
program that sets it. ``Followed`` keeps both apart: its callback hears fingers only, and for a moment after a finger
the program does not set the widget.

Callbacks are coroutines: viser runs them on its own loop, one after the other, before the next message is looked at. On
its pool of threads two quick presses could both read the later button. They must therefore return at once.
"""

import html
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import viser

from guidance_app.language import Words
from guidance_app.view.status import Figure, Level

__all__ = [
    "STYLE",
    "Choice",
    "Followed",
    "Shown",
    "buttons",
    "note_html",
    "notice_html",
    "notice_line_html",
    "progress_html",
    "rows_html",
    "tiles_html",
    "words_html",
]

HELD_S = 1.2
"""So long after a finger the program leaves a widget alone."""

STYLE = """<style>
.g-tiles{display:grid;grid-template-columns:repeat(4,1fr);gap:.35em .3em;padding:0 .6em .15em;
 font-variant-numeric:tabular-nums}
.g-tile{min-width:0;line-height:1.12}
.g-tile i{font-style:normal;display:block;font-size:.56em;color:var(--mantine-color-dimmed);white-space:nowrap}
.g-tile b{font-size:1.12em;font-weight:650;letter-spacing:-.02em;white-space:nowrap}
.g-tile s{text-decoration:none;font-size:.58em;color:var(--mantine-color-dimmed);margin-left:.2em;white-space:nowrap}
.g-words{padding:0 .75em .25em;font-size:.72em;white-space:nowrap;overflow:hidden;text-overflow:ellipsis}
.g-words::before{content:"";display:inline-block;width:.62em;height:.62em;border-radius:50%;margin-right:.5em}
.g-good::before{background:#2f9e44}.g-fair::before{background:#f08c00}
.g-bad::before{background:#e03131;border-radius:0}.g-off::before{background:#868e96}
.g-notice{margin:.1em .6em .45em;padding:.3em .6em;font-size:.66em;line-height:1.3;border-radius:.3em;
 border-left:.25em solid #f08c00;background:rgba(240,140,0,.13)}
.g-line .g-notice{margin:0 .9em .25em;padding:.05em .6em;white-space:nowrap;overflow:hidden;text-overflow:ellipsis}
.g-note{padding:0 1.1em .3em .75em;font-size:.72em;color:var(--mantine-color-dimmed)}
.g-bar{margin:.3em .9em;height:.7em;border-radius:.35em;background:rgba(128,128,128,.25);overflow:hidden}
.g-bar b{display:block;height:100%;background:#2f9e44}
.g-rows{padding:.1em 1.1em .5em .75em;font-size:.74em;line-height:1.55;font-variant-numeric:tabular-nums}
.g-rows div{display:flex;justify-content:space-between;gap:1em}
.g-rows i{font-style:normal;color:var(--mantine-color-dimmed);white-space:nowrap}
.g-rows b{font-weight:500;text-align:right;overflow-wrap:anywhere}
.mantine-Button-root[data-size="compact-xs"]{height:2.55em;font-size:.74em;--button-fz:.74em;padding-inline:.35em;
 color:var(--mantine-color-text);border-color:var(--mantine-color-default-border);
 background:var(--mantine-color-default-hover);font-weight:550}
.mantine-Button-root[data-size="compact-xs"]:active{background:var(--mantine-primary-color-filled);color:#fff}
.mantine-Slider-thumb{height:1.5rem!important;width:1rem!important;border-radius:.3rem!important}
.mantine-Slider-trackContainer{height:1.6rem!important}
[style*="width: 7.25em"]{width:5.2em!important}
.mantine-Tabs-tab{padding-inline:.42em!important;font-size:.9em}
[style*="max-width: 14em"]{padding:0 .42em!important;font-size:.85em;height:2.82em!important}
@media(max-width:576px){[style*="width: 20em"]{width:100vw!important}
 .g-tile:nth-child(-n+4){display:none}.g-tiles{padding-bottom:.3em}}
</style>"""
"""Sizes follow the page's font size; colours are the theme's own, so that day and night need nothing here."""


def tiles_html(figures: Iterable[Figure]) -> str:
    """Large numbers with small names, four in a row."""
    tiles = "".join(
        f'<div class="g-tile"><i>{html.escape(one.name)}</i><b>{html.escape(one.value)}</b>'
        f"<s>{html.escape(one.unit)}</s></div>"
        for one in figures
    )
    return f'<div class="g-tiles">{tiles}</div>'


def words_html(words: str, level: Level) -> str:
    """One line with a dot for how good it is; bad is a square, so that it is not the colour alone."""
    return f'<div class="g-words g-{level}">{html.escape(words)}</div>'


def note_html(words: str) -> str:
    """One small line."""
    return f'<div class="g-note">{html.escape(words)}</div>'


def notice_html(notices: Iterable[str]) -> str:
    """Things to know, in boxes of their own."""
    return "".join(f'<div class="g-notice">{html.escape(one)}</div>' for one in notices)


def notice_line_html(notices: Sequence[str], words: Words) -> str:
    """The first thing to know on one line, and how many there are; all of them are in the info panel."""
    if not notices:
        return ""
    first = notices[0]
    if len(notices) > 1:
        first = words("(1 of {count}) {notice}", count=len(notices), notice=first)
    return f'<div class="g-line">{notice_html([first])}</div>'


def progress_html(done: float) -> str:
    """A bar that is filled from the left by so much, 0 to 1."""
    return f'<div class="g-bar"><b style="width:{100 * min(max(done, 0.0), 1.0):.0f}%"></b></div>'


def rows_html(rows: Iterable[tuple[str, str]]) -> str:
    """Names on the left, values on the right."""
    lines = "".join(f"<div><i>{html.escape(name)}</i><b>{html.escape(value)}</b></div>" for name, value in rows)
    return f'<div class="g-rows">{lines}</div>'


class Shown:
    """A piece of HTML that is sent only when it has changed, and hidden when it is empty."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._handle = gui.add_html("")

    def show(self, content: str) -> None:
        """Replaces the content."""
        self._handle.content = content
        self._handle.visible = bool(content)


class Followed:
    """An input that shows what is. ``heard`` is called with the value a finger has set, on viser's loop."""

    def __init__(self, handle: Any, heard: Callable[[Any], None]) -> None:
        self._handle = handle
        self._touched = -HELD_S

        @handle.on_update  # type: ignore[untyped-decorator]  # any of viser's inputs
        async def _(event: viser.GuiEvent[Any]) -> None:
            if event.client_id is None:
                return
            self._touched = time.monotonic()
            heard(event.target.value)

    def show(self, value: Any) -> None:
        """Sets the value, unless a finger was there a moment ago."""
        if time.monotonic() - self._touched >= HELD_S and self._handle.value != value:
            self._handle.value = value


def buttons(
    gui: viser.GuiApi, label: str, actions: Sequence[tuple[str, Callable[[], None]]]
) -> viser.GuiButtonGroupHandle:
    """A row of buttons side by side behind a label that may change; each has its action."""
    handle = gui.add_button_group(label, tuple(words for words, _ in actions))
    by_words = dict(actions)

    @handle.on_click
    async def _(event: viser.GuiEvent[viser.GuiButtonGroupHandle]) -> None:
        by_words[event.target.value]()

    return handle


class Choice:
    """A row of buttons of which one is chosen, marked by a dot; ``beside`` are plain buttons in the same row."""

    MARK = "● "

    def __init__(
        self,
        gui: viser.GuiApi,
        label: str,
        options: Sequence[str],
        heard: Callable[[str], None],
        beside: Mapping[str, Callable[[], None]] | None = None,
    ) -> None:
        self._options = tuple(str(one) for one in options)  # viser makes a value of the first one's type
        self._beside = dict(beside or {})
        self._chosen: str | None = None
        self._handle = gui.add_button_group(label, (*self._options, *self._beside))

        @self._handle.on_click
        async def _(event: viser.GuiEvent[viser.GuiButtonGroupHandle]) -> None:
            words = event.target.value.removeprefix(self.MARK)
            if words in self._beside:
                self._beside[words]()
            else:
                heard(words)

    def show(self, chosen: str) -> None:
        """Marks the chosen one."""
        if chosen != self._chosen:
            self._chosen = chosen
            marked = (f"{self.MARK}{one}" if one == chosen else one for one in self._options)
            self._handle.options = (*marked, *self._beside)
