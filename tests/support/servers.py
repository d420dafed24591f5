"""Servers on this machine that say what a test wants: for receivers in the network, gpsd and casters."""

import contextlib
import socket
import threading
from collections.abc import Callable, Iterator

__all__ = ["PATIENCE_S", "Server", "free_port", "server"]

PATIENCE_S = 60.0


def free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    """A port that nothing listens at now."""
    with socket.socket(socket.AF_INET, kind) as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


class Server:
    """Answers each connection by ``answer(connection, number)`` on a thread of its own and then closes it."""

    def __init__(self, answer: Callable[[socket.socket, int], None], port: int = 0) -> None:
        self._answer = answer
        self._open: list[socket.socket] = []
        self._listening = socket.create_server(("127.0.0.1", port))
        self.port = int(self._listening.getsockname()[1])
        self._threads: list[threading.Thread] = []
        self._thread = threading.Thread(target=self._run, name="server")
        self._thread.start()

    def _run(self) -> None:
        while True:
            try:
                connection, _ = self._listening.accept()
            except OSError:
                return
            connection.settimeout(PATIENCE_S)
            self._open.append(connection)
            thread = threading.Thread(target=self._serve, args=(connection, len(self._open)), name="answer")
            self._threads.append(thread)
            thread.start()

    def _serve(self, connection: socket.socket, number: int) -> None:
        with connection, contextlib.suppress(OSError):
            self._answer(connection, number)

    def close(self) -> None:
        self._listening.shutdown(socket.SHUT_RDWR)
        self._listening.close()
        self._thread.join(PATIENCE_S)
        for one in self._open:
            with contextlib.suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
        for thread in self._threads:
            thread.join(PATIENCE_S)
        assert not any(thread.is_alive() for thread in self._threads)


@contextlib.contextmanager
def server(answer: Callable[[socket.socket, int], None], port: int = 0) -> Iterator[Server]:
    """Meanwhile it answers."""
    one = Server(answer, port)
    try:
        yield one
    finally:
        one.close()
