"""A field by driving its boundary, with the line drawn as it grows."""

import threading

import viser

from guidance_app.boundary import BoundaryError, FieldDraft, checked_field
from guidance_app.console.desk import Desk
from guidance_app.console.registering.atelier import Atelier
from guidance_app.console.registering.by_tapping import draft_ring
from guidance_app.console.widgets import Shown, buttons, notice_html, rows_html
from guidance_app.guidance.boundary_drive import BoundaryDrive, DrivenEdge, QualityGate
from guidance_app.language import message
from guidance_app.model import Snapshot
from guidance_app.view.units import area_text, distance_text

__all__ = ["Driving"]

DRIVEN, CLOSING = "driven", "closing"
UNDO = 10.0
"""Metres that one press takes back."""
REFUSED = {
    "fix quality": message("fix too poor"),
    "direction unknown": message("direction unknown"),
    "jump": message("jump of the receiver"),
}
EDGES = {
    DrivenEdge.TRACK: message("tractor"),
    DrivenEdge.LEFT: message("left edge of the implement"),
    DrivenEdge.RIGHT: message("right edge of the implement"),
}
GATES = {
    QualityGate.ANY: message("any fix"),
    QualityGate.DGPS: message("DGPS or better"),
    QualityGate.RTK: message("RTK only"),
}


class Driving:
    """Listens to the drive and draws its boundary."""

    def __init__(self, gui: viser.GuiApi, atelier: Atelier) -> None:
        self._atelier = atelier
        self._hands = atelier.hands
        self._words = words = atelier.hands.words
        self._drive: BoundaryDrive | None = None
        self._lock = threading.Lock()
        self._drawn: object = None
        self._notice = Shown(gui)
        self._edge = gui.add_dropdown(words("Boundary is at"), tuple(words(name) for name in EDGES.values()))
        self._gate = gui.add_dropdown(words("Take"), tuple(words(name) for name in GATES.values()))
        self._start = gui.add_button(words("Start here"), color="green")
        self._rows = Shown(gui)
        self._pause = gui.add_button(words("Pause"), color="gray", visible=False)
        buttons(gui, "", ((words("Undo 10 m"), self._undo), (words("Cancel"), atelier.cancel)))
        self._done = gui.add_button(words("Close the ring and preview"), color="green", visible=False)

        @self._start.on_click
        async def _(_: object) -> None:
            self._begin()

        @self._pause.on_click
        async def _(_: object) -> None:
            self._toggle_pause()

        @self._done.on_click
        async def _(_: object) -> None:
            self._hands.later(self._finish)

        self._stop_hearing = self._hands.house.manager.subscribe(self._hear)

    def _begin(self) -> None:
        edge = list(EDGES)[self._edge.options.index(self._edge.value)]
        gate = list(GATES)[self._gate.options.index(self._gate.value)]
        width = self._hands.house.manager.job.implement.working_width
        with self._lock:
            self._drive = BoundaryDrive(edge, gate, width)
        self._hands.soon()

    def _toggle_pause(self) -> None:
        with self._lock:
            if self._drive is not None:
                self._drive.paused = not self._drive.paused

    def _undo(self) -> None:
        with self._lock:
            if self._drive is not None:
                self._drive.undo(UNDO)

    def _hear(self, snapshot: Snapshot) -> None:
        """On the engine's thread: one more pose."""
        with self._lock:
            if self._drive is None or snapshot.pose is None or snapshot.implement is None or snapshot.fix is None:
                return
            self._drive.step(snapshot.pose, snapshot.implement, snapshot.fix.quality)

    def _finish(self) -> None:
        frame = self._atelier.frame()
        with self._lock:
            drive = self._drive
            if drive is None or frame is None:
                raise BoundaryError(self._words("Nothing has been driven yet."))
            try:
                points = drive.ring()
            except ValueError as error:
                raise BoundaryError(str(error)) from error
            gap = drive.gap
        ring = draft_ring(frame, [(float(east), float(north)) for east, north in points])
        name = self._atelier.unique_name(self._words("New field"))
        remarks = () if gap < 1.0 else (self._words("closed with a straight line of {metres:.0f} m", metres=gap),)
        draft = FieldDraft(name, (([*ring, ring[0]],),), remarks=remarks)
        self._atelier.offer((checked_field(draft, name),), self._words("driven"))

    def show(self, desk: Desk) -> None:
        """Brings line and numbers up to what was driven."""
        if desk.snapshot.pose is None:
            words = self._words("The receiver gives no position: start a drive under Start, then come back here.")
            self._notice.show(notice_html([words]))
        else:
            self._notice.show("")
        self._start.disabled = desk.snapshot.pose is None
        with self._lock:
            drive = self._drive
            if drive is None:
                return
            points, length, area, gap = drive.points, drive.length, drive.area, drive.gap
            refused, paused = dict(drive.refused), drive.paused
        self._edge.disabled = self._gate.disabled = True
        self._start.visible = False
        self._pause.visible = True
        key = (self._hands.sketch.scene_number, len(points))
        if key != self._drawn:
            self._drawn = key
            self._hands.sketch.line(DRIVEN, points)
            self._hands.sketch.line(CLOSING, points[[-1, 0]] if len(points) > 2 else ())
        rows = [
            (self._words("driven"), distance_text(length, desk.units, self._words)),
            (self._words("inside"), area_text(area, desk.units, self._words)),
            (self._words("to the start"), distance_text(gap, desk.units, self._words)),
        ]
        rows += [
            (self._words("left out: {why}", why=self._words(REFUSED[why])), str(count))
            for why, count in refused.items()
        ]
        self._rows.show(rows_html(rows))
        self._pause.label = self._words("Go on") if paused else self._words("Pause")
        self._done.visible = len(points) > 2

    def close(self) -> None:
        """Stops listening and takes the sketch away."""
        self._stop_hearing()
        self._hands.sketch.clear()
