"""Filters over the scenarios: which are compared, how many seeds, and the rows that come of it.

All methods see the same runs. A geometric mean over eight scenarios is the yardstick, for it cannot be improved by
being good on straight lines alone. What is reported uses other seeds than what was tuned, and the shapes of
``scenarios.UNSEEN`` show that the tuning holds elsewhere.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from guidance_app.estimation.filter import FilterSettings
from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.metrics import Score, errors_of, geometric_mean, pool, summarise
from guidance_app.evaluation.parallel import Spread
from guidance_app.evaluation.peers import PeerMissing, constant_velocity
from guidance_app.evaluation.rows import Goal, Row, at_most, between
from guidance_app.evaluation.scenarios import SCENARIOS, UNSEEN, Purpose, generator, truth_of
from guidance_app.evaluation.signals import Sensors, outliers, record
from guidance_app.evaluation.tracks import Recording, Track
from guidance_app.model import FixQuality

__all__ = ["METHODS", "Case", "CaseResult", "Method", "run_case", "scenario_rows"]

CM = 100.0
OUTLIER_SHARE = 0.01
SCATTER = 0.02
"""Standard deviation in metres of the scatter under the outliers."""

BUNCH = 25
"""Seeds in one job: short enough to keep all processes busy to the end."""


@dataclass(frozen=True, slots=True)
class Method:
    """A way to estimate: its name in the tables, the estimator and the sensors it is given."""

    title: str
    estimator: str
    sensors: Sensors = Sensors()


METHODS: Mapping[str, Method] = MappingProxyType(
    {
        "off": Method("no filter", "off"),
        "paper": Method("paper's filter", "quantisation_kf"),
        "peer": Method("constant velocity, filterpy", "peer"),
        "position": Method("adaptive, position only", "adaptive"),
        "doppler": Method("adaptive, with Doppler 5 cm/s", "adaptive", Sensors(velocity=True)),
        "gyro": Method("adaptive, with gyro", "adaptive", Sensors(gyro=True)),
        "doppler gyro": Method("adaptive, with Doppler and gyro", "adaptive", Sensors(velocity=True, gyro=True)),
        "smoother": Method("offline smoother, position only", "smoother"),
        "smoother doppler": Method("offline smoother, with Doppler", "smoother", Sensors(velocity=True)),
    }
)


@dataclass(frozen=True, slots=True)
class Case:
    """One method on some seeds of one scenario. ``outlier_share`` spoils so many fixes by 1 to 5 m."""

    method: str
    scenario: str
    seeds: range
    purpose: Purpose = Purpose.REPORT
    outlier_share: float = 0.0
    quality: FixQuality = FixQuality.RTK_FIXED
    settings: FilterSettings | None = None


@dataclass(frozen=True, slots=True)
class CaseResult:
    """The score pooled over the case's seeds, and each seed's own rms in metres."""

    score: Score
    each: tuple[float, ...]


def recording_of(case: Case, seed: int) -> tuple[Track, Recording]:
    """The truth and what the receiver says of it, the same for every method."""
    random = generator(case.purpose, case.scenario, seed)
    truth = truth_of(case.scenario, random)
    error = None
    if case.outlier_share > 0:
        scatter = random.normal(0.0, SCATTER, (len(truth), 2))
        error = scatter + outliers(len(truth), case.outlier_share, random)
    sensors = METHODS[case.method].sensors
    return truth, record(truth, random, sensors, error=error, quality=case.quality)


def estimator_named(name: str, settings: FilterSettings | None) -> Callable[[Recording], Track]:
    """The function behind a method's ``estimator``."""
    if name == "peer":
        return constant_velocity
    if name == "smoother":
        return lambda recording: smooth_recording(recording, settings)
    return lambda recording: estimate_recording(recording, name, settings)


def run_case(case: Case) -> CaseResult:
    """The score of one case."""
    estimator = estimator_named(METHODS[case.method].estimator, case.settings)
    parts = []
    for seed in case.seeds:
        truth, recording = recording_of(case, seed)
        parts.append(errors_of(estimator(recording), truth))
    return CaseResult(summarise(pool(parts)), tuple(summarise(part).rms for part in parts))
