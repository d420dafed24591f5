"""When the implement works: on the pass by itself, by the driver's button, by speed, or by its own switch.

By itself it works too while the pass is driven from which a guidance line is made, wherever that leads.

Each way has its own hysteresis, so that an implement on the edge of a rule does not flutter: it goes down under the
narrow condition and comes up only outside the wide one.
"""

import math
from dataclasses import dataclass, replace
from typing import assert_never

from guidance_app.model import Guidance, Pose, WorkMode

__all__ = ["WorkSwitch"]

SLOWEST_WORK = 0.3
"""Nobody works below this speed (m/s)."""
STOPPED = 0.1
"""Work goes on above this speed (m/s) once it has begun."""
STRAIGHT, TURNED = math.radians(20.0), math.radians(40.0)
"""Heading errors below which work begins, and above which it ends."""
NEAR, FAR = 0.5, 0.75
"""The same for the cross-track error, in parts of the working width."""


@dataclass(frozen=True, slots=True)
class WorkSwitch:
    """Whether the implement is down. A value: each step gives the next one."""

    width: float
    mode: WorkMode = WorkMode.AUTO
    down: bool = False
    button: bool = False

    def pressed(self, *, down: bool) -> "WorkSwitch":
        """The driver's button; whoever presses it decides from then on."""
        return replace(self, button=down, down=down, mode=WorkMode.BUTTON)

    def with_mode(self, mode: WorkMode) -> "WorkSwitch":
        """Another way of deciding. The implement stays as it is until that way says otherwise."""
        return replace(self, mode=mode, button=self.down)

    def lifted(self) -> "WorkSwitch":
        """Lifted for now; the same way of deciding."""
        return replace(self, button=False, down=False)

    def after(
        self, pose: Pose | None, guidance: Guidance | None, reported: bool | None, *, line_driven: bool = False
    ) -> "WorkSwitch":
        """The switch after one more fix. ``reported`` is what the implement's own switch says, None if nothing.

        ``line_driven`` while a guidance line is made by driving it: there is no pass yet to be on.
        """
        match self.mode:
            case WorkMode.BUTTON:
                down = self.button
            case WorkMode.SWITCH:
                down = self.down if reported is None else reported
            case WorkMode.SPEED:
                down = pose is not None and _moves(pose, working=self.down)
            case WorkMode.AUTO:
                down = pose is not None and self._on_the_pass(pose, guidance, line_driven=line_driven)
            case _:
                assert_never(self.mode)
        return self if down == self.down else replace(self, down=down)

    def _on_the_pass(self, pose: Pose, guidance: Guidance | None, *, line_driven: bool) -> bool:
        if pose.reverse or not _moves(pose, working=self.down):
            return False
        if line_driven:
            return True
        if guidance is None or not guidance.on_pass:
            return False
        turn = TURNED if self.down else STRAIGHT
        side = (FAR if self.down else NEAR) * self.width
        return abs(guidance.heading_error) <= turn and abs(guidance.cross_track) <= side


def _moves(pose: Pose, *, working: bool) -> bool:
    return pose.speed >= (STOPPED if working else SLOWEST_WORK)
