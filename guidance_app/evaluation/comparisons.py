"""Filters over the scenarios: which are compared, how many seeds, and the rows that come of it.

All methods see the same runs. A geometric mean over eight scenarios is the yardstick, for it cannot be improved by
being good on straight lines alone. What is reported uses other seeds than what was tuned, and the shapes of
``scenarios.UNSEEN`` show that the tuning holds elsewhere.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from guidance_app.estimation.filter import FilterSettings
from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.metrics import Score, after, errors_of, geometric_mean, pool, summarise
from guidance_app.evaluation.parallel import Spread
from guidance_app.evaluation.peers import PeerMissingError, constant_velocity
from guidance_app.evaluation.rows import Goal, Row, at_most, between
from guidance_app.evaluation.scenarios import RATE_HZ, SCENARIOS, UNSEEN, Purpose, generator, truth_of
from guidance_app.evaluation.signals import Sensors, outliers, record
from guidance_app.evaluation.smoothed import smooth_recording
from guidance_app.evaluation.tracks import Recording, Track
from guidance_app.model import FixQuality

__all__ = ["METHODS", "Case", "CaseResult", "Method", "run_case", "scenario_rows"]

CM = 100.0
OUTLIER_SHARE = 0.01
STARTING = 3.0
"""Seconds at the start of a drive with outliers that are not scored: one among the first fixes is believed."""
SCATTER = 0.02
"""Standard deviation in metres of the scatter under the outliers; the receiver says it (GST)."""


POSITION_ONLY = Sensors()


@dataclass(frozen=True, slots=True)
class Method:
    """A way to estimate: its name in the tables, the estimator and the sensors it is given."""

    title: str
    estimator: str
    sensors: Sensors = POSITION_ONLY


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
    """One method on some seeds of one scenario.

    ``outlier_share`` spoils so many fixes by 1 to 5 m; ``rate`` is the receiver's, in Hz.
    """

    method: str
    scenario: str
    seeds: range
    purpose: Purpose = Purpose.REPORT
    outlier_share: float = 0.0
    quality: FixQuality = FixQuality.RTK_FIXED
    rate: float = RATE_HZ
    settings: FilterSettings | None = None


@dataclass(frozen=True, slots=True)
class CaseResult:
    """The score pooled over the case's seeds, and each seed's own rms in metres."""

    score: Score
    each: tuple[float, ...]


def recording_of(case: Case, seed: int) -> tuple[Track, Recording]:
    """The truth and what the receiver says of it, the same for every method."""
    random = generator(case.purpose, case.scenario, seed)
    truth = truth_of(case.scenario, random, case.rate)
    error = None
    if case.outlier_share > 0:
        scatter = random.normal(0.0, SCATTER, (len(truth), 2))
        error = scatter + outliers(len(truth), case.outlier_share, random)
    recording = record(truth, random, METHODS[case.method].sensors, error=error, quality=case.quality)
    return truth, recording if error is None else replace(recording, sigma=(SCATTER, SCATTER))


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
        track = estimator(recording)
        if case.outlier_share > 0:
            track = after(track, STARTING)
        parts.append(errors_of(track, truth))
    return CaseResult(summarise(pool(parts)), tuple(summarise(part).rms for part in parts))


def scenario_rows(seeds: int, spread: Spread) -> list[Row]:
    """All rows of the scenarios, over ``seeds`` runs each."""
    runs = range(seeds)
    cases = {
        (method, scenario): Case(method, scenario, runs)
        for method in METHODS
        for scenario in (*SCENARIOS, *(UNSEEN if method in UNSEEN_METHODS else ()))
    }
    spoiled = {
        (method, "outliers"): Case(method, "straight", runs, outlier_share=OUTLIER_SHARE)
        for method in ("paper", "peer", "position")
    }
    drifting = {
        ("autonomous", scenario): Case("position", scenario, runs, quality=FixQuality.AUTONOMOUS)
        for scenario in SCENARIOS
    }
    rates = {
        (_at_rate(method, rate), scenario): Case(method, scenario, runs, rate=rate)
        for method in RATE_METHODS
        for rate in OTHER_RATES
        for scenario in SCENARIOS
    }
    jobs = {**cases, **spoiled, **drifting, **rates}
    results = dict(zip(jobs, spread(_attempt, list(jobs.values())), strict=True))
    known = {key: result for key, result in results.items() if result is not None}
    return [
        *_mean_rows(known),
        *_single_rows(known),
        *_outlier_rows(known),
        *_honesty_rows(known),
        *_scenario_table(known),
        *_unseen_rows(known),
        *_rate_rows(known),
    ]


# --- the rows ------------------------------------------------------------------------------------------------------

Results = Mapping[tuple[str, str], CaseResult]

UNSEEN_METHODS = ("paper", "peer", "position", "doppler", "doppler gyro")

OTHER_RATES = (1.0, 10.0)
RATE_METHODS = ("off", "paper", "position", "doppler gyro")

MEAN_GOALS: Mapping[str, tuple[float, float | None]] = MappingProxyType(
    {
        "position": (3.0, 0.85),
        "doppler": (2.2, 0.55),
        "doppler gyro": (2.1, 0.29),
        "smoother": (1.85, None),
        "smoother doppler": (1.4, None),
    }
)
"""Goals for the geometric means: cm and degrees."""


def _attempt(case: Case) -> CaseResult | None:
    """The case's result; None when it needs a peer that is not installed."""
    try:
        return run_case(case)
    except PeerMissingError:
        return None


def _centimetres(results: Results, method: str, scenario: str) -> float | None:
    result = results.get((method, scenario))
    return None if result is None else result.score.rms * CM


def _degrees(results: Results, method: str, scenario: str) -> float | None:
    result = results.get((method, scenario))
    rms = None if result is None else result.score.heading_rms
    return None if rms is None else float(np.degrees(rms))


def _mean(values: Sequence[float | None]) -> float | None:
    """Geometric mean; None as soon as one is missing."""
    known = [value for value in values if value is not None]
    return geometric_mean(known) if known and len(known) == len(values) else None


def _means(results: Results, method: str, scenarios: Sequence[str]) -> tuple[float | None, float | None]:
    distance = _mean([_centimetres(results, method, scenario) for scenario in scenarios])
    return distance, _mean([_degrees(results, method, scenario) for scenario in scenarios])


def _pair(
    results: Results, protocol: str, method: str, scenarios: Sequence[str], title: str, goals: tuple[Goal | None, ...]
) -> list[Row]:
    ours, paper, peer = (_means(results, name, scenarios) for name in (method, "paper", "peer"))
    rows = []
    for index, (quantity, unit) in enumerate((("distance", "cm"), ("heading", "deg"))):
        value = ours[index]
        if value is not None:
            rows.append(
                Row(protocol, f"{title}, {quantity}", unit, value, paper[index], peer[index], goal=goals[index])
            )
    return rows


def _mean_rows(results: Results) -> list[Row]:
    protocol = "Eight scenarios, geometric mean of RMS (paper: its filter on the same runs)"
    rows: list[Row] = []
    for method, description in METHODS.items():
        if method in {"paper", "peer"}:
            continue
        distance, heading = MEAN_GOALS.get(method, (None, None))
        goals = (None if distance is None else at_most(distance), None if heading is None else at_most(heading))
        rows += _pair(results, protocol, method, list(SCENARIOS), description.title, goals)
    title = "adaptive, position only, said to be autonomous"
    rows += _pair(results, protocol, "autonomous", list(SCENARIOS), title, (None, None))
    return rows


def _single_rows(results: Results) -> list[Row]:
    protocol = "Where filters differ most, position only"
    rows = []
    for scenario, title, distance, delay in (
        ("uturn", "U-turn of 5 m", 2.9, 0.12),
        ("fishtail", "fishtail of 15 cm", 4.0, 0.5),
    ):
        rows += _pair(results, protocol, "position", [scenario], title, (at_most(distance), None))
        lags = {
            name: results[name, scenario].score.heading_lag
            for name in ("position", "paper", "peer")
            if (name, scenario) in results
        }
        lag = lags["position"]
        if lag is None:
            msg = f"the scenario {scenario} does not turn: it has no lag to report"
            raise ValueError(msg)
        rows.append(
            Row(protocol, f"{title}, heading lag", "s", lag, lags.get("paper"), lags.get("peer"), goal=at_most(delay))
        )
    return rows


def _outlier_rows(results: Results) -> list[Row]:
    protocol = "Straight line, 1 % outliers of 1 to 5 m on 2 cm scatter, after the first 3 s, position only"
    ours = results["position", "outliers"]
    goals = (at_most(2.4), None)
    rows = _pair(results, protocol, "position", ["outliers"], "adaptive", goals)
    rows.append(Row(protocol, "adaptive, worst seed", "cm", max(ours.each) * CM, goal=at_most(6.0)))
    return rows


def _honesty_rows(results: Results) -> list[Row]:
    protocol = "True positions inside the shown 95 % ellipse"
    rows = []
    for method in ("position", "doppler", "doppler gyro"):
        shares = {name: results[method, name].score.within_ellipse for name in (*SCENARIOS, *UNSEEN)}
        known = {name: share for name, share in shares.items() if share is not None}
        for extreme, choose in (("least", min), ("most", max)):
            name = choose(known, key=lambda scenario: known[scenario])
            title = f"{METHODS[method].title}, {extreme} of {len(known)} paths"
            rows.append(Row(protocol, title, "%", 100 * known[name], goal=between(90, 99), note=name))
    return rows


def _scenario_table(results: Results) -> list[Row]:
    protocol = "Each scenario, position only"
    rows: list[Row] = []
    for scenario in SCENARIOS:
        rows += _pair(results, protocol, "position", [scenario], scenario, (None, None))
    return rows


def _unseen_rows(results: Results) -> list[Row]:
    protocol = f"{len(UNSEEN)} shapes that no tuning saw, geometric mean of RMS"
    rows: list[Row] = []
    for method in ("position", "doppler", "doppler gyro"):
        rows += _pair(results, protocol, method, list(UNSEEN), METHODS[method].title, (None, None))
    return rows


def _at_rate(method: str, rate: float) -> str:
    """The key of a method at another rate than the scenarios' own."""
    return f"{method} at {rate:g} Hz"


def _rate_rows(results: Results) -> list[Row]:
    protocol = "Eight scenarios at other rates, geometric mean of RMS (peer: no filter)"
    rows = []
    for method in ("position", "doppler gyro"):
        for rate in OTHER_RATES:
            keys = (method, "paper", "off")
            ours, paper, raw = (_means(results, _at_rate(key, rate), list(SCENARIOS)) for key in keys)
            for index, (quantity, unit) in enumerate((("distance", "cm"), ("heading", "deg"))):
                value = ours[index]
                title = f"{METHODS[method].title}, {rate:g} Hz, {quantity}"
                if value is not None:
                    rows.append(Row(protocol, title, unit, value, paper[index], raw[index]))
    return rows
