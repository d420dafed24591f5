"""What has been driven and worked, and along what: ground, tracker, implement switch, coverage and trails together.

They belong together because they begin together: with the field when there is one, else with the first fix, and with
the first straight stretch when there is no plan. Like the engine this only sequences.
"""

import copy
from dataclasses import replace
from typing import Any

from guidance_app.documents import HitchKind, Job
from guidance_app.engine.ground import Ground, ground_beside, ground_of, mainland_of, shown_beside
from guidance_app.estimation.reference_point import carried, offset_point
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.coverage import Coverage
from guidance_app.guidance.straight import StraightStretch
from guidance_app.guidance.tracking import Tracker
from guidance_app.guidance.trail import TrackTrail
from guidance_app.guidance.work import WorkSwitch
from guidance_app.model import (
    Command,
    DropOffset,
    Guidance,
    LineHere,
    Nudge,
    OffsetRecord,
    Pose,
    Prediction,
    ReverseDirection,
    SetWork,
    SetWorkMode,
    SkipPass,
    Snapshot,
    TakePass,
)

__all__ = ["WorkDone"]

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
        self._tracker: Tracker | None = None
        self._switch = WorkSwitch(job.implement.working_width)
        self._track = TrackTrail()
        self._guidance: Guidance | None = None
        self._guided: tuple[Pose, tuple[float, float]] | None = None
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
            _tracker=None if self._tracker is None else self._tracker.fork(),
            _track=self._track.fork(),
            _coverage=self._coverage.fork(),
        )
        return other

    def step(self, pose: Pose, implement: tuple[float, float, float], *, reported: bool | None) -> None:
        """One pose further: along which pass, is the implement down, what has it worked."""
        if self._tracker is None:
            self._look_for_a_line(pose)
        guided = self._guided_point(pose, implement)
        self._guided = pose, guided
        if self._tracker is not None:
            self._guidance = self._tracker.step(pose, guided, self._switch.down)
            self._show_around_target()
        self._switch = self._switch.after(pose, self._guidance, reported)
        number = None if self._guidance is None else self._guidance.target.number
        self._coverage.step(implement, pose.t, self._switch.down, number)
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

    def _guided_point(self, pose: Pose, implement: tuple[float, float, float]) -> tuple[float, float]:
        """The implement's working point, or the point of the rear axle's line that runs ahead of it on the pass."""
        if self._job.settings.guide_implement:
            return implement[:2]
        return offset_point(pose.east, pose.north, pose.heading, 0.0, self._job.implement.offset_right)

    def command(self, command: Command, arrival: float) -> None:
        """The driver's wish. Without a line, wishes about lines have nothing to act on and change nothing."""
        match command:
            case SetWork():
                self._switch = self._switch.pressed(down=command.down)
            case SetWorkMode():
                self._switch = self._switch.with_mode(command.mode)
            case _:
                if self._tracker is not None:
                    self._line_command(self._tracker, command, arrival)

    def _line_command(self, tracker: Tracker, command: Command, arrival: float) -> None:
        match command:
            case TakePass():
                tracker.take(command.number)
            case SkipPass():
                tracker.skip()
            case ReverseDirection():
                tracker.reverse()
            case Nudge():
                tracker.shift(command.metres, command.kind, arrival)
            case LineHere():
                if self._guided is not None:
                    tracker.line_here(self._guided[1], arrival)
            case DropOffset():
                tracker.drop(command.kind)
            case _:
                msg = f"{type(command).__name__} is not a command about lines"
                raise TypeError(msg)
        if self._guided is not None:
            self._guidance = tracker.step(*self._guided, self._switch.down)
        self._version += 1

    def ahead(self, prediction: Prediction) -> Prediction:
        """The prediction with its errors against the target pass, when there is one."""
        if self._tracker is None or self._guided is None:
            return prediction
        later = prediction.pose
        point = carried(self._guided[1], self._guided[0], later)
        errors = self._tracker.errors_at(*point, later.heading)
        return prediction if errors is None else replace(prediction, cross_track=errors[0], heading_error=errors[1])

    @property
    def notices(self) -> tuple[str, ...]:
        """What the driver should know of field and plan."""
        return () if self._ground is None else self._ground.notices

    def shown_since(self, snapshot: Snapshot, marks: tuple[OffsetRecord, ...]) -> dict[str, Any]:
        """The members of a snapshot that all this makes; the ground only where ``snapshot`` shows an older one."""
        lines = () if self._tracker is None else self._tracker.offsets
        shown: dict[str, Any] = {
            "guidance": self._guidance,
            "working": self._switch.down,
            "work_mode": self._switch.mode,
            "totals": self._coverage.totals,
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

    def _look_for_a_line(self, pose: Pose) -> None:
        stretch = self._stretch.step(pose)
        if stretch is None or self._ground is None:
            return
        self._ground = ground_beside(self._ground, stretch, self._job.implement.spacing)
        self._version += 1
        if self._ground.family is not None:
            field = self._ground.polygon
            spacing = self._job.implement.spacing
            self._tracker = Tracker(self._ground.family, spacing, field=field, behind=self._behind)

    def _show_around_target(self) -> None:
        """Without a field the shown lines follow the tractor."""
        ground, guidance = self._ground, self._guidance
        if ground is None or ground.family is None or guidance is None:
            return
        number = guidance.target.number
        if abs(number - self._shown_around) > SHOW_AGAIN_AFTER:
            self._shown_around = number
            self._ground = replace(ground, passes=shown_beside(ground.family, number))
            self._version += 1
