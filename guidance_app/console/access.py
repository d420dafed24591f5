"""Who may come in: the PIN, the session cookie, and what a request must say about where it comes from.

Two dangers are kept out, also on this machine alone. A foreign web page open in the same browser may send requests here
(so Origin must equal Host, and the browser's own word on cross-site requests is heard), and it may give this machine's
address a name of its own (so Host must be a name or number of this machine).

On a network a six-digit PIN stands before everything. Wrong ones are counted by address: after five within a minute the
address waits, and so does everybody after twenty. Guessing all PINs at that pace takes a month.
"""

import hmac
import ipaddress
import secrets
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from urllib.parse import urlsplit

__all__ = ["Admitted", "Door", "Names", "Refused", "Wait", "foreign", "new_pin"]

PIN_DIGITS = 6
TRIES = 5
TRIES_OF_ALL = 20
WINDOW_S = 60.0
SESSIONS = 64
"""So many browsers may be signed in; one more signs out the oldest."""


def new_pin() -> str:
    """Six random digits."""
    return f"{secrets.randbelow(10**PIN_DIGITS):0{PIN_DIGITS}d}"


@dataclass(frozen=True, slots=True)
class Admitted:
    """The PIN was right; the browser keeps this token as its cookie."""

    token: str


@dataclass(frozen=True, slots=True)
class Refused:
    """The PIN was wrong. So many tries are left in this minute; when none is, ``seconds`` until the next."""

    tries_left: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Wait:
    """Too many wrong PINs; no PIN is looked at for so many seconds."""

    seconds: float


class Door:
    """Remembers who has shown the PIN and who has tried. Without a PIN everybody is in. One thread only."""

    def __init__(self, pin: str | None, clock: Callable[[], float] = time.monotonic) -> None:
        if pin is not None and not (len(pin) == PIN_DIGITS and pin.isascii() and pin.isdigit()):
            msg = f"a PIN has {PIN_DIGITS} digits, not {pin!r}"
            raise ValueError(msg)
        self._pin = pin
        self._clock = clock
        self._tokens: deque[str] = deque(maxlen=SESSIONS)
        self._wrong: deque[tuple[float, str]] = deque()

    def admits(self, token: str | None) -> bool:
        """Whether this cookie belongs to a browser that has shown the PIN; always without a PIN."""
        if self._pin is None:
            return True
        if token is None:
            return False
        return any(hmac.compare_digest(known.encode(), token.encode()) for known in self._tokens)

    def knock(self, address: str, pin: str) -> Admitted | Refused | Wait:
        """One try from ``address``. While an address waits, even the right PIN is not looked at."""
        now = self._clock()
        while self._wrong and now - self._wrong[0][0] >= WINDOW_S:
            self._wrong.popleft()
        own = [when for when, who in self._wrong if who == address]
        if len(own) >= TRIES:
            return Wait(own[-TRIES] + WINDOW_S - now)
        if len(self._wrong) >= TRIES_OF_ALL:
            return Wait(self._wrong[-TRIES_OF_ALL][0] + WINDOW_S - now)
        if self._pin is None or not hmac.compare_digest(self._pin.encode(), pin.encode()):
            self._wrong.append((now, address))
            left = TRIES - len(own) - 1
            return Refused(left, 0.0 if left else [*own, now][-TRIES] + WINDOW_S - now)
        token = secrets.token_urlsafe(32)
        self._tokens.append(token)
        return Admitted(token)


@dataclass(frozen=True, slots=True)
class Names:
    """By what names a browser may call this console: these, and with ``any_number`` every numeric address too."""

    names: frozenset[str]
    any_number: bool = False


def foreign(headers: Mapping[str, str], called: Names, *, socket: bool) -> str | None:
    """Why a request is not from our own page, in words; None when it is.

    A ``socket`` must say its Origin, as every browser does; other requests may leave it out.
    """
    host = headers.get("host", "")
    name = _host_name(host)
    if name not in called.names and not (called.any_number and _is_number(name)):
        return "the Host is not this console's"
    origin = headers.get("origin")
    if origin is None and socket:
        return "a socket without an Origin"
    if origin is not None and urlsplit(origin).netloc.lower() != host.lower():
        return "the Origin is not this console's"
    if headers.get("sec-fetch-site") in {"cross-site", "same-site"} and not _is_navigation(headers):
        return "asked for by another site"
    return None


def _is_navigation(headers: Mapping[str, str]) -> bool:
    """A link that a person follows from elsewhere to our page is no danger: nothing of it can be read there."""
    return headers.get("sec-fetch-mode") == "navigate" and headers.get("sec-fetch-dest") == "document"


def _host_name(host: str) -> str:
    """The host without its port, in lower case; empty when it is not a host at all."""
    try:
        return (urlsplit(f"//{host}").hostname or "").rstrip(".")
    except ValueError:
        return ""


def _is_number(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
