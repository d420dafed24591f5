"""The gate behind the checksum: a fix that a machine on the ground cannot have reached is not believed.

Eight bits of checksum let one wrong sentence in 256 through. A fix passes when it lies no farther from the last
believed one than speed and acceleration can carry a vehicle, plus what a receiver's solution may honestly jump. The
gate must not lock out a true jump (a receiver that finds RTK, a log that was cut together): three fixes in a row that
agree with each other are believed whatever stood before. The same holds for time and for the reported speed.

Limits, with what made them: acceleration 15 m/s2 (an emergency stop of a car is 10); an honest jump 15 m (the largest
between fixes of an autonomous receiver in the open); a pause of an hour is a new beginning.
"""

from dataclasses import dataclass, replace
from math import cos, hypot, radians

from guidance_app.model.making import made_quickly

__all__ = ["Place", "Plausibility", "metres_between"]

MAX_ACCELERATION = 15.0
HONEST_JUMP = 15.0
UNKNOWN_SPEED = 40.0
"""Of a receiver that reports no speed, until two fixes have told it; also the most that two fixes may tell."""
LONGEST_STEP = 5.0
"""Seconds over which two fixes still tell a speed."""
MAX_SPEED = 150.0
HONEST_SPEED_STEP = 10.0
LONGEST_PAUSE = 3600.0
AGREEING = 3
METRES_PER_DEGREE = 1852.0 * 60.0
"""Good to half a percent, which is enough to judge a jump by."""


@made_quickly
@dataclass(frozen=True, slots=True)
class Place:
    """Where and when a fix was, and its speed where known."""

    t: float
    latitude_deg: float
    longitude_deg: float
    speed: float | None


def metres_between(a: tuple[float, float], b: tuple[float, float]) -> float:
    """About how far two positions (latitude, longitude in degrees) are apart."""
    north = (b[0] - a[0]) * METRES_PER_DEGREE
    turn = (b[1] - a[1] + 180.0) % 360.0 - 180.0
    return hypot(north, turn * METRES_PER_DEGREE * cos(radians(a[0])))


class Plausibility:
    """Remembers the last believed fix and the doubted ones since."""

    __slots__ = ("_agreeing", "_doubted", "_last", "_speed", "_speed_agreeing", "_speed_doubted")

    def __init__(self) -> None:
        self._last: Place | None = None
        self._doubted: Place | None = None
        self._agreeing = 0
        self._speed: tuple[float, float] | None = None
        self._speed_doubted: tuple[float, float] | None = None
        self._speed_agreeing = 0

    def fork(self) -> "Plausibility":
        """An independent copy."""
        copy = Plausibility()
        for name in self.__slots__:
            setattr(copy, name, getattr(self, name))
        return copy

    def doubt(self, place: Place) -> str | None:
        """Why the fix is not believed, or None; a believed fix becomes the one that the next is judged by."""
        reason = None if self._last is None else _contradiction(self._last, place)
        if reason is not None:
            agrees = self._doubted is not None and _contradiction(self._doubted, place) is None
            self._agreeing = self._agreeing + 1 if agrees else 1
            self._doubted = place
            if self._agreeing < AGREEING:
                return reason
        self._last, self._doubted, self._agreeing = _with_speed(self._last, place), None, 0
        return None

    def believes_speed(self, t: float, speed: float) -> bool:
        """Whether a reported speed can follow the one before it."""
        new = (t, speed)
        if speed > MAX_SPEED:
            return False
        if self._speed is not None and _speed_jumps(self._speed, new):
            agrees = self._speed_doubted is not None and not _speed_jumps(self._speed_doubted, new)
            self._speed_agreeing = self._speed_agreeing + 1 if agrees else 1
            self._speed_doubted = new
            if self._speed_agreeing < AGREEING:
                return False
        self._speed, self._speed_doubted, self._speed_agreeing = new, None, 0
        return True


def _with_speed(before: Place | None, place: Place) -> Place:
    """The place with the speed at which it was reached, where the receiver reports none."""
    if place.speed is not None or before is None or not 0.0 < place.t - before.t <= LONGEST_STEP:
        return place
    return replace(place, speed=min(_metres(before, place) / (place.t - before.t), UNKNOWN_SPEED))


def _metres(before: Place, after: Place) -> float:
    return metres_between((before.latitude_deg, before.longitude_deg), (after.latitude_deg, after.longitude_deg))


def _contradiction(before: Place, after: Place) -> str | None:
    dt = after.t - before.t
    if not 0.0 < dt <= LONGEST_PAUSE:
        return "implausible time"
    known = [place.speed for place in (before, after) if place.speed is not None]
    speed = max(known) if known else UNKNOWN_SPEED
    reach = HONEST_JUMP + speed * dt + MAX_ACCELERATION * dt * dt / 2.0
    return "implausible jump" if _metres(before, after) > reach else None


def _speed_jumps(before: tuple[float, float], after: tuple[float, float]) -> bool:
    dt = max(after[0] - before[0], 0.0)
    return abs(after[1] - before[1]) > HONEST_SPEED_STEP + MAX_ACCELERATION * dt
