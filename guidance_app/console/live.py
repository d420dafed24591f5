"""The light bar's hub: one small message to every page at once when something is new, and twenty a second between.

The picture between two fixes is carried forward on the server (``view.bar``), so a page only draws. A page answers each
message with its stamp when it has drawn it. That bounds what is under way to each: a page behind a slow network misses
messages instead of working through a queue of old ones, and the time from sending to drawn and answered is known.
"""

import asyncio
import contextlib
import json
import logging
import math
import secrets
import time
from collections import deque

from starlette.websockets import WebSocket, WebSocketDisconnect

from guidance_app.console.clock import shown_instant
from guidance_app.console.tasks import until_one_ends
from guidance_app.model import Snapshot
from guidance_app.runtime import Session
from guidance_app.view.bar import bar_of
from guidance_app.view.bar_wire import bar_json, style_json

__all__ = ["LiveHub"]

BETWEEN_S = 0.05
"""Without news, a message this often: the watchdog's food and the carried-forward picture."""
SHORTEST_S = 0.008
"""Two messages are never nearer than this, however fast a replay runs."""
UNDER_WAY = 4
"""So many messages may be unanswered by one page; then it misses some."""
LONGEST_ANSWER = 32

log = logging.getLogger(__name__)


class _Page:
    """One browser: whether there is something for it, and how many messages it has not answered."""

    def __init__(self) -> None:
        self.wanted = asyncio.Event()
        self.unanswered = 0
        self.style = ""


class LiveHub:
    """Makes each message once and hands it to every page. All but ``_hear`` runs on the front's loop."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._pages: set[_Page] = set()
        self._message = ""
        self._style = ""
        self._start = json.dumps({"style": {"start": secrets.token_urlsafe(6)}})
        self._loop: asyncio.AbstractEventLoop | None = None
        self._news = asyncio.Event()
        self._told = False
        self._last_fault = ""
        self.round_trips_ms: deque[float] = deque(maxlen=2048)
        """From sending a message to its answer after drawing, of the newest messages of all pages."""

    @property
    def pages(self) -> int:
        """How many pages listen."""
        return len(self._pages)

    async def run(self) -> None:
        """Feeds the pages until cancelled."""
        self._loop = asyncio.get_running_loop()
        stop_hearing = self._session.subscribe(self._hear)
        try:
            while True:
                await self._something()
                self._news.clear()
                self._told = False
                if self._pages:
                    self._compose()
                await asyncio.sleep(SHORTEST_S)
        finally:
            stop_hearing()

    async def _something(self) -> None:
        """Returns at news or when it is time for a message; without pages only a new page is news."""
        try:
            async with asyncio.timeout(BETWEEN_S - SHORTEST_S if self._pages else None):
                await self._news.wait()
        except TimeoutError:
            pass

    def _hear(self, _: Snapshot) -> None:
        """On the engine's thread: wakes the loop once, however many snapshots come before it has looked."""
        if self._told or self._loop is None:
            return
        self._told = True
        with contextlib.suppress(RuntimeError):  # the loop has just been closed
            self._loop.call_soon_threadsafe(self._news.set)

    def _compose(self) -> None:
        try:
            snapshot = self._session.snapshot()
            settings = self._session.job.settings
            self._style = style_json(settings, snapshot.look_ahead_s)
            view = bar_of(snapshot, shown_instant(self._session, snapshot), settings)
            self._message = bar_json(view, time.time() * 1000.0)
        except Exception as fault:
            # One odd snapshot must not end the bar: until it is gone the pages get nothing and say NO DATA.
            if repr(fault) != self._last_fault:
                self._last_fault = repr(fault)
                log.exception("the light bar could not be made")
            return
        for page in self._pages:
            page.wanted.set()

    async def serve(self, websocket: WebSocket) -> None:
        """One page's socket, from its opening to its end."""
        await websocket.accept()
        page = _Page()
        self._pages.add(page)
        self._news.set()
        try:
            await until_one_ends(self._tell(websocket, page), self._listen(websocket, page))
        finally:
            self._pages.discard(page)

    async def _tell(self, websocket: WebSocket, page: _Page) -> None:
        try:
            await websocket.send_text(self._start)
            while True:
                await page.wanted.wait()
                page.wanted.clear()
                if page.unanswered >= UNDER_WAY:
                    continue
                if page.style != self._style:
                    page.style = self._style
                    await websocket.send_text(page.style)
                page.unanswered += 1
                await websocket.send_text(self._message)
        except WebSocketDisconnect:
            return

    async def _listen(self, websocket: WebSocket, page: _Page) -> None:
        """Answers are the stamp of the message that has been drawn, nothing else."""
        try:
            while True:
                answer = await websocket.receive_text()
                sent = _stamp(answer)
                if sent is None:
                    await websocket.close(1003)
                    return
                page.unanswered = max(0, page.unanswered - 1)
                self.round_trips_ms.append(time.time() * 1000.0 - sent)
        except (WebSocketDisconnect, KeyError):  # KeyError: a message that is not text
            return


def _stamp(answer: str) -> float | None:
    if len(answer) > LONGEST_ANSWER:
        return None
    try:
        stamp = float(answer)
    except ValueError:
        return None
    return stamp if math.isfinite(stamp) else None
