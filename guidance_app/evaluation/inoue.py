"""The field test of Inoue et al. (section "Display location accuracy"), rebuilt as a simulation.

Four passes of 160 m at 13 km/h, meandering on purpose, with headland turns, at 10 Hz after 10 s of standing. The
DGPS drifts (Gauss-Markov, 16 cm over 150 s), jumps by 25 cm for some seconds, and scatters by 2 cm; the attitude
sensor's heading is good to 2 degrees; the antenna sits 2.6 m high on a tractor that rolls. As in the paper, the mean
offset of the standing time is taken off all later fixes.

What is judged: that filtering does not worsen the position (the paper's own gain is 12 and 1 %, for no filter sees a
constant offset), and that it makes direction and motion calm, which is what a driver steers by.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from guidance_app.estimation.reference_point import level_lever_arm
from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.metrics import errors_of
from guidance_app.evaluation.parallel import Spread
from guidance_app.evaluation.rows import Row, at_most
from guidance_app.evaluation.scenarios import KMH, Purpose, drive, generator
from guidance_app.evaluation.signals import gauss_markov, gyro, outliers, steps
from guidance_app.evaluation.tracks import Recording, Track
from guidance_app.model import FixQuality, FloatArray

__all__ = ["FieldRun", "FieldScore", "field_run", "inoue_rows", "score_field_run"]

RATE_HZ = 10.0
STANDING_S = 10.0
PASS_LENGTH = 160.0
TURN_RADIUS = 5.0
PASSES = 4
TOP_SPEED = 13 * KMH
LEVER_ARM = (0.5, -0.1, 2.6)
"""Antenna ahead of, right of (here left) and above the reference point."""

CM = 100.0


@dataclass(frozen=True, slots=True, eq=False)
class FieldRun:
    """One simulated drive: the truth, what the sensors said, and the number of the pass, -1 off the passes."""

    truth: Track
    recording: Recording
    passes: FloatArray


@dataclass(frozen=True, slots=True)
class FieldScore:
    """How one drive went, in metres and radians.

    ``change`` is the rms change of the position error within a second, ``within_pass`` the
    cross-track error less its mean of each pass, ``each_pass`` the rms distance on every pass.
    """

    rms: float
    each_pass: tuple[float, ...]
    heading: float
    change: float
    within_pass: float


def field_run(seed: int, outlier_share: float = 0.0) -> FieldRun:
    """The drive number ``seed``."""
    random = generator(Purpose.REPORT, "inoue", seed)
    period = PASS_LENGTH + math.pi * TURN_RADIUS
    amplitude, wavelength = 0.8, 45.0
    k = math.tau / wavelength

    def curvature(distance: FloatArray) -> FloatArray:
        place = np.mod(distance, period)
        side = np.where(np.floor(distance / period) % 2 == 0, 1.0, -1.0)
        wave = amplitude * k * k * np.sin(k * place) * (place < 3 * wavelength)
        return np.where(place < PASS_LENGTH, wave, side / TURN_RADIUS)

    truth = drive(
        lambda t: np.clip((t - STANDING_S) * 0.8, 0, TOP_SPEED),
        curvature,
        STANDING_S + PASSES * period / TOP_SPEED + 3,
        heading=-math.atan(amplitude * k),
        rate=RATE_HZ,
    )
    driven = np.concatenate(([0.0], np.cumsum(truth.speed[:-1] / RATE_HZ)))
    on_pass = (np.mod(driven, period) < PASS_LENGTH) & (truth.speed > 1) & (driven < PASSES * period)
    return FieldRun(truth, _sensed(truth, random, outlier_share), np.where(on_pass, np.floor(driven / period), -1.0))


def score_field_run(run: FieldRun, filter_name: str) -> FieldScore:
    """How the filter does on this drive, scored on the passes."""
    errors = errors_of(estimate_recording(run.recording, filter_name), run.truth)
    number = run.passes[np.searchsorted(run.truth.t, errors.t)]
    on_pass = number >= 0
    distance = errors.distance
    second = round(RATE_HZ)
    change = np.hypot(errors.east[second:] - errors.east[:-second], errors.north[second:] - errors.north[:-second])
    calm = np.concatenate([errors.right[number == n] - np.mean(errors.right[number == n]) for n in range(PASSES)])
    return FieldScore(
        rms=_rms(distance[on_pass]),
        each_pass=tuple(_rms(distance[number == n]) for n in range(PASSES)),
        heading=_rms(errors.heading[on_pass & errors.scored]),
        change=_rms(change[on_pass[second:]]),
        within_pass=_rms(calm),
    )


def inoue_rows(seeds: int, spread: Spread) -> list[Row]:
    """The rows of Fig. 9 and its text, over ``seeds`` drives."""
    names = ("off", "gyro_ekf", "adaptive")
    jobs = [(name, seed, share) for share in (0.0, 0.01) for name in names for seed in range(seeds)]
    scores = dict(zip(jobs, spread(_job, jobs), strict=True))
    clean = {name: [scores[name, seed, 0.0] for seed in range(seeds)] for name in names}
    spoiled = {name: [scores[name, seed, 0.01] for seed in range(seeds)] for name in names}
    protocol = "Inoue: DGPS with drift and 25 cm steps, gyro, 13 km/h, meandering (peer: no filter)"
    raw, ours = _means(clean["off"]), _means(clean["adaptive"])
    unfiltered = raw["rms"] * CM
    rows = [
        Row(protocol, "gyro_ekf, RMS change on pass 1", "%", _gain(clean, "gyro_ekf", 0), paper=-12.1),
        Row(protocol, "gyro_ekf, RMS change on pass 2", "%", _gain(clean, "gyro_ekf", 1), paper=-1.3),
        Row(protocol, "adaptive, RMS change on pass 1", "%", _gain(clean, "adaptive", 0), paper=-12.1),
        Row(protocol, "adaptive, RMS change on pass 2", "%", _gain(clean, "adaptive", 1), paper=-1.3),
        Row(protocol, "adaptive, RMS", "cm", ours["rms"] * CM, peer=unfiltered, goal=at_most(round(unfiltered, 2))),
        *_calm_rows(protocol, "adaptive", ours, raw, (0.34, 2.9, 4.2)),
        *_calm_rows(protocol, "gyro_ekf", _means(clean["gyro_ekf"]), raw, (None, None, None)),
    ]  # fmt: skip
    protocol = "The same with 1 % outliers of 1 to 5 m (peer: no filter)"
    raw, ours = _means(spoiled["off"]), _means(spoiled["adaptive"])
    rows.append(Row(protocol, "adaptive, RMS", "cm", ours["rms"] * CM, peer=raw["rms"] * CM))
    return rows + _calm_rows(protocol, "adaptive", ours, raw, (None, None, None))


def _sensed(truth: Track, random: np.random.Generator, outlier_share: float) -> Recording:
    """What the sensors say along ``truth``."""
    count, interval = len(truth), 1 / RATE_HZ
    standing = truth.t < STANDING_S
    sway = gauss_markov(count, interval, math.radians(1.2), 0.8, random)[:, 0]
    roll = (sway + math.radians(0.8) * np.sin(np.cumsum(truth.speed) * interval / 9)) * (truth.speed > 0.1)
    antenna = truth.positions + _turned(_rolled(LEVER_ARM, roll), truth.heading)
    drift = gauss_markov(count, interval, 0.16, 150.0, random)
    jumps = steps(count, interval, 0.25, 40.0, random)
    error = drift + jumps + random.normal(0.0, 0.02, (count, 2))
    error = error - error[standing].mean(axis=0) + outliers(count, outlier_share, random)
    swing = truth.yaw_rate[:, np.newaxis] * np.array([-LEVER_ARM[1], LEVER_ARM[0]])  # a receiver tells its antenna's
    velocity = truth.velocity + _turned(swing, truth.heading) + random.normal(0.0, 0.05, (count, 2))
    compass = gauss_markov(count, interval, math.radians(2.0), 200.0, random)[:, 0]
    compass = truth.heading + compass + random.normal(0.0, math.radians(0.2), count)
    zero = math.radians(0.35) * random.standard_normal()
    seen_roll = roll + zero + random.normal(0.0, math.radians(0.5), count)
    return Recording(
        t=truth.t,
        position=antenna + error,
        cell=None,
        velocity=velocity,
        yaw_rate=gyro(truth, random),
        heading=compass % math.tau,
        heading_sigma=math.radians(3.0),
        antenna=np.array([level_lever_arm(LEVER_ARM, angle, 0.0) for angle in seen_roll.tolist()]),
        quality=FixQuality.DGPS,
    )


def _rolled(arm: tuple[float, float, float], roll: FloatArray) -> FloatArray:
    """Shape (N, 2): the antenna forward and right of the reference point, by the rotation about the forward axis."""
    forward, right, up = arm
    across = right * np.cos(roll) + up * np.sin(roll)
    return np.column_stack([np.full(len(roll), forward), across])


def _turned(body: FloatArray, heading: FloatArray) -> FloatArray:
    """Shape (N, 2): east, north of points given forward and right."""
    sine, cosine = np.sin(heading), np.cos(heading)
    east = body[:, 0] * sine + body[:, 1] * cosine
    return np.column_stack([east, body[:, 0] * cosine - body[:, 1] * sine])


def _job(job: tuple[str, int, float]) -> FieldScore:
    name, seed, share = job
    return score_field_run(field_run(seed, share), name)


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _means(scores: Sequence[FieldScore]) -> dict[str, float]:
    names = ("rms", "heading", "change", "within_pass")
    return {name: float(np.mean([getattr(score, name) for score in scores])) for name in names}


def _gain(scores: Mapping[str, Sequence[FieldScore]], name: str, number: int) -> float:
    """Change of the RMS on a pass against no filter, in percent; negative is better."""
    filtered = np.mean([score.each_pass[number] for score in scores[name]])
    return float(100 * (filtered / np.mean([score.each_pass[number] for score in scores["off"]]) - 1))


def _calm_rows(
    protocol: str,
    name: str,
    ours: Mapping[str, float],
    raw: Mapping[str, float],
    goals: tuple[float | None, float | None, float | None],
) -> list[Row]:
    """Heading, change within a second and cross-track within a pass."""
    heading, change, within = (None if goal is None else at_most(goal) for goal in goals)
    degrees = math.degrees
    return [
        Row(protocol, f"{name}, heading", "deg", degrees(ours["heading"]), peer=degrees(raw["heading"]), goal=heading),
        Row(
            protocol, f"{name}, error's change in 1 s", "cm", ours["change"] * CM, peer=raw["change"] * CM, goal=change
        ),
        Row(
            protocol,
            f"{name}, cross-track within a pass",
            "cm",
            ours["within_pass"] * CM,
            peer=raw["within_pass"] * CM,
            goal=within,
        ),
    ]
