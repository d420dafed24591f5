"""A person at the wheel: predictive steering after Inoue et al., equations 22 to 24, and a person's imperfections.

The wanted heading leads back to the target line along ``x exp(-p y)``, so that ``tan(theta) = -p x`` (equation 23);
predictive steering asks for the heading that belongs to the place ``look_ahead_s`` from now (equation 24) and turns
the wheel as far as leads to it in that time. On a bent path the same law runs along the path: the deviation and the
line's direction are those beside the predicted place. With p = 0.35 to 0.45 per metre and a bounded steering angle the
law does what the paper reports; with the printed p = 1 it swings at every speed when it looks 0.5 s ahead.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from guidance_app.angles import wrap_pi
from guidance_app.model import SegmentKind
from guidance_app.simulation.route import Part, Place, Stretch
from guidance_app.simulation.vehicle import TractorModel, slip_and_yaw_rate

__all__ = ["Control", "Driver", "DriverSettings", "Seen", "steering_towards"]

SLOWEST = 0.2
"""Metres per second; slower than this nobody rolls on purpose."""
WALKING = 1.0
"""Metres per second; slower than this the wheel is turned as if it went so fast, not to its stop."""
ARRIVED = 0.08
"""Metres before its end at which a stretch is driven."""
STANDING = 0.02
"""Metres per second below which the tractor stands."""


@dataclass(frozen=True, slots=True)
class DriverSettings:
    """How a person drives. Metres, seconds, m/s; ``convergence`` is p of equation 22, per metre.

    ``attention_s`` is the time between two looks at the screen, ``wander`` the standard deviation of the deviation
    that is not noticed or not cared for, ``wander_s`` how long it lasts.
    """

    work_speed: float = 2.7
    turn_speed: float = 1.5
    reverse_speed: float = 1.0
    look_ahead_s: float = 1.2
    convergence: float = 0.45
    braking: float = 0.5
    attention_s: float = 0.2
    wander: float = 0.08
    wander_s: float = 5.0
    gear_s: float = 1.6


@dataclass(frozen=True, slots=True)
class Seen:
    """What the driver sees: the guided point, the heading of the body, signed speed and yaw rate."""

    east: float
    north: float
    heading: float
    speed: float
    yaw_rate: float


@dataclass(frozen=True, slots=True)
class Control:
    """What the driver does: steering angle and signed speed wanted, and the implement.

    ``part`` is what is driven now, ``along`` the metres driven of its stretch. ``finished`` says that the job is done.
    """

    steering: float
    speed: float
    implement_down: bool
    part: Part
    along: float
    finished: bool = False


def steering_towards(model: TractorModel, seen: Seen, predicted: Place, settings: DriverSettings) -> float:
    """The steering angle that turns to the heading of equation 24 within the look-ahead.

    ``predicted`` is where the guided point will be then. In reverse it is the way of travel that is turned. The speed
    must not be zero.
    """
    backwards = seen.speed < 0
    wanted = predicted.heading - math.atan(settings.convergence * predicted.right) + (math.pi if backwards else 0.0)
    yaw_rate = wrap_pi(wanted - seen.heading) / settings.look_ahead_s
    return yaw_rate / slip_and_yaw_rate(model, seen.speed, 1.0)[1]


class Driver:
    """Drives the stretches one after the other; call ``look`` at least every ``attention_s``.

    ``implement_back`` is how far behind the guided point the implement works: it goes down and up there, not earlier.
    An ``endless`` driver begins again after the last stretch, which must lead to the first one's beginning.
    """

    def __init__(
        self,
        model: TractorModel,
        stretches: Sequence[Stretch],
        settings: DriverSettings,
        implement_back: float,
        generator: np.random.Generator,
        *,
        endless: bool = False,
    ) -> None:
        self._endless = endless
        self._model = model
        self._stretches = stretches
        self._settings = settings
        self._implement_back = implement_back
        self._generator = generator
        self._index = 0
        self._along = 0.0
        self._wander = 0.0
        self._looked_at = -math.inf
        self._stood_since: float | None = None
        self._control = Control(0.0, 0.0, implement_down=False, part=stretches[0].parts[0], along=0.0)

    def look(self, t: float, seen: Seen) -> Control:
        """What the driver wants at ``t``; between two looks it stays as it was."""
        if t - self._looked_at >= self._settings.attention_s - 1e-9 and not self._control.finished:
            self._wander_on(min(t - self._looked_at, self._settings.wander_s))
            self._looked_at = t
            self._control = self._decide(t, seen)
        return self._control

    def _wander_on(self, seconds: float) -> None:
        """A deviation that comes and goes: first-order Gauss-Markov."""
        keep = math.exp(-seconds / self._settings.wander_s)
        shake = self._settings.wander * math.sqrt(1 - keep**2)
        self._wander = keep * self._wander + shake * float(self._generator.standard_normal())

    def _decide(self, t: float, seen: Seen) -> Control:
        stretch = self._stretches[self._index]
        place = stretch.place_of(seen.east, seen.north, self._along)
        self._along = max(self._along, place.along)
        if stretch.length - self._along < ARRIVED:
            return self._at_end(t, seen)
        speed = self._speed(stretch)
        steering = self._steering(stretch, seen, speed)
        part = stretch.part_at(self._along)
        return Control(steering, speed, self._implement_down(stretch), part, self._along)

    def _steering(self, stretch: Stretch, seen: Seen, wanted_speed: float) -> float:
        ahead = self._settings.look_ahead_s
        rolling = _at_least(WALKING, seen, wanted_speed)
        course = rolling.heading + rolling.yaw_rate * ahead / 2
        east = rolling.east + rolling.speed * ahead * math.sin(course)
        north = rolling.north + rolling.speed * ahead * math.cos(course)
        predicted = stretch.place_of(east, north, self._along + abs(rolling.speed) * ahead)
        off = predicted.right + (self._wander if stretch.part_at(self._along).implement_down else 0.0)
        return steering_towards(self._model, rolling, Place(predicted.along, off, predicted.heading), self._settings)

    def _speed(self, stretch: Stretch) -> float:
        """As fast as this part allows, and slow enough for what comes within braking distance."""
        braking = 2 * self._settings.braking
        speed = self._limit(stretch, stretch.part_at(self._along))
        for part in stretch.parts_from(self._along):
            speed = min(speed, math.sqrt(self._limit(stretch, part) ** 2 + braking * (part.start - self._along)))
        speed = min(speed, max(SLOWEST, math.sqrt(braking * (stretch.length - self._along))))
        return -speed if stretch.reverse else speed

    def _limit(self, stretch: Stretch, part: Part) -> float:
        if stretch.reverse:
            return self._settings.reverse_speed
        straight = part.kind in {SegmentKind.PASS, SegmentKind.LAP}
        return self._settings.work_speed if straight else self._settings.turn_speed

    def _implement_down(self, stretch: Stretch) -> bool:
        where = self._along - self._implement_back
        return not stretch.reverse and where >= 0 and stretch.part_at(where).implement_down

    def _at_end(self, t: float, seen: Seen) -> Control:
        """Stands, changes gear and goes on with the next stretch; after the last one the job is done."""
        stretch = self._stretches[self._index]
        last = self._index == len(self._stretches) - 1 and not self._endless
        part = stretch.part_at(self._along)
        if abs(seen.speed) > STANDING:
            return Control(self._control.steering, 0.0, self._control.implement_down, part, self._along)
        if self._stood_since is None:
            self._stood_since = t
        if t - self._stood_since >= self._settings.gear_s and not last:
            self._index = (self._index + 1) % len(self._stretches)
            self._along = 0.0
            self._stood_since = None
            return self._decide(t, seen)
        return Control(self._control.steering, 0.0, implement_down=False, part=part, along=self._along, finished=last)


def _at_least(slowest: float, seen: Seen, wanted_speed: float) -> Seen:
    """What is seen, as if it went at least so fast: a driver who starts thinks of the speed to come."""
    if abs(seen.speed) >= slowest:
        return seen
    share = abs(seen.speed) / slowest
    speed = math.copysign(slowest, wanted_speed)
    return Seen(seen.east, seen.north, seen.heading, speed, seen.yaw_rate * share)
