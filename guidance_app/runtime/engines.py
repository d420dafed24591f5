"""The engine of a replay, and beside it a second one that takes the same events with something changed.

The second one's track is shown as a ghost beside the first one's: another filter, another look-ahead, another place
of the antenna than the drive had.
"""

from dataclasses import dataclass, replace

from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.estimation.filter import FilterSettings
from guidance_app.model import Chunk, Commanded, Event, Ghost, SetLookAhead, Snapshot
from guidance_app.runtime.stepping import stepped

__all__ = ["Comparison", "Engines", "Setup"]


@dataclass(frozen=True, slots=True)
class Comparison:
    """What the second engine has else than the drive; None is the same. ``antenna``: forward, right, height in m."""

    filter_name: str | None = None
    settings: FilterSettings | None = None
    look_ahead: float | None = None
    antenna: tuple[float, float, float] | None = None

    def job_of(self, job: Job) -> Job:
        """The documents with what is changed in them. Raises ``ValueError`` for what they cannot hold."""
        changes: dict[str, object] = {}
        if self.look_ahead is not None:
            receiver = {**job.receiver.model_dump(), "look_ahead": self.look_ahead}
            changes["receiver"] = type(job.receiver).model_validate(receiver)
        if self.antenna is not None:
            forward, right, height = self.antenna
            places = {"antenna_forward": forward, "antenna_right": right, "antenna_height": height}
            changes["tractor"] = type(job.tractor).model_validate({**job.tractor.model_dump(), **places})
        return job.model_copy(update=changes)


@dataclass(frozen=True, slots=True)
class Setup:
    """All that engines are made of."""

    job: Job
    filter_name: str | None = None
    settings: FilterSettings | None = None
    notices: tuple[str, ...] = ()
    compare: Comparison | None = None


class Engines:
    """One engine, or two that take the same events. Never raises; used by one thread."""

    def __init__(self, main: Engine, other: Engine | None = None, *, keeps_look_ahead: bool = False) -> None:
        self._main = main
        self._other = other
        self._keeps_look_ahead = keeps_look_ahead

    @classmethod
    def made_of(cls, setup: Setup) -> "Engines":
        """Engines that have taken nothing yet. Raises ``ValueError`` for a filter that is not known."""
        main = Engine(setup.job, filter_name=setup.filter_name, settings=setup.settings, notices=setup.notices)
        compare = setup.compare
        if compare is None:
            return cls(main)
        other = Engine(
            compare.job_of(setup.job),
            filter_name=compare.filter_name or setup.filter_name,
            settings=compare.settings or setup.settings,
        )
        return cls(main, other, keeps_look_ahead=compare.look_ahead is not None)

    @property
    def snapshot(self) -> Snapshot:
        """The newest, with the ghost where there is a second engine."""
        snapshot = self._main.snapshot
        if self._other is None:
            return snapshot
        other = self._other.snapshot
        ghost = Ghost(other.track, other.pose, other.guidance, other.prediction, other.filter_name)
        return replace(snapshot, ghost=ghost)

    @property
    def wake_at(self) -> float | None:
        """When a half-received epoch wants to be closed."""
        return self._main.wake_at

    @property
    def close_epoch(self) -> Chunk | None:
        """What closes it."""
        return self._main.close_epoch

    def step(self, event: Event) -> Snapshot:
        """The snapshot after one more event."""
        stepped(self._main, event)
        if self._other is not None and not (self._keeps_look_ahead and _is_look_ahead(event)):
            stepped(self._other, event)
        return self.snapshot

    def fork(self, generation: int | None = None) -> "Engines":
        """An independent copy; with a new ``generation`` its readers see that time has jumped."""
        other = None if self._other is None else self._other.fork(generation)
        return Engines(self._main.fork(generation), other, keeps_look_ahead=self._keeps_look_ahead)


def _is_look_ahead(event: Event) -> bool:
    return isinstance(event, Commanded) and isinstance(event.command, SetLookAhead)
