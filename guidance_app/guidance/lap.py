"""A headland lap: a closed line, or one with corners at which the machine backs up along the next side.

A lap may be begun anywhere on its line.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from guidance_app.guidance.ring import Ring
from guidance_app.guidance.turn import Leg, Turn, leg_of
from guidance_app.model import FloatArray

__all__ = ["Corner", "Lap", "Side"]

SHORTEST = 0.1
"""Metres; a shorter rest of a corner is not drawn."""

BENT = 0.1
"""Radians; a line that turns by less is straight enough to begin and end a lap on."""


@dataclass(frozen=True, slots=True, eq=False)
class Corner:
    """Where a lap's side ends and the next begins.

    The implement is lifted at ``lift`` and the corner passed at ``end``, metres along the lap (``lift`` may lie before
    its seam); ``back`` (N, 2) leads from the corner's end back to where the next side begins.
    """

    lift: float
    end: float
    back: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """A stretch to work, shape (N, 2), and the turn that leads to it from the side before; None for the first."""

    points: FloatArray
    closed: bool
    approach: Turn | None


@dataclass(frozen=True, slots=True, eq=False)
class Lap:
    """One ring to drive.

    ``place`` counts from the boundary, from 0; ``nest`` says which of the ground's rings is the nearest, 0 for the
    outer boundary.
    """

    place: int
    nest: int
    line: Ring
    corners: tuple[Corner, ...]

    @property
    def points(self) -> FloatArray:
        """Shape (N, 2), the first point not repeated."""
        return self.line.points

    def poses(self, step: float, ahead: float, out: float) -> tuple[FloatArray, FloatArray]:
        """Poses (M, 3) at which the lap may be begun, and how far along each is.

        Not where the implement is up, nor so short of it that there are no ``ahead`` metres to work before; nor in a
        bend: where a lap is begun it also ends, and the tractor runs ``out`` metres straight on. Where that leaves
        nothing, anywhere on a side.
        """
        everywhere = self.line.places(step)
        for metres, straight in ((ahead, True), (ahead, False), (0.0, False)):
            along = everywhere
            for corner in self.corners:
                before_lift = np.mod(corner.lift - along, self.line.length)
                raised = np.mod(corner.end - along, self.line.length) <= corner.end - corner.lift
                along = along[(before_lift >= metres) & ~raised]
            if straight:
                along = along[self._bend(along, out) < BENT]
            if len(along):
                break
        return self.line.poses(along), along

    def _bend(self, along: FloatArray, out: float) -> FloatArray:
        """Radians by which the line turns over ``out`` metres from each place (M,)."""
        turned = self.line.poses(along + out)[:, 2] - self.line.poses(along)[:, 2]
        bend: FloatArray = np.abs(np.mod(turned + np.pi, 2 * np.pi) - np.pi)
        return bend

    def sides_from(self, begin: float) -> Iterator[Side]:
        """The sides in driving order when the lap is begun at ``begin`` metres along its line."""
        if not self.corners:
            yield Side(self.line.stretch(begin, begin)[:-1], closed=True, approach=None)
            return
        first = next((place for place, corner in enumerate(self.corners) if corner.lift >= begin), 0)
        corners = [*self.corners[first:], *self.corners[:first]]
        yield Side(self.line.stretch(begin, corners[0].lift), closed=False, approach=None)
        for corner, following in zip(corners, [*corners[1:], None], strict=True):
            target = begin if following is None else following.lift
            points = np.vstack([corner.back[:0:-1], self.line.stretch(corner.end, target)])
            yield Side(points, closed=False, approach=self._round(corner))

    def _round(self, corner: Corner) -> Turn:
        """The rest of the corner with the implement up, then straight back to where the next side begins."""
        legs: list[Leg] = []
        if corner.end - corner.lift > SHORTEST:
            legs.append(leg_of(self.line.stretch(corner.lift, corner.end), reverse=False))
        legs.append(leg_of(corner.back, reverse=True))
        return Turn(tuple(legs), sum(leg.length for leg in legs))
