"""Event in, next ``Snapshot`` out; the engine only sequences. A case may call, not compute.

One engine serves the live drive, the replay, the batch and the tests; it knows no clock, no file and no screen. Two
engines that are given the same events reach the same snapshots to the bit. ``fork`` gives an independent copy that
shares everything immutable: a replay keeps one every so often, to jump back to.
"""

import copy
from collections.abc import Iterator
from dataclasses import fields, replace
from typing import Any, assert_never

from guidance_app.documents import Job, Tractor
from guidance_app.engine import position, roll_drives
from guidance_app.engine.attitudes import Attitudes
from guidance_app.engine.hearing import Heard, Hearing
from guidance_app.engine.link import after_chunk, after_down, after_up, changed_link, link_of
from guidance_app.engine.position import Measuring, Position
from guidance_app.engine.roll_drives import RollDrives
from guidance_app.engine.state import why_not
from guidance_app.engine.work_done import WorkDone
from guidance_app.estimation.filter import Filter, FilterSettings
from guidance_app.estimation.prediction import Predictor
from guidance_app.estimation.reference_point import ImplementPoint, measurement_from_fix
from guidance_app.estimation.restarting import RestartingFilter
from guidance_app.geodesy import FieldFrame
from guidance_app.language import sentence
from guidance_app.model import (
    RECEIVER,
    ApplyRollZero,
    Attitude,
    BeginInitialisation,
    BeginRollZero,
    CancelRollZero,
    Chunk,
    Command,
    Commanded,
    DropOffset,
    EndDrive,
    Event,
    FinishRollZero,
    Fix,
    Initialised,
    LinkState,
    LinkStatus,
    Measurement,
    NextRollZeroDrive,
    NoFix,
    OffsetKind,
    OnTheMark,
    Pause,
    Pose,
    Rejected,
    Resume,
    SessionState,
    SetLookAhead,
    SkipInitialisation,
    Snapshot,
    SourceDown,
    SourceUp,
)

__all__ = ["Engine"]

OFF = "off"
Changes = dict[str, Any]
"""Members of a snapshot that are new; one event replaces the snapshot once, whatever it changes."""
NO_POSE: Changes = {"pose": None, "implement": None, "prediction": None, "guidance": None}
ANSWER_S = 12.0
"""So long the answer to a command that could not be done stands among the notices, unless another command comes."""


class Engine:
    """Holds what one session remembers between events. Not thread-safe; its snapshots are.

    ``filter_name`` goes before the receiver document's choice; ``notices`` are shown beside those of field and plan;
    ``estimator`` goes before both (poses that are known beforehand, as those of the smoother). ``link`` is the
    receiver's before anything is heard of it, else connecting. Raises ``ValueError`` for a filter that is not known.
    """

    def __init__(
        self,
        job: Job,
        *,
        filter_name: str | None = None,
        settings: FilterSettings | None = None,
        notices: tuple[str, ...] = (),
        estimator: Filter | None = None,
        link: LinkState | None = None,
    ) -> None:
        self._job = job
        self._told = notices
        receiver = job.receiver
        self._filter_name = filter_name or (receiver.filter if receiver.filter_on else OFF)
        self._filter: Filter = estimator or RestartingFilter(self._filter_name, settings)
        self._hearing = Hearing()
        self._attitudes = Attitudes()
        self._implement = ImplementPoint(job.implement)
        self._predictor = Predictor(settings)
        self._look_ahead = receiver.look_ahead
        self._tractor = job.tractor
        self._state = SessionState.IDLE
        self._position = Position()
        self._before = SessionState.DRIVING
        self._start_point: tuple[float, float] | None = None
        self._measuring: Measuring | None = None
        self._measured: Initialised | None = None
        self._roll_drives: RollDrives | None = None
        self._answer: tuple[float, str] | None = None
        self._work = WorkDone(job)
        self._frame = self._work.frame
        self._raw_pose: Pose | None = None
        first = Snapshot(0, 0.0, link or LinkState(), look_ahead_s=self._look_ahead, filter_name=self._filter_name)
        self._members: Changes = {one.name: getattr(first, one.name) for one in fields(first)}
        self._members |= self._work.shown_since(first, ()) | {"notices": self._notices(0.0)} | self._procedures
        self._snapshot = Snapshot(**self._members)

    @property
    def snapshot(self) -> Snapshot:
        """The newest snapshot."""
        return self._snapshot

    @property
    def wake_at(self) -> float | None:
        """When a half-received epoch wants to be closed, on the session clock; None when there is none."""
        close = self.close_epoch
        return None if close is None else close.arrival

    @property
    def close_epoch(self) -> Chunk | None:
        """The empty chunk that closes the half-received epoch which waits longest, at ``wake_at`` or later."""
        return self._hearing.close_epoch

    def fork(self, generation: int | None = None) -> "Engine":
        """An independent copy; with a new ``generation`` its readers see that time has jumped."""
        other = copy.copy(self)
        vars(other).update(
            _hearing=self._hearing.fork(),
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

    @property
    def hearing(self) -> Hearing:
        """What it listens with, as it is now."""
        return self._hearing

    def take_hearing(self, hearing: Hearing) -> None:
        """Goes on listening from here, after steps that were given what was heard."""
        self._hearing = hearing

    def step(self, event: Event) -> Snapshot:
        """The snapshot after one more event."""
        for _ in self.steps(event):
            pass
        return self._snapshot

    def steps(self, event: Event, heard: Heard | None = None) -> Iterator[Snapshot]:
        """The snapshots after each fix that the event closed, or one when it closed none.

        ``heard`` is what ``Hearing`` says of the event, where that was found out beforehand; then of every one.
        """
        match event:
            case Chunk():
                yield from self._observe(event, heard or self._hearing.hear(event))
            case Commanded():
                yield self._publish(event.arrival, self._command(event.arrival, event.command))
            case SourceUp():
                state = after_up(link_of(self._snapshot, event.link), event)
                yield self._publish(event.arrival, changed_link(event.link, self._snapshot.links_beside, state))
            case SourceDown():
                last = heard or self._hearing.hear(event)
                if last.closed:
                    yield from self._observe(Chunk(event.arrival, b"", event.link), last)
                state = after_down(link_of(self._snapshot, event.link), event)
                yield self._publish(event.arrival, changed_link(event.link, self._snapshot.links_beside, state))
            case _:
                assert_never(event)

    @property
    def tractor(self) -> Tractor:
        """The tractor as it is used now, with the roll zero that was applied."""
        return self._tractor

    def failed(self, arrival: float, reason: str) -> Snapshot:
        """The snapshot that says that the engine itself has failed, with nothing to steer by."""
        link = replace(
            self._snapshot.link,
            status=LinkStatus.DOWN,
            since=arrival,
            reason=sentence("internal error: {reason}", reason=reason),
        )
        return self._publish(arrival, {"link": link, **NO_POSE})

    def _publish(self, arrival: float, changes: Changes) -> Snapshot:
        self._members |= changes
        self._members["sequence"] += 1
        self._members["arrival"] = arrival
        self._snapshot = Snapshot(**self._members)
        return self._snapshot

    def _observe(self, chunk: Chunk, heard: Heard) -> Iterator[Snapshot]:
        before = self._snapshot
        state = after_chunk(link_of(before, chunk.link), chunk, heard.closed, heard.counts)
        changes: Changes = changed_link(chunk.link, before.links_beside, state)
        if heard.sky is not before.sky and chunk.link == RECEIVER:
            changes["sky"] = heard.sky
        for one in heard.closed:
            match one:
                case Fix():
                    self._fix(one, changes)
                    yield self._publish(chunk.arrival, changes)
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

    def _fix(self, fix: Fix, changes: Changes) -> None:
        """From one fix to guidance: frame, measurement, filter, implement, guidance, coverage. Fills in ``changes``."""
        if self._frame is None:
            self._frame = FieldFrame(fix.latitude_deg, fix.longitude_deg)
            self._work.begin_at(self._frame)
        changes["fix"] = fix
        if self._snapshot.fix is not None and fix.t > self._snapshot.fix.t:
            changes["fix_interval"] = fix.t - self._snapshot.fix.t
        try:
            measurement = measurement_from_fix(fix, self._attitudes.at(fix.arrival), self._frame, self._tractor)
        except ValueError as error:
            changes |= NO_POSE
            changes["notices"] = (*self._notices(fix.arrival), str(error))
            return
        if self._state is SessionState.IDLE:
            self._state = SessionState.DRIVING
        self._raw_pose = self._filter.step(measurement)
        if self._state is SessionState.INITIALISING:
            self._measure(measurement, self._frame)
        if self._roll_drives is not None and self._raw_pose is not None:
            self._roll_drives = self._roll_drives.with_pose(self._raw_pose)
        self._guide(fix, changes)

    def _guide(self, fix: Fix, changes: Changes) -> None:
        pose = self._position.of(self._raw_pose)
        if pose is None:
            changes |= NO_POSE | self._procedures
            changes["notices"] = self._notices(fix.arrival)
            return
        implement = self._implement.step(pose)
        prediction = self._predictor.step(pose, self._look_ahead)
        if self._state is not SessionState.ENDED:
            counted = self._state is SessionState.DRIVING
            self._work.step(pose, implement, reported=fix.implement_down, counted=counted)
        if prediction is not None:
            prediction = self._work.ahead(prediction)
        changes["pose"], changes["implement"], changes["prediction"] = pose, implement, prediction
        changes |= self._shown(fix.arrival)

    def _shown(self, arrival: float) -> Changes:
        """What there is to guide along, what is worked, every offset in force, and what is under way."""
        shown = self._work.shown_since(self._snapshot, self._position.records)
        shown |= self._procedures
        shown["notices"] = self._notices(arrival)
        return shown

    @property
    def _procedures(self) -> Changes:
        """The session's state and its procedures, as a snapshot shows them."""
        return {
            "state": self._state,
            "initialising": None if self._measuring is None else self._measuring.shown,
            "initialised": self._measured,
            "roll_zero": None if self._roll_drives is None else self._roll_drives.shown,
            "roll_zero_deg": self._tractor.roll_zero_deg,
        }

    def _notices(self, arrival: float) -> tuple[str, ...]:
        """What there is to know; first of all why the last command could not be done."""
        if self._answer is not None and arrival >= self._answer[0] + ANSWER_S:
            self._answer = None
        answers = () if self._answer is None else (self._answer[1],)
        return (*answers, *self._told, *self._work.notices)

    # --- commands ---------------------------------------------------------------------------------------------------

    def _command(self, arrival: float, command: Command) -> Changes:
        """What a command changes. One that cannot be done changes nothing and says why."""
        refused = why_not(self._state, command) or self._obey(arrival, command)
        self._answer = None if refused is None else (arrival, refused)
        shown = self._shown(arrival) | {"look_ahead_s": self._look_ahead}
        return shown if self._snapshot.pose is not None else shown | NO_POSE

    def _obey(self, arrival: float, command: Command) -> str | None:
        """Does it, or says in a sentence why it cannot be done."""
        match command:
            case SetLookAhead():
                self._look_ahead = command.seconds
            case Pause():
                self._state = SessionState.PAUSED
                self._work.lift()
            case Resume():
                self._state = SessionState.DRIVING
            case EndDrive():
                self._state = SessionState.ENDED
                self._measuring = self._roll_drives = None
                self._work.end()
            case OnTheMark():
                return self._mark(arrival, command)
            case DropOffset(kind=OffsetKind.MARK | OffsetKind.INITIALISATION):
                self._position = self._position.without(command.kind)
            case BeginInitialisation() | SkipInitialisation():
                return self._initialise(command)
            case BeginRollZero() | NextRollZeroDrive() | FinishRollZero() | ApplyRollZero() | CancelRollZero():
                return self._calibrate(command)
            case _:
                return self._work.command(command, arrival)
        return None

    def _mark(self, arrival: float, command: OnTheMark) -> str | None:
        place = (0.0, 0.0)
        if self._frame is not None:
            place = self._frame.east_north_from_degrees(command.latitude_deg, command.longitude_deg)
        found = self._position.on_the_mark(arrival, place, self._raw_pose)
        if isinstance(found, str):
            return found
        self._position = found
        return None

    def _initialise(self, command: BeginInitialisation | SkipInitialisation) -> str | None:
        if isinstance(command, SkipInitialisation):
            self._state, self._measuring = self._before, None
            return None
        if self._job.receiver.measuring_time <= 0.0:
            return sentence("The receiver's measuring time is 0 s: there is nothing to measure.")
        place = command.latitude_deg, command.longitude_deg
        self._start_point = None if place[0] is None or place[1] is None else (place[0], place[1])
        self._before = SessionState.PAUSED if self._state is SessionState.PAUSED else SessionState.DRIVING
        self._state = SessionState.INITIALISING
        self._measuring = None if self._frame is None else self._begun(self._frame)
        self._work.lift()
        return None

    def _begun(self, frame: FieldFrame) -> Measuring:
        return position.begun(self._job.receiver.measuring_time, self._start_point, frame, self._raw_pose)

    def _measure(self, measurement: Measurement, frame: FieldFrame) -> None:
        """One more epoch at the start point; after the last one the drive goes on with what was learnt."""
        self._measuring = (self._measuring or self._begun(frame)).with_measurement(measurement)
        start = self._measuring.start
        if start is None:
            return
        self._filter.begin(start)
        self._measured = self._measuring.result(measurement.arrival, start)
        if self._measuring.known:
            found = self._position.initialised(measurement.arrival, start)
            if isinstance(found, str):
                self._answer = (measurement.arrival, found)
            else:
                self._position = found
        self._state, self._measuring = self._before, None

    def _calibrate(
        self, command: BeginRollZero | NextRollZeroDrive | FinishRollZero | ApplyRollZero | CancelRollZero
    ) -> str | None:
        drives = self._roll_drives
        after: RollDrives | str | None
        match command:
            case CancelRollZero():
                after = None
            case BeginRollZero():
                after = roll_drives.begun(self._tractor, self._raw_pose)
            case _ if drives is None:
                after = sentence("No calibration is under way: begin one.")
            case NextRollZeroDrive():
                after = drives.turned()
            case FinishRollZero():
                after = drives.finished(self._tractor)
            case ApplyRollZero():
                if drives.found is None:
                    return sentence("Nothing has been found yet: finish both drives first.")
                self._tractor = self._tractor.model_copy(update={"roll_zero_deg": drives.found.roll_zero_deg})
                after = None
            case _:
                assert_never(command)
        if isinstance(after, str):
            return after
        self._roll_drives = after
        return None
