"""viser, shut in: on loopback, on a port of the system's choice, open to our own front alone.

viser has no login, does not look at a socket's Origin, and lets every page ask for a public tunnel. So its tunnel
handlers are taken out, and a socket that does not carry this start's secret is closed before it is told anything: no
other program, user or web page of this machine can go round the front.
"""

import hmac
import secrets
import warnings

import rich
import viser
from viser._messages import ShareUrlDisconnect, ShareUrlRequest
from viser.infra import WebsockClientConnection

from guidance_app.console.address import LOOPBACK

__all__ = ["SECRET_HEADER", "InnerViser"]

SECRET_HEADER = "X-Guidance-Front"  # noqa: S105 - the header's name; its value is made at each start
POLICY_VIOLATION = 1008


class InnerViser:
    """A running viser server and what our front needs to reach it."""

    def __init__(self, label: str) -> None:
        # A browser that leaves between two redraws is nothing to tell the terminal; viser warns of it each time.
        warnings.filterwarnings("ignore", message="Queued a .* on a closed connection", category=UserWarning)
        rich.get_console().quiet = True  # viser prints an address that nobody can use; nothing else here uses rich
        self._secret = secrets.token_urlsafe(32)
        self.server = viser.ViserServer(host=LOOPBACK, port=0, label=label, verbose=False)
        sockets = self.server._websock_server  # noqa: SLF001 - viser offers no other way to its handlers
        for message in (ShareUrlRequest, ShareUrlDisconnect):
            sockets.unregister_handler(message)
        sockets.on_client_connect(self._turn_away_strangers)

    async def _turn_away_strangers(self, connection: WebsockClientConnection) -> None:
        socket = self.server._websock_server._live_connections[connection.client_id]  # noqa: SLF001 - the same
        shown = "" if socket.request is None else socket.request.headers.get(SECRET_HEADER, "")
        if not hmac.compare_digest(shown.encode(), self._secret.encode()):
            await socket.close(POLICY_VIOLATION, "not from the front")

    @property
    def uri(self) -> str:
        """Where viser's socket is."""
        return f"ws://{LOOPBACK}:{self.server.get_port()}/"

    @property
    def headers(self) -> dict[str, str]:
        """What a socket must say to be let in."""
        return {SECRET_HEADER: self._secret}

    def close(self) -> None:
        """Ends viser and its threads."""
        self.server.stop()
