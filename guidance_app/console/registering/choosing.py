"""The choice of a coordinate system, as in the menu of Inoue et al.: coordinates, zone, datum, order."""

import re

import viser

from guidance_app.boundary import BoundaryError
from guidance_app.console.registering.atelier import Atelier
from guidance_app.coordinates import Order
from guidance_app.geodesy import CoordinateSystem, Datum, Projection
from guidance_app.language import message

__all__ = ["SystemChoice"]

SYSTEMS: dict[str, Projection] = {
    message("Degrees (also DMS)"): Projection.GEOGRAPHIC,
    message("UTM"): Projection.UTM,
    message("Plane rectangular (Japan)"): Projection.PLANE_RECTANGULAR,
}
DATUMS: dict[str, Datum] = {message("World"): Datum.WORLD, message("Tokyo"): Datum.TOKYO}
ORDERS: dict[str, Order | None] = {
    message("as written"): None,
    message("north first"): "north first",
    message("east first"): "east first",
}


class SystemChoice:
    """The widgets of the choice; begins with what the receiver in use says."""

    def __init__(self, gui: viser.GuiApi, atelier: Atelier) -> None:
        self._words = words = atelier.hands.words
        receiver = atelier.hands.house.manager.job.receiver
        systems = tuple(words(name) for name in SYSTEMS)
        begin = [one.value for one in SYSTEMS.values()].index(receiver.projection)
        self._system = gui.add_dropdown(words("Coordinates"), systems, initial_value=systems[begin])
        datums = tuple(words(name) for name in DATUMS)
        begin = [one.value for one in DATUMS.values()].index(receiver.datum)
        self._datum = gui.add_dropdown(words("Datum"), datums, initial_value=datums[begin])
        hint = words("UTM: 32 or 32S. Plane rectangular: 1 to 19.")
        self._zone = gui.add_text(words("Zone"), "", hint=hint)
        self._order = gui.add_dropdown(words("Order"), tuple(words(name) for name in ORDERS))
        self._inexact = gui.add_checkbox(
            words("Take it although it may be off by 9 m"), initial_value=False, visible=False
        )
        self._asks_for_consent = False
        self.show()

        @self._system.on_update
        async def _(_: object) -> None:
            atelier.hands.soon()

    def show(self) -> None:
        """Only what the chosen system needs is in sight."""
        self._zone.visible = self.projection is not Projection.GEOGRAPHIC
        self._inexact.visible = self._asks_for_consent

    @property
    def projection(self) -> Projection:
        """The chosen way of writing."""
        return list(SYSTEMS.values())[self._system.options.index(self._system.value)]

    @property
    def order(self) -> Order | None:
        """Which number comes first; None as it is written."""
        return list(ORDERS.values())[self._order.options.index(self._order.value)]

    @property
    def inexact(self) -> bool:
        """Whether a change of datum that is metres off is accepted."""
        return bool(self._inexact.value)

    def ask_for_consent(self) -> None:
        """Brings up the box that accepts an inexact datum, at the next redraw; from any thread."""
        self._asks_for_consent = True

    def system(self) -> CoordinateSystem:
        """The chosen system. Raises ``BoundaryError`` for a zone that does not exist."""
        datum = list(DATUMS.values())[self._datum.options.index(self._datum.value)]
        if self.projection is Projection.GEOGRAPHIC:
            return CoordinateSystem(self.projection, datum)
        match = re.fullmatch(r"\s*(\d{1,2})\s*([NnSs]?)\s*", self._zone.value)
        if match is None:
            msg = self._words("Type the zone: a number, for UTM with N or S behind it.")
            raise BoundaryError(msg)
        try:
            return CoordinateSystem(self.projection, datum, int(match[1]), match[2].upper() == "S")
        except ValueError as error:
            raise BoundaryError(str(error)) from error
