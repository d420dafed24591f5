"""Finding Q and R of the four-state filter: the Monte Carlo search of Gomez-Gil et al. (2013), and CMA-ES beside it.

Both minimise the same :class:`~guidance_app.evaluation.objectives.Objective` and give their best so far again and
again, so that whoever waits may stop at any time and keep it. The Monte Carlo search draws the elements of Q and R
evenly from 0 to 6, as the paper does; its draws are cut into chunks with random numbers of their own, so that one
process, many processes and a cluster find the same winner. CMA-ES (Hansen 2001) searches the logarithms and needs two
or three thousand evaluations instead of two million.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

import numpy as np

from guidance_app.estimation.filter import FilterSettings, QuantisationSettings
from guidance_app.evaluation.kernels import best_of
from guidance_app.evaluation.objectives import Objective
from guidance_app.evaluation.parallel import ignore_interrupt
from guidance_app.evaluation.scenarios import Purpose
from guidance_app.model import FloatArray

__all__ = [
    "CHUNK",
    "Chunk",
    "ChunkBest",
    "Found",
    "OptimiserMissingError",
    "Validation",
    "best_of_chunk",
    "best_so_far",
    "chunks_of",
    "cma_search",
    "cross_validation",
    "new_search",
    "noise_of",
    "random_search",
    "settings_from",
]

HIGHEST = 6.0
"""The paper draws each element of Q and R from 0 to here."""

CHUNK = 5000
LOG_BOUNDS = (math.log(1e-6), math.log(1e3))
EVALUATIONS = 4000
FOLDS = 5


class OptimiserMissingError(Exception):
    """The package with the optimiser is not installed."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """A number of draws with random numbers of their own."""

    seed: int
    number: int
    size: int


@dataclass(frozen=True, slots=True, eq=False)
class ChunkBest:
    """The smallest sum of squares of a chunk's draws and the draw itself."""

    number: int
    draws: int
    total: float
    noise: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """The best so far. ``noise`` holds the diagonals of Q, R and P0, ``rms`` is in metres."""

    noise: FloatArray
    rms: float
    evaluations: int
    of: int


def noise_of(settings: QuantisationSettings) -> FloatArray:
    """The diagonals of Q, R and P0 in one row (12 numbers)."""
    return np.array(settings.numbers)


def settings_from(noise: FloatArray, base: FilterSettings | None = None) -> FilterSettings:
    """The settings document with these diagonals; all else as in ``base``."""
    q, r, p0 = (tuple(float(f"{value:.6g}") for value in part) for part in np.split(noise, 3))
    part = QuantisationSettings.model_validate({"process_noise": q, "measurement_noise": r, "start_covariance": p0})
    return (base or FilterSettings()).model_copy(update={"quantisation_kf": part})


def chunks_of(samples: int, seed: int = int(Purpose.TUNING)) -> list[Chunk]:
    """``samples`` draws as chunks."""
    return [Chunk(seed, number, min(CHUNK, samples - first)) for number, first in enumerate(range(0, samples, CHUNK))]


def best_of_chunk(objective: Objective, chunk: Chunk) -> ChunkBest:
    """Draws the chunk and gives its best."""
    random = np.random.default_rng([chunk.seed, chunk.number])
    start = noise_of(QuantisationSettings())[8:]
    drawn = random.uniform(0.0, HIGHEST, (chunk.size, 8))
    draws = np.column_stack([drawn, np.broadcast_to(start, (chunk.size, 4))])
    total, row = best_of(objective.table, objective.starts, draws, np.inf)
    return ChunkBest(chunk.number, chunk.size, float(total), draws[row])


def random_search(objective: Objective, chunks: Sequence[Chunk], processes: int = 1) -> Iterator[Found]:
    """The best draw so far after each chunk, over so many processes; the order of arrival does not change the end."""
    objective = objective.hardest_first(noise_of(QuantisationSettings()))
    if processes <= 1:
        yield from best_so_far(objective, chunks, (best_of_chunk(objective, chunk) for chunk in chunks))
        return
    pool = ProcessPoolExecutor(processes, mp_context=get_context("spawn"), initializer=ignore_interrupt)
    try:
        yield from best_so_far(objective, chunks, _as_completed(pool, objective, chunks, 2 * processes))
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def cma_search(objective: Objective, seed: int = int(Purpose.TUNING)) -> Iterator[Found]:
    """The best so far after each generation of CMA-ES, started at the paper's equation 14."""
    first = noise_of(QuantisationSettings())
    start = first[8:]
    search = new_search(np.log(first[:8]), 1.5, LOG_BOUNDS, EVALUATIONS, seed)
    best = Found(first, objective.rms(first), 1, EVALUATIONS)
    yield best
    while not search.stop():
        asked = search.ask()
        rms = [objective.rms(np.concatenate([np.exp(point), start])) for point in asked]
        search.tell(asked, rms)
        winner = int(np.argmin(rms))
        done = best.evaluations + len(asked)
        noise, least = best.noise, best.rms
        if rms[winner] < least:
            noise, least = np.concatenate([np.exp(asked[winner]), start]), rms[winner]
        best = Found(noise, least, done, max(EVALUATIONS, done))
        yield best


def new_search(
    start: FloatArray,
    step: float,
    bounds: tuple[float, float] | tuple[FloatArray, FloatArray],
    evaluations: int,
    seed: int,
) -> Any:
    """A CMA-ES search with ``ask``, ``tell`` and ``stop``. Raises :class:`OptimiserMissingError` without cma."""
    try:
        import cma  # noqa: PLC0415 - an extra
    except ModuleNotFoundError as error:
        msg = "the optimiser cma is not installed; pip install 'guidance-app[tune]', or take --method random"
        raise OptimiserMissingError(msg) from error
    options = {"seed": seed, "verbose": -9, "bounds": list(bounds), "maxfevals": evaluations, "verb_log": 0}
    return cma.CMAEvolutionStrategy(start, step, {**options, "tolfun": 1e-7, "tolx": 1e-4})


@dataclass(frozen=True, slots=True)
class Validation:
    """Errors in metres on pieces that the tuning did not see: with the tuned and with the default numbers."""

    tuned: float
    default: float
    folds: int


def cross_validation(objective: Objective, search: Callable[[Objective], Iterator[Found]]) -> Iterator[Validation]:
    """After each fold what the tuning is worth on the fifth that it did not see, all folds so far pooled."""
    folds = min(FOLDS, len(objective.names))
    shares = np.array_split(np.arange(len(objective.names)), folds)
    default = noise_of(QuantisationSettings())
    tuned_sum = default_sum = count = 0.0
    for number, share in enumerate(shares, start=1):
        kept = [piece for piece in range(len(objective.names)) if piece not in share]
        unseen = objective.picked(share.tolist())
        *_, best = search(objective.picked(kept))
        tuned_sum += unseen.rms(best.noise) ** 2 * unseen.count
        default_sum += unseen.rms(default) ** 2 * unseen.count
        count += unseen.count
        yield Validation(math.sqrt(tuned_sum / count), math.sqrt(default_sum / count), number)


def best_so_far(objective: Objective, chunks: Sequence[Chunk], arriving: Iterable[ChunkBest]) -> Iterator[Found]:
    """The best draw after each chunk that arrives, in whatever order. Of equal ones the lower number wins."""
    of = sum(chunk.size for chunk in chunks)
    done, best = 0, None
    for chunk in arriving:
        done += chunk.draws
        if best is None or (chunk.total, chunk.number) < (best.total, best.number):
            best = chunk
        yield Found(best.noise, math.sqrt(best.total / objective.count), done, of)


def _as_completed(pool: Executor, objective: Objective, chunks: Sequence[Chunk], at_once: int) -> Iterator[ChunkBest]:
    """The chunks' bests as they come, never more than ``at_once`` asked for."""
    waiting = list(reversed(chunks))
    asked: set[Future[ChunkBest]] = set()
    while waiting or asked:
        while waiting and len(asked) < at_once:
            asked.add(pool.submit(best_of_chunk, objective, waiting.pop()))
        done, asked = wait(asked, return_when=FIRST_COMPLETED)
        for future in done:
            yield future.result()
