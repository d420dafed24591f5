"""A recorded drive for other programs, each format under a link; and time logs of other programs as recordings."""

import threading
from collections.abc import Callable
from pathlib import Path

import viser

from guidance_app.batch.exporting import drive_export
from guidance_app.batch.time_logs import stored_logs
from guidance_app.console.desk import Hands
from guidance_app.console.files import Download, link_html, upload_html
from guidance_app.console.widgets import notice_html
from guidance_app.exchange.drives import DRIVE_WRITERS, DriveExport, DriveFormat
from guidance_app.store import StoreError
from guidance_app.store.recordings import open_recording

__all__ = ["TimeLogs", "add_exports"]

ARCHIVE = ".zip"
MEDIA_TYPES = {
    ".csv": "text/csv",
    ".gpx": "application/gpx+xml",
    ".kml": "application/vnd.google-earth.kml+xml",
    ".geojson": "application/geo+json",
    ".zip": "application/zip",
    ".nmea": "text/plain",
}


def add_exports(gui: viser.GuiApi, hands: Hands, path: Path) -> None:
    """A link for each format. The drive is gathered when the first is asked for, and kept while the page is open."""
    words = hands.words
    gathered = _Gathered(path)
    with gui.add_folder(words("For other programs"), expand_by_default=False):
        gui.add_html(notice_html([words("A long drive takes a while: it is driven once more for this.")]))
        for name, form in DRIVE_WRITERS.items():
            address = hands.house.files.offer(_maker(gathered, name, form))
            gui.add_html(link_html(address, f"{name.upper()}: {words(form.words)}"))


class _Gathered:
    """The drive of a recording, gathered once however many formats are asked for, and however many at a time."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._lock = threading.Lock()
        self._drive: DriveExport | None = None

    def drive(self) -> DriveExport:
        """Takes seconds the first time. Raises ``StoreError``."""
        with self._lock:
            if self._drive is None:
                self._drive = drive_export(open_recording(self._path))
            return self._drive


def _maker(gathered: _Gathered, name: str, form: DriveFormat) -> Callable[[], Download | None]:
    def make() -> Download | None:
        try:
            drive = gathered.drive()
        except StoreError:
            return None  # the recording has gone since the page was opened
        return Download(f"{drive.name}-{name}{form.ending}", MEDIA_TYPES[form.ending], form.write(drive))

    return make


class TimeLogs:
    """Awaits a zip of ISOXML task data and stores its time logs as recordings; ``stored`` is called then."""

    def __init__(self, gui: viser.GuiApi, hands: Hands, stored: Callable[[], None]) -> None:
        self._hands = hands
        self._stored = stored
        words = hands.words
        with gui.add_folder(words("From other programs"), expand_by_default=False):
            gui.add_html(
                notice_html([words("A zip of ISOXML task data: each of its time logs becomes a recording here.")])
            )
            gui.add_html(upload_html(hands.house.files.awaits(self._take), words("Choose a file"), ARCHIVE))

    def _take(self, name: str, content: bytes) -> None:
        self._hands.later(lambda: self._store(name, content))

    def _store(self, name: str, content: bytes) -> None:
        store = self._hands.house.store
        if store is None:
            msg = self._hands.words("There is no data folder to store a recording in.")
            raise StoreError(msg)
        paths = stored_logs(content, name, store.root)
        words = self._hands.words
        self._hands.tell(
            words("Stored"),
            words.plural("{n} time log is a recording now", "{n} time logs are recordings now", len(paths)),
        )
        self._stored()
