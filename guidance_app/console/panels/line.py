"""The line panel: how to drive without a plan, along a line that the driver draws by driving."""

from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.widgets import Choice, Shown, notice_html
from guidance_app.documents import Units
from guidance_app.engine.line_drawing import AT_ONCE
from guidance_app.language import message
from guidance_app.model import BeginLine, DropLine, EndLine, LineBegun, LineKind
from guidance_app.view.drive import line_begun_words

__all__ = ["Line"]

NAMES = {
    message("AB"): LineKind.AB,
    message("A+"): LineKind.A_PLUS,
    message("Curve"): LineKind.CURVE,
    message("Pivot"): LineKind.PIVOT,
    message("Last pass"): LineKind.FOLLOW,
}
HELP = {
    LineKind.AB: message("Straight passes: press Begin at A, drive, press End at B."),
    LineKind.A_PLUS: message("Straight passes through here, in the heading typed below or where the tractor points."),
    LineKind.CURVE: message("Passes beside a curve: press Begin, drive it, press End."),
    LineKind.PIVOT: message("Circles: press Begin, drive a part of the circle, press End."),
    LineKind.FOLLOW: message("Drive the first pass as you like; each next one runs beside the one before."),
}


class Line:
    """Chooses a kind of line, then begins and ends it."""

    title: ClassVar[str] = message("Line")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._words = words = hands.words
        self._kind = LineKind.AB
        self._kinds = {words(name): kind for name, kind in NAMES.items()}
        self._choice = Choice(gui, words("Kind"), tuple(self._kinds), self._choose)
        self._help = Shown(gui)
        self._heading = gui.add_text(words("Heading (°)"), "", hint=words("0 to 360; empty: where the tractor points"))
        self._begin = gui.add_button(words("Begin here (A)"), color="green")
        self._end = gui.add_button(words("End here (B)"), color="green", visible=False)
        self._drop = gui.add_button(words("Give up"), color="gray", visible=False)

        @self._begin.on_click
        async def _(_: object) -> None:
            self._start()

        @self._end.on_click
        async def _(_: object) -> None:
            hands.post(EndLine())

        @self._drop.on_click
        async def _(_: object) -> None:
            hands.post(DropLine())

    def _choose(self, name: str) -> None:
        self._kind = self._kinds[name]

    def _start(self) -> None:
        heading: float | None = None
        if self._kind == LineKind.A_PLUS and self._heading.value.strip():
            try:
                heading = self._words.parse_number(self._heading.value)
                command = BeginLine(self._kind, heading)
            except ValueError:
                said = self._words("'{text}' is no heading: type 0 to 360 degrees.", text=self._heading.value)
                self._hands.tell(self._words("Not done"), said, bad=True)
                return
        else:
            command = BeginLine(self._kind)
        self._hands.post(command)

    def _hints(self, under_way: LineBegun | None, units: Units) -> list[str]:
        """What to do: before a line is begun, and while it is drawn, when all that is driven counts as worked."""
        words = self._words
        if under_way is None:
            return [words(HELP[self._kind])]
        so_far = line_begun_words(under_way, units, words)
        what = (
            words(HELP[LineKind.FOLLOW])
            if under_way.start is None
            else words("{distance}: drive on, press End at B.", distance=so_far)
        )
        return [what, words("With Auto it counts as worked; press to lift for a drive without work.")]

    def show(self, desk: Desk) -> None:
        """Brings buttons and words up to the line that is drawn."""
        words = self._words
        under_way = desk.snapshot.line_begun
        begun = None if under_way is None or under_way.start is None else under_way.kind
        names = {kind: words(name) for name, kind in NAMES.items()}
        self._choice.show(names[begun or self._kind])
        planned = desk.snapshot.plan is not None
        said = words("This drive follows a plan: start one without a plan to draw a line.") if planned else ""
        self._help.show(notice_html([said] if said else self._hints(under_way, desk.units)))
        self._heading.visible = self._kind == LineKind.A_PLUS and begun is None and not planned
        self._begin.visible = begun is None and not planned
        self._begin.label = words("Guide from here") if self._kind in AT_ONCE else words("Begin here (A)")
        self._end.visible = self._drop.visible = begun is not None
