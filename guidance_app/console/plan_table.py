"""The table of plans as HTML: large rows to press, numbers in columns, the best one marked.

HTML in a panel hears no fingers. A label does: pressing it presses the button whose identifier it names, and that is
what each cell is made of. ``RowButtons`` makes those buttons, which nobody sees.
"""

import html
from collections.abc import Callable, Sequence

import viser

from guidance_app.language import Words, message
from guidance_app.view.plan_table import PlanRow

__all__ = ["RowButtons", "table_html"]

HEADS = (
    (message("Plan"), ""),
    (message("Minutes"), ""),
    (message("Worked"), message("Empty")),
    (message("Turns"), message("Tight")),
    (message("Twice"), message("Missed")),
)
"""Of each column what its upper and its lower text are: seven numbers side by side do not fit beside a map."""

STYLE = """<style>
.g-plans{border-collapse:collapse;width:calc(100% - 1.2em);margin:.2em .6em .5em;font-size:.66em;line-height:1.25;
 font-variant-numeric:tabular-nums}
.g-plans th{font-weight:500;color:var(--mantine-color-dimmed);padding:.2em .3em;text-align:right;vertical-align:bottom}
.g-plans th:first-child,.g-plans td:first-child{text-align:left}
.g-plans td{border-top:1px solid var(--mantine-color-default-border);text-align:right;padding:0;white-space:nowrap}
.g-plans label{display:flex;flex-direction:column;justify-content:center;min-height:3.6em;padding:.25em .3em;
 cursor:pointer}
.g-plans td:first-child label{white-space:normal}
.g-plans small{color:var(--mantine-color-dimmed);font-size:.9em}
.g-plans th small{display:block}.g-plans td:not(:first-child){font-size:1.15em}
.g-plans .g-best b::before{content:"★ ";color:#f08c00}
.g-plans .g-on{background:rgba(47,158,68,.22);box-shadow:inset .3em 0 #2f9e44}
.g-plans .g-unfit{color:#e03131;font-weight:600}
</style>"""


class RowButtons:
    """Unseen buttons, one a row, made when first asked for; ``pressed`` is called with the row's number."""

    def __init__(self, gui: viser.GuiApi, pressed: Callable[[int], None]) -> None:
        self._gui = gui
        self._pressed = pressed
        self._made: dict[int, str] = {}
        self._holder = gui.add_folder(None)  # rows come later, when the panel's own tab is open no more

    def named(self, number: int) -> str:
        """The identifier of this row's button in the page."""
        if number not in self._made:
            with self._holder:
                handle = self._gui.add_button(f"row {number}")
            self._made[number] = str(handle._impl.uuid)  # noqa: SLF001 - viser tells it nowhere else

            @handle.on_click
            async def _(_: object) -> None:
                self._pressed(number)

        return self._made[number]

    @property
    def style(self) -> str:
        """What keeps them out of sight; the second rule takes away the room they would take."""
        names = [f'[id="{name}"]' for name in self._made.values()]
        rooms = ",".join(f"div:has(>{name})" for name in names)
        return f"<style>{','.join(names)}{{display:none}}</style><style>{rooms}{{display:none}}</style>"


def table_html(rows: Sequence[PlanRow], chosen: int | None, named: Callable[[int], str], words: Words) -> str:
    """The table; empty without rows. ``named`` gives the identifier of a row's button."""
    if not rows:
        return ""
    head = "".join(f"<th>{_two(words(upper), words(lower))}</th>" for upper, lower in HEADS)
    lines = "".join(_line(row, named(row.number), words, on=row.number == chosen) for row in rows)
    return f'{STYLE}<table class="g-plans"><tr>{head}</tr>{lines}</table>'


def _line(row: PlanRow, button: str, words: Words, *, on: bool) -> str:
    marks = " ".join(name for name, is_so in (("g-best", row.best), ("g-on", on)) if is_so)
    unfit = ""
    if row.unfit:
        lacking = words.plural("{n} turn does not fit", "{n} turns do not fit", row.unfit)
        unfit = f'<span class="g-unfit">{html.escape(lacking)}</span>'
    small = html.escape(row.where if not row.reason else words.say(row.reason))
    first = f"<b>{html.escape(row.title)}</b><small>{small}</small>{unfit}"
    if row.reason:
        return f'<tr class="{marks}"><td colspan="{len(HEADS)}"><label>{first}</label></td></tr>'
    cells = "".join(f'<td><label for="{button}">{_two(*cell)}</label></td>' for cell in row.cells)
    return f'<tr class="{marks}"><td><label for="{button}">{first}</label></td>{cells}</tr>'


def _two(upper: str, lower: str) -> str:
    """One text over another."""
    return f"<span>{html.escape(upper)}</span><small>{html.escape(lower)}</small>" if lower else html.escape(upper)
