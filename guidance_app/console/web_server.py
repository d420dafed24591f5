"""uvicorn on a thread and a loop of its own: begins when told, ends when told, leaves no thread behind."""

import socket
import threading

import uvicorn
from starlette.types import ASGIApp

from guidance_app.console.address import ConsoleError

__all__ = ["WebServer"]

START_S = 15.0
STOP_S = 10.0
GRACE_S = 3
"""So long may sockets take to say goodbye."""
BIGGEST_MESSAGE = 64 * 1024 * 1024
"""The largest message from a browser: viser's own limit is 50 MB, and its upload button splits files."""


class _Uvicorn(uvicorn.Server):
    """Tells when it is ready."""

    def __init__(self, config: uvicorn.Config) -> None:
        super().__init__(config)
        self.ready = threading.Event()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self.ready.set()


class WebServer:
    """Serves ``app`` on a listening socket, from construction until ``close``."""

    def __init__(self, app: ASGIApp, listener: socket.socket) -> None:
        self._listener = listener
        self._server = _Uvicorn(
            uvicorn.Config(
                app,
                log_config=None,
                log_level="error",
                access_log=False,
                server_header=False,
                lifespan="on",
                ws="websockets-sansio",
                ws_max_size=BIGGEST_MESSAGE,
                ws_per_message_deflate=False,
                timeout_graceful_shutdown=GRACE_S,
            )
        )
        self._thread = threading.Thread(target=self._run, name="console-front", daemon=True)
        self._thread.start()
        if not self._server.ready.wait(START_S) or not self._server.started:
            self.close()
            msg = "The web server did not start; the lines above say why."
            raise ConsoleError(msg)

    def _run(self) -> None:
        try:
            self._server.run(sockets=[self._listener])
        finally:
            self._server.ready.set()

    def close(self) -> None:
        """Ends every connection and the thread; again is harmless."""
        self._server.should_exit = True
        self._thread.join(STOP_S)
