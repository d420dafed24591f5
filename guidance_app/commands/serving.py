"""What demo, replay and run share: a session, its console, and an orderly end."""

import argparse
import contextlib
import signal
import threading
from collections.abc import Iterator
from pathlib import Path

from guidance_app.console.server import Console
from guidance_app.runtime import LiveSession, ReplaySession

__all__ = ["serve"]


def serve(session: LiveSession | ReplaySession, arguments: argparse.Namespace, data: Path, opening: str) -> int:
    """Opens the console on a session and stays until Ctrl-C or a termination signal. Raises ``ConsoleError``."""
    host = "0.0.0.0" if arguments.lan else "127.0.0.1"  # noqa: S104 - only when --lan asks for it, and behind a PIN
    console = Console(session, host=host, port=arguments.port, lan=arguments.lan)
    print(opening)
    print(f"data folder: {data}")
    address = console.start()
    try:
        session.start()
        print(f"the console is open at {address}", flush=True)
        print("stop it with Ctrl-C", flush=True)
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
