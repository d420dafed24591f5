"""The first heading: from a heading sensor, from the receiver's course, or from the way the first fixes go.

A filter that starts with a guessed heading spins. Here it waits: at once with a heading sensor, two agreeing courses
above 0.5 m/s, or fixes of the last 6 s that lie on one straight, evenly driven way of at least half a metre and two and
a half cells. The oldest are dropped until the rest does, so an outlier among the first fixes, or a standstill before
the tractor moved off, costs a moment and not the heading.
"""

import math
from dataclasses import dataclass

import numpy as np

from guidance_app.angles import wrap_pi
from guidance_app.estimation.receiver_noise import DEFAULT_CELL, fix_covariance
from guidance_app.model import Measurement, Pose

__all__ = ["Departure", "Waiting", "without_heading"]

WINDOW = 6.0
SHORTEST = 0.5
CELLS = 2.5
DRIVING = 0.5
AGREEING = math.radians(20)
SENSOR_SD = math.radians(2.0)
FASTEST = 20.0
FASTEST_BACK = 3.0
"""Nobody backs up faster, in m/s."""
REVERSAL = math.radians(110)
"""In the few seconds of being lost no tractor turns as far."""


def without_heading(z: Measurement, *, standing: bool = False) -> Pose:
    """What the first fixes say: a position, and that the heading is not known."""
    return Pose(
        z.t,
        z.arrival,
        z.east,
        z.north,
        heading=0.0,
        speed=z.speed or 0.0,
        covariance=fix_covariance(z),
        heading_known=False,
        standing=standing,
        roll=z.roll,
        pitch=z.pitch,
    )


@dataclass(frozen=True, slots=True)
class Departure:
    """The first heading and speed, with their standard deviations."""

    heading: float
    heading_sd: float
    speed: float
    speed_sd: float

    def as_before(self, heading: float) -> "Departure":
        """The same way, driven backwards if it leads away from where the body pointed a moment ago."""
        if abs(wrap_pi(self.heading - heading)) < REVERSAL or self.speed > FASTEST_BACK:
            return self
        return Departure(wrap_pi(self.heading + math.pi), self.heading_sd, -self.speed, self.speed_sd)


@dataclass(frozen=True, slots=True)
class Waiting:
    """The last seconds' measurements, until they tell a heading."""

    seen: tuple[Measurement, ...] = ()

    def to(self, z: Measurement) -> "Waiting":
        """With one more measurement."""
        return Waiting((*(old for old in self.seen if old.t >= z.t - WINDOW), z)[-100:])

    def departure(self, white: float) -> Departure | None:
        """The first heading if it can be told; ``white`` is the fixes' scatter in metres."""
        z = self.seen[-1]
        if z.heading is not None:
            speed = 0.0 if z.speed is None else z.speed
            if z.course is not None and abs(wrap_pi(z.course - z.heading)) > math.pi / 2:
                speed = -speed
            return Departure(z.heading, z.heading_sigma or SENSOR_SD, speed, 0.1 if z.speed is not None else 1.0)
        if z.speed is not None:
            return self._by_course()
        return self._by_way(white)

    def _by_course(self) -> Departure | None:
        if len(self.seen) < 2:
            return None
        before, z = self.seen[-2:]
        if z.speed is None or z.course is None or before.speed is None or before.course is None:
            return None
        agree = abs(wrap_pi(z.course - before.course)) < AGREEING
        if not agree or min(z.speed, before.speed) < DRIVING:
            return None
        return Departure(z.course, 0.1 / z.speed + 0.02, z.speed, 0.1)

    def _by_way(self, white: float) -> Departure | None:
        cell = max(self.seen[-1].cell or (DEFAULT_CELL,))
        needed = max(SHORTEST, CELLS * cell, 8.0 * white)
        scatter = 0.5 * cell + 2.0 * white
        newest = self.seen[-1]
        t = np.array([z.t - newest.t for z in self.seen])
        place = np.array([(z.east - newest.east, z.north - newest.north) for z in self.seen])
        for first in range(max(0, len(t) - 30), len(t) - 2):
            if math.hypot(*place[first]) < needed:
                continue
            middle = t[first:].mean()
            spread = float(((t[first:] - middle) ** 2).sum())
            velocity = ((t[first:] - middle) @ place[first:]) / spread
            rest = place[first:] - place[first:].mean(axis=0) - np.outer(t[first:] - middle, velocity)
            speed = math.hypot(*velocity)
            far = -float(t[first]) * speed
            if float(np.abs(rest).max()) <= 2.0 * scatter and needed <= far and speed < FASTEST:
                heading = math.atan2(velocity[0], velocity[1])
                return Departure(heading, math.hypot(scatter / far, 0.1), speed, 0.15 + 0.2 * speed)
        return None
