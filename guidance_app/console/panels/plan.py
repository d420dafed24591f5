"""The plan panel: every method, direction and corner of an operation compared in a table that grows.

One press on a row shows that plan on the map, another one stores it in the operation. What is driven meanwhile stays
as it is: a plan taken here begins with the next drive.
"""

import threading
from collections.abc import Sequence
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


class Plan:
    """Compares the plans of one registered operation."""

    title: ClassVar[str] = message("Plan")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._words = words = hands.words
        self._operations: dict[str, Stored[Operation]] = {}
        self._version = -1
        self._stored: Stored[Operation] | None = None
        self._rows: tuple[PreviewRow, ...] = ()
        self._chosen: int | None = None
        self._stop = threading.Event()
        self._running = False
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
        async def _(_: object) -> None:
            self._forget()

    def _look(self) -> None:
        """The operations as they are stored now; on a thread of its own."""
        store = self._hands.house.store
        found = () if store is None else store.list(Operation)
        self._operations = {f"{each.document.field}: {each.document.name}": each for each in found}
        names = tuple(self._operations) or ("-",)
        if tuple(self._which.options) != names:
            self._which.options = names
        self._which.visible = self._button.visible = bool(found)
        nothing = self._words("No operation is registered yet: register a field, machines and an operation first.")
        self._nothing.show("" if found else notice_html([nothing]))

    # --- comparing -------------------------------------------------------------------------------------------------

    def _begin_or_stop(self) -> None:
        if self._running:
            self._stop.set()
            return
        self._forget()
        self._stored = self._operations[self._which.value]
        self._running = True
        stop, stored = self._stop, self._stored
        self._hands.later(lambda: self._compare(stored, stop))

    def _forget(self) -> None:
        """Another operation, or the same once more: the old search ends and its rows go."""
        self._stop.set()
        self._stop = threading.Event()
        self._running = False
        self._rows, self._chosen, self._stored = (), None, None
        draw_plan(self._hands.sketch, ())

    def _compare(self, stored: Stored[Operation], stop: threading.Event) -> None:
        """Plans row by row until all are there or somebody stops it."""
        try:
            job = self._job(stored)
            assert job.field is not None
            self._hands.house.show_field(job.field)
            polygon = polygon_in(frame_of(job.field.boundary), job.field.boundary)
            for row in preview(polygon, request_of(job)):
                if stop.is_set():
                    return
                self._rows = (*self._rows, row)
        finally:
            if stop is self._stop:
                self._running = False

    def _job(self, stored: Stored[Operation]) -> Job:
        store = self._hands.house.store
        assert store is not None, "an operation comes from a store"
        return load_job(store, stored.document.name, stored.document.field)

    # --- one of them -----------------------------------------------------------------------------------------------

    def _pressed(self, number: int) -> None:
        """The first press on a row shows its plan, the second takes it."""
        row = next((each for each in self._rows if each.number == number), None)
        if row is None or row.plan is None:
            return
        if number == self._chosen:
            self._take_chosen()
            return
        self._chosen = number
        segments = row.plan.segments
        self._hands.look(ViewMode.WHOLE_FIELD)
        self._hands.later(lambda: self._draw(segments))

    def _draw(self, segments: Sequence[Segment]) -> None:
        draw_plan(self._hands.sketch, segments)

    def _take_chosen(self) -> None:
        row = next((each for each in self._rows if each.number == self._chosen), None)
        stored = self._stored
        if row is not None and stored is not None:
            self._hands.later(lambda: self._store(row, stored))

    def _store(self, row: PreviewRow, stored: Stored[Operation]) -> None:
        """Into the operation, as it was when the comparison began; a change by somebody else is not overwritten."""
        store = self._hands.house.store
        assert store is not None, "an operation comes from a store"
        request = row.request
        changed = {
            "method": request.method,
            "direction": request.direction,
            "start_corner": request.start_corner,
            "options": dict(request.options),
        }
        document = stored.document.model_copy(update=changed)
        store.save(document, stored.revision)
        again = store.load(Operation, document.name, document.field)
        self._operations[f"{document.field}: {document.name}"] = again
        self._stored = again
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
        words, rows = self._words, self._rows
        self._button.label = words("Stop") if self._running else words("Compare plans")
        self._button.color = "red" if self._running else "green"
        self._progress.visible = self._running
        if rows:
            self._progress.value = 100.0 * len(rows) / rows[0].count
        self._take.visible = self._chosen is not None
        shown = plan_rows(rows, desk.units, words)
        self._table.show(table_html(shown, self._chosen, self._buttons.named, words))
        if rows:
            self._unseen.show(self._buttons.style)
        self._said.show(notice_html(self._hints(shown)))

    def _hints(self, shown: Sequence[PlanRow]) -> list[str]:
        """How many plans there are, which is the best so far, and what a press does."""
        best = next((row for row in shown if row.best), None)
        if best is None:
            return []
        words, count = self._words, self._rows[0].count
        return [
            words(
                "{made} of {count} plans. Best so far: {title}, {where}.",
                made=len(shown),
                count=count,
                title=best.title,
                where=best.where,
            ),
            words("Press a row to see it on the map, and once more to take it."),
        ]
