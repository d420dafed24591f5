"""The columns of a drive kept while it is driven, so that it opens at once for looking back.

They wait in a nameless file of the system, not in memory. Nothing depends on them: where they cannot be written they
are made from the recording when it is opened.
"""

import logging
import queue
import tempfile
from typing import IO

from guidance_app.model import CoverageTotals, Snapshot
from guidance_app.recording.columns import DriveGathering, columns_of
from guidance_app.store.reviews import KeptColumns

__all__ = ["LiveColumns"]

log = logging.getLogger(__name__)


class LiveColumns:
    """``look_at`` is called by the engine's thread and returns at once, all else by the recorder's."""

    def __init__(self) -> None:
        self._snapshots: queue.SimpleQueue[Snapshot] = queue.SimpleQueue()
        self._gathering = DriveGathering()
        self._file: IO[bytes] | None = None
        self._given_up = False

    def look_at(self, snapshot: Snapshot) -> None:
        """One more snapshot."""
        self._snapshots.put(snapshot)

    def flush(self) -> None:
        """Hands the rows of all that was looked at to the system."""
        while not self._snapshots.empty():
            self._gathering.take(self._snapshots.get())
        rows = self._gathering.hand_over()
        if self._given_up or not rows:
            return
        try:
            if self._file is None:
                self._file = tempfile.TemporaryFile()  # noqa: SIM115 - open as long as the drive
            self._file.write(rows)
        except OSError as error:
            log.warning("columns are not kept while driving: %s", error)
            self._given_up = True

    def whole(self) -> KeptColumns | None:
        """All of them; None where they could not be written."""
        self.flush()
        last = self._gathering.last
        if self._given_up or last is None:
            return None
        try:
            rows = b""
            if self._file is not None:
                self._file.seek(0)
                rows = self._file.read()
        except OSError as error:
            log.warning("columns are not kept while driving: %s", error)
            return None
        return KeptColumns(columns_of(rows, last.origin_deg), last.totals or CoverageTotals(), whole=True)

    def close(self) -> None:
        """Forgets them."""
        if self._file is not None:
            self._file.close()
