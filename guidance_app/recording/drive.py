"""A recorded drive: the documents in use, and every input of the engine in its order."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from guidance_app.documents import Job
from guidance_app.estimation.filter import FilterSettings
from guidance_app.model import Chunk, Event, FloatArray
from guidance_app.recording.lines import FORMAT, Lines

__all__ = ["RecordedDrive", "RecordingMeta"]


class RecordingMeta(BaseModel):
    """What stands beside the events: all that an engine needs to make the same of them again, and when it was.

    ``started_utc`` is ISO 8601 with Z by the clock of the machine. ``filter_settings`` is None for the program's own.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["recording"] = "recording"
    schema_version: int = Field(FORMAT, ge=1)
    program: str
    started_utc: str
    source: str
    filter: str
    filter_settings: FilterSettings | None = None
    notices: tuple[str, ...] = ()
    job: Job


@dataclass(frozen=True, slots=True, eq=False)
class RecordedDrive:
    """A recording that was opened. ``events`` are read when asked for; ``truncated`` says where it breaks off.

    ``digest`` tells two recordings apart by their content.
    """

    name: str
    meta: RecordingMeta
    lines: Lines
    truncated: str | None
    digest: str

    @property
    def job(self) -> Job:
        """The documents in use."""
        return self.meta.job

    @property
    def filter_name(self) -> str:
        """The filter in use."""
        return self.meta.filter

    @property
    def settings(self) -> FilterSettings | None:
        """The filter's settings; None for those of the program."""
        return self.meta.filter_settings

    @property
    def notices(self) -> tuple[str, ...]:
        """What the engine was told to say beside its own notices."""
        return self.meta.notices

    @property
    def events(self) -> Sequence[Event]:
        """Every input in the order in which the engine took it."""
        return self.lines

    @property
    def arrivals(self) -> FloatArray:
        """When each event came, on the session clock; never steps back. Shape (N,)."""
        return self.lines.arrivals

    @property
    def duration(self) -> float:
        """The session clock at the last event."""
        return float(self.arrivals[-1]) if len(self.arrivals) else 0.0

    @property
    def description(self) -> str:
        """What a person calls it."""
        return self.name

    @property
    def chunks(self) -> Iterator[Chunk]:
        """The receiver's bytes alone."""
        return (event for event in self.events if isinstance(event, Chunk) and event.data)
