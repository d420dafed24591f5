"""Files that come and go by HTTP: what a panel awaits and offers, each under a name that cannot be guessed.

viser's own upload has no limit before the whole file is in memory, and its download none after; here the size is
checked while bytes come in, and nothing of a file that is too large is kept.
"""

import html
import secrets
import threading
from collections.abc import Callable
from dataclasses import dataclass

from guidance_app.language import Words

__all__ = [
    "LARGEST_UPLOAD",
    "LONGEST_NAME",
    "Download",
    "Files",
    "Maker",
    "NotMadeError",
    "Taker",
    "link_html",
    "made_link_html",
    "note_said",
    "upload_html",
]

LARGEST_UPLOAD = 64 * 1024 * 1024
"""Bytes; the largest real field archive has a few hundred thousand."""
LONGEST_NAME = 200

Taker = Callable[[str, bytes], None]
"""Takes the file's name and content, on a thread of its own; what it raises becomes a sentence for the person."""


@dataclass(frozen=True, slots=True)
class Download:
    """A file that leaves by HTTP."""

    name: str
    media_type: str
    data: bytes


class NotMadeError(Exception):
    """A file that was asked for cannot be made; the message is a sentence in the language of who asked."""


Maker = Callable[[], Download | None]
"""Makes a file when it is asked for; may raise ``NotMadeError``."""


class Files:
    """Which files are awaited and offered now. Its methods may be called from any thread."""

    def __init__(self) -> None:
        self._makers: dict[str, Maker] = {}
        self._takers: dict[str, tuple[Taker, int]] = {}
        self._lock = threading.Lock()

    def offer(self, make: Maker, name: str | None = None) -> str:
        """The address under which ``make``'s file leaves, made anew for each request; ``name`` instead of a token."""
        token = name or secrets.token_urlsafe(12)
        with self._lock:
            self._makers[token] = make
        return f"/download/{token}"

    def maker(self, token: str) -> Maker | None:
        """Who makes the file of this token."""
        return self._makers.get(token)

    def awaits(self, take: Taker, largest: int = LARGEST_UPLOAD) -> str:
        """The token under which a file of at most ``largest`` bytes may come in, until ``forget``."""
        token = secrets.token_urlsafe(12)
        with self._lock:
            self._takers[token] = (take, largest)
        return token

    def taker(self, token: str) -> Taker | None:
        """Who awaits a file under this token."""
        awaited = self._takers.get(token)
        return None if awaited is None else awaited[0]

    def largest(self, token: str) -> int:
        """So many bytes are taken at most under this token."""
        awaited = self._takers.get(token)
        return LARGEST_UPLOAD if awaited is None else awaited[1]

    def forget(self, token: str) -> None:
        """Nothing is awaited or offered under this token any more."""
        with self._lock:
            self._takers.pop(token, None)
            self._makers.pop(token.removeprefix("/download/"), None)


def link_html(address: str, words: str) -> str:
    """A link that looks like a button and stores the file."""
    return f'<a class="g-file" href="{html.escape(address)}" download>{html.escape(words)}</a>'


def made_link_html(address: str, words: str, making: str, failed: str) -> str:
    """The same for a file that takes its time: ``making`` stands in it meanwhile, ``failed`` when nothing came."""
    said = f'data-making="{html.escape(making)}" data-failed="{html.escape(failed)}"'
    return f'<a class="g-file" href="{html.escape(address)}" download {said}>{html.escape(words)}</a>'


def note_said(error: Exception, words: Words) -> str:
    """The sentence of an error in the language of ``words``."""
    first = error.args[0] if error.args else ""
    return words.say(first) if isinstance(first, str) else str(error)


def upload_html(token: str, words: str, accept: str = "") -> str:
    """A button that asks for a file and sends it; ``accept`` as in HTML (".kml,.zip")."""
    return (
        f'<label class="g-file">{html.escape(words)}'
        f'<input type="file" hidden data-upload="{html.escape(token)}" accept="{html.escape(accept)}"></label>'
    )
