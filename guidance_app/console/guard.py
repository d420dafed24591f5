"""What stands around the whole front: nothing of it is reached without passing here. The rules are in ``access.py``."""

import html
from collections.abc import Callable, Mapping
from urllib.parse import parse_qs

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from guidance_app.console.access import Admitted, Door, Names, Refused, Wait, foreign
from guidance_app.console.front import ICON, Asset
from guidance_app.language import Words

__all__ = ["Guard"]

PIN_PAGE = "pin.html"
PIN_PATH = "/pin"
OPEN_FILES = frozenset({"pin.css", "pin.js", "icon.svg", ICON, "icon-512.png", "manifest.webmanifest"})
"""What the PIN page needs. A browser asks for manifest and icons without the cookie."""
LONGEST_FORM = 64
ENTER = (
    '<!doctype html><meta charset="utf-8"><title>Guidance</title><meta http-equiv="refresh" content="0;url=/">'
    '<p><a href="/">Open the console</a></p>'
)
"""After the PIN in an address: the browser goes on by itself, so that the next request counts as our own page's."""

ON_EVERY_RESPONSE = {
    "Content-Security-Policy": (
        "default-src 'self' data: blob: 'unsafe-inline' 'unsafe-eval' 'wasm-unsafe-eval'; "
        "frame-ancestors 'none'; base-uri 'none'; form-action 'self'; object-src 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
"""The page is one file of inline script and compiled code; beyond that it may reach this console and nothing else."""


class Guard:
    """Lets through to ``app`` what comes from our own page and, on a network, from a browser that has shown the PIN."""

    def __init__(
        self,
        app: ASGIApp,
        door: Door,
        files: Mapping[str, Asset],
        names: Names,
        *,
        cookie: str,
        words: Callable[[], Words],
    ) -> None:
        self._app = app
        self._words = words
        self._door = door
        self._files = files
        self._names = names
        self._cookie = cookie

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """One request or one socket."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        socket = scope["type"] == "websocket"
        visitor = HTTPConnection(scope)
        why = foreign(visitor.headers, self._names, socket=socket)
        admitted = self._door.admits(visitor.cookies.get(self._cookie))
        if socket:
            if why is None and admitted:
                await self._app(scope, receive, send)
            else:
                await send({"type": "websocket.close", "code": 1008})
            return
        send = _with_headers(send)
        if why is not None:
            await PlainTextResponse(f"Refused: {why}.\n", 403)(scope, receive, send)
        elif admitted and scope["path"] != PIN_PATH:
            await self._app(scope, receive, send)
        else:
            response = await self._at_the_door(Request(scope, receive))
            await response(scope, receive, send)

    async def _at_the_door(self, request: Request) -> Response:
        """What a browser gets that has not shown the PIN."""
        path = request.url.path
        name = ICON if path == "/favicon.ico" else path.removeprefix("/static/")
        if name != path and name in OPEN_FILES and name in self._files:
            return self._files[name].response(request)
        if path == PIN_PATH:
            if request.method != "POST":
                return RedirectResponse("/", 303)
            return self._knock(request, await _posted_pin(request))
        if path != "/":
            return PlainTextResponse("Show the PIN first.\n", 401)
        if "pin" in request.query_params:
            return self._knock(request, request.query_params["pin"])
        return self._pin_page("", 0.0, 401)

    def _knock(self, request: Request, pin: str) -> Response:
        words = self._words()
        match self._door.knock("" if request.client is None else request.client.host, pin.strip()):
            case Admitted(token):
                entered = HTMLResponse(ENTER, headers={"Cache-Control": "no-store", "Referrer-Policy": "no-referrer"})
                entered.set_cookie(
                    self._cookie, token, httponly=True, samesite="strict", secure=request.url.scheme == "https"
                )
                return entered
            case Refused(0, seconds):
                return self._pin_page(words("Wrong PIN."), seconds, 401)
            case Refused(tries, _):
                left = words.plural("Wrong PIN. {n} try left.", "Wrong PIN. {n} tries left.", tries)
                return self._pin_page(left, 0.0, 401)
            case Wait(seconds):
                return self._pin_page(words("Too many wrong PINs."), seconds, 429)

    def _pin_page(self, message: str, wait: float, status: int) -> Response:
        page = self._files[PIN_PAGE].body.decode()
        said = _said(self._words()) | {"message": message, "wait": f"{max(0.0, wait):.0f}"}
        for name, text in said.items():
            page = page.replace(f"{{{name}}}", html.escape(text))
        headers = {"Cache-Control": "no-store"} | ({"Retry-After": f"{wait + 1:.0f}"} if wait else {})
        return HTMLResponse(page, status, headers)


def _said(words: Words) -> dict[str, str]:
    """What the PIN page says, by the names in its braces."""
    return {
        "language": words.language,
        "title": words("Guidance: PIN"),
        "heading": words("Guidance console"),
        "hint": words("Type the PIN that stands in the console's terminal."),
        "digits": words("PIN, six digits"),
        "open": words("Open"),
        "clear": words.within("keypad", "Clear"),
        "back": words.within("keypad", "Back"),
        "delete": words("Delete the last digit"),
        "waiting": words("Wait {seconds} s."),
    }


async def _posted_pin(request: Request) -> str:
    """The form's one field; a body that is longer than any PIN is not read to its end."""
    body = b""
    async for part in request.stream():
        body += part
        if len(body) > LONGEST_FORM:
            return ""
    return parse_qs(body.decode("ascii", "replace")).get("pin", [""])[0]


def _with_headers(send: Send) -> Send:
    async def send_with_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in ON_EVERY_RESPONSE.items():
                headers.setdefault(name, value)
        await send(message)

    return send_with_headers
