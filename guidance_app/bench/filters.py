"""How long a fix takes: every filter of the console, and two peers on the same four-state filter in the same run.

The peers do exactly what ``quantisation_kf`` does (a test compares the numbers), so the ratio of the times is that of
the programs alone. Times are the best of several runs: what else the machine does only ever makes it slower.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from guidance_app.estimation.filters import make_filter
from guidance_app.evaluation.comparisons import Case, recording_of
from guidance_app.evaluation.gomez_gil import Reading, rounding_only
from guidance_app.evaluation.objectives import straight_objective
from guidance_app.evaluation.peers import (
    PeerMissingError,
    filterpy_four_state,
    four_state_input,
    stonesoup_four_state,
)
from guidance_app.evaluation.rows import Row, at_most
from guidance_app.evaluation.scenarios import straight_line
from guidance_app.evaluation.smoothed import smooth_recording
from guidance_app.evaluation.tracks import Recording, measurements
from guidance_app.evaluation.tuning import chunks_of, cma_search, random_search

__all__ = ["FilterTime", "filter_rows", "filter_times", "tuning_rows"]

FIXES = 2000
REPEATS = 3
MICROSECONDS = 1e6
TRIAL_DRAWS = 100_000
ALL_DRAWS = 2_000_000
"""As many as Gomez-Gil et al. (2013) drew."""


@dataclass(frozen=True, slots=True)
class FilterTime:
    """Microseconds a fix; ``ratio`` to our ``quantisation_kf``, None for what does something else."""

    name: str
    microseconds: float
    ratio: float | None = None


def filter_times() -> list[FilterTime]:
    """Our filters one fix at a time, as the console calls them, and the peers that are installed."""
    line = rounding_only(straight_line(0.5, 1.4, FIXES), Reading.TWO_STEP)
    ours = _per_fix(line, "quantisation_kf")
    times = [FilterTime("quantisation_kf", ours, 1.0)]
    z = four_state_input(line)
    peers: Sequence[tuple[str, Callable[[], object]]] = (
        ("filterpy, same filter", lambda: filterpy_four_state(z, 0.2)),
        ("Stone Soup, same filter", lambda: stonesoup_four_state(z[: FIXES // 4], 0.2)),
    )
    for name, peer in peers:
        fixes = FIXES if "filterpy" in name else FIXES // 4
        try:
            peer_time = _best(peer) / fixes * MICROSECONDS
        except PeerMissingError:
            continue
        times.append(FilterTime(name, peer_time, peer_time / ours))
    turning = recording_of(Case("position", "uturn", range(1)), 0)[1]
    everything = recording_of(Case("doppler gyro", "uturn", range(1)), 0)[1]
    times.append(FilterTime("off", _per_fix(line, "off")))
    times.append(FilterTime("gyro_ekf, Doppler and gyro", _per_fix(everything, "gyro_ekf")))
    times.append(FilterTime("adaptive, position only", _per_fix(turning, "adaptive")))
    times.append(FilterTime("adaptive, Doppler and gyro", _per_fix(everything, "adaptive")))
    smoothing = _best(lambda: smooth_recording(turning, None)) / len(turning) * MICROSECONDS
    times.append(FilterTime("smoother, position only", smoothing))
    return times


def filter_rows() -> list[Row]:
    """The times as rows; the peer of ``quantisation_kf`` is filterpy."""
    protocol = "Time per fix (peer: filterpy's same filter)"
    times = filter_times()
    peer = next((time.microseconds for time in times if time.name.startswith("filterpy")), None)
    goals = {"quantisation_kf": 2.0, "adaptive, position only": 20.0, "smoother, position only": 30.0}
    rows = []
    for entry in times:
        if entry.name.startswith(("filterpy", "Stone Soup")):
            continue
        goal = goals.get(entry.name)
        rows.append(
            Row(
                protocol, entry.name, "us", entry.microseconds, peer=peer if entry.ratio else None,
                goal=None if goal is None else at_most(goal),
            )
        )  # fmt: skip
    return rows


def tuning_rows(processes: int) -> list[Row]:
    """How long the searches take on the paper's 18 lines; the two million draws are timed on a part of them."""
    protocol = "Tuning on the paper's 18 lines"
    objective = straight_objective()
    for _ in random_search(objective, chunks_of(100)):
        """The kernel is compiled before anything is timed."""
    began = time.perf_counter()
    *_, optimum = cma_search(objective)
    seconds = time.perf_counter() - began
    began = time.perf_counter()
    *_, drawn = random_search(objective, chunks_of(TRIAL_DRAWS), processes)
    drawing = (time.perf_counter() - began) * ALL_DRAWS / TRIAL_DRAWS
    return [
        Row(protocol, "CMA-ES, time to the optimum", "s", seconds, goal=at_most(2.0)),
        Row(protocol, "CMA-ES, RMSE (straight lines only: not for driving)", "cm", 100 * optimum.rms, paper=3.74),
        Row(
            protocol, f"2 million draws on {processes} processes, time", "s", drawing, goal=at_most(80.0),
            note=f"from {TRIAL_DRAWS:,} draws",
        ),
        Row(protocol, f"{TRIAL_DRAWS:,} draws, RMSE", "cm", 100 * drawn.rms, paper=3.74),
    ]  # fmt: skip


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
    seconds = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - began)
    return min(seconds)
