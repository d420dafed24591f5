"""A time log of ISOXML as a recording with the log's field and width: a zip that ``replay`` plays, or a stored one."""

import io
import zipfile
from datetime import UTC, datetime
from pathlib import Path

from guidance_app import __version__
from guidance_app.documents import FieldDocument, Implement, Job, Receiver, Tractor
from guidance_app.exchange import ExchangeError, read_fields
from guidance_app.exchange.time_log_drive import TimeLog, events_of
from guidance_app.recording import LineWriter, RecordingMeta
from guidance_app.store.recordings import PACKED, SESSION, packed

__all__ = ["field_of", "job_of", "recording_of"]

WIDTH = 3.0
"""Metres where the log tells no width, or one that no implement has."""
NARROWEST, WIDEST = 0.3, 60.0
"""Metres that an implement may be wide."""
FIRST_MOMENT = (1980, 1, 1, 0, 0, 0)
"""Of a member of an archive, so that the same log gives the same bytes."""


def field_of(source: Path | bytes, log: TimeLog, name: str = "") -> FieldDocument | None:
    """The field of the log's task; None where it has none, or none that can be used."""
    try:
        fields = read_fields(source, name)
    except ExchangeError:
        return None  # the log is looked at all the same
    return next((field.document for field in fields if field.name == " ".join((log.field or "").split())), None)


def job_of(log: TimeLog, field: FieldDocument | None) -> Job:
    """Documents for looking at a log: its field, and an implement of its widest working width."""
    widest = log.widest if log.widest is not None and NARROWEST <= log.widest <= WIDEST else WIDTH
    return Job(
        tractor=Tractor(name="Tractor", antenna_height=0.0),
        implement=Implement(name="Implement", working_width=widest, offset_back=0.0, length=1.0),
        receiver=Receiver(name="Receiver"),
        field=field,
    )


def recording_of(log: TimeLog, job: Job) -> bytes:
    """The recording as a zip, the same bytes for the same log."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(zipfile.ZipInfo(SESSION, FIRST_MOMENT), _meta(log, job).model_dump_json(indent=1) + "\n")
        archive.writestr(zipfile.ZipInfo(PACKED, FIRST_MOMENT), packed(_lines(log)))
    return target.getvalue()


def _meta(log: TimeLog, job: Job) -> RecordingMeta:
    return RecordingMeta(
        program=f"guidance-app {__version__}",
        started_utc=datetime.fromtimestamp(log.rows[0].utc, UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
        source=f"time log {log.name}",
        filter=job.receiver.filter,
        notices=(f"A time log of ISOXML: {log.task}", *log.warnings),
        job=job,
    )


def _lines(log: TimeLog) -> bytes:
    writer = LineWriter()
    return b"".join(writer.line(event) for event in events_of(log))
