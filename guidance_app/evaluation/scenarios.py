"""The paths on which filters are judged: eight that tell filters apart, and shapes no tuning ever saw.

A path is made from a speed over time and a curvature over distance, integrated on a grid twenty times finer than the
receiver's rate, so that a sample's error is below a tenth of a millimetre. Start, direction and the side of each
turn are drawn, for a path's angle to the receiver's grid decides how much its rounding hurts.

Randomness is by number, not by accident: :func:`generator` gives each purpose its own streams, so what tunes a
filter can never be what judges it.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from types import MappingProxyType

import numpy as np

from guidance_app.evaluation.tracks import Track
from guidance_app.model import FloatArray

__all__ = ["RATE_HZ", "SCENARIOS", "UNSEEN", "Purpose", "drive", "generator", "straight_line", "truth_of"]

KMH = 1 / 3.6
RATE_HZ = 5.0
FINER = 20

Profile = Callable[[FloatArray], FloatArray]


class Purpose(IntEnum):
    """What random numbers are for. Streams of different purposes share no seed."""

    REPORT = 20131108
    TUNING = 70711


def generator(purpose: Purpose, name: str, number: int) -> np.random.Generator:
    """The random numbers of run ``number`` of the scenario ``name``, always the same ones."""
    return np.random.default_rng([int(purpose), *name.encode(), number])


def drive(
    speed: Profile,
    curvature: Profile,
    duration: float,
    *,
    heading: float,
    start: tuple[float, float] = (0.0, 0.0),
    rate: float = RATE_HZ,
) -> Track:
    """The exact path driven with ``speed`` over time and ``curvature`` over distance (positive clockwise)."""
    step = 1 / (rate * FINER)
    samples = round(duration * rate)
    t = np.arange(samples * FINER + 1, dtype=np.float64) * step
    v = speed(t)
    distance = _integral(v, step)
    bend = curvature(distance)
    theta = heading + _integral(v * bend, step)
    east = start[0] + _integral(v * np.sin(theta), step)
    north = start[1] + _integral(v * np.cos(theta), step)
    kept = slice(0, samples * FINER, FINER)
    return Track(
        t=t[kept],
        east=east[kept],
        north=north[kept],
        heading=theta[kept] % math.tau,
        speed=v[kept].copy(),
        curvature=bend[kept].copy(),
        heading_known=np.ones(samples, dtype=bool),
    )


def straight_line(
    heading: float, speed: float, samples: int, *, start: tuple[float, float] = (0.0, 0.0), rate: float = RATE_HZ
) -> Track:
    """A straight path at constant speed, exact to the last digit."""
    t = np.arange(samples) / rate
    return Track(
        t=t,
        east=start[0] + speed * t * math.sin(heading),
        north=start[1] + speed * t * math.cos(heading),
        heading=np.full(samples, heading % math.tau),
        speed=np.full(samples, speed),
        curvature=np.zeros(samples),
        heading_known=np.ones(samples, dtype=bool),
    )


def truth_of(name: str, random: np.random.Generator, rate: float = RATE_HZ) -> Track:
    """The true path of a scenario, its start, direction and side drawn. ``KeyError`` for an unknown name."""
    recipe = SCENARIOS[name] if name in SCENARIOS else UNSEEN[name]
    heading = random.uniform(-math.pi, math.pi)
    start = (float(random.uniform(-5, 5)), float(random.uniform(-5, 5)))
    side = 1.0 if random.random() < 0.5 else -1.0
    return drive(
        recipe.speed,
        lambda distance: side * recipe.curvature(distance),
        recipe.duration,
        heading=heading if recipe.heading is None else recipe.heading,
        start=start,
        rate=rate,
    )


# --- profiles ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Recipe:
    """``heading`` is fixed where the scenario asks for it, else drawn."""

    speed: Profile
    curvature: Profile
    duration: float
    heading: float | None = None


def _integral(values: FloatArray, step: float) -> FloatArray:
    """Running integral by the trapezoidal rule, starting at 0."""
    return np.concatenate(([0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * step)))


def _constant(value: float) -> Profile:
    return lambda argument: np.full_like(argument, value)


def _ramp(first: float, last: float, duration: float) -> Profile:
    return lambda t: first + (last - first) * t / duration


def _stop_and_go(top: float, acceleration: float, period: float) -> Profile:
    """Four seconds of standing at either end of each period, a ramp up and down between them."""

    def speed(t: FloatArray) -> FloatArray:
        phase = t % period
        return np.clip(np.minimum(phase - 4, period - 4 - phase) * acceleration, 0, top)

    return speed


def _turn(radius: float, angle: float, after: float, clothoid: float = 2.0) -> Profile:
    """One turn by ``angle`` after a straight, its curvature ramped over ``clothoid`` metres on either side."""
    length = radius * angle + clothoid

    def curvature(distance: FloatArray) -> FloatArray:
        inside = distance - after
        return np.clip(np.minimum(inside, length - inside) / clothoid, 0, 1) / radius

    return curvature


def _sine(amplitude: float, wavelength: float) -> Profile:
    """Curvature of a sine-shaped path, its arc length taken for the abscissa."""
    k = math.tau / wavelength

    def curvature(distance: FloatArray) -> FloatArray:
        slope = amplitude * k * np.cos(k * distance)
        return -amplitude * k * k * np.sin(k * distance) / (1 + slope**2) ** 1.5

    return curvature


def _sum(*profiles: Profile) -> Profile:
    def total(distance: FloatArray) -> FloatArray:
        bend = np.zeros_like(distance)
        for profile in profiles:
            bend += profile(distance)
        return bend

    return total


def _spiral(first_radius: float, last_radius: float, length: float) -> Profile:
    return lambda distance: 1 / first_radius + (1 / last_radius - 1 / first_radius) * np.clip(distance / length, 0, 1)


SCENARIOS: Mapping[str, _Recipe] = MappingProxyType(
    {
        "straight": _Recipe(_constant(5 * KMH), _constant(0.0), 60),
        "sweep60": _Recipe(_ramp(5 * KMH, 10 * KMH, 100), _constant(0.0), 100, heading=math.radians(30)),
        "arc50": _Recipe(_constant(8 * KMH), _constant(1 / 50), 60),
        "arc15": _Recipe(_constant(6 * KMH), _constant(1 / 15), 60),
        "uturn": _Recipe(_constant(5 * KMH), _turn(5.0, math.pi, 40.0), 72),
        "accel": _Recipe(_stop_and_go(8 * KMH, 0.5, 30.0), _constant(0.0), 90),
        "meander": _Recipe(_constant(13 * KMH), _sine(1.0, 40.0), 60),
        "fishtail": _Recipe(_constant(6 * KMH), _sine(0.15, 15.0), 60),
    }
)
"""The eight of the tables. ``sweep60`` is 60 degrees from east, that is a heading of 30; ``meander`` is Inoue's."""

UNSEEN: Mapping[str, _Recipe] = MappingProxyType(
    {
        "quarter turn": _Recipe(_constant(7 * KMH), _turn(8.0, math.pi / 2, 30.0), 60),
        "omega turn": _Recipe(
            _constant(6 * KMH),
            _sum(
                lambda s: -_turn(6.0, math.pi / 4, 35.0)(s),
                _turn(6.0, 1.5 * math.pi, 43.0),
                lambda s: -_turn(6.0, math.pi / 4, 76.0)(s),
            ),
            80,
        ),
        "spiral": _Recipe(_constant(7 * KMH), _spiral(60.0, 8.0, 110.0), 60),
        "contour": _Recipe(_constant(9 * KMH), _sum(_sine(3.0, 90.0), _sine(0.3, 33.0)), 70),
        "lane change": _Recipe(
            _constant(10 * KMH), _sum(_turn(25.0, 0.15, 60.0), lambda s: -_turn(25.0, 0.15, 72.0)(s)), 60
        ),
        "slow fishtail": _Recipe(_constant(4 * KMH), _sine(0.10, 12.0), 60),
        "start in the turn": _Recipe(_ramp(0.0, 8 * KMH, 40), _constant(1 / 12), 40),
    }
)
"""Shapes kept from every tuning: what the numbers are worth away from the eight."""
