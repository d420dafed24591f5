"""The files of one recording for other programs and people: exports in each format, and the zip for a bug report.

Each is made when its link is pressed, on a thread of the front; what cannot be made is a sentence in the link itself.
"""

import logging
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import viser

from guidance_app.batch.exporting import drive_export
from guidance_app.console.desk import Hands
from guidance_app.console.files import Download, NotMadeError, made_link_html, note_said
from guidance_app.console.house import SENTENCES
from guidance_app.console.widgets import note_html
from guidance_app.exchange.drives import DRIVE_WRITERS, DriveExport
from guidance_app.language import sentence
from guidance_app.recording import RecordedDrive
from guidance_app.recording.moving import possible_moves
from guidance_app.store import StoreError
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_report import report_of

__all__ = ["HandingOn"]

log = logging.getLogger(__name__)

MEDIA_TYPES = {
    ".csv": "text/csv",
    ".gpx": "application/gpx+xml",
    ".kml": "application/vnd.google-earth.kml+xml",
    ".geojson": "application/geo+json",
    ".zip": "application/zip",
    ".nmea": "text/plain",
}


class HandingOn:
    """The links, made inside a folder of the page of one recording. ``close`` takes their addresses back."""

    def __init__(self, gui: viser.GuiApi, hands: Hands, path: Path) -> None:
        self._gui = gui
        self._hands = hands
        self._path = path
        self._addresses: list[str] = []
        self._gathering = threading.Lock()
        self._made: DriveExport | None = None
        words = hands.words
        with gui.add_folder(words("For other programs"), expand_by_default=False):
            gui.add_html(note_html(words("A long drive takes a while: it is driven once more for this.")))
            for name, form in DRIVE_WRITERS.items():
                self._add(f"{name.upper()}: {words(form.words)}", partial(self._export, name))
        with gui.add_folder(words("For a bug report"), expand_by_default=False):
            said = words("One file that plays elsewhere as it did here, without passwords.")
            gui.add_html(note_html(said))
            self._moved = gui.add_checkbox(words("Move it elsewhere on earth"), initial_value=False)
            warning = words("It is moved east or west: latitude, times, names and the field's shape stay.")
            gui.add_html(note_html(warning))
            self._add(words("Zip for a bug report"), self._report)

    def close(self) -> None:
        """Nothing of this page is offered any more."""
        for address in self._addresses:
            self._hands.house.files.forget(address)

    def _add(self, label: str, make: Callable[[], Download]) -> None:
        words = self._hands.words

        def guarded() -> Download:
            try:
                return make()
            except SENTENCES as error:
                raise NotMadeError(note_said(error, words)) from error
            except Exception as error:
                log.exception("a file of %s could not be made", self._path)
                failed = words("This failed inside the program ({error}). Send a bug report.", error=str(error))
                raise NotMadeError(failed) from error

        address = self._hands.house.files.offer(guarded)
        self._addresses.append(address)
        making = words("is being made …"), words("The connection broke: try again.")
        self._gui.add_html(made_link_html(address, label, *making))

    def _drive(self) -> RecordedDrive:
        drive = open_recording(self._path)
        if not len(drive.events):
            msg = sentence("This recording holds no event.")
            raise StoreError(msg)
        return drive

    def _export(self, name: str) -> Download:
        writer = DRIVE_WRITERS[name]
        made = self._gathered()
        if not made.epochs:
            msg = sentence("This recording holds no position fix, so there is no drive to write.")
            raise StoreError(msg)
        return Download(f"{made.name}-{name}{writer.ending}", MEDIA_TYPES[writer.ending], writer.write(made))

    def _gathered(self) -> DriveExport:
        """The drive for exports, gathered once however many formats are asked for, also at a time."""
        with self._gathering:
            if self._made is None:
                self._made = drive_export(self._drive())
            return self._made

    def _report(self) -> Download:
        drive = self._drive()
        move: int | None = None
        if self._moved.value:
            move = int(np.random.default_rng().choice(possible_moves(drive.job)))
        content, _ = report_of(drive, move)
        return Download(f"{drive.name}-report.zip", "application/zip", content)
