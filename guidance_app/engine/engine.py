"""Event in, next ``Snapshot`` out; the engine only sequences. A case may call, not compute.

One engine serves the live drive, the replay, the batch and the tests; it knows no clock, no file and no screen. Two
engines that are given the same events reach the same snapshots to the bit. ``fork`` gives an independent copy that
shares everything immutable: a replay keeps one every so often, to jump back to.
"""

import copy
from collections.abc import Iterator
from dataclasses import fields, replace
from typing import Any, assert_never

from guidance_app.decode.decoder import Decoder
from guidance_app.documents import Job
from guidance_app.engine.attitudes import Attitudes
from guidance_app.engine.link import after_chunk, after_down, after_up, changed_link, link_of
from guidance_app.engine.work_done import WorkDone
from guidance_app.estimation.filter import Filter, FilterSettings
from guidance_app.estimation.filters import make_filter
from guidance_app.estimation.prediction import Predictor
from guidance_app.estimation.reference_point import ImplementPoint, measurement_from_fix
from guidance_app.geodesy import FieldFrame
from guidance_app.model import (
    RECEIVER,
    Attitude,
    Chunk,
    Command,
    Commanded,
    DropOffset,
    Event,
    Fix,
    LinkState,
    LinkStatus,
    NoFix,
    Observation,
    OffsetKind,
    OffsetRecord,
    OnTheMark,
    Pose,
    Rejected,
    SetLookAhead,
    Snapshot,
    SourceDown,
    SourceUp,
)

__all__ = ["Engine"]

OFF = "off"
Changes = dict[str, Any]
"""Members of a snapshot that are new; one event replaces the snapshot once, whatever it changes."""
NO_POSE: Changes = {"pose": None, "implement": None, "prediction": None, "guidance": None}


class Engine:
    """Holds what one session remembers between events. Not thread-safe; its snapshots are.

    ``filter_name`` goes before the receiver document's choice; ``notices`` are shown beside those of field and plan;
    ``estimator`` goes before both (poses that are known beforehand, as those of the smoother). Raises ``ValueError``
    for a filter that is not known.
    """

    def __init__(
        self,
        job: Job,
        *,
        filter_name: str | None = None,
        settings: FilterSettings | None = None,
        notices: tuple[str, ...] = (),
        estimator: Filter | None = None,
    ) -> None:
        self._job = job
        self._told = notices
        receiver = job.receiver
        self._filter_name = filter_name or (receiver.filter if receiver.filter_on else OFF)
        self._filter = estimator or make_filter(self._filter_name, settings)
        self._decoders: dict[str, Decoder] = {}
        self._attitudes = Attitudes()
        self._implement = ImplementPoint(job.implement)
        self._predictor = Predictor(settings)
        self._look_ahead = receiver.look_ahead
        self._mark: OffsetRecord | None = None
        self._work = WorkDone(job)
        self._frame = self._work.frame
        self._raw_pose: Pose | None = None
        first = Snapshot(0, 0.0, LinkState(), look_ahead_s=self._look_ahead, filter_name=self._filter_name)
        self._members: Changes = {one.name: getattr(first, one.name) for one in fields(first)}
        self._members |= self._work.shown_since(first, ()) | {"notices": self._notices}
        self._snapshot = Snapshot(**self._members)

    @property
    def snapshot(self) -> Snapshot:
        """The newest snapshot."""
        return self._snapshot

    @property
    def wake_at(self) -> float | None:
        """When a half-received epoch wants to be closed, on the session clock; None when there is none."""
        waiting = [one.wake_at for one in self._decoders.values() if one.wake_at is not None]
        return min(waiting, default=None)

    def fork(self, generation: int | None = None) -> "Engine":
        """An independent copy; with a new ``generation`` its readers see that time has jumped."""
        other = copy.copy(self)
        vars(other).update(
            _decoders={link: one.fork() for link, one in self._decoders.items()},
            _attitudes=self._attitudes.fork(),
            _filter=self._filter.fork(),
            _implement=self._implement.fork(),
            _predictor=self._predictor.fork(),
            _work=self._work.fork(),
            _members=dict(self._members),
        )
        if generation is not None:
            other._publish(self._snapshot.arrival, {"generation": generation})  # noqa: SLF001 - its own class
        return other

    def step(self, event: Event) -> Snapshot:
        """The snapshot after one more event."""
        for _ in self.steps(event):
            pass
        return self._snapshot

    def steps(self, event: Event) -> Iterator[Snapshot]:
        """The snapshots after each fix that the event closed, or one when it closed none."""
        match event:
            case Chunk():
                decoder = self._decoder(event.link)
                yield from self._observe(event, decoder.feed(event), decoder)
            case Commanded():
                yield self._publish(event.arrival, self._command(event.arrival, event.command))
            case SourceUp():
                state = after_up(link_of(self._snapshot, event.link), event)
                yield self._publish(event.arrival, changed_link(event.link, self._snapshot.links_beside, state))
            case SourceDown():
                decoder = self._decoder(event.link)
                closed = decoder.finish(event.arrival)
                if closed:
                    yield from self._observe(Chunk(event.arrival, b"", event.link), closed, decoder)
                state = after_down(link_of(self._snapshot, event.link), event)
                yield self._publish(event.arrival, changed_link(event.link, self._snapshot.links_beside, state))
            case _:
                assert_never(event)

    def failed(self, arrival: float, reason: str) -> Snapshot:
        """The snapshot that says that the engine itself has failed, with nothing to steer by."""
        link = replace(self._snapshot.link, status=LinkStatus.DOWN, since=arrival, reason=f"internal error: {reason}")
        return self._publish(arrival, {"link": link, **NO_POSE})

    def _publish(self, arrival: float, changes: Changes) -> Snapshot:
        self._members |= changes
        self._members["sequence"] += 1
        self._members["arrival"] = arrival
        self._snapshot = Snapshot(**self._members)
        return self._snapshot

    def _decoder(self, link: str) -> Decoder:
        if link not in self._decoders:
            self._decoders[link] = Decoder(link)
        return self._decoders[link]

    def _observe(self, chunk: Chunk, closed: tuple[Observation, ...], decoder: Decoder) -> Iterator[Snapshot]:
        counts = (decoder.sentences, sum(decoder.rejected.values()), sum(decoder.kinds.values()))
        before = self._snapshot
        state = after_chunk(link_of(before, chunk.link), chunk, closed, counts)
        changes: Changes = changed_link(chunk.link, before.links_beside, state)
        if decoder.sky is not before.sky and chunk.link == RECEIVER:
            changes["sky"] = decoder.sky
        for one in closed:
            match one:
                case Fix():
                    yield self._publish(chunk.arrival, changes | self._fix(one))
                    changes = {}
                case Attitude():
                    self._attitudes.take(one)
                    changes["attitude"] = one
                case NoFix() | Rejected():
                    pass
                case _:
                    assert_never(one)
        if changes:
            yield self._publish(chunk.arrival, changes)

    def _fix(self, fix: Fix) -> Changes:
        """From one fix to guidance: frame, measurement, filter, implement, guidance, coverage."""
        if self._frame is None:
            self._frame = FieldFrame(fix.latitude_deg, fix.longitude_deg)
            self._work.begin_at(self._frame)
        changes: Changes = {"fix": fix}
        if self._snapshot.fix is not None and fix.t > self._snapshot.fix.t:
            changes["fix_interval"] = fix.t - self._snapshot.fix.t
        try:
            measurement = measurement_from_fix(fix, self._attitudes.at(fix.arrival), self._frame, self._job.tractor)
        except ValueError as error:
            return changes | NO_POSE | {"notices": (*self._notices, str(error))}
        self._raw_pose = self._filter.step(measurement)
        return changes | self._guide(reported=fix.implement_down)

    def _guide(self, *, reported: bool | None) -> Changes:
        pose = self._marked(self._raw_pose)
        if pose is None:
            return NO_POSE | {"notices": self._notices}
        implement = self._implement.step(pose)
        prediction = self._predictor.step(pose, self._look_ahead)
        self._work.step(pose, implement, reported=reported)
        if prediction is not None:
            prediction = self._work.ahead(prediction)
        return {"pose": pose, "implement": implement, "prediction": prediction} | self._shown()

    def _shown(self) -> Changes:
        """What there is to guide along, what is worked, and every offset in force."""
        shown = self._work.shown_since(self._snapshot, () if self._mark is None else (self._mark,))
        return shown | {"notices": self._notices}

    @property
    def _notices(self) -> tuple[str, ...]:
        return (*self._told, *self._work.notices)

    def _marked(self, pose: Pose | None) -> Pose | None:
        """The pose with the driver's position offset."""
        if pose is None or self._mark is None:
            return pose
        return replace(pose, east=pose.east + self._mark.east, north=pose.north + self._mark.north)

    def _command(self, arrival: float, command: Command) -> Changes:
        match command:
            case SetLookAhead():
                self._look_ahead = command.seconds
                return {"look_ahead_s": command.seconds}
            case OnTheMark():
                self._mark = self._mark_from(arrival, command)
            case DropOffset(kind=OffsetKind.MARK):
                self._mark = None
            case _:
                self._work.command(command, arrival)
        shown = self._shown()
        return shown if self._snapshot.pose is not None else shown | NO_POSE

    def _mark_from(self, arrival: float, command: OnTheMark) -> OffsetRecord | None:
        """The offset that puts the reference point where the driver says it stands; unchanged without a pose."""
        if self._frame is None or self._raw_pose is None:
            return self._mark
        east, north = self._frame.east_north_from_degrees(command.latitude_deg, command.longitude_deg)
        pose = self._raw_pose
        return OffsetRecord(OffsetKind.MARK, arrival, east=east - pose.east, north=north - pose.north)
