"""The position panel: every offset in force with its undo, the mark, measuring at the start point, the roll zero."""

from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.widgets import Shown, notice_html, progress_html, rows_html
from guidance_app.coordinates import parse_corner
from guidance_app.documents import Tractor
from guidance_app.geodesy import CoordinateSystem, Datum
from guidance_app.language import message
from guidance_app.model import (
    BeginInitialisation,
    CancelRollZero,
    DropOffset,
    OffsetKind,
    OnTheMark,
    SessionState,
    SkipInitialisation,
)
from guidance_app.view.points import KnownPoint, distance_to, known_points, nearest_of
from guidance_app.view.position import measured_words, measuring_words, offsets_in_force, roll_zero_view
from guidance_app.view.units import offset_text

__all__ = ["Position"]

TYPED, NEAREST = message("Typed below"), message("The nearest point")


class Position:
    """Posts commands; what is in force is read from the snapshot."""

    title: ClassVar[str] = message("Position")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._words = hands.words
        self._offsets = _Offsets(gui, hands)
        self._point = _Point(gui, hands)
        self._marks(gui)
        with gui.add_folder(self._words("Roll sensor's zero"), expand_by_default=False):
            self._roll = _RollZero(gui, hands)

    def _marks(self, gui: viser.GuiApi) -> None:
        words = self._words
        mark = gui.add_button(words("I stand on this point"), color="green")
        self._measure = gui.add_button(words("Measure here"), color="gray")
        self._without = gui.add_button(words("Measure without a known point"), color="gray")
        self._measuring = Shown(gui)
        self._result = Shown(gui)

        @mark.on_click
        async def _(_: object) -> None:
            point = self._point.chosen()
            if point is not None:
                self._hands.post(OnTheMark(point.latitude_deg, point.longitude_deg))

        @self._measure.on_click
        async def _(_: object) -> None:
            self._pressed()

        @self._without.on_click
        async def _(_: object) -> None:
            self._hands.post(BeginInitialisation())

    def _pressed(self) -> None:
        if self._hands.desk().snapshot.state is SessionState.INITIALISING:
            self._hands.post(SkipInitialisation())
            return
        point = self._point.chosen()
        if point is not None:
            self._hands.post(BeginInitialisation(point.latitude_deg, point.longitude_deg))

    def show(self, desk: Desk) -> None:
        """Brings offsets, point, measuring time and roll zero up to what is."""
        words, snapshot = self._words, desk.snapshot
        self._offsets.show(desk)
        self._point.show(desk)
        running = snapshot.initialising
        seconds = self._hands.house.manager.job.receiver.measuring_time
        again = words("Measure on this point, {seconds:.0f} s", seconds=seconds)
        measuring = snapshot.state is SessionState.INITIALISING
        self._measure.label = words("Skip measuring") if measuring else again
        self._without.visible = not measuring
        said = measuring_words(snapshot, words)
        self._measuring.show("" if running is None else progress_html(running.done) + notice_html([said]))
        rows = measured_words(snapshot, desk.units, words)
        self._result.show(rows_html(rows) if rows else "")
        self._roll.show(desk)


class _Offsets:
    """One button for each offset in force, which takes it back."""

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._words = hands.words
        self._none = Shown(gui)
        self._undo = {kind: self._button(gui, hands, kind) for kind in OffsetKind}

    def _button(self, gui: viser.GuiApi, hands: Hands, kind: OffsetKind) -> viser.GuiButtonHandle:
        button = gui.add_button(kind.value, color="gray", visible=False, hint=self._words("Take this offset back"))

        @button.on_click
        async def _(_: object) -> None:
            hands.post(DropOffset(kind))

        return button

    def show(self, desk: Desk) -> None:
        known = offsets_in_force(desk.snapshot, desk.now, desk.units, self._words)
        self._none.show("" if known else rows_html([(self._words("Offsets"), self._words("none"))]))
        for kind, button in self._undo.items():
            said = known.get(kind)
            button.visible = said is not None
            if said is not None:
                button.label = self._words("Undo: {offset}", offset=said)


class _Point:
    """Which point the tractor stands on: the nearest known one, one by its name, or one that is typed."""

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._words = words = hands.words
        self._datum = Datum(hands.house.manager.job.receiver.datum)
        self._points = known_points(hands.house.manager.job.field, words)
        names = [one.name for one in self._points]
        options = [*([words(NEAREST)] if names else []), *names, words(TYPED)]
        self._choice = gui.add_dropdown(words("Known point"), options, initial_value=options[0])
        self._text = gui.add_text(words("Latitude, longitude"), "", visible=not names)
        self._away = Shown(gui)

    def chosen(self) -> KnownPoint | None:
        """The point; None, and the reason is told, when there is none."""
        words = self._words
        value = self._choice.value
        if value == words(TYPED):
            return self._typed()
        if value != words(NEAREST):
            return next(one for one in self._points if one.name == value)
        nearest = nearest_of(self._points, self._hands.desk().snapshot)
        if nearest is None:
            self._hands.tell(words("Not yet: there is no position."), bad=True)
        return nearest

    def _typed(self) -> KnownPoint | None:
        words = self._words
        try:
            corner = parse_corner(self._text.value, CoordinateSystem(datum=self._datum))
        except ValueError as error:
            self._hands.tell(words("The point cannot be read"), words.say(error.args[0]), bad=True)
            return None
        return KnownPoint(words(TYPED), corner.latitude_deg, corner.longitude_deg)

    def show(self, desk: Desk) -> None:
        words = self._words
        typed = self._choice.value == words(TYPED)
        self._text.visible = typed
        snapshot = desk.snapshot
        named = next((one for one in self._points if one.name == self._choice.value), None)
        point = named or (None if typed else nearest_of(self._points, snapshot))
        away = None if point is None else distance_to(point, snapshot)
        if point is None or away is None:
            self._away.show("")
            return
        said = words("{distance} away", distance=offset_text(away, desk.units, words))
        self._away.show(rows_html([(point.name, said)]))


class _RollZero:
    """One button that goes on step by step, and one that gives up; then one that keeps the result."""

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._words = words = hands.words
        self._said = Shown(gui)
        self._next = gui.add_button(words("Begin the first drive"), color="green")
        self._cancel = gui.add_button(words("Give up"), color="gray", visible=False)
        self._keep = gui.add_button(words("Keep it for this tractor"), color="gray", visible=False)

        @self._next.on_click
        async def _(_: object) -> None:
            desk = hands.desk()
            hands.post(roll_zero_view(desk.snapshot, desk.units, words).command)

        @self._cancel.on_click
        async def _(_: object) -> None:
            hands.post(CancelRollZero())

        @self._keep.on_click
        async def _(_: object) -> None:
            hands.later(self._save)

    def show(self, desk: Desk) -> None:
        view = roll_zero_view(desk.snapshot, desk.units, self._words)
        self._said.show(notice_html([view.said]))
        self._next.label = view.press
        self._cancel.visible = view.under_way
        zero = self._hands.house.manager.job.tractor.roll_zero_deg
        changed = desk.snapshot.roll_zero_deg != zero and self._hands.house.store is not None
        self._keep.visible = changed and not view.under_way

    def _save(self) -> None:
        """Writes the roll zero in use into the tractor's document, which keeps everything else."""
        store, words = self._hands.house.store, self._words
        assert store is not None, "the button is shown with a store alone"
        name = self._hands.house.manager.job.tractor.name
        zero = self._hands.desk().snapshot.roll_zero_deg
        stored = store.load(Tractor, name)
        store.save(stored.document.model_copy(update={"roll_zero_deg": zero}), stored.revision)
        degrees = words.number(zero, 2)
        self._hands.tell(words("Kept: roll zero {degrees}° for {tractor}.", degrees=degrees, tractor=name))
