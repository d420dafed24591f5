"""The Monte Carlo search on a Dask cluster (an extra): the same chunks, so the same winner, on many machines.

A worker that dies takes nothing with it: the scheduler gives its chunks to another, and what could not be given again
is asked for anew from here.
"""

import contextlib
from collections.abc import Iterator, Sequence
from typing import Any

from guidance_app.estimation.filter import QuantisationSettings
from guidance_app.evaluation.objectives import Objective
from guidance_app.evaluation.tuning import Chunk, ChunkBest, Found, best_of_chunk, best_so_far, noise_of

__all__ = ["PER_THREAD", "ClusterError", "cluster_search", "connected"]

PER_THREAD = 2
"""Tasks that are asked for at a time, for each thread of the cluster."""

CONNECT_S = 10
TRIES = 5


class ClusterError(Exception):
    """Why the cluster cannot be used, in a sentence."""


@contextlib.contextmanager
def connected(address: str) -> Iterator[tuple[Any, Any]]:
    """A client of the scheduler at ``address``, and its queue of what is completed; both go at the end.

    Raises :class:`ClusterError` when Dask is not installed or no scheduler answers.
    """
    try:
        import distributed  # noqa: PLC0415 - an extra
    except ModuleNotFoundError as error:
        msg = "Dask is not installed; pip install 'guidance-app[cluster]'"
        raise ClusterError(msg) from error
    try:
        client: Any = distributed.Client(address, timeout=CONNECT_S, set_as_default=False)  # type: ignore[no-untyped-call]  # the package has no types
    except (OSError, TimeoutError, ValueError) as error:
        msg = f"no Dask scheduler answers at {address}: {error}"
        raise ClusterError(msg) from error
    with client:
        yield client, distributed.as_completed(loop=client.loop, raise_errors=False)  # type: ignore[no-untyped-call]  # no types


def cluster_search(objective: Objective, chunks: Sequence[Chunk], address: str) -> Iterator[Found]:
    """The best draw so far after each chunk, computed by the workers of the scheduler at ``address``.

    Raises :class:`ClusterError` when Dask is not installed or no scheduler answers.
    """
    objective = objective.hardest_first(noise_of(QuantisationSettings()))
    with connected(address) as (client, asked):
        yield from best_so_far(objective, chunks, _arriving(client, asked, objective, chunks))


def _arriving(client: Any, asked: Any, objective: Objective, chunks: Sequence[Chunk]) -> Iterator[ChunkBest]:
    """The chunks' bests as the cluster gives them; ``asked`` is the client's queue of what is completed."""
    waiting = [(chunk, 1) for chunk in reversed(chunks)]
    pending: dict[Any, tuple[Chunk, int]] = {}
    while waiting or pending:
        threads = max(1, sum(client.nthreads().values()))
        while waiting and len(pending) < PER_THREAD * threads:
            chunk, attempt = waiting.pop()
            future = client.submit(best_of_chunk, objective, chunk, pure=False, retries=TRIES)
            pending[future] = (chunk, attempt)
            asked.add(future)
        future = next(asked)
        chunk, attempt = pending.pop(future)
        if future.status == "finished":
            yield future.result()
        elif attempt < TRIES:
            waiting.append((chunk, attempt + 1))
        else:
            msg = f"the cluster gave up on chunk {chunk.number} after {TRIES} tries: {future.exception()}"
            raise ClusterError(msg)
