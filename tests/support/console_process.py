"""A console in a process of its own, which a test may freeze and kill. Run as a program it is that process."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

__all__ = ["ConsoleProcess", "console_process"]

TESTS = Path(__file__).parent.parent
START_S = 60.0


class ConsoleProcess:
    """The running process and the address that it has printed."""

    def __init__(self, port: int) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-W", "error", str(Path(__file__)), str(port)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(TESTS), str(TESTS.parent)])},
        )
        assert self._process.stdout is not None
        self.address = self._process.stdout.readline().strip()
        assert self.address, "the console's process has not started"

    @property
    def port(self) -> int:
        return int(self.address.rpartition(":")[2])

    def freeze(self) -> None:
        self._process.send_signal(signal.SIGSTOP)

    def thaw(self) -> None:
        self._process.send_signal(signal.SIGCONT)

    def end(self) -> None:
        """Kills it; ``poll`` has its status afterwards, so no child is left."""
        if self._process.poll() is not None:
            return
        self._process.kill()
        self._process.communicate(timeout=START_S)


@contextlib.contextmanager
def console_process(port: int = 0) -> Iterator[ConsoleProcess]:
    """A console that drives along its line at 10 Hz, until the block ends."""
    process = ConsoleProcess(port)
    try:
        yield process
    finally:
        process.end()


def main() -> None:
    from support.consoles import running_console  # noqa: PLC0415 - only the process itself needs a console
    from support.sessions import HandSession, driven, driving  # noqa: PLC0415

    session = HandSession()
    with (
        running_console(session, port=int(sys.argv[1])) as console,
        driven(session, lambda now, sequence: driving(0.124, at=now, sequence=sequence)),
    ):
        sys.stdout.write(f"{console.addresses[0]}\n")
        sys.stdout.flush()
        threading.Event().wait()


if __name__ == "__main__":
    main()
