"""The plan panel: every method, direction and corner of an operation compared in a table that grows.

One press on a row shows that plan on the map, another one stores it in the operation. What is driven meanwhile stays
as it is: a plan taken here begins with the next drive.
"""

import threading
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import viser

from guidance_app.boundary import frame_of, polygon_in
from guidance_app.console.desk import Desk, Hands
from guidance_app.console.plan_strokes import draw_plan
from guidance_app.console.plan_table import RowButtons, table_html
from guidance_app.console.widgets import Shown, notice_html
from guidance_app.documents import Job, Operation
from guidance_app.guidance.preview import PreviewRow, preview
from guidance_app.guidance.wishes import request_of
from guidance_app.language import message
from guidance_app.model import Segment
from guidance_app.store import Stored, load_job
from guidance_app.view.camera import ViewMode
from guidance_app.view.plan_table import PlanRow, plan_rows

__all__ = ["Plan"]


@dataclass(slots=True)
class _Search:
    """One comparison: the worker adds rows until all are there or ``stop`` is set; the redraw shows them."""

    stored: Stored[Operation]
    rows: tuple[PreviewRow, ...] = ()
    running: bool = True
    stop: threading.Event = field(default_factory=threading.Event)


class Plan:
    """Compares the plans of one registered operation."""

    title: ClassVar[str] = message("Plan")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._words = words = hands.words
        self._operations: dict[str, Stored[Operation]] | None = None
        """As they were found by the last look; None before the first."""
        self._version = -1
        self._search: _Search | None = None
        self._chosen: int | None = None
        self._segments: Sequence[Segment] = ()
        """Of the plan that is to be seen on the map."""
        self._drawn: object = None
        self._nothing = Shown(gui)
        self._which: Any = gui.add_dropdown(words("Operation"), ("-",), visible=False)
        self._button = gui.add_button(words("Compare plans"), color="green", visible=False)
        self._progress: Any = gui.add_progress_bar(0.0, visible=False)
        self._said = Shown(gui)
        self._take = gui.add_button(words("Take this plan"), color="green", visible=False)
        self._table = Shown(gui)
        self._unseen = Shown(gui)
        self._buttons = RowButtons(gui, self._pressed)

        @self._button.on_click
        async def _(_: object) -> None:
            self._begin_or_stop()

        @self._take.on_click
        async def _(_: object) -> None:
            self._take_chosen()

        @self._which.on_update
        async def _(event: viser.GuiEvent[Any]) -> None:
            if event.client_id is not None:  # not when the list changes under the finger
                self._forget()

    def _look(self) -> None:
        """The operations as they are stored now; on a thread of its own."""
        store = self._hands.house.store
        found = () if store is None else store.list(Operation)
        self._operations = {f"{each.document.field}: {each.document.name}": each for each in found}
        self._hands.soon()

    # --- comparing -------------------------------------------------------------------------------------------------

    def _begin_or_stop(self) -> None:
        if self._search is not None and self._search.running:
            self._search.stop.set()
            return
        self._forget()
        stored = (self._operations or {}).get(self._which.value)
        if stored is None:
            return  # taken away by another console a moment ago: the list is about to say so
        self._search = search = _Search(stored)
        self._hands.later(lambda: self._compare(search))

    def _forget(self) -> None:
        """Another operation, or the same once more: the old search ends and its rows go."""
        if self._search is not None:
            self._search.stop.set()
        self._search, self._chosen, self._segments = None, None, ()
        self._hands.soon()

    def _compare(self, search: "_Search") -> None:
        """Plans row by row until all are there or somebody stops it."""
        try:
            job = self._job(search.stored)
            assert job.field is not None
            self._hands.house.show_field(job.field)
            polygon = polygon_in(frame_of(job.field.boundary), job.field.boundary)
            for row in preview(polygon, request_of(job)):
                if search.stop.is_set():
                    return
                search.rows = (*search.rows, row)
        finally:
            search.running = False
            self._hands.soon()

    def _job(self, stored: Stored[Operation]) -> Job:
        store = self._hands.house.store
        assert store is not None, "an operation comes from a store"
        return load_job(store, stored.document.name, stored.document.field)

    # --- one of them -----------------------------------------------------------------------------------------------

    def _pressed(self, number: int) -> None:
        """The first press on a row shows its plan, the second takes it."""
        row = next((each for each in self._rows() if each.number == number), None)
        if row is None or row.plan is None:
            return
        if number == self._chosen:
            self._take_chosen()
            return
        self._chosen = number
        self._segments = row.plan.segments
        self._hands.look(ViewMode.WHOLE_FIELD)
        self._hands.soon()

    def _take_chosen(self) -> None:
        row, search = next((each for each in self._rows() if each.number == self._chosen), None), self._search
        if row is not None and search is not None:
            self._hands.later(lambda: self._store(row, search))

    def _store(self, row: PreviewRow, search: "_Search") -> None:
        """Into the operation, as it was when the comparison began; a change by somebody else is not overwritten."""
        store = self._hands.house.store
        assert store is not None, "an operation comes from a store"
        request, stored = row.request, search.stored
        changed = {
            "method": request.method,
            "direction": request.direction,
            "start_corner": request.start_corner,
            "options": dict(request.options),
        }
        document = stored.document.model_copy(update=changed)
        store.save(document, stored.revision)
        again = store.load(Operation, document.name, document.field)
        self._operations = {**(self._operations or {}), f"{document.field}: {document.name}": again}
        search.stored = again
        self._hands.tell(
            self._words("Plan taken"),
            self._words("{operation} is driven like this from its next start on.", operation=document.name),
        )

    # --- what is shown ---------------------------------------------------------------------------------------------

    def show(self, desk: Desk) -> None:
        """Brings table, bar and buttons up to what is."""
        version = self._hands.house.version
        if version != self._version:
            self._version = version
            self._hands.house.aside(self._look)
        self._offer()
        self._draw()
        words, rows = self._words, self._rows()
        running = self._search is not None and self._search.running
        self._button.label = words("Stop") if running else words("Compare plans")
        self._button.color = "red" if running else "green"
        self._progress.visible = running
        if rows:
            self._progress.value = 100.0 * len(rows) / rows[0].count
        self._take.visible = self._chosen is not None
        shown = plan_rows(rows, desk.units, words)
        self._table.show(table_html(shown, self._chosen, self._buttons.named, words))
        if rows:
            self._unseen.show(self._buttons.style)
        self._said.show(notice_html(self._hints(shown, len(rows) and rows[0].count)))

    def _offer(self) -> None:
        """The operations that were found; a sentence where there is none."""
        found = self._operations
        if found is None:
            return
        names = tuple(found) or ("-",)
        if tuple(self._which.options) != names:
            self._which.options = names
        self._which.visible = self._button.visible = bool(found)
        nothing = self._words("No operation is registered yet: register a field, machines and an operation first.")
        self._nothing.show("" if found else notice_html([nothing]))

    def _draw(self) -> None:
        """The plan of the pressed row, again when the map was made anew."""
        key = (self._segments, self._hands.sketch.scene_number) if self._segments else None
        if key != self._drawn:
            self._drawn = key
            draw_plan(self._hands.sketch, self._segments)

    def _rows(self) -> tuple[PreviewRow, ...]:
        return () if self._search is None else self._search.rows

    def _hints(self, shown: Sequence[PlanRow], count: int) -> list[str]:
        """How many plans there are, which is the best so far, and what a press does."""
        best = next((row for row in shown if row.best), None)
        words = self._words
        if best is None:
            return [words("Planning …")] if self._search is not None and self._search.running else []
        made = len(shown)
        if made < count:
            found = message("{made} of {count} plans. Best so far: {title}, {where}.")
        else:
            found = message("{count} plans. The best: {title}, {where}.")
        return [
            words(found, made=made, count=count, title=best.title, where=best.where),
            words("Press a row to see it on the map, and once more to take it."),
        ]
