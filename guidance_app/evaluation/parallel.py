"""Spreads independent jobs over processes, or does them here when one process is asked for."""

import multiprocessing
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from typing import Protocol, TypeVar

__all__ = ["Spread", "ignore_interrupt", "in_this_process", "spread_over"]

Job = TypeVar("Job")
Answer = TypeVar("Answer")


class Spread(Protocol):
    """Like ``map``: does the work for each job, gives the answers in the order of the jobs."""

    def __call__(self, work: Callable[[Job], Answer], jobs: Sequence[Job]) -> list[Answer]:
        """The answers; ``work`` must be a function that another process can import."""
        ...


def in_this_process(work: Callable[[Job], Answer], jobs: Sequence[Job]) -> list[Answer]:
    """The answers, one after the other."""
    return [work(job) for job in jobs]


def ignore_interrupt() -> None:
    """A worker leaves Ctrl-C to the process that started it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def spread_over(processes: int) -> Iterator[Spread]:
    """Gives a :data:`Spread` over so many processes; 1 stays in this one. The processes end with the block."""
    if processes <= 1:
        yield in_this_process
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, mp_context=context, initializer=ignore_interrupt) as pool:

        def spread(work: Callable[[Job], Answer], jobs: Sequence[Job]) -> list[Answer]:
            return list(pool.map(work, jobs))

        try:
            yield spread
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
