"""The way from our front to viser's socket: frames pass both ways as they are, and one side's pace holds the other's.

viser listens on this machine alone and takes sockets only from here (``inner.py``), so whoever reaches it has passed
the PIN and the Origin check.
"""

from collections.abc import Iterable
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.typing import Subprotocol

from guidance_app.console.tasks import until_one_ends

__all__ = ["pass_through"]

NORMAL_CLOSE, GOING_AWAY, TRY_AGAIN = 1000, 1001, 1013
OPEN_TIMEOUT_S = 5.0
CLOSE_TIMEOUT_S = 2.0
SUBPROTOCOL = "viser-v"


async def pass_through(page: WebSocket, inner_uri: str, headers: dict[str, str]) -> None:
    """Joins a browser's socket to viser's until either closes; the close code goes on to the other side."""
    wanted = [Subprotocol(name) for name in _viser_protocols(page.scope.get("subprotocols", ()))]
    try:
        inner = await connect(
            inner_uri,
            subprotocols=wanted or None,
            additional_headers=headers,
            compression=None,
            max_size=None,
            ping_interval=None,
            open_timeout=OPEN_TIMEOUT_S,
            close_timeout=CLOSE_TIMEOUT_S,
            proxy=None,
        )
    except (OSError, TimeoutError, InvalidHandshake):
        await page.close(TRY_AGAIN)
        return
    async with inner:
        await page.accept(subprotocol=inner.subprotocol)
        await until_one_ends(_to_viser(page, inner), _to_page(inner, page))
        if page.client_state is WebSocketState.CONNECTED and page.application_state is WebSocketState.CONNECTED:
            await page.close(_sendable(inner.close_code), inner.close_reason or None)


def _viser_protocols(offered: Iterable[str]) -> list[str]:
    return [name for name in offered if name.startswith(SUBPROTOCOL)]


async def _to_viser(page: WebSocket, inner: ClientConnection) -> None:
    while True:
        message: dict[str, Any] = dict(await page.receive())
        if message["type"] == "websocket.disconnect":
            await inner.close(_sendable(message.get("code")))
            return
        data = message.get("bytes")
        try:
            await inner.send(data if data is not None else message["text"])
        except ConnectionClosed:
            return


async def _to_page(inner: ClientConnection, page: WebSocket) -> None:
    try:
        async for message in inner:
            if isinstance(message, bytes):
                await page.send_bytes(message)
            else:
                await page.send_text(message)
    except (ConnectionClosed, WebSocketDisconnect):
        return


def _sendable(code: int | None) -> int:
    """A close code that may stand in a frame: 1005, 1006 and 1015 only ever describe what happened on one side."""
    if code is None or code in {1005, 1006, 1015} or not 1000 <= code <= 4999:
        return NORMAL_CLOSE if code == 1005 else GOING_AWAY
    return code
