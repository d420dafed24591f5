"""A time log of ISOXML as a recording: the zip that ``replay`` plays, with the field and the width of the log."""

import io
import json
import zipfile
from datetime import UTC, datetime

from guidance_app import __version__
from guidance_app.documents import FieldDocument, Implement, Job, Receiver, Tractor
from guidance_app.exchange.time_log_drive import TimeLog, events_of
from guidance_app.recording import LineWriter, RecordingMeta
from guidance_app.store.recordings import PACKED, SESSION, packed

__all__ = ["job_of", "recording_of"]

WIDTH = 3.0
"""Metres where the log tells no width, or one that no implement has."""
NARROWEST, WIDEST = 0.3, 60.0
"""Metres that an implement may be wide."""
FIRST_MOMENT = (1980, 1, 1, 0, 0, 0)


def job_of(log: TimeLog, field: FieldDocument | None, width: float | None = None) -> Job:
    """Documents for looking at a log: its field, and an implement of its widest working width unless one is given."""
    widest = log.widest if log.widest is not None and NARROWEST <= log.widest <= WIDEST else WIDTH
    return Job(
        tractor=Tractor(name="Tractor", antenna_height=0.0),
        implement=Implement(name="Implement", working_width=width or widest, offset_back=0.0, length=1.0),
        receiver=Receiver(name="Receiver"),
        field=field,
    )


def recording_of(log: TimeLog, job: Job) -> bytes:
    """The recording as a zip, the same bytes for the same log."""
    started = datetime.fromtimestamp(log.rows[0].utc, UTC)
    meta = RecordingMeta(
        program=f"guidance-app {__version__}",
        started_utc=started.strftime("%Y-%m-%dT%H:%M:%SZ"),
        source=f"time log {log.name}",
        filter=job.receiver.filter,
        notices=(f"A time log of ISOXML: {log.task}", *log.warnings),
        job=job,
    )
    writer = LineWriter()
    lines = b"".join(writer.line(event) for event in events_of(log))
    session = json.dumps(json.loads(meta.model_dump_json()), indent=1, ensure_ascii=False).encode() + b"\n"
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(zipfile.ZipInfo(SESSION, FIRST_MOMENT), session)
        archive.writestr(zipfile.ZipInfo(PACKED, FIRST_MOMENT), packed(lines))
    return target.getvalue()
