"""What a replay plays: a receiver's log or a recorded drive, as one sequence of events with their times."""

from collections.abc import Sequence
from dataclasses import dataclass

from guidance_app.model import Event, SourceUp
from guidance_app.recording import RecordedDrive
from guidance_app.sources.file import FileLog

__all__ = ["Timeline", "timeline_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Timeline:
    """Events in their order. ``first`` are those before the clock begins.

    A recorded drive holds what closed its half-received epochs, a log does not: there the session ``closes_epochs``
    as a live one would. ``digest`` tells contents apart, None where it has not been reckoned.
    """

    description: str
    events: Sequence[Event]
    duration: float
    first: tuple[Event, ...]
    closes_epochs: bool
    digest: str | None


def timeline_of(source: FileLog | RecordedDrive) -> Timeline:
    """What is in a log, or in a recorded drive."""
    if isinstance(source, RecordedDrive):
        events = source.events
        return Timeline(source.description, events, source.duration, (), closes_epochs=False, digest=source.digest)
    up = SourceUp(0.0, source.description)
    return Timeline(source.description, source.chunks, source.duration, (up,), closes_epochs=True, digest=None)
