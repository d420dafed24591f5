"""What demo, replay and run share: a session, its console, and an orderly end."""

import argparse
import contextlib
import signal
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

from guidance_app.console.server import Console
from guidance_app.runtime import Session, SessionManager, Warming
from guidance_app.store import Store

__all__ = ["serve"]

PATIENCE_S = 2.0
"""A wait that is longer is explained."""


def serve(session: Session | None, arguments: argparse.Namespace, data: Path, opening: str) -> int:
    """Opens the console and stays until Ctrl-C or a termination signal. Raises ``ConsoleError``.

    It begins with ``session``, or without one where things are set up, and changes to what the driver wants later.
    """
    manager = SessionManager(session)
    console = Console(manager, port=arguments.port, lan=arguments.lan, store=Store(data))
    print(opening)
    print(f"data folder: {data}")
    console.start()
    try:
        _warm_up(manager, arguments.filter if "filter" in arguments else None, wait=session is not None)
        manager.start()
        print(console.invitation(colour=sys.stdout.isatty()))
        print("Stop it with Ctrl-C.", flush=True)
        with _until_stopped() as stopped:
            stopped.wait()
    finally:
        console.close()
        manager.close()
    return 0


def _warm_up(manager: SessionManager, filter_name: str | None, *, wait: bool) -> None:
    """Compiles what a drive needs before it begins; with nothing to drive yet, beside the setup. The page says so."""
    warming = Warming(filter_name, manager.say)
    warming.start()
    if wait and not warming.done(PATIENCE_S):
        print("compiling the filters: only the first start takes this long ...", flush=True)
        warming.done()


@contextlib.contextmanager
def _until_stopped() -> Iterator[threading.Event]:
    """An event that Ctrl-C and a termination signal set."""
    stopped = threading.Event()

    def stop(_number: int, _frame: object) -> None:
        stopped.set()

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stopped
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
