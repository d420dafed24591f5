"""A recording as one file to give away: it opens elsewhere as it is, without passwords, and may be moved on earth."""

import io
import re
import zipfile
from dataclasses import dataclass
from pathlib import Path

from guidance_app.recording import LineWriter, RecordedDrive, RecordingMeta
from guidance_app.recording.moving import moved_events, moved_job
from guidance_app.store.files import write_atomically
from guidance_app.store.recordings import PACKED, SESSION, packed

__all__ = ["WrittenReport", "report_of", "write_report"]

README = "README.txt"
_hide_secrets = re.compile(r"(?<=//)[^/@\s]*@").sub


@dataclass(frozen=True, slots=True)
class WrittenReport:
    """What is in the file: how many events; ``blanked`` sentences were not understood when it was moved."""

    events: int
    size: int
    blanked: int | None


def write_report(drive: RecordedDrive, target: Path, move: int | None = None) -> WrittenReport:
    """Writes the drive as a zip, ``move`` degrees of longitude to the east if given. Raises ``StoreError``."""
    content, written = report_of(drive, move)
    write_atomically(target, content)
    return written


def report_of(drive: RecordedDrive, move: int | None = None) -> tuple[bytes, WrittenReport]:
    """The drive as a zip, ``move`` degrees of longitude to the east if given, and what is in it."""
    meta, events, blanked = drive.meta, drive.events, None
    if move is not None:
        moved = moved_events(events, move)
        events, blanked = moved.events, moved.blanked
        meta = meta.model_copy(update={"job": moved_job(meta.job, move)})
    writer = LineWriter()
    text = b"".join(writer.line(event) for event in events)
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(SESSION, _without_secrets(meta).model_dump_json(indent=1))
        archive.writestr(zipfile.ZipInfo(PACKED), packed(text))
        archive.writestr(README, _readme(drive, blanked))
    made = content.getvalue()
    return made, WrittenReport(len(events), len(made), blanked)


def _without_secrets(meta: RecordingMeta) -> RecordingMeta:
    """Addresses without user and password."""
    receiver = meta.job.receiver
    changes = {
        name: _hide_secrets("", value)
        for name, value in receiver.model_dump().items()
        if isinstance(value, str) and "//" in value
    }
    job = meta.job.model_copy(update={"receiver": receiver.model_copy(update=changes)})
    return meta.model_copy(update={"job": job, "source": _hide_secrets("", meta.source)})


def _readme(drive: RecordedDrive, blanked: int | None) -> str:
    lines = [
        "A recorded drive of the guidance console.",
        "Play it:  guidance-app replay THIS_FILE.zip",
        "As table: guidance-app process THIS_FILE.zip --out drive.csv",
        f"Recorded by {drive.meta.program}, {len(drive.events)} events of {drive.duration:.0f} s.",
    ]
    if blanked is not None:
        lines += [
            "It was moved by whole degrees of longitude; lengths, angles and areas are those of the drive.",
            f"In {blanked} sentences that were not understood the digits were blanked.",
            "Latitude, time of day, the shape of the field and all names are as they were.",
        ]
    if drive.truncated is not None:
        lines.append(drive.truncated)
    return "\n".join(lines) + "\n"
