"""Measurements along simple drives, for the tests of the filters: exact truth, then what a receiver makes of it."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from guidance_app.angles import wrap_pi
from guidance_app.model import FixQuality, Measurement, Pose

PAPER_CELL = (0.14, 0.18)
FINE_CELL = (0.002, 0.002)
KMH = 1 / 3.6


@dataclass(frozen=True, slots=True)
class Moment:
    """The truth at one time."""

    t: float
    east: float
    north: float
    heading: float
    speed: float
    curvature: float


def drive(
    speed: Callable[[float], float],
    curvature: Callable[[float], float],
    duration: float,
    *,
    heading: float = 0.5,
    rate: float = 5.0,
) -> list[Moment]:
    """The path with ``speed`` over time and ``curvature`` over time, by steps of a fiftieth of an epoch."""
    moments = []
    east, north, step = 0.03, -0.04, 1 / rate / 50
    for k in range(round(duration * rate) + 1):
        t = k / rate
        moments.append(Moment(t, east, north, heading % math.tau, speed(t), curvature(t)))
        for j in range(50):
            now = t + (j + 0.5) * step
            turn = speed(now) * curvature(now) * step
            east += speed(now) * step * math.sin(heading + turn / 2)
            north += speed(now) * step * math.cos(heading + turn / 2)
            heading += turn
    return moments


def straight(duration: float = 40.0, speed: float = 1.5, heading: float = 0.5, rate: float = 5.0) -> list[Moment]:
    """A straight drive at constant speed."""
    return drive(lambda _: speed, lambda _: 0.0, duration, heading=heading, rate=rate)


@dataclass(frozen=True, slots=True)
class Kit:
    """Which sensors a tractor has, and how well they see."""

    cell: tuple[float, float] = PAPER_CELL
    velocity: bool = False
    gyro: bool = False
    compass: bool = False
    white: float = 0.0
    quality: FixQuality = FixQuality.RTK_FIXED
    antenna: tuple[float, float, float] = (0.0, 0.0, 0.0)


KITS = {
    "position": Kit(),
    "velocity": Kit(velocity=True),
    "gyro": Kit(gyro=True),
    "velocity and gyro": Kit(velocity=True, gyro=True),
    "dual antenna": Kit(velocity=True, compass=True, cell=FINE_CELL, white=0.01),
    "everything, DGPS": Kit(velocity=True, gyro=True, compass=True, white=0.03, quality=FixQuality.DGPS),
}


def measured(moments: Iterable[Moment], kit: Kit = Kit(), seed: int = 1) -> list[Measurement]:
    """What the kit reports of these moments; the antenna sits where ``kit.antenna`` says."""
    random = np.random.default_rng(seed)
    return [_measured(moment, kit, random) for moment in moments]


def _measured(m: Moment, kit: Kit, random: np.random.Generator) -> Measurement:
    sine, cosine = math.sin(m.heading), math.cos(m.heading)
    forward, right, _ = kit.antenna
    east = m.east + forward * sine + right * cosine + random.normal(0, 1) * kit.white
    north = m.north + forward * cosine - right * sine + random.normal(0, 1) * kit.white
    rate = m.speed * m.curvature
    ve = m.speed * sine + rate * (forward * cosine - right * sine) + random.normal(0, 0.03)
    vn = m.speed * cosine + rate * (-forward * sine - right * cosine) + random.normal(0, 0.03)
    return Measurement(
        t=m.t,
        arrival=m.t,
        east=rounded(east, kit.cell[0]),
        north=rounded(north, kit.cell[1]),
        quality=kit.quality,
        cell=kit.cell,
        speed=math.hypot(ve, vn) if kit.velocity else None,
        course=math.atan2(ve, vn) % math.tau if kit.velocity else None,
        yaw_rate=rate + 0.003 + random.normal(0, 0.002) if kit.gyro else None,
        heading=(m.heading + random.normal(0, 0.004)) % math.tau if kit.compass else None,
        antenna=kit.antenna,
    )


def rounded(value: float, cell: float) -> float:
    """The nearest multiple of the cell."""
    return math.floor(value / cell + 0.5) * cell


def mirrored(z: Measurement) -> Measurement:
    """The same measurement in a world whose east is west."""
    return replace(
        z,
        east=-z.east,
        course=None if z.course is None else -z.course % math.tau,
        heading=None if z.heading is None else -z.heading % math.tau,
        yaw_rate=None if z.yaw_rate is None else -z.yaw_rate,
        roll=None if z.roll is None else -z.roll,
        antenna=(z.antenna[0], -z.antenna[1], z.antenna[2]),
    )


def position_error(pose: Pose, truth: Moment) -> float:
    """Metres from the truth."""
    return math.hypot(pose.east - truth.east, pose.north - truth.north)


def heading_error(pose: Pose, truth: Moment) -> float:
    """Radians, never negative."""
    return abs(wrap_pi(pose.heading - truth.heading))


def rms(values: Iterable[float]) -> float:
    """Root mean square."""
    array = np.fromiter(values, dtype=float)
    return float(np.sqrt(np.mean(array**2)))
