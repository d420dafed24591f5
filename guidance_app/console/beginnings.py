"""What a drive can begin with: one that was cut off, registered operations, and what was used last time.

Only reads. The panel that shows it gathers it again when something may have been stored.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from guidance_app.documents import FieldDocument, Implement, Job, Operation, Receiver, Tractor
from guidance_app.store import Store, StoreError
from guidance_app.store.recordings import job_of_recording
from guidance_app.store.recordings_list import ListedRecording, Resumable, list_recordings, resumable

__all__ = ["Beginnings", "LastTime", "OnField", "beginnings_of"]


@dataclass(frozen=True, slots=True)
class OnField:
    """The operations of one field, the last used first."""

    field: str
    operations: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class LastTime:
    """What the newest drive used."""

    width: float = 3.0
    tractor: str = ""
    implement: str = ""
    receiver: str = ""
    source: str = ""


@dataclass(frozen=True, slots=True)
class Beginnings:
    """All of it. ``receivers`` are names with their sources; ``fields`` counts the registered ones."""

    cut_off: Resumable | None
    work: tuple[OnField, ...]
    tractors: tuple[str, ...]
    implements: tuple[str, ...]
    receivers: tuple[tuple[str, str], ...]
    fields: int
    last: LastTime


def beginnings_of(store: Store) -> Beginnings:
    """Looks at the data folder."""
    recordings = list_recordings(store.root)
    receivers = tuple((one.document.name, one.document.source) for one in store.list(Receiver))
    tractors = tuple(one.document.name for one in store.list(Tractor))
    implements = tuple(one.document.name for one in store.list(Implement))
    return Beginnings(
        cut_off=resumable(store.root),
        work=_by_use([one.document for one in store.list(Operation)], recordings),
        tractors=tractors,
        implements=implements,
        receivers=receivers,
        fields=len(store.list(FieldDocument)),
        last=_last_time(recordings),
    )


def _by_use(operations: Sequence[Operation], recordings: Sequence[ListedRecording]) -> tuple[OnField, ...]:
    """Fields and their operations, the last used first; what was never used follows by name."""
    used: dict[tuple[str | None, str | None], int] = {}
    for place, recording in enumerate(recordings):
        if recording.summary is not None:
            used.setdefault((recording.summary.field, recording.summary.operation), place)
    never = len(recordings)

    def last_used(one: Operation) -> int:
        return used.get((one.field, one.name), never)

    ordered = sorted(operations, key=last_used)
    fields = dict.fromkeys(one.field for one in ordered)
    return tuple(OnField(field, tuple(one.name for one in ordered if one.field == field)) for field in fields)


def _last_time(recordings: Sequence[ListedRecording]) -> LastTime:
    for recording in recordings:
        try:
            job: Job = job_of_recording(recording.path)
        except StoreError:
            continue  # the list of recordings says what is wrong with it
        return LastTime(
            width=job.implement.working_width,
            tractor=job.tractor.name,
            implement=job.implement.name,
            receiver=job.receiver.name,
            source=job.receiver.source,
        )
    return LastTime()
