"""The columns of a drive kept while it is driven, so that it opens at once for looking back.

They wait in a file, not in memory: one of the drive's resume points, else a nameless one of the system. Nothing depends
on them: where they cannot be written they are made from the recording when it is opened.
"""

import contextlib
import logging
import os
import queue
import tempfile
from typing import IO

from guidance_app.model import CoverageTotals, Snapshot
from guidance_app.recording.columns import DriveGathering, columns_of
from guidance_app.runtime.resume_points import ResumePoint, ResumePoints
from guidance_app.store.reviews import KeptColumns

__all__ = ["LiveColumns"]

log = logging.getLogger(__name__)


class LiveColumns:
    """``look_at`` and ``mark`` are called by the engine's thread and return at once, all else by the recorder's.

    With ``points`` the rows go on behind those of the point that was found.
    """

    def __init__(self, points: ResumePoints | None = None) -> None:
        self._points = points
        found = None if points is None else points.found
        self._heard: queue.SimpleQueue[Snapshot | ResumePoint] = queue.SimpleQueue()
        self._gathering = DriveGathering(None if found is None else found.engine.snapshot)
        self._file: IO[bytes] | None = None
        self._given_up = found is not None and found.rows is None

    def look_at(self, snapshot: Snapshot) -> None:
        """One more snapshot."""
        self._heard.put(snapshot)

    def mark(self, point: ResumePoint) -> None:
        """All that was looked at so far stands before this point, which learns how many bytes that is."""
        self._heard.put(point)

    def flush(self) -> None:
        """Hands the rows of all that was looked at to the system."""
        while not self._heard.empty():
            heard = self._heard.get()
            if isinstance(heard, ResumePoint):
                heard.rows = self._written()
            else:
                self._gathering.take(heard)
        self._write()

    def _write(self) -> None:
        rows = self._gathering.hand_over()
        if self._given_up or not rows:
            return
        try:
            self._open().write(rows)
        except OSError as error:
            log.warning("columns are not kept while driving: %s", error)
            self._given_up = True

    def _written(self) -> int | None:
        """How many bytes of rows are on the disk now; None where they are not kept."""
        self._write()
        if self._given_up or self._points is None:
            return None
        try:
            file = self._open()
            file.flush()
            os.fsync(file.fileno())
            return file.tell()
        except OSError as error:
            log.warning("columns are not kept while driving: %s", error)
            self._given_up = True
            return None

    def _open(self) -> IO[bytes]:
        if self._file is None:
            self._file = tempfile.TemporaryFile() if self._points is None else self._points.open_rows()  # noqa: SIM115 - open as long as the drive
        return self._file

    def whole(self) -> KeptColumns | None:
        """All of them; None where they could not be written."""
        self.flush()
        last = self._gathering.last
        if self._given_up or last is None:
            return None
        try:
            file = self._open()
            file.seek(0)
            rows = file.read()
        except OSError as error:
            log.warning("columns are not kept while driving: %s", error)
            return None
        return KeptColumns(columns_of(rows, last.origin_deg), last.totals or CoverageTotals(), whole=True)

    def close(self) -> None:
        """Forgets them."""
        if self._file is not None:
            with contextlib.suppress(OSError):  # what the disk does not take any more is made anew when it is opened
                self._file.close()
