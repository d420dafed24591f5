"""The steering simulation of Inoue et al. (section "Simulation of tractor movement", equations 15 to 27, Fig. 13).

A two-wheel model is steered to a target line by predicting the deviation ``tau`` seconds ahead. The paper prints
neither all equations readably nor all numbers, so this is what was read and what was chosen:

* The tractor is ``simulation.vehicle``, with the speed squared put back into equation 18.
* Equation 22 is read with a rate p: x = x_k exp(-p (y - y_k)). At p = 1 1/m, as its figure says, 0.5 s is unstable at
  1.0 and at 1.5 m/s, which the paper denies; with p = 0.45 1/m and a steering limit of 15 degrees all four of its
  statements hold (0.35 1/m with 35 degrees does the same).
* Mass, cornering power and axle distances are an M90's order of magnitude; below 1.5 m/s they change C by 0.3 %.

Here x is the cross-track error (positive right of the line) and theta the heading relative to the line.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from guidance_app.angles import wrap_pi
from guidance_app.evaluation.rows import Row, at_least, at_most, between
from guidance_app.evaluation.scenarios import Purpose, generator
from guidance_app.model import FloatArray
from guidance_app.simulation.vehicle import TractorModel, VehicleState, moved, slip_and_yaw_rate

__all__ = ["Convergence", "Run", "Steering", "convergence", "simulate", "steering_rows"]


STEP = 0.1
"""Seconds between two looks at the line."""
DRIVE_STEPS = 400


@dataclass(frozen=True, slots=True)
class Steering:
    """How the driver steers: seconds ahead that he looks, rate p of convergence in 1/m, and the steering limit."""

    prediction_s: float
    convergence: float = 0.45
    limit: float = math.radians(15)


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One drive: time, distance along the line, cross-track error, heading, steering angle; all of shape (N,)."""

    t: FloatArray
    along: FloatArray
    cross_track: FloatArray
    heading: FloatArray
    steering: FloatArray


@dataclass(frozen=True, slots=True)
class Convergence:
    """How a drive came to the line: metres beyond it, how often across, seconds until it stays within 5 cm."""

    overshoot: float
    crossings: int
    settled_s: float


def simulate(
    speed: float,
    steering: Steering,
    random: np.random.Generator,
    *,
    start: float = 1.0,
    noise: float = 0.08,
    shown_off: FloatArray | None = None,
) -> Run:
    """A drive to the line from ``start`` metres right of it; ``noise`` is the paper's 8 % on slip and yaw rate.

    The line is the north axis, so east is the cross-track error. ``shown_off``, a value for each tenth of a second
    of the drive, is by how much the screen shows the tractor too far right; without it the drive takes 40 s.
    """
    model = TractorModel(steering_limit=steering.limit)
    _, gain = slip_and_yaw_rate(model, speed, 1.0)
    ahead = steering.prediction_s
    state = VehicleState(t=0.0, east=start, north=0.0, heading=0.0, speed=speed)
    states = []
    off = np.zeros(DRIVE_STEPS) if shown_off is None else shown_off
    for shown_too_far in off.tolist():
        heading = wrap_pi(state.heading)
        states.append((state.t, state.north, state.east, heading, state.steering))
        predicted = (
            state.east + shown_too_far + speed * ahead * math.sin(heading + state.slip + state.yaw_rate * ahead / 2)
        )
        target = -math.atan(steering.convergence * predicted)
        wanted = (target - heading) / ahead / gain
        disturbance = noise * random.standard_normal(2)
        state = moved(model, state, (wanted, speed), STEP, (float(disturbance[0]), float(disturbance[1])))
    return Run(*np.array(states).T)


def convergence(run: Run) -> Convergence:
    """How ``run`` came to the line. Deviations below 1 cm do not count as crossing it."""
    away = run.cross_track[np.abs(run.cross_track) > 0.01]
    outside = np.flatnonzero(np.abs(run.cross_track) > 0.05)
    return Convergence(
        overshoot=max(0.0, -float(run.cross_track.min())),
        crossings=int(np.count_nonzero(np.diff(np.sign(away)))),
        settled_s=float(outside[-1] + 1) * STEP if len(outside) else 0.0,
    )


def steering_rows(seeds: int) -> list[Row]:
    """The paper's four statements as numbers; each a mean over ``seeds`` drives from 1 m beside the line."""
    protocol = "Inoue Fig. 13: steering to the line from 1 m (statements of the text)"

    def mean(speed: float, prediction: float) -> tuple[float, float, float]:
        drives = _drives(speed, prediction, seeds)
        return (
            100 * float(np.mean([drive.overshoot for drive in drives])),
            float(np.mean([drive.crossings for drive in drives])),
            float(np.mean([drive.settled_s for drive in drives])),
        )

    calm, meander = mean(1.0, 0.5), mean(1.5, 0.5)
    smooth, slow = mean(1.5, 1.5), mean(1.5, 2.5)
    smooth_slowly = mean(1.0, 1.5)
    slower = round(smooth[2] + 1, 1)
    return [
        Row(protocol, "1.0 m/s, 0.5 s ahead: no meandering, overshoot", "cm", calm[0], goal=at_most(1.0)),
        Row(protocol, "1.5 m/s, 0.5 s ahead: slight meandering, overshoot", "cm", meander[0], goal=between(2.0, 15.0)),
        Row(protocol, "1.5 m/s, 0.5 s ahead: crosses the line", "times", meander[1], goal=at_least(1.0)),
        Row(protocol, "1.0 m/s, 1.5 s ahead: smooth, overshoot", "cm", smooth_slowly[0], goal=at_most(1.0)),
        Row(protocol, "1.5 m/s, 1.5 s ahead: smooth, overshoot", "cm", smooth[0], goal=at_most(1.0)),
        Row(protocol, "1.5 m/s: 0.5 s is quick, within 5 cm after", "s", meander[2], goal=at_most(round(smooth[2], 1))),
        Row(protocol, "1.5 m/s: 1.5 s, within 5 cm after", "s", smooth[2]),
        Row(protocol, "1.5 m/s: above 2 s is slow (2.5 s), within 5 cm after", "s", slow[2], goal=at_least(slower)),
    ]


def _drives(speed: float, prediction: float, seeds: int) -> Sequence[Convergence]:
    name = f"steering {speed} {prediction}"
    steering = Steering(prediction)
    return [convergence(simulate(speed, steering, generator(Purpose.REPORT, name, seed))) for seed in range(seeds)]
