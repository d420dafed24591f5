"""How long a fix takes: every filter of the console, and two peers on the same four-state filter in the same run.

The peers do exactly what ``quantisation_kf`` does (a test compares the numbers), so the ratio of the times is that of
the programs alone. Two things are timed, and each row says which: a **whole recording**, arrays in and arrays out, as
``evaluation.estimate`` and the smoother take it; and **one fix at a time**, ``Filter.step``, measurement in, pose out,
as the console calls it. The peers are called for each fix too, on the bare matrices, and compared with that. Times are
those of the processor, the best of several runs: what else the machine does only ever makes them longer.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

from guidance_app.bench.rows import Row, Subparsers, add_bench
from guidance_app.estimation.filter import QuantisationSettings
from guidance_app.estimation.filters import make_filter
from guidance_app.evaluation.comparisons import Case, recording_of
from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.gomez_gil import Reading, rounding_only
from guidance_app.evaluation.objectives import Objective, straight_objective
from guidance_app.evaluation.peers import (
    PeerMissingError,
    filterpy_four_state,
    four_state_input,
    stonesoup_four_state,
)
from guidance_app.evaluation.rows import Row as EvaluationRow
from guidance_app.evaluation.rows import at_most
from guidance_app.evaluation.scenarios import straight_line
from guidance_app.evaluation.smoothed import smooth_recording
from guidance_app.evaluation.tracks import Recording, measurements
from guidance_app.evaluation.tuning import Found, chunks_of, cma_search, noise_of, random_search

__all__ = ["FilterTime", "add_parser", "filter_rows", "filter_times", "rows_of", "tuning_rows"]

FIXES = 2000
FEWER = 400
"""Stone Soup is measured on fewer fixes: it is a hundred times slower."""
REPEATS = 5
MICROSECONDS = 1e6
TRIAL_DRAWS = 200_000
ALL_DRAWS = 2_000_000
"""As many as Gomez-Gil et al. (2013) drew."""
WHOLE = "quantisation_kf, whole recording"
STEPPED = "quantisation_kf, one fix at a time"
GOALS = {
    WHOLE: 2.0,
    "adaptive, position only, one fix at a time": 20.0,
    "smoother, position only, whole recording": 30.0,
}


@dataclass(frozen=True, slots=True)
class FilterTime:
    """Microseconds a fix; ``ratio`` to our ``quantisation_kf`` one fix at a time, None for what is something else."""

    name: str
    microseconds: float
    ratio: float | None = None


def add_parser(subparsers: Subparsers) -> None:
    """Describes the bench."""
    add_bench(
        subparsers,
        "filters",
        lambda _: rows_of(filter_times()),
        about="time per fix of every filter, beside filterpy and Stone Soup on the same four-state filter",
        does="Times every filter one fix at a time, quantisation_kf and the smoother over a whole recording,"
        " and both peers on the same filter in the same run.",
    )


def rows_of(times: list[FilterTime]) -> list[Row]:
    """The times as rows."""
    rows = []
    for entry in times:
        goal = GOALS.get(entry.name)
        rows.append(Row("filters", entry.name, entry.microseconds, "us", "" if goal is None else f"<= {goal:g}"))
        if entry.ratio is not None:
            rows.append(
                Row("filters", f"{entry.name}, over ours", entry.ratio, "x", note="one fix at a time, same run")
            )
    return rows


def filter_times() -> list[FilterTime]:
    """Our filters, and the peers that are installed."""
    line = rounding_only(straight_line(0.5, 1.4, FIXES), Reading.TWO_STEP)
    turning = recording_of(Case("position", "uturn", range(1)), 0)[1]
    everything = recording_of(Case("doppler gyro", "uturn", range(1)), 0)[1]
    ours = _per_fix(line, "quantisation_kf")
    whole = _best(lambda: estimate_recording(line, "quantisation_kf")) / len(line) * MICROSECONDS
    smoothing = _best(lambda: smooth_recording(turning)) / len(turning) * MICROSECONDS
    return [
        FilterTime(WHOLE, whole),
        FilterTime(STEPPED, ours),
        *_peer_times(line, ours),
        FilterTime("quantisation_kf, the tuning's error alone", _error_alone()),
        FilterTime("off, one fix at a time", _per_fix(line, "off")),
        FilterTime("gyro_ekf, Doppler and gyro, one fix at a time", _per_fix(everything, "gyro_ekf")),
        FilterTime("adaptive, position only, one fix at a time", _per_fix(turning, "adaptive")),
        FilterTime("adaptive, Doppler and gyro, one fix at a time", _per_fix(everything, "adaptive")),
        FilterTime("smoother, position only, whole recording", smoothing),
    ]


def filter_rows() -> list[EvaluationRow]:
    """The times as rows of ``evaluate``; the peer of ``quantisation_kf`` is filterpy."""
    protocol = "Time per fix (peer: filterpy's same filter, called for each fix)"
    times = {entry.name: entry for entry in filter_times()}
    peer = times.get("filterpy, same filter")
    rows = []
    for name, entry in times.items():
        if name.endswith("same filter"):
            continue
        goal = GOALS.get(name)
        compared = peer.microseconds if peer is not None and name in {WHOLE, STEPPED} else None
        rows.append(
            EvaluationRow(
                protocol,
                name,
                "us",
                entry.microseconds,
                peer=compared,
                goal=None if goal is None else at_most(goal),
            )
        )
    return rows


def tuning_rows(processes: int) -> list[EvaluationRow]:
    """How long the searches take on the paper's 18 lines; the two million draws are timed on a part of them."""
    protocol = "Tuning on the paper's 18 lines"
    objective = straight_objective()
    for _ in random_search(objective, chunks_of(100)):
        """The kernel is compiled before anything is timed."""
    began = time.process_time()
    *_, optimum = cma_search(objective)
    seconds = time.process_time() - began
    drawn, drawing = _drawing(objective, processes)
    return [
        EvaluationRow(protocol, "CMA-ES, time to the optimum", "s", seconds, goal=at_most(2.0)),
        EvaluationRow(
            protocol, "CMA-ES, RMSE (straight lines only: not for driving)", "cm", 100 * optimum.rms, paper=3.74
        ),
        EvaluationRow(
            protocol,
            f"2 million draws on {processes} processes, time",
            "s",
            drawing,
            goal=at_most(80.0),
            note=f"from {TRIAL_DRAWS:,} draws",
        ),
        EvaluationRow(protocol, f"{TRIAL_DRAWS:,} draws, RMSE", "cm", 100 * drawn.rms, paper=3.74),
    ]


def _drawing(objective: Objective, processes: int) -> tuple[Found, float]:
    """The best of the trial's draws, and how long all draws would take: the start, and the rest at the trial's pace."""
    began = time.perf_counter()
    search = random_search(objective, chunks_of(TRIAL_DRAWS), processes)
    first = next(search)
    started = time.perf_counter()
    *_, found = search
    pace = (time.perf_counter() - started) / (found.evaluations - first.evaluations)
    return found, started - began + pace * (ALL_DRAWS - first.evaluations)


def _peer_times(line: Recording, ours: float) -> list[FilterTime]:
    """The peers that are installed, with their ratio to ``ours``."""
    z = four_state_input(line)
    times = []
    for name, peer, fixes in (
        ("filterpy, same filter", filterpy_four_state, FIXES),
        ("Stone Soup, same filter", stonesoup_four_state, FEWER),
    ):
        part = z[:fixes]
        try:
            each = _best(lambda peer=peer, part=part: peer(part, 0.2)) / fixes * MICROSECONDS  # type: ignore[misc]  # defaults bind the loop's values
        except PeerMissingError:
            continue
        times.append(FilterTime(name, each, each / ours))
    return times


def _error_alone() -> float:
    """Microseconds a fix of the tuning's kernel, which keeps no poses."""
    objective = straight_objective(FIXES)
    noise = noise_of(QuantisationSettings())
    return _best(lambda: objective.rms(noise)) / objective.count * MICROSECONDS


def _per_fix(recording: Recording, name: str) -> float:
    """Microseconds a fix through ``Filter.step``."""
    fixes = list(measurements(recording))

    def whole() -> None:
        estimator = make_filter(name)
        for z in fixes:
            estimator.step(z)

    return _best(whole) / len(fixes) * MICROSECONDS


def _best(work: Callable[[], object]) -> float:
    """Seconds of the quickest of several runs, the first one (which compiles) not counted."""
    work()
    quickest = math.inf
    for _ in range(REPEATS):
        began = time.process_time()
        work()
        quickest = min(quickest, time.process_time() - began)
    return quickest
