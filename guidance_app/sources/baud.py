"""Which baud rate a serial device speaks: found by trying, and remembered for the next time.

Each rate gets 1.2 s of bytes, 2.5 s when one whole sentence has come; it is taken after two. Nothing is tried while
nothing comes: silence says nothing about the rate. When bytes go on for 5 s without a whole sentence at the rate that
was taken (somebody has set the receiver anew), the search begins again.
"""

import json
import logging
import os
from pathlib import Path

from platformdirs import user_state_path

from guidance_app.decode.framing import Framer
from guidance_app.decode.nmea import has_checksum, read_line
from guidance_app.decode.sentence import DecodeError

__all__ = ["BAUD_RATES", "BaudHunt", "BaudMemory"]

log = logging.getLogger(__name__)

BAUD_RATES = (115200, 460800, 38400, 9600, 57600, 230400, 921600, 4800)
"""In the order in which they are tried: today's usual ones first."""

TRY_S = 1.2
LONGER_TRY_S = 2.5
LOST_S = 5.0
NEEDED = 2
LARGEST_FILE = 1 << 16


class BaudHunt:
    """Looks at what comes and says which rate to set next. It reads no clock; times are session seconds."""

    def __init__(self, first: int | None = None) -> None:
        self._rates = BAUD_RATES if first is None else (first, *(one for one in BAUD_RATES if one != first))
        self._place = 0
        self.found = False
        self._framer = Framer()
        self._whole = 0
        self._since: float | None = None

    @property
    def rate(self) -> int:
        """The rate that was taken, or is tried now."""
        return self._rates[self._place]

    def hear(self, data: bytes, now: float) -> bool:
        """Bytes that came at ``rate``; whether ``rate`` or ``found`` has changed."""
        if not data:
            return False
        self._since = now if self._since is None else self._since
        whole = sum(_is_whole(line) for line in self._framer.feed(data))
        return self._keep(whole, now) if self.found else self._try(whole, now)

    def _keep(self, whole: int, now: float) -> bool:
        if whole:
            self._since = None
        elif self._since is not None and now - self._since > LOST_S:
            self.found = False
            self._next()
            return True
        return False

    def _try(self, whole: int, now: float) -> bool:
        self._whole += whole
        tried = now - (now if self._since is None else self._since)
        if self._whole >= NEEDED:
            self.found = True
            self._since = None
            return True
        if tried > (LONGER_TRY_S if self._whole else TRY_S):
            self._next()
            return True
        return False

    def _next(self) -> None:
        self._place = (self._place + 1) % len(self._rates)
        self._listen()

    def _listen(self) -> None:
        self._framer = Framer()
        self._whole = 0
        self._since = None


def _is_whole(line: str) -> bool:
    """Whether the line carries a checksum and it is right, whatever the sentence."""
    try:
        read_line(line)
    except DecodeError as error:
        return str(error) == "unknown sentence" and has_checksum(line)
    return has_checksum(line)


class BaudMemory:
    """Rate by device, in a small file. What cannot be read or written is as if it were not there: only time is lost."""

    def __init__(self, path: Path | None = None) -> None:
        self._path = path

    @property
    def path(self) -> Path:
        """The file: the one given, else in the user's folder for such things."""
        return self._path or user_state_path("guidance-app", appauthor=False) / "baud-rates.json"

    def recall(self, device: str) -> int | None:
        """The rate that this device spoke last time."""
        rate = self._all().get(device)
        return rate if rate in BAUD_RATES else None

    def keep(self, device: str, rate: int) -> None:
        """Remembers it, unless it is known."""
        known = self._all()
        if known.get(device) == rate:
            return
        path = self.path
        beside = path.with_name(f"{path.name}.{os.getpid()}")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            beside.write_text(json.dumps({**known, device: rate}, indent=1), encoding="utf-8")
            beside.replace(path)
        except OSError as error:
            log.info("the baud rate of %s is not remembered: %s", device, error)

    def _all(self) -> dict[str, int]:
        try:
            if self.path.stat().st_size > LARGEST_FILE:
                return {}
            known = json.loads(self.path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        if not isinstance(known, dict):
            return {}
        return {device: rate for device, rate in known.items() if isinstance(rate, int)}
