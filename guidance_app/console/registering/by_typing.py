"""A field by typing its corners, in any of the systems of the receiver's menu (Inoue et al.)."""

import viser

from guidance_app.boundary import BoundaryError, FieldDraft, checked_field
from guidance_app.console.desk import Desk
from guidance_app.console.registering.atelier import Atelier
from guidance_app.console.registering.choosing import SystemChoice
from guidance_app.console.widgets import Shown, buttons, notice_html, rows_html
from guidance_app.coordinates import CornerError, parse_corner
from guidance_app.geodesy import Projection

__all__ = ["Typing"]

FEWEST = 4
"""Corners that are asked for, as in Inoue et al.; three are taken."""
EXAMPLES = {
    Projection.GEOGRAPHIC: "47.500123, 8.500456",
    Projection.UTM: "462355.12, 5260988.40",
    Projection.PLANE_RECTANGULAR: "-36258.123, 12034.567",
}


class Typing:
    """Reads one corner a line."""

    def __init__(self, gui: viser.GuiApi, atelier: Atelier) -> None:
        self._atelier = atelier
        self._hands = atelier.hands
        self._words = words = atelier.hands.words
        self._said = ""
        """How the lines were read, or why they were not; the worker leaves it, the redraw shows it."""
        self._choice = SystemChoice(gui, atelier)
        self._help = Shown(gui)
        self._text = gui.add_text(words("One corner a line"), "", multiline=True)
        self._read = Shown(gui)
        buttons(gui, "", ((words("Check"), self._pressed), (words("Cancel"), atelier.cancel)))
        done = gui.add_button(words("Preview"), color="green")

        @done.on_click
        async def _(_: object) -> None:
            self._hands.later(self._finish)

    def _pressed(self) -> None:
        self._hands.later(self._check)

    def _say(self, said: str) -> None:
        self._said = said
        self._hands.soon()

    def _corners(self) -> list[tuple[tuple[float, float], str]]:
        """Longitude, latitude of each line, and how it was read. Raises ``BoundaryError`` that names the line."""
        system, order, inexact = self._choice.system(), self._choice.order, self._choice.inexact
        found = []
        for number, line in enumerate(self._text.value.splitlines(), start=1):
            if not line.strip():
                continue
            try:
                corner = parse_corner(line, system, order=order, inexact=inexact)
            except CornerError as error:
                if error.inexact:
                    self._choice.ask_for_consent()
                msg = self._words("Line {number}: {why}", number=number, why=self._words.say(str(error)))
                raise BoundaryError(msg) from error
            found.append(((corner.longitude_deg, corner.latitude_deg), self._words.say(corner.said)))
        if len(found) < FEWEST - 1:
            msg = self._words("{count} corners are typed; a field needs at least three.", count=len(found))
            raise BoundaryError(msg)
        return found

    def _check(self) -> None:
        """Says how each line was read, before anything is made of it."""
        try:
            corners = self._corners()
        except BoundaryError as error:
            self._say(notice_html([self._words.say(str(error))]))
            return
        self._say(rows_html((str(number), said) for number, (_, said) in enumerate(corners, start=1)))

    def _finish(self) -> None:
        try:
            ring = [place for place, _ in self._corners()]
            name = self._atelier.unique_name(self._words("New field"))
            closed = ring if ring[0] == ring[-1] else [*ring, ring[0]]
            checked = checked_field(FieldDraft(name, ((closed,),)), name)
        except BoundaryError as error:
            self._say(notice_html([self._words.say(str(error))]))
            return
        self._atelier.offer((checked,), self._words("typed"))

    def show(self, desk: Desk) -> None:
        """Brings help and what was read up to the choice and the check."""
        del desk
        self._choice.show()
        example = self._words("For example: {corner}", corner=EXAMPLES[self._choice.projection])
        count = self._words("At least {count} corners, in turn around the field.", count=FEWEST)
        self._help.show(notice_html([f"{count} {example}"]))
        self._read.show(self._said)
