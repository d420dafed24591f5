"""Spreads tasks over the processes of this machine, or over a Dask cluster (an extra). Outcomes come as they are done.

A process or a worker that dies takes nothing with it: its tasks are given out again, but not for ever, as a task may be
what killed it.
"""

import multiprocessing
import signal
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from guidance_app.batch.many import Outcome, Task, brought_along, outcome_of
from guidance_app.evaluation.cluster import PER_THREAD, connected
from guidance_app.sources import SourceError
from guidance_app.store import StoreError

__all__ = ["clustered", "spread"]

TRIES = 2


def spread(tasks: Sequence[Task], processes: int) -> Iterator[Outcome]:
    """The outcomes, from so many processes of this machine; 1 does them here, one after the other."""
    if processes <= 1 or len(tasks) <= 1:
        yield from map(outcome_of, tasks)
        return
    waiting = deque(tasks)
    while waiting:
        struck: list[Task] = []
        yield from _one_pool(waiting, processes, struck)
        yield from _one_by_one(deque((task, 1) for task in struck))


def _one_pool(waiting: "deque[Task]", processes: int, struck: list[Task]) -> Iterator[Outcome]:
    """Until all is done, or a process has died, which breaks the whole pool; ``struck`` are the tasks it had then."""
    pending: dict[Future[Outcome], Task] = {}
    with _pool(min(processes, len(waiting))) as pool:
        try:
            while waiting or pending:
                while waiting and len(pending) < 2 * processes:
                    task = waiting.popleft()
                    struck.append(task)  # until it is known that the pool has taken it
                    pending[pool.submit(outcome_of, task)] = struck.pop()
                for future in wait(pending, return_when=FIRST_COMPLETED).done:
                    yield future.result()
                    del pending[future]
        except BrokenProcessPool:
            struck += pending.values()
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _one_by_one(tasks: "deque[tuple[Task, int]]") -> Iterator[Outcome]:
    """Those that were there when a process died, so that one of them can only take itself down."""
    while tasks:
        with _pool(1) as pool:
            try:
                while tasks:
                    outcome = pool.submit(outcome_of, tasks[0][0]).result()
                    tasks.popleft()
                    yield outcome
            except BrokenProcessPool:
                task, attempt = tasks.popleft()
                if attempt < TRIES:
                    tasks.appendleft((task, attempt + 1))
                else:
                    yield _given_up(task)


def _pool(processes: int) -> ProcessPoolExecutor:
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(processes, mp_context=context, initializer=_leave_ctrl_c)


def clustered(tasks: Sequence[Task], address: str) -> Iterator[Outcome]:
    """The outcomes, from the workers of the Dask scheduler at ``address``.

    Raises ``ClusterError`` when Dask is not installed or no scheduler answers.
    """
    with connected(address) as (client, done):
        yield from _arriving(client, done, deque((task, 1) for task in tasks))


def _arriving(client: Any, done: Any, waiting: "deque[tuple[Task, int]]") -> Iterator[Outcome]:
    """The outcomes as the cluster gives them; ``done`` is the client's queue of what is completed."""
    pending: dict[Any, tuple[Task, int]] = {}  # the content of so many is in memory at once
    while waiting or pending:
        threads = max(1, sum(client.nthreads().values()))
        while waiting and len(pending) < PER_THREAD * threads:
            task, attempt = waiting.popleft()
            try:
                full = brought_along(task)
            except (SourceError, StoreError) as error:
                yield Outcome(task.name, problem=str(error))
                continue
            future = client.submit(outcome_of, full, pure=False, retries=TRIES)
            pending[future] = (task, attempt)
            done.add(future)
        if not pending:
            return
        future = next(done)
        task, attempt = pending.pop(future)
        if future.status == "finished":
            yield future.result()
        elif attempt < TRIES:
            waiting.append((task, attempt + 1))
        else:
            yield _given_up(task)


def _given_up(task: Task) -> Outcome:
    return Outcome(task.name, problem=f"{task.name} was given up: the process that worked on it died every time")


def _leave_ctrl_c() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
