"""Standing at the start point for the measuring time: what the receiver's offset and the sensors' scatter are.

Inoue et al.: "the system is initialized: calculate initial offset error of GPS and covariance matrix of error of GPS
and gyroscope". The mean of the fixes against the known start point is the position correction; the fixes' sample
covariance becomes R; the gyro's mean rate is its bias. If the tractor moves it starts again and says so: half a minute
of driving would be averaged into an offset that nobody would find.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from guidance_app.estimation.filter import Start
from guidance_app.estimation.receiver_noise import DEFAULT_CELL, noise_of
from guidance_app.estimation.reference_point import offset_point
from guidance_app.language import sentence
from guidance_app.model import Measurement

__all__ = ["Initialisation", "Progress"]

FEWEST = 5
"""Fewer fixes than this give no covariance worth the name."""
MOVING_SPEED = 0.3
"""A receiver that says it is faster than this, in m/s, is on a moving tractor."""
TURNING_RATE = math.radians(3)
"""A yaw rate above this, in rad/s, is a turning tractor; a gyro's bias is below 1 degree a second."""
WANDER = 0.6
"""A standing receiver's fixes stay within this many metres of their first, and its cell and scatter."""


@dataclass(frozen=True, slots=True)
class Progress:
    """How far the initialisation is. ``done`` from 0 to 1; ``refused`` says why it had to begin again."""

    done: float
    samples: int
    refused: str | None = None
    start: Start | None = None


@dataclass(frozen=True, slots=True)
class Initialisation:
    """Averages at the start point. A frozen record: ``with_measurement`` gives the next one.

    ``known`` is where the reference point really is, (east, north) in the field frame, None when that is not known.
    ``heading`` turns the antenna's lever arm; without it the arm must be short against what is wanted. A measuring
    time of zero is done at once and corrects nothing.
    """

    measuring_time: float
    known: tuple[float, float] | None = None
    heading: float | None = None
    seen: tuple[Measurement, ...] = ()
    refused: str | None = None

    def with_measurement(self, z: Measurement) -> "Initialisation":
        """After one more epoch. One that shows the tractor moving begins the measuring time again."""
        if self.finished or (self.seen and z.t <= self.seen[-1].t):
            return self
        reason = self._moving(z)
        if reason is not None:
            return replace(self, seen=(), refused=reason)
        refused = self.refused if len(self.seen) < FEWEST else None
        return replace(self, seen=(*self.seen, z), refused=refused)

    @property
    def finished(self) -> bool:
        """Whether the measuring time is over and there were fixes enough."""
        if self.measuring_time <= 0.0:
            return True
        return len(self.seen) >= FEWEST and self._elapsed >= self.measuring_time

    @property
    def progress(self) -> Progress:
        """What to show, and the result once it is there."""
        share = 1.0 if self.finished else min(self._elapsed / self.measuring_time, 1.0)
        return Progress(share, len(self.seen), self.refused, self._start() if self.finished else None)

    @property
    def _elapsed(self) -> float:
        return self.seen[-1].t - self.seen[0].t if self.seen else 0.0

    def _moving(self, z: Measurement) -> str | None:
        if z.speed is not None and z.speed > MOVING_SPEED:
            return sentence(
                "the tractor moves at {speed:.1f} km/h: stand still at the start point", speed=3.6 * z.speed
            )
        if z.yaw_rate is not None and abs(z.yaw_rate) > TURNING_RATE:
            return sentence("the tractor turns: stand still at the start point")
        if not self.seen:
            return None
        first = self.seen[0]
        away = math.hypot(z.east - first.east, z.north - first.north)
        allowed = WANDER + max(z.cell or (DEFAULT_CELL,)) + 4.0 * noise_of(z).white
        if away > allowed:
            return sentence("the fix has moved by {away:.1f} m: stand still at the start point", away=away)
        if z.quality != first.quality:
            return sentence("the kind of fix has changed: measuring again")
        return None

    def _start(self) -> Start:
        if not self.seen:
            return Start(0.0, 0.0, (0.0, 0.0, 0.0), None, None, 0.0, 0)
        fixes = np.array([self._reference(z) for z in self.seen])
        mean = fixes.mean(axis=0)
        cell = self.seen[0].cell or (DEFAULT_CELL, DEFAULT_CELL)
        spread = np.cov(fixes.T) + np.diag([cell[0] ** 2 / 12, cell[1] ** 2 / 12])
        rates = [z.yaw_rate for z in self.seen if z.yaw_rate is not None]
        enough = len(rates) >= FEWEST
        correction = (0.0, 0.0)
        if self.known is not None:
            correction = (self.known[0] - float(mean[0]), self.known[1] - float(mean[1]))
        return Start(
            east=correction[0],
            north=correction[1],
            covariance=(float(spread[0, 0]), float(spread[0, 1]), float(spread[1, 1])),
            gyro_bias=float(np.mean(rates)) if enough else None,
            gyro_sigma=float(np.std(rates, ddof=1)) if enough else None,
            seconds=self._elapsed,
            samples=len(self.seen),
        )

    def _reference(self, z: Measurement) -> tuple[float, float]:
        """The reference point of a fix, where a heading is known; else the antenna."""
        heading = z.heading if z.heading is not None else self.heading
        if heading is None:
            return z.east, z.north
        return offset_point(z.east, z.north, heading, -z.antenna[0], -z.antenna[1])
