"""A field by typing its corners, in any of the systems of the receiver's menu (Inoue et al.)."""

import re

from guidance_app.boundary import BoundaryError, FieldDraft, checked_field
from guidance_app.console.registering.atelier import Atelier
from guidance_app.console.widgets import Shown, buttons, notice_html, rows_html
from guidance_app.coordinates import CornerError, Order, parse_corner
from guidance_app.geodesy import CoordinateSystem, Datum, Projection

__all__ = ["Typing"]

SYSTEMS = {
    "Degrees (also DMS)": Projection.GEOGRAPHIC,
    "UTM": Projection.UTM,
    "Plane rectangular (Japan)": Projection.PLANE_RECTANGULAR,
}
DATUMS = {"World": Datum.WORLD, "Tokyo": Datum.TOKYO}
ORDERS: dict[str, Order | None] = {"as written": None, "north first": "north first", "east first": "east first"}
FEWEST = 4
"""Corners that are asked for, as in Inoue et al.; three are taken."""
EXAMPLES = {
    Projection.GEOGRAPHIC: "47.500123, 8.500456",
    Projection.UTM: "462355.12, 5260988.40",
    Projection.PLANE_RECTANGULAR: "-36258.123, 12034.567",
}


class Typing:
    """Reads one corner a line."""

    def __init__(self, atelier: Atelier) -> None:
        self._atelier = atelier
        self._hands = atelier.hands
        self._words = words = atelier.hands.words
        gui = atelier.gui
        self._system = gui.add_dropdown(words("Coordinates"), tuple(words(name) for name in SYSTEMS))
        self._datum = gui.add_dropdown(words("Datum"), tuple(words(name) for name in DATUMS))
        self._zone = gui.add_text(words("Zone"), "", hint=words("UTM: 32 or 32S. Plane rectangular: 1 to 19."), visible=False)
        self._order = gui.add_dropdown(words("Order"), tuple(words(name) for name in ORDERS))
        self._inexact = gui.add_checkbox(words("Take it although it may be off by 9 m"), initial_value=False, visible=False)
        self._help = Shown(gui)
        self._text = gui.add_text(words("One corner a line"), "", multiline=True)
        self._read = Shown(gui)
        buttons(gui, "", ((words("Check"), self._check), (words("Cancel"), atelier.cancel)))
        done = gui.add_button(words("Preview"), color="green")

        @done.on_click
        async def _(_: object) -> None:
            self._hands.later(self._finish)

        @self._system.on_update
        async def _(_: object) -> None:
            self._explain()

        self._explain()

    def _projection(self) -> Projection:
        return list(SYSTEMS.values())[self._system.options.index(self._system.value)]

    def _explain(self) -> None:
        projection = self._projection()
        self._zone.visible = projection is not Projection.GEOGRAPHIC
        example = self._words("For example: {corner}", corner=EXAMPLES[projection])
        count = self._words("At least {count} corners, in turn around the field.", count=FEWEST)
        self._help.show(notice_html([f"{count} {example}"]))

    def _chosen_system(self) -> CoordinateSystem:
        """Raises ``BoundaryError`` for a zone that does not exist."""
        projection = self._projection()
        datum = list(DATUMS.values())[self._datum.options.index(self._datum.value)]
        if projection is Projection.GEOGRAPHIC:
            return CoordinateSystem(projection, datum)
        match = re.fullmatch(r"\s*(\d{1,2})\s*([NnSs]?)\s*", self._zone.value)
        if match is None:
            msg = self._words("Type the zone: a number, for UTM with N or S behind it.")
            raise BoundaryError(msg)
        try:
            return CoordinateSystem(projection, datum, int(match[1]), match[2].upper() == "S")
        except ValueError as error:
            raise BoundaryError(str(error)) from error

    def _corners(self) -> list[tuple[tuple[float, float], str]]:
        """Longitude, latitude of each line, and how it was read. Raises ``BoundaryError`` that names the line."""
        system = self._chosen_system()
        order = list(ORDERS.values())[self._order.options.index(self._order.value)]
        found = []
        for number, line in enumerate(self._text.value.splitlines(), start=1):
            if not line.strip():
                continue
            try:
                corner = parse_corner(line, system, order=order, inexact=bool(self._inexact.value))
            except CornerError as error:
                if error.inexact:
                    self._inexact.visible = True
                msg = self._words("Line {number}: {why}", number=number, why=str(error))
                raise BoundaryError(msg) from error
            found.append(((corner.longitude_deg, corner.latitude_deg), corner.said))
        if len(found) < FEWEST - 1:
            msg = self._words("{count} corners are typed; a field needs at least three.", count=len(found))
            raise BoundaryError(msg)
        return found

    def _check(self) -> None:
        """Says how each line was read, before anything is made of it."""
        try:
            corners = self._corners()
        except BoundaryError as error:
            self._read.show(notice_html([str(error)]))
            return
        self._read.show(rows_html((str(number), said) for number, (_, said) in enumerate(corners, start=1)))

    def _finish(self) -> None:
        try:
            ring = [place for place, _ in self._corners()]
        except BoundaryError as error:
            self._read.show(notice_html([str(error)]))
            return
        name = self._atelier.unique_name(self._words("New field"))
        closed = ring if ring[0] == ring[-1] else [*ring, ring[0]]
        self._atelier.offer((checked_field(FieldDraft(name, ((closed,),)), name),), self._words("typed"))

    def show(self) -> None:
        """Nothing here changes by itself."""

    def close(self) -> None:
        """Nothing is listened to."""
