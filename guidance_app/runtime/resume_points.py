"""The engine of a live drive as it stood minutes ago, so that a drive that was cut off is gone on with in a moment.

Taking all inputs again gives the same engine, but needs half a minute behind eight hours. So the engine is kept every
ten minutes in the user's cache folder, with a digest of the inputs that it stands for; only what came later is taken
again. A point that does not fit the recording, or was made by another program, is not used: then all is taken again.
Beside it lie the rows of the drive's columns, which are not made a second time either.
"""

import contextlib
import hashlib
import io
import json
import logging
import os
import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from guidance_app.engine import Engine
from guidance_app.recording import RecordedDrive
from guidance_app.runtime.cache import CachePickler, keep_newest, program_now

__all__ = ["KEEP_EVERY", "ResumePoint", "ResumePoints"]

log = logging.getLogger(__name__)

KEEP_EVERY = 600.0
"""Seconds of the drive between two points: some 6,000 fixes to take again at most, in a second."""
KEPT = 2
"""Drives whose points are kept: the present one and the one before."""


@dataclass(slots=True, eq=False)
class ResumePoint:
    """The engine after the first ``count`` events, whose lines have this ``digest``, and the links heard by then.

    ``rows`` is how many bytes of columns there are by then. Recorder and columns fill in what they know.
    """

    engine: Engine
    links: tuple[str, ...]
    count: int = 0
    digest: str = ""
    rows: int | None = None


class ResumePoints:
    """Those of one recording in ``folder``. Where nothing can be kept, nothing else is lost."""

    def __init__(self, folder: Path, recording: Path, past: RecordedDrive) -> None:
        parts = [str(recording.resolve()), past.meta.model_dump_json(), program_now()]
        stem = hashlib.sha256(json.dumps(parts).encode()).hexdigest()
        self._folder = folder
        self._point = folder / f"{stem}.point"
        self._rows = folder / f"{stem}.rows"
        self.found = self._newest(past)
        """The newest one that stands for what the recording holds; None without one."""

    def keep(self, point: ResumePoint) -> None:
        """Replaces the one before."""
        unfinished = self._point.with_suffix(".point.part")
        content = io.BytesIO()
        pickle.dump((point.count, point.digest, point.rows), content, protocol=5)
        CachePickler(content, protocol=5).dump((point.engine, point.links))
        try:
            self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            with unfinished.open("wb") as file:
                file.write(content.getbuffer())
                file.flush()
                os.fsync(file.fileno())
            unfinished.replace(self._point)
            for pattern in ("*.point", "*.rows"):
                keep_newest(self._folder, pattern, KEPT)
        except OSError as error:
            log.warning("the engine is not kept, going on after a stop will take longer: %s", error)
            with contextlib.suppress(OSError):
                unfinished.unlink(missing_ok=True)

    def open_rows(self) -> IO[bytes]:
        """The file of rows, up to the point that was found; empty without one. Raises ``OSError``."""
        self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        length = 0 if self.found is None or self.found.rows is None else self.found.rows
        file = self._rows.open("r+b" if length else "w+b")
        file.truncate(length)
        file.seek(length)
        return file

    def forget(self) -> None:
        """The drive is over: nobody goes on with it."""
        with contextlib.suppress(OSError):
            self._point.unlink(missing_ok=True)
            self._rows.unlink(missing_ok=True)

    def _newest(self, past: RecordedDrive) -> ResumePoint | None:
        try:
            with self._point.open("rb") as file:
                count, digest, rows = pickle.load(file)  # noqa: S301 - this user's own cache folder, as in ``indexing``
                if not 0 < count <= len(past.lines) or _digest(past, count) != digest:
                    return None
                engine, links = pickle.load(file)  # noqa: S301 - as above
        except FileNotFoundError:
            return None
        except (OSError, EOFError, pickle.UnpicklingError, AttributeError, ImportError, ValueError, TypeError) as error:
            log.warning("%s is damaged (%s): the drive is taken again from its beginning", self._point, error)
            return None
        return ResumePoint(engine, links, count, digest, self._there(rows))

    def _there(self, rows: int | None) -> int | None:
        """So many bytes of rows, if they are still there."""
        try:
            return rows if rows is not None and self._rows.stat().st_size >= rows else None
        except OSError:
            return None


def _digest(past: RecordedDrive, count: int) -> str:
    return hashlib.sha256(memoryview(past.lines.text)[: past.lines.size_of(count)]).hexdigest()
