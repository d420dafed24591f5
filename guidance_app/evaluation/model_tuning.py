"""Tuning the adaptive filter's motion models: where the numbers in ``estimation.filter`` come from.

One set of models must serve all scenarios at once, at 5 Hz and at 1 Hz, so that is what it is judged by: the mean over
them of the logarithm of the distance plus half that of the heading error. Two kinds of runs are added that the eight
scenarios do not hold and real driving does: a speed that wanders, and the eighteen lines along the grid. A set whose
ellipse holds less than 91.5 % of the true positions pays for it: a filter must not buy smoothness with confidence.

All runs are of the tuning's own seeds.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from guidance_app.estimation.filter import AdaptiveSettings, FilterSettings
from guidance_app.estimation.motion_models import ModelSet
from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.gomez_gil import eighteen_lines, rounding_only
from guidance_app.evaluation.metrics import Score, errors_of, pool, summarise
from guidance_app.evaluation.scenarios import KMH, SCENARIOS, Purpose, drive, generator, truth_of
from guidance_app.evaluation.signals import Sensors, record
from guidance_app.evaluation.tracks import Recording, Track
from guidance_app.evaluation.tuning import Found, new_search
from guidance_app.model import FloatArray

__all__ = ["KINDS", "ModelObjective", "model_search", "model_settings", "numbers_of"]

KINDS = {
    "position": Sensors(),
    "doppler": Sensors(velocity=True),
    "gyro": Sensors(gyro=True),
    "doppler_gyro": Sensors(velocity=True, gyro=True),
}
"""The model sets by what they are for, named as in ``AdaptiveSettings``."""

LOWEST = np.array([*np.tile((1e-4, 1e-5, 0.1), 4), *np.full(6, 1e-3)])
HIGHEST = np.array([*np.tile((4.0, 1.5, 500.0), 4), *np.full(6, 40.0)])
"""Bounds of the eighteen numbers: acceleration, curvature and memory of four models, six rates of change."""

HONEST = 0.915
SLOW_RATE_HZ = 1.0
SLOW_WEIGHT = 0.2
SLOW_SCENARIOS = ("arc15", "uturn", "accel", "meander", "fishtail")
EVALUATIONS = 400

Run = tuple[Track, Recording]


@dataclass(frozen=True, slots=True)
class ModelObjective:
    """What a model set of this kind is judged by, over so many tuning seeds."""

    kind: str
    seeds: int

    def scores(self, settings: FilterSettings) -> dict[tuple[str, float], Score]:
        """The score of every group of runs, by name and rate."""
        groups = _groups(self.kind, self.seeds)
        return {name: _score(runs, settings) for name, runs in groups.items()}

    def value(self, settings: FilterSettings) -> float:
        """The smaller the better; its exponential is a mean distance in metres times the root of a mean heading."""
        scores = self.scores(settings)
        quick = [_cost(score) for (_, rate), score in scores.items() if rate > SLOW_RATE_HZ]
        slow = [_cost(score) for (_, rate), score in scores.items() if rate == SLOW_RATE_HZ]
        doubt = [max(0.0, HONEST - (score.within_ellipse or 0.0)) for score in scores.values()]
        return float(np.mean(quick) + SLOW_WEIGHT * np.mean(slow) + 2 * np.mean(doubt))


def numbers_of(models: ModelSet) -> FloatArray:
    """The eighteen numbers of a model set, in the order of the bounds."""
    return np.array(models.numbers)


def model_settings(kind: str, numbers: FloatArray, base: FilterSettings | None = None) -> FilterSettings:
    """The settings document with these eighteen numbers as the model set ``kind``; all else as in ``base``."""
    models = ModelSet.of([float(f"{value:.4g}") for value in numbers])
    settings = base or FilterSettings()
    adaptive: AdaptiveSettings = settings.adaptive.model_copy(update={kind: models})
    return settings.model_copy(update={"adaptive": adaptive})


def model_search(
    objective: ModelObjective, evaluations: int = EVALUATIONS, step: float = 0.4, seed: int = int(Purpose.TUNING)
) -> Iterator[Found]:
    """The best set so far after each generation of CMA-ES, begun at the present one.

    ``Found.rms`` is the exponential of the objective.
    """
    first = np.clip(numbers_of(getattr(FilterSettings().adaptive, objective.kind)), 1.01 * LOWEST, 0.99 * HIGHEST)
    search = new_search(np.log(first), step, (np.log(LOWEST), np.log(HIGHEST)), evaluations, seed)
    best = Found(first, math.exp(objective.value(model_settings(objective.kind, first))), 1, evaluations)
    yield best
    while not search.stop():
        asked = search.ask()
        values = [objective.value(model_settings(objective.kind, np.exp(point))) for point in asked]
        search.tell(asked, values)
        winner = int(np.argmin(values))
        done = best.evaluations + len(asked)
        better = math.exp(values[winner]) < best.rms
        noise, value = (np.exp(asked[winner]), math.exp(values[winner])) if better else (best.noise, best.rms)
        best = Found(noise, value, done, max(evaluations, done))
        yield best


def _cost(score: Score) -> float:
    """Distance and heading of one group; a heading that was never scored costs as one that is 90 degrees off."""
    heading = math.pi / 2 if score.heading_rms is None else score.heading_rms
    return math.log(score.rms) + 0.5 * math.log(heading)


def _score(runs: tuple[Run, ...], settings: FilterSettings) -> Score:
    return summarise(
        pool([errors_of(estimate_recording(recording, "adaptive", settings), truth) for truth, recording in runs])
    )


@lru_cache(maxsize=8)
def _groups(kind: str, seeds: int) -> dict[tuple[str, float], tuple[Run, ...]]:
    """The runs, made once."""
    few = max(2, seeds // 3)
    groups = {(name, 5.0): _runs(kind, name, seeds, 5.0) for name in SCENARIOS}
    groups["wandering speed", 5.0] = tuple(_wandering(kind, seed) for seed in range(seeds))
    if kind == "position":
        groups["18 lines", 5.0] = tuple((line, rounding_only(line)) for line in eighteen_lines(200))
    groups |= {(name, SLOW_RATE_HZ): _runs(kind, name, few, SLOW_RATE_HZ) for name in SLOW_SCENARIOS}
    return groups


def _runs(kind: str, name: str, seeds: int, rate: float) -> tuple[Run, ...]:
    runs = []
    for seed in range(seeds):
        random = generator(Purpose.TUNING, name, seed)
        truth = truth_of(name, random, rate)
        runs.append((truth, record(truth, random, KINDS[kind])))
    return tuple(runs)


def _wandering(kind: str, seed: int) -> Run:
    """A bend of 30 m radius at a speed that swings by 1.5 km/h."""
    random = generator(Purpose.TUNING, "wandering speed", seed)
    period, side = float(random.uniform(10, 30)), float(random.choice([-1.0, 1.0]))
    truth = drive(
        lambda t: (7 + 1.5 * np.sin(math.tau * t / period)) * KMH,
        lambda distance: np.full_like(distance, side / 30),
        50.0,
        heading=float(random.uniform(-math.pi, math.pi)),
    )
    return truth, record(truth, random, KINDS[kind])
