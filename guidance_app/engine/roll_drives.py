"""The two drives of a calibration of the roll sensor's zero, and what comes out. Values; nothing acts by itself."""

import math
from dataclasses import dataclass, replace

from guidance_app.documents import Tractor
from guidance_app.estimation.roll_zero import SHORTEST, CalibrationError, roll_zero
from guidance_app.language import sentence
from guidance_app.model import Pose, RollZeroFound, RollZeroProgress, RollZeroStage

__all__ = ["RollDrives", "begun"]

POSE_EVERY = 0.25
"""Metres between two poses that are kept."""

LONGEST = 2000.0
"""Metres of one drive that are kept."""

LARGEST_DEG = 15.0
"""The tractor document's bound."""


@dataclass(frozen=True, slots=True)
class _Drive:
    poses: tuple[Pose, ...] = ()
    metres: float = 0.0

    def with_pose(self, pose: Pose) -> "_Drive":
        if not pose.heading_known or pose.standing or pose.speed <= 0.0 or self.metres >= LONGEST:
            return self
        if not self.poses:
            return _Drive((pose,))
        last = self.poses[-1]
        moved = math.hypot(pose.east - last.east, pose.north - last.north)
        return self if moved < POSE_EVERY else _Drive((*self.poses, pose), self.metres + moved)


@dataclass(frozen=True, slots=True)
class RollDrives:
    """A calibration under way."""

    stage: RollZeroStage = RollZeroStage.THERE
    there: _Drive = _Drive()
    back: _Drive = _Drive()
    found: RollZeroFound | None = None

    def with_pose(self, pose: Pose) -> "RollDrives":
        """After one more pose, before any position offset."""
        match self.stage:
            case RollZeroStage.THERE:
                drive = self.there.with_pose(pose)
                return self if drive is self.there else replace(self, there=drive)
            case RollZeroStage.BACK:
                drive = self.back.with_pose(pose)
                return self if drive is self.back else replace(self, back=drive)
            case RollZeroStage.FOUND:
                return self

    def turned(self) -> "RollDrives | str":
        """On to the way back; a sentence when the first drive is too short."""
        if self.stage is not RollZeroStage.THERE:
            return sentence("The second drive has already begun.")
        if self.there.metres < SHORTEST:
            return sentence(
                "The first drive is {metres:.0f} m long; {needed:.0f} m are needed. Drive on.",
                metres=self.there.metres,
                needed=SHORTEST,
            )
        return replace(self, stage=RollZeroStage.BACK)

    def finished(self, tractor: Tractor) -> "RollDrives | str":
        """With what the two drives say; a sentence when they say nothing. They may then be driven on."""
        if self.stage is not RollZeroStage.BACK:
            return sentence("Drive the same line back first.")
        try:
            found = roll_zero(list(self.there.poses), list(self.back.poses), tractor.antenna_height)
        except CalibrationError as error:
            return sentence("No roll zero: {reason}.", reason=error.args[0])
        zero = tractor.roll_zero_deg + found.correction_deg
        if abs(zero) > LARGEST_DEG:
            return sentence("A roll zero of {zero:.1f}° is no mounting: level the sensor and begin again.", zero=zero)
        result = RollZeroFound(zero, found.correction_deg, found.sigma_deg, found.metres)
        return replace(self, stage=RollZeroStage.FOUND, found=result)

    @property
    def shown(self) -> RollZeroProgress:
        """What a screen shows."""
        return RollZeroProgress(self.stage, self.there.metres, self.back.metres, self.found)


def begun(tractor: Tractor, raw: Pose | None) -> RollDrives | str:
    """A calibration from now on; a sentence when there is nothing to calibrate."""
    if tractor.antenna_height < 0.5:
        return sentence(
            "An antenna {height:g} m above the ground hardly moves with the roll.", height=tractor.antenna_height
        )
    if raw is None or raw.roll is None:
        return sentence("No roll sensor speaks: there is nothing to calibrate.")
    return RollDrives()
