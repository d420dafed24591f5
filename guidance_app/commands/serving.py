"""What demo, replay and run share: a session, its console, and an orderly end."""

import argparse
import contextlib
import signal
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

from guidance_app.console.server import Console
from guidance_app.runtime import LiveSession, ReplaySession

__all__ = ["serve"]


def serve(session: LiveSession | ReplaySession, arguments: argparse.Namespace, data: Path, opening: str) -> int:
    """Opens the console on a session and stays until Ctrl-C or a termination signal. Raises ``ConsoleError``."""
    console = Console(session, port=arguments.port, lan=arguments.lan)
    print(opening)
    print(f"data folder: {data}")
    console.start()
    try:
        session.start()
        print(console.invitation(colour=sys.stdout.isatty()))
        print("Stop it with Ctrl-C.", flush=True)
        with _until_stopped() as stopped:
            stopped.wait()
    finally:
        console.close()
        session.close()
    return 0


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
