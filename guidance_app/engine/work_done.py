"""What has been driven and worked, and along what: ground, tracker, implement switch, coverage and trails together.

They belong together because they begin together: with the field when there is one, else with the first fix, and with
the first straight stretch when there is no plan. Like the engine this only sequences.
"""

import copy
import math
from dataclasses import replace
from typing import Any

from guidance_app.documents import HitchKind, Job
from guidance_app.engine.ground import Ground, ground_of, ground_with, mainland_of, rest_of, shown_beside
from guidance_app.engine.line_drawing import AT_ONCE, LineDrawing, line_at_once
from guidance_app.estimation.reference_point import carried, offset_point
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.coverage import Coverage
from guidance_app.guidance.family import GuidanceLineError, Learner, ParallelLines, PassFamily
from guidance_app.guidance.pass_work import PassWork
from guidance_app.guidance.request import PlanError
from guidance_app.guidance.straight import StraightStretch
from guidance_app.guidance.tracking import Tracker
from guidance_app.guidance.trail import TrackTrail
from guidance_app.guidance.turning import Turning, turning_of
from guidance_app.guidance.work import WorkSwitch
from guidance_app.language import message, sentence
from guidance_app.model import (
    BeginLine,
    Command,
    CoverageTotals,
    DropLine,
    DropOffset,
    EndLine,
    Guidance,
    LineBegun,
    LineHere,
    LineKind,
    Nudge,
    OffsetRecord,
    Pose,
    Prediction,
    ReplanRest,
    ReverseDirection,
    SetSection,
    SetWork,
    SetWorkMode,
    SkipPass,
    Snapshot,
    TakePass,
)

__all__ = ["WorkDone"]

TOO_FAR = message("The line cannot be moved there: it would leave its place, or be moved by more than 1000 m.")

SHOW_AGAIN_AFTER = 6
"""Without a field the shown lines are renewed when the target is so many passes from their middle."""


class WorkDone:
    """Remembers the work of one session. ``fork`` shares what cannot change."""

    def __init__(self, job: Job) -> None:
        self._job = job
        self._ground = ground_of(job)
        self._version = 1
        self._shown_around = 0
        self._stretch = StraightStretch()
        self._drawing: LineDrawing | None = None
        self._tracker: Tracker | None = None
        self._switch = WorkSwitch(job.implement.working_width)
        self._track = TrackTrail()
        self._pass_work = PassWork(self._behind, job.implement.sections)
        self._guidance: Guidance | None = None
        self._turning: Turning | None = None
        self._guided: tuple[Pose, tuple[float, float]] | None = None
        self._mask = (1 << job.implement.sections) - 1
        self._sections = (True,) * job.implement.sections
        self._later: frozenset[int] = frozenset()
        plan = None if self._ground is None else self._ground.plan
        if plan is not None:
            self._tracker = Tracker(plan, plan.spacing, behind=self._behind)
        self._coverage = Coverage(
            job.implement.working_width,
            field=None if self._ground is None else self._ground.polygon,
            mainland=mainland_of(plan),
            sections=job.implement.sections,
        )

    @property
    def frame(self) -> FieldFrame | None:
        """The field's frame; None until ``begin_at`` when there is no field."""
        return None if self._ground is None else self._ground.frame

    def begin_at(self, frame: FieldFrame) -> None:
        """Without a field, the ground begins at the first fix."""
        self._ground = Ground(frame)

    def fork(self) -> "WorkDone":
        """An independent copy."""
        other = copy.copy(self)
        vars(other).update(
            _stretch=self._stretch.fork(),
            _drawing=None if self._drawing is None else self._drawing.fork(),
            _tracker=None if self._tracker is None else self._tracker.fork(),
            _track=self._track.fork(),
            _pass_work=self._pass_work.fork(),
            _coverage=self._coverage.fork(),
        )
        return other

    def step(self, pose: Pose, implement: tuple[float, float, float], *, reported: bool | None, counted: bool) -> None:
        """One pose further: along which pass, is the implement down, what has it worked.

        While nothing is to be counted the implement is taken as lifted, whatever switches it.
        """
        guided = self._guided_point(pose, implement)
        self._guided = pose, guided
        if self._drawing is not None:
            self._drawing.step(guided)
        elif self._tracker is None:
            self._look_for_a_line(pose)
        if self._tracker is not None:
            self._guide(self._tracker, pose, guided)
            self._show_around_target()
        if counted:
            line_driven = self._line_begun is not None
            self._switch = self._switch.after(pose, self._guidance, reported, line_driven=line_driven)
        number = None if self._guidance is None else self._guidance.target.number
        self._coverage.step(implement, pose.t, self._working, number, self._mask)
        self._pass_work.step(self._guidance, self._mask if self._working else 0)
        self._track.step(pose.t, pose.east, pose.north, pose.heading)

    @property
    def _behind(self) -> float:
        """How far the work lies behind the guided point: a pass is driven on until the implement is at its end."""
        implement = self._job.implement
        if self._job.settings.guide_implement:
            return 0.0
        if implement.hitch is HitchKind.TRAILED:
            return implement.hitch_back + implement.drawbar
        return implement.offset_back

    def _guide(self, tracker: Tracker, pose: Pose, point: tuple[float, float]) -> None:
        """Guidance along the target, and along the turn that leads there; none while another line is drawn."""
        if self._drawing is not None:
            self._guidance = self._turning = None
            return
        guidance = tracker.step(pose, point, self._working)
        self._turning = turning_of(self._turning, guidance, pose, point)
        if self._turning is not None and guidance is not None and guidance.turn is not None:
            guidance = replace(guidance, turn=self._turning.shown(guidance.turn, pose.heading))
        self._guidance = guidance

    def _guided_point(self, pose: Pose, implement: tuple[float, float, float]) -> tuple[float, float]:
        """The implement's working point, or the point of the rear axle's line that runs ahead of it on the pass."""
        if self._job.settings.guide_implement:
            return implement[:2]
        return offset_point(pose.east, pose.north, pose.heading, 0.0, self._job.implement.offset_right)

    def lift(self) -> None:
        """Lifts the implement; how it is switched stays as it is."""
        self._switch = self._switch.lifted()

    def end(self) -> None:
        """The drive is over: nothing works and nothing is guided."""
        self.lift()
        self._guidance = self._tracker = self._turning = None

    @property
    def _working(self) -> bool:
        """Whether anything works: the implement is down and not all of its sections are switched off."""
        return self._switch.down and self._mask != 0

    def command(self, command: Command, arrival: float) -> str | None:
        """Does what the driver wishes, or says in a sentence why it cannot be done."""
        match command:
            case SetWork():
                self._switch = self._switch.pressed(down=command.down)
            case SetWorkMode():
                self._switch = self._switch.with_mode(command.mode)
            case SetSection():
                return self._switch_section(command)
            case BeginLine() | EndLine() | DropLine():
                return self._draw_line(command)
            case _:
                return self._line_command(command, arrival)
        return None

    def _draw_line(self, command: BeginLine | EndLine | DropLine) -> str | None:
        """A guidance line of the driver's own, instead of the first straight stretch."""
        if self._ground is None or self._guided is None:
            return sentence("Not yet: there is no position.")
        if self._ground.plan is not None:
            return sentence("This drive follows a plan: start one without a plan to draw a line.")
        pose, point = self._guided
        spacing = self._job.implement.spacing
        try:
            match command:
                case BeginLine() if command.kind in AT_ONCE:
                    heading = pose.heading if command.heading_deg is None else math.radians(command.heading_deg)
                    self._guide_beside(line_at_once(command.kind, point, heading, spacing))
                case BeginLine():
                    self._drawing = LineDrawing(command.kind, point)
                case EndLine():
                    if self._drawing is None:
                        return sentence("No line has been begun: press A first.")
                    self._guide_beside(self._drawing.family(point, spacing))
                case DropLine():
                    self._drawing = None
        except GuidanceLineError as error:
            return error.args[0] if isinstance(error.args[0], str) else str(error)
        return None

    def _guide_beside(self, family: PassFamily) -> None:
        """These passes instead of what was guided along before; offsets belong to the old ones and go with them."""
        assert self._ground is not None
        self._drawing = None
        self._ground = ground_with(self._ground, family)
        self._tracker = Tracker(family, self._job.implement.spacing, field=self._ground.polygon, behind=self._behind)
        self._guidance = self._turning = None
        self._shown_around = 0
        self._version += 1

    def _switch_section(self, command: SetSection) -> str | None:
        count = self._job.implement.sections
        if command.number > count:
            return sentence(
                "There is no section {number}: the implement has {count}.", number=command.number, count=count
            )
        bit = 1 << (command.number - 1)
        self._mask = self._mask | bit if command.on else self._mask & ~bit
        self._sections = tuple(bool(self._mask >> place & 1) for place in range(count))
        return None

    def _line_command(self, command: Command, arrival: float) -> str | None:
        tracker = self._tracker
        if tracker is None:
            return sentence("There is no line yet: drive a first straight stretch.")
        refused = self._obey(tracker, command, arrival)
        if refused is not None:
            return refused
        if self._guided is not None:
            self._guide(tracker, *self._guided)
        self._version += 1
        return None

    def _obey(self, tracker: Tracker, command: Command, arrival: float) -> str | None:
        otherwise: str
        match command:
            case TakePass() | SkipPass() | ReverseDirection():
                return self._change_pass(tracker, command)
            case Nudge():
                done, otherwise = tracker.shift(command.metres, command.kind, arrival), TOO_FAR
            case LineHere():
                done = self._guided is not None and tracker.line_here(self._guided[1], arrival)
                otherwise = TOO_FAR
            case DropOffset():
                done, otherwise = tracker.drop(command.kind), TOO_FAR
            case ReplanRest():
                return self._plan_rest(tracker)
            case _:
                msg = f"{type(command).__name__} is not a command about lines"
                raise TypeError(msg)
        return None if done else otherwise

    def _change_pass(self, tracker: Tracker, command: TakePass | SkipPass | ReverseDirection) -> str | None:
        """Another pass or another way round; with a plan the rest follows it, unless that pass is done already."""
        match command:
            case TakePass():
                if not tracker.take(command.number):
                    return sentence("There is no line {number}.", number=command.number)
                self._later -= {command.number}
                if command.number in tracker.done:
                    return None
            case SkipPass():
                left = None if self._guidance is None else self._guidance.target.number
                if left is None or not tracker.skip():
                    return sentence("There is no other line to go on with.")
                self._later |= {left}
            case ReverseDirection():
                if not tracker.reverse():
                    return sentence("There is no line yet to be driven the other way.")
        if self._ground is None or self._ground.plan is None or self._guided is None:
            return None
        return self._plan_rest(tracker)

    def _plan_rest(self, tracker: Tracker) -> str | None:
        """Plans what is left from where the tractor is; the pass being worked stays the target."""
        if self._ground is None or self._guided is None:
            return sentence("Not yet: there is no position to plan from.")
        standing = replace(tracker.standing(*self._guided), later=self._later)
        try:
            ground = rest_of(self._ground, tracker.done, standing)
        except PlanError as error:
            return sentence("The rest cannot be planned: {reason}.", reason=error.args[0])
        if ground is None or ground.plan is None:
            return sentence("There is no plan: lines are driven as they come.")
        tracker.follow(ground.plan)
        self._ground = ground
        return None

    def ahead(self, prediction: Prediction) -> Prediction:
        """The prediction with its errors against the turn being driven or the target pass, when there is one."""
        if self._tracker is None or self._guided is None or self._guidance is None:
            return prediction
        later = prediction.pose
        point = carried(self._guided[1], self._guided[0], later)
        errors = None
        if self._turning is not None:
            errors = self._turning.errors_at(point, later.heading, math.dist(point, self._guided[1]))
        errors = errors or self._tracker.errors_at(*point, later.heading)
        if errors is None:
            return prediction
        return Prediction(
            prediction.look_ahead_s, later, prediction.arc, cross_track=errors[0], heading_error=errors[1]
        )

    @property
    def notices(self) -> tuple[str, ...]:
        """What the driver should know of field and plan."""
        return () if self._ground is None else self._ground.notices

    def shown_since(self, snapshot: Snapshot, marks: tuple[OffsetRecord, ...]) -> dict[str, Any]:
        """The members of a snapshot that all this makes; the ground only where ``snapshot`` shows an older one."""
        lines = () if self._tracker is None else self._tracker.offsets
        shown: dict[str, Any] = {
            "guidance": self._guidance,
            "working": self._working,
            "sections": self._sections,
            "line_begun": self._line_begun,
            "work_mode": self._switch.mode,
            "totals": self._coverage.totals,
            "pass_totals": self._pass_totals,
            "track": self._track.trail,
            "worked": self._coverage.worked,
            "offsets": (*marks, *lines),
        }
        ground = self._ground
        if ground is not None and snapshot.ground_version != self._version:
            shown |= {
                "origin_deg": (ground.frame.latitude_deg, ground.frame.longitude_deg),
                "field_rings": ground.rings,
                "passes": ground.passes if self._tracker is None else self._tracker.moved(ground.passes),
                "plan": ground.plan,
                "ground_version": self._version,
            }
        return shown

    @property
    def _line_begun(self) -> LineBegun | None:
        """The line that is being drawn, or the first pass that the next ones will follow."""
        if self._drawing is not None:
            return self._drawing.begun
        family = None if self._ground is None else self._ground.family
        return LineBegun(LineKind.FOLLOW) if isinstance(family, Learner) and not family.lines else None

    @property
    def _pass_totals(self) -> CoverageTotals | None:
        """Of the target pass; what is left of it is what was driven by and not worked."""
        if self._guidance is None:
            return None
        missed = self._pass_work.missed * self._job.implement.working_width
        return self._coverage.of_pass(self._guidance.target.number, missed)

    def _look_for_a_line(self, pose: Pose) -> None:
        stretch = self._stretch.step(pose)
        if stretch is None or self._ground is None:
            return
        self._guide_beside(ParallelLines(*stretch, self._job.implement.spacing))

    def _show_around_target(self) -> None:
        """Without a plan the shown lines follow the tractor, and what was learned from the last pass."""
        ground, guidance = self._ground, self._guidance
        family = None if self._tracker is None else self._tracker.family
        if ground is None or family is None or guidance is None:
            return
        number = guidance.target.number
        if family is not ground.family or abs(number - self._shown_around) > SHOW_AGAIN_AFTER:
            self._shown_around = number
            self._ground = replace(ground, family=family, passes=shown_beside(family, number))
            self._version += 1
