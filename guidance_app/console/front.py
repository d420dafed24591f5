"""The web server in front of viser: the page, our files, the light bar's socket, viser's socket, files to and fro.

The page is viser's own, with our head put before ``</head>`` when the console starts; viser's package stays as it is.
All files are small and held in memory, so no request ever touches a path on disk. viser's page makes sockets to, and
plays recordings from, whatever address its query names, and runs what comes from there: a query is never let through.
"""

import asyncio
import contextlib
import gzip
import hashlib
import mimetypes
from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote, unquote

import viser
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, RedirectResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from guidance_app.console.files import LONGEST_NAME, Download, Files, Maker, NotMadeError, Taker
from guidance_app.console.live import LiveHub
from guidance_app.console.proxy import pass_through
from guidance_app.language import Words, message

__all__ = [
    "ICON",
    "Asset",
    "front_app",
    "own_files",
    "patched_page",
    "static_folder",
]

ANCHOR = "</head>"
HEAD = (
    '<link rel="manifest" href="/static/manifest.webmanifest">'
    '<link rel="apple-touch-icon" href="/static/icon-192.png">'
    '<link rel="icon" type="image/svg+xml" href="/static/icon.svg">'
    '<meta name="mobile-web-app-capable" content="yes">'
    '<link rel="stylesheet" href="/static/console.css">'
    '<script src="/static/page.js"></script>'
    '<script src="/static/touch.js"></script>'
    '<script src="/static/upload.js"></script>'
    '<script src="/static/download.js"></script>'
    '<script src="/static/forms.js"></script>'
    '<script type="module" src="/static/lightbar.js"></script>'
)
ICON = "icon-192.png"
"""What a browser gets that asks for the icon by its old name."""
MEDIA_TYPES = {".js": "text/javascript", ".webmanifest": "application/manifest+json", ".svg": "image/svg+xml"}
"""What the system's own table gets wrong on some machines."""


@dataclass(frozen=True, slots=True)
class Asset:
    """A file in memory, as it is and compressed, with the mark by which a browser knows that it has it already."""

    body: bytes
    zipped: bytes
    media_type: str
    etag: str

    @classmethod
    def of(cls, body: bytes, media_type: str) -> "Asset":
        """Compresses and marks ``body``."""
        mark = hashlib.sha256(body).hexdigest()[:20]
        return cls(body, gzip.compress(body, 6, mtime=0), media_type, f'"{mark}"')

    def response(self, request: Request) -> Response:
        """The file, or word that it has not changed."""
        headers = {"ETag": self.etag, "Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
        if self.etag in request.headers.get("if-none-match", ""):
            return Response(status_code=304, headers=headers)
        if "gzip" in request.headers.get("accept-encoding", "") and len(self.zipped) < len(self.body):
            headers["Content-Encoding"] = "gzip"
            return Response(self.zipped, headers=headers, media_type=self.media_type)
        return Response(self.body, headers=headers, media_type=self.media_type)


def static_folder() -> Path:
    """Our page's files: inside the installed package, or beside it in a checkout."""
    package = Path(__file__).parent.parent
    installed = package / "_static"
    return installed if installed.is_dir() else package.parent / "static"


def own_files(folder: Path) -> dict[str, Asset]:
    """Every file of the folder, by name."""
    return {path.name: Asset.of(path.read_bytes(), _media_type(path)) for path in folder.iterdir() if path.is_file()}


def patched_page() -> Asset:
    """The page: viser's own with our head in it."""
    page = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text("utf-8")
    before, anchor, after = page.partition(ANCHOR)
    if not anchor:
        msg = f"viser {viser.__version__}'s page has no {ANCHOR}: the console does not fit this version"
        raise RuntimeError(msg)
    return Asset.of(f"{before}{HEAD}{anchor}{after}".encode(), "text/html; charset=utf-8")


def _media_type(path: Path) -> str:
    return MEDIA_TYPES.get(path.suffix) or mimetypes.guess_type(path.name)[0] or "application/octet-stream"


def front_app(
    files: Mapping[str, Asset],
    hub: LiveHub,
    inner_uri: str,
    inner_headers: dict[str, str],
    exchanged: Files,
    language: Callable[[], Words],
) -> Starlette:
    """The whole front, without access control: ``guard.Guard`` goes around it."""
    page_file = patched_page()

    async def page(request: Request) -> Response:
        if request.url.query:
            return RedirectResponse("/", status_code=303)
        return page_file.response(request)

    async def own_file(request: Request) -> Response:
        found = files.get(request.path_params["name"])
        return PlainTextResponse("no such file", 404) if found is None else found.response(request)

    async def own_icon(request: Request) -> Response:
        return files[ICON].response(request)

    async def download(request: Request) -> Response:
        return await _made(exchanged.maker(request.path_params["name"]))

    async def upload(request: Request) -> Response:
        take, words = exchanged.taker(request.path_params["token"]), language()
        if take is None:
            return PlainTextResponse(words("No file is awaited here any more: open the form again."), 404)
        return await _taken(request, take, exchanged.largest(request.path_params["token"]), words)

    async def viser_socket(websocket: WebSocket) -> None:
        await pass_through(websocket, inner_uri, inner_headers)

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        feeding = asyncio.create_task(hub.run())
        yield
        feeding.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await feeding

    routes = [
        Route("/", page),
        Route("/static/{name}", own_file),
        Route("/favicon.ico", own_icon),
        Route("/download/{name}", download),
        Route("/upload/{token}", upload, methods=["POST"]),
        WebSocketRoute("/live", hub.serve),
        WebSocketRoute("/", viser_socket),
    ]
    return Starlette(routes=routes, lifespan=lifespan)


async def _made(make: Maker | None) -> Response:
    """What the maker makes, or its sentence on why it cannot."""
    try:
        made = None if make is None else await asyncio.to_thread(make)
    except NotMadeError as error:
        return PlainTextResponse(str(error), 409)
    return PlainTextResponse("nothing to download", 404) if made is None else _attached(made)


def _attached(made: Download) -> Response:
    headers = {
        "Content-Disposition": f"attachment; filename*=UTF-8''{quote(made.name, safe='')}",
        "Cache-Control": "no-store",
    }
    return Response(made.data, headers=headers, media_type=made.media_type)


async def _taken(request: Request, take: Taker, largest: int, words: Words) -> Response:
    """The posted file handed to who awaits it; one that is too large is not read to its end."""
    name = unquote(request.headers.get("x-file-name", ""))[:LONGEST_NAME] or "file"
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > largest:
            pattern = message("{name} is larger than {most} MB, the most that is taken; nothing was stored.")
            said = words(pattern, name=name, most=largest // 2**20)
            return PlainTextResponse(said, 413, {"Connection": "close"})
    await asyncio.to_thread(take, name, bytes(body))
    return PlainTextResponse("")
