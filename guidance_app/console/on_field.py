"""What an operation says of places on its field: the edge along which its passes lie, the exclusions it drives over.

Both are tapped on the map, where they are drawn in colours, or chosen in the form: the next edge by a button, each
exclusion from a list below a picture with numbers. The form tells which field and method are chosen; taps are heard
only while one of the two is asked for.
"""

import html
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import shapely
import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.forms import hint_html, message_html, picture_html
from guidance_app.console.widgets import Choice, Shown, notice_html
from guidance_app.documents import FieldDocument, Position
from guidance_app.guidance.picking import Picking, edge_words, picking_of, places_in
from guidance_app.guidance.wishes import exclusions_with
from guidance_app.language import message
from guidance_app.model import FloatArray
from guidance_app.view.camera import ViewMode
from guidance_app.view.drawing_field import field_picture
from guidance_app.view.numerals import painted
from guidance_app.view.polyline import closed_ring
from guidance_app.view.units import distance_text, small_area_text

__all__ = ["Asked", "OnField"]

GREEN, RED, ORANGE, WHITE = (47, 158, 68), (224, 49, 49), (232, 89, 12), (255, 255, 255)
EDGE, AROUND, OVER, NUMBERS = "edge", "around", "over", "numbers"
DRIVE_AROUND, PASSABLE, ONE_BY_ONE = message("Drive around"), message("Passable"), message("One by one")
LISTED = 40
"""Exclusions that have a row of their own; of more the largest ones have."""
REACH, REACH_BESIDE_EDGES = 0.04, 0.012
"""How far beside an exclusion a finger may tap, as a part of the field's span; less while edges are tapped too."""
DIGIT = 0.018
"""Width of a painted digit, as a part of the field's span."""
EDGE_PIXELS, RING_PIXELS = 9.0, 5.0


@dataclass(frozen=True, slots=True)
class Asked:
    """What the form has chosen: the field's name, and whether its edges and its exclusions are asked for."""

    field: str
    edge: bool
    exclusions: bool


@dataclass(slots=True)
class _Wishes:
    """What is chosen on one field so far."""

    edge_at: Position | None = None
    exclusions: str = DRIVE_AROUND
    passable: set[int] = field(default_factory=set)
    lost: int = 0
    """Places of the operation that lie in no exclusion any more."""


class OnField:
    """The parts of an operation's form that are about its field; ``make_*`` puts them where the form wants them."""

    def __init__(
        self,
        hands: Hands,
        gui: viser.GuiApi,
        initial: Mapping[str, Any],
        documents: Mapping[str, FieldDocument],
        touched: Callable[[], None],
    ) -> None:
        self._hands, self._gui, self._touched = hands, gui, touched
        self._words = hands.words
        self._documents, self._initial = documents, initial
        self._wishes: dict[str, _Wishes] = {}
        self._pickings: dict[str, Picking] = {}
        self._asked = Asked("", edge=False, exclusions=False)
        self._wrong = ""
        self._drawn: object = None
        self._listed: object = None
        self.changed = False

    def make_edge(self) -> None:
        """What is said of the edge, and the button that goes on to another one."""
        self._edge_said = Shown(self._gui)
        self._next: Any = self._gui.add_button(self._words("Next edge"), color="gray", visible=False)

        @self._next.on_click
        async def _(_: object) -> None:
            self._next_edge()

    def make_exclusions(self) -> None:
        """The choice for all of them; the list comes below it as it is wanted."""
        self._holder = self._gui.add_folder(None)
        self._inner: viser.GuiFolderHandle | None = None
        self._rows: list[tuple[int, Choice]] = []
        self._all: Choice | None = None

    # --- what is chosen --------------------------------------------------------------------------------------------

    @property
    def _now(self) -> _Wishes:
        return self._on(self._asked.field)

    def _on(self, name: str) -> _Wishes:
        if name not in self._wishes:
            self._wishes[name] = self._begun(name)
        return self._wishes[name]

    def _begun(self, name: str) -> _Wishes:
        """As the operation was stored, if it was for this field."""
        document = self._documents.get(name)
        if document is None or name != self._initial.get("field"):
            return _Wishes()
        places = list(self._initial.get("passable", ()))
        passable = set(exclusions_with(document, places))
        exclusions = ONE_BY_ONE if places else DRIVE_AROUND
        if self._initial.get("over_exclusions"):
            exclusions = PASSABLE
        return _Wishes(self._initial.get("edge_at"), exclusions, passable, max(0, len(places) - len(passable)))

    def _picking(self) -> Picking | None:
        name = self._asked.field
        if name not in self._pickings and name in self._documents:
            self._pickings[name] = picking_of(self._documents[name])
        return self._pickings.get(name)

    def values(self, asked: Asked) -> dict[str, Any]:
        """The members of the operation that are chosen here; ``asked`` as the form is now, not as it was drawn last."""
        now, document = self._on(asked.field), self._documents.get(asked.field)
        one_by_one = now.exclusions == ONE_BY_ONE and document is not None
        known = list(self._initial.get("passable", ()))
        return {
            "edge_at": now.edge_at,
            "over_exclusions": now.exclusions == PASSABLE,
            "passable": places_in(document, now.passable, known) if one_by_one and document is not None else [],
        }

    def complete(self, asked: Asked) -> bool:
        """False when an edge is wanted and none is tapped, which then stands in the form."""
        missing = asked.edge and self._on(asked.field).edge_at is None
        self._wrong = self._words("No edge is chosen yet: tap one on the map.") if missing else ""
        if missing:
            self._touched()
        return not missing

    def _change(self) -> None:
        self.changed = True
        self._wrong = ""
        self._touched()

    def _tap(self, east: float, north: float) -> None:
        picking, now = self._picking(), self._now
        if picking is None:
            return
        if self._asked.exclusions and now.exclusions == ONE_BY_ONE:
            reach = (REACH_BESIDE_EDGES if self._asked.edge else REACH) * picking.span
            found = picking.exclusion_at(east, north, reach)
            if found is not None:
                now.passable ^= {found}
                self._change()
                return
        if self._asked.edge:
            now.edge_at = picking.edge_at(east, north)
            self._change()

    def _next_edge(self) -> None:
        picking, now = self._picking(), self._now
        if picking is not None:
            edges = picking.longest_edges()
            before = edges.index(now.edge_at) if now.edge_at in edges else -1
            now.edge_at = edges[(before + 1) % len(edges)]
            self._change()

    def _choose_all(self, label: str) -> None:
        by_label = {self._words(one): one for one in (DRIVE_AROUND, PASSABLE, ONE_BY_ONE)}
        self._now.exclusions = by_label[label]
        self._change()

    def _choose(self, number: int, label: str) -> None:
        if label == self._words(PASSABLE):
            self._now.passable.add(number)
        else:
            self._now.passable.discard(number)
        self._change()

    # --- what is shown ---------------------------------------------------------------------------------------------

    def show(self, asked: Asked, desk: Desk | None) -> None:
        """Brings form and map up to what the form asks for."""
        if asked != self._asked:
            self._asked = asked
            self._wrong = ""
        picking = self._picking()
        self._edge_said.show(self._edge_html(picking) if asked.edge else "")
        self._next.visible = asked.edge and picking is not None
        self._show_list(picking)
        if desk is not None:
            self._show_map(picking, desk)

    def _edge_html(self, picking: Picking | None) -> str:
        at = self._now.edge_at
        if at is None or picking is None:
            return message_html(self._wrong) + notice_html([self._words("Tap an edge of the field on the map.")])
        metres, degrees = edge_words(picking.edge_of(at))
        said = self._words(
            "Along the orange edge: {length} long, heading {degrees}°. Tap another one to change.",
            length=distance_text(metres, self._hands.house.settings().units, self._words),
            degrees=round(degrees),
        )
        return f'<div class="g-said">{html.escape(said)}</div>'

    def _show_list(self, picking: Picking | None) -> None:
        """The choice for all, and below it the picture with a row for each; made anew for another field or choice."""
        count = 0 if picking is None or not self._asked.exclusions else len(picking.polygon.interiors)
        one_by_one = count > 0 and self._now.exclusions == ONE_BY_ONE
        wanted = (self._asked.field, count, one_by_one)
        if wanted != self._listed:
            self._listed = wanted
            self._make_list(picking if count else None, one_by_one=one_by_one)
        if self._all is not None:
            self._all.show(self._words(self._now.exclusions))
        if one_by_one and picking is not None:
            self._picture.show(picture_html(field_picture(picking.rings, self._now.passable, self._words)))
        for number, row in self._rows:
            row.show(self._words(PASSABLE if number in self._now.passable else DRIVE_AROUND))

    def _make_list(self, picking: Picking | None, *, one_by_one: bool) -> None:
        if self._inner is not None:
            self._inner.remove()
        self._rows, self._all, self._inner = [], None, None
        if picking is None:
            return
        words = self._words
        with self._holder:
            self._inner = self._gui.add_folder(None)
        with self._inner:
            kinds = [words(one) for one in (DRIVE_AROUND, PASSABLE, ONE_BY_ONE)]
            self._all = Choice(self._gui, words("Exclusions"), kinds, self._choose_all)
            self._gui.add_html(hint_html(words("Passable ones are driven and worked over")))
            if one_by_one:
                self._make_rows(picking)

    def _make_rows(self, picking: Picking) -> None:
        words, units = self._words, self._hands.house.settings().units
        self._gui.add_html(hint_html(words("Tap an exclusion on the map, or choose below.")))
        if self._now.lost:
            lost = words("An exclusion that was passable is not there any more.")
            self._gui.add_html(notice_html([lost]))
        self._picture = Shown(self._gui)
        areas = picking.exclusion_areas()
        largest = sorted(range(len(areas)), key=lambda number: -areas[number])[:LISTED]
        for number in sorted(largest):
            label = f"{number + 1} · {small_area_text(areas[number], units, words)}"
            kinds = [words(DRIVE_AROUND), words(PASSABLE)]
            self._rows.append((number, Choice(self._gui, label, kinds, partial(self._choose, number))))
        if len(areas) > LISTED:
            rest = words("Only the {count} largest are listed; the others can be tapped.", count=LISTED)
            self._gui.add_html(hint_html(rest))

    # --- the map ---------------------------------------------------------------------------------------------------

    def _show_map(self, picking: Picking | None, desk: Desk) -> None:
        """Edge and exclusions in colours over the field, while they are asked for and the field is on the map."""
        now, asked = self._now, self._asked
        one_by_one = asked.exclusions and now.exclusions == ONE_BY_ONE
        wanted = picking is not None and (asked.edge or one_by_one)
        place = (desk.snapshot.origin_deg, self._hands.sketch.scene_number)
        key = (wanted, asked, now.edge_at, one_by_one, frozenset(now.passable), place)
        if key == self._drawn:
            return
        begins = wanted and (not isinstance(self._drawn, tuple) or self._drawn[:2] != key[:2])
        self._drawn = key
        if begins:
            self._bring_field()
        on_map = picking is not None and _same_place(desk.snapshot.origin_deg, picking)
        self._draw(picking if wanted and on_map else None, one_by_one=one_by_one)

    def _bring_field(self) -> None:
        """The field of the form on the map; while something is driven, its own field stays."""
        document, house = self._documents[self._asked.field], self._hands.house
        self._hands.look(ViewMode.WHOLE_FIELD)
        shown = house.manager.job.field
        if shown is None or shown.boundary != document.boundary:
            self._hands.later(lambda: self._tell_unless(shown_now=house.show_field(document)))

    def _tell_unless(self, *, shown_now: bool) -> None:
        if not shown_now:
            title = self._words("Another field is on the map")
            self._hands.tell(title, self._words("Something is driven now: choose in the form, not on the map."))

    def _draw(self, picking: Picking | None, *, one_by_one: bool) -> None:
        sketch, now = self._hands.sketch, self._now
        edge = picking is not None and self._asked.edge and now.edge_at is not None
        at = now.edge_at
        lines = [picking.edge_of(at)] if picking is not None and edge and at is not None else []
        sketch.strokes(EDGE, lines, ORANGE, EDGE_PIXELS)
        rings = picking.rings[1:] if picking is not None and one_by_one else []
        closed = [closed_ring(ring) for ring in rings]
        sketch.strokes(AROUND, [one for n, one in enumerate(closed) if n not in now.passable], RED, RING_PIXELS)
        sketch.strokes(OVER, [one for n, one in enumerate(closed) if n in now.passable], GREEN, RING_PIXELS)
        sketch.strokes(NUMBERS, _numbers(picking) if picking is not None and rings else [], WHITE, RING_PIXELS)
        sketch.hear_taps(None if picking is None else self._tap)

    def close(self) -> None:
        """Takes away what it has drawn, and hears no taps."""
        self._draw(None, one_by_one=False)


def _same_place(origin_deg: tuple[float, float] | None, picking: Picking) -> bool:
    return origin_deg == (picking.frame.latitude_deg, picking.frame.longitude_deg)


def _numbers(picking: Picking) -> list[FloatArray]:
    """Strokes of the exclusions' numbers, on those that are large enough and beside the others."""
    size = DIGIT * picking.span
    strokes: list[FloatArray] = []
    for number, ring in enumerate(picking.polygon.interiors):
        hole = shapely.Polygon(ring)
        middle = hole.representative_point()
        west, south, east, north = hole.bounds
        room = min(east - west, north - south) > 4 * size
        place = (middle.x, middle.y) if room else (east + 1.5 * size, (south + north) / 2)
        strokes.extend(painted(number + 1, place, (0.0, 1.0), size=size))
    return strokes
