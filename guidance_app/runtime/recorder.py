"""Writes a live drive down as it happens, on a thread of its own: the engine thread never waits for the disk.

What the engine takes is in the hands of the system half a second later (so a killed program loses less than a second)
and on the disk after five. A disk that is full, or fails, stops nothing: events wait in memory and are written when
there is room again; the driver is told, and told early when room gets short.
"""

import hashlib
import logging
import queue
import shutil
import threading
from datetime import UTC, datetime
from pathlib import Path

from guidance_app import __version__
from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.estimation.filter import FilterSettings
from guidance_app.language import sentence
from guidance_app.model import Chunk, Commanded, Event, Snapshot
from guidance_app.recording import LineWriter, RecordedDrive, RecordingMeta, read_lines
from guidance_app.runtime.cache import cache_folder
from guidance_app.runtime.columns import LiveColumns
from guidance_app.runtime.resume_points import ResumePoint, ResumePoints
from guidance_app.store.files import StoreError, why
from guidance_app.store.recordings import RecordingSummary, read_recording
from guidance_app.store.recordings_list import summary_of
from guidance_app.store.recordings_writing import RecordingFolder
from guidance_app.store.reviews import keep_columns, place_of

__all__ = ["FLUSH_EVERY", "SYNC_EVERY", "Recorder", "new_recording"]

log = logging.getLogger(__name__)

FLUSH_EVERY = 0.5
"""Seconds between two hand-overs to the system."""
SYNC_EVERY = 5.0
"""Seconds between two flushes to the disk itself; the summary is written then too."""
LOW_SPACE = 300_000_000
"""Bytes free below which the driver is told: a long day at 10 Hz and its checkpoints."""
MOST_WAITING = 64_000_000
"""Bytes that wait in memory for a full disk, eight hours at 10 Hz; then the recording ends where it was written to."""
BLOCK = 1 << 20
PATIENCE = 30.0
MEGABYTE = 1_000_000


class Recorder:
    """Writes events into a recording's folder. ``take`` and ``look_at`` return at once; ``close`` waits for the disk.

    ``past`` is what the folder holds already when a drive is gone on with; with ``points`` the engine is kept now and
    then.
    """

    def __init__(
        self,
        folder: RecordingFolder,
        past: RecordedDrive,
        *,
        points: ResumePoints | None = None,
        low_space: int = LOW_SPACE,
        flush_every: float = FLUSH_EVERY,
        most_waiting: int = MOST_WAITING,
    ) -> None:
        self.path = folder.path
        self._folder = folder
        self._low_space = low_space
        self._flush_every = flush_every
        self._most_waiting = most_waiting
        self._writer = LineWriter(past.lines.check)
        self._past = summary_of(past)
        self._digest = hashlib.sha256(memoryview(past.lines.text)[: past.lines.size])
        self._points = points
        self._point: ResumePoint | None = None
        self._events: queue.SimpleQueue[Event | ResumePoint] = queue.SimpleQueue()
        self._waiting = bytearray()
        self._lengths: list[tuple[int, float]] = []
        self._count = len(past.events)
        self._is_empty = not past.events
        self._last = past.duration
        self._flushed_to = past.duration
        self._snapshot: Snapshot | None = None
        self._columns = LiveColumns(points)
        self._trouble: str | None = None
        self._shortage: str | None = None
        self._given_up = False
        self._ended = True
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._thread.start()

    def take(self, event: Event) -> None:
        """One more event, before the engine takes it."""
        self._events.put(event)

    def look_at(self, snapshot: Snapshot) -> None:
        """What is known now, for the summary and the columns. Every snapshot, so that no fix is missing."""
        self._snapshot = snapshot
        self._columns.look_at(snapshot)

    def keep(self, engine: Engine, links: tuple[str, ...]) -> None:
        """Keeps the engine as it stands behind all that was taken so far; it must not be used any more elsewhere."""
        if self._points is not None:
            point = ResumePoint(engine, links)
            self._columns.mark(point)
            self._events.put(point)

    @property
    def notice(self) -> str | None:
        """What the driver should know of the recording, in a sentence; None when all is well."""
        return self._trouble or self._shortage

    @property
    def flushed_to(self) -> float:
        """The session clock up to which events are in the system's hands: they survive the end of this program."""
        return self._flushed_to

    def close(self, *, ended: bool = True) -> None:
        """Writes what is left and gives the folder free. Not ``ended``, it may be gone on with at the next start."""
        self._ended = ended
        self._stop.set()
        self._thread.join(timeout=PATIENCE)

    def _run(self) -> None:
        beats = max(round(SYNC_EVERY / self._flush_every), 1)
        beat = 0
        try:
            while not self._stop.wait(self._flush_every):
                beat += 1
                self._flush()
                if beat % beats == 0 or beat == 1:
                    self._sync()
            self._flush()
            self._sync()
            self._end()
        except Exception:
            log.exception("the recorder failed")
            self._trouble = sentence("This drive is no longer recorded: the recorder failed. Driving goes on.")
        finally:
            self._columns.close()
            self._folder.close()

    def _flush(self) -> None:
        """Hands over what came since; what the disk does not take waits."""
        self._gather()
        self._columns.flush()
        if not self._waiting:
            return
        try:
            while self._waiting:
                taken = self._folder.append(bytes(self._waiting[:BLOCK]))
                del self._waiting[:taken]
                self._note_taken(taken)
        except OSError as error:
            self._say_trouble(why(error))
        else:
            self._trouble = self._over("the disk was full") if self._given_up else None

    def _gather(self) -> None:
        while True:
            try:
                event = self._events.get_nowait()
            except queue.Empty:
                return
            if self._given_up:
                continue
            if isinstance(event, ResumePoint):
                event.count, event.digest = self._count, self._digest.hexdigest()
                self._point = event
                continue
            self._is_empty = self._is_empty and not _says_something(event)
            line = self._writer.line(event)
            self._waiting += line
            self._digest.update(line)
            self._lengths.append((len(line), event.arrival))
            self._count += 1
            self._last = event.arrival
            if len(self._waiting) > self._most_waiting:
                self._given_up = True

    def _note_taken(self, taken: int) -> None:
        """Whole lines among the bytes that the system took are safe; a part of one waits for its rest."""
        done = 0
        for length, arrival in self._lengths:
            if length > taken:
                break
            taken -= length
            done += 1
            self._flushed_to = arrival
        del self._lengths[:done]
        if taken:
            length, arrival = self._lengths[0]
            self._lengths[0] = (length - taken, arrival)

    def _say_trouble(self, reason: str) -> None:
        if self._given_up:
            self._trouble = self._over(reason)
            return
        if self._trouble is None:
            log.warning("the recording %s cannot be written: %s", self.path, reason)
        self._trouble = sentence(
            "This drive is not being written down: {reason}. Make room; driving goes on, and what is missing is"
            " written as soon as there is room.",
            reason=reason,
        )

    def _over(self, reason: str) -> str:
        return sentence(
            "The recording ended at {time}: {reason}, for too long. Driving goes on.",
            time=_clock(self._last),
            reason=reason,
        )

    def _sync(self) -> None:
        try:
            self._folder.sync()
            free = shutil.disk_usage(self.path).free
            self._folder.write_summary(self._summary(ended=False))
        except OSError as error:
            self._say_trouble(why(error))
        except StoreError as error:
            log.warning("%s", error)  # without room for the summary there is none for events, which say so
        else:
            self._keep_point()
            low = free < self._low_space
            self._shortage = (
                sentence("The disk is nearly full: {left} MB are left. Make room soon.", left=free // MEGABYTE)
                if low
                else None
            )

    def _keep_point(self) -> None:
        """Once the inputs that it stands for are on the disk."""
        point, points = self._point, self._points
        if point is not None and points is not None and not self._waiting:
            self._point = None
            points.keep(point)

    def _summary(self, *, ended: bool) -> RecordingSummary:
        now = datetime.now(UTC).isoformat(timespec="seconds").replace("+00:00", "Z")
        changes: dict[str, object] = {
            "written_utc": now,
            "duration_s": self._last,
            "events": self._count,
            "ended": ended,
            "truncated": None,
        }
        snapshot = self._snapshot
        if snapshot is not None:
            changes["worked_m2"] = snapshot.totals.worked
            if snapshot.guidance is not None:
                changes["pass_number"] = snapshot.guidance.target.number
            if snapshot.guidance is not None and snapshot.guidance.count is not None:
                changes["passes_done"] = len(snapshot.guidance.done)
                changes["passes_planned"] = snapshot.guidance.count
        return self._past.model_copy(update=changes)

    def _end(self) -> None:
        """Packs a drive that is over; one in which nothing ever came in is taken away.

        Where something could not be written the recording stays unpacked, as the program's end left it.
        """
        if not self._ended or self._waiting:
            return
        try:
            if self._is_empty:
                self._folder.discard()
            else:
                self._folder.pack()
                self._folder.write_summary(self._summary(ended=True))
                self._keep_columns()
        except StoreError as error:
            log.warning("%s", error)  # it stays as it is, whole and unpacked
        else:
            self._columns.close()
            if self._points is not None:
                self._points.forget()

    def _keep_columns(self) -> None:
        columns = self._columns.whole()
        if columns is not None:
            keep_columns(place_of(self.path.parent.parent, read_recording(self.path)), columns)


def new_recording(
    data: Path,
    job: Job,
    source: str,
    filter_name: str | None = None,
    settings: FilterSettings | None = None,
    notices: tuple[str, ...] = (),
) -> Recorder:
    """A recorder into a new folder under the data folder, for the engine that these make. Raises ``StoreError``."""
    meta = RecordingMeta(
        program=f"guidance-app {__version__}",
        started_utc=datetime.now(UTC).isoformat(timespec="seconds").replace("+00:00", "Z"),
        source=source,
        filter=filter_name or (job.receiver.filter if job.receiver.filter_on else "off"),
        filter_settings=settings,
        notices=notices,
        job=job,
    )
    folder = RecordingFolder.create(data, meta)
    past = RecordedDrive(folder.path.name, meta, read_lines(b""), None, "")
    return Recorder(folder, past, points=ResumePoints(cache_folder(), folder.path, past))


def _says_something(event: Event) -> bool:
    return isinstance(event, Commanded) or (isinstance(event, Chunk) and bool(event.data))


def _clock(seconds: float) -> str:
    return f"{int(seconds // 3600)}:{int(seconds // 60) % 60:02}:{int(seconds % 60):02}"
