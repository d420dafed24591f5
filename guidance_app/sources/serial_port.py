"""``serial:///dev/ttyUSB0?baud=115200``: a receiver at a serial port, or at a USB port that looks like one.

The port is ours alone while it is open. It is read as ``read(in_waiting or 1)``, which takes what is there and waits
for no line's end. An unplugged device raises pyserial's error or a bare ``OSError``; both mean the same. It is looked
for every half to whole second: by its VID, PID and serial number once those were seen, because it may come back under
another name, else by its path. Without ``baud`` the rate is found by trying (``baud.py``) and remembered.
"""

import errno
import os
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, cast
from urllib.parse import SplitResult, parse_qsl, unquote

import serial

from guidance_app.language import Sentence, message, sentence
from guidance_app.sources import SourceError
from guidance_app.sources.addresses import split
from guidance_app.sources.baud import BAUD_RATES, BaudHunt, BaudMemory
from guidance_app.sources.kept import READ_S, Kept, LinkError, Pauses
from guidance_app.sources.ports import FoundPort, ListPorts, found_ports

if sys.platform == "win32":
    PORT_ERRORS: tuple[type[Exception], ...] = (OSError,)
else:
    import termios

    PORT_ERRORS = (OSError, termios.error)

__all__ = ["OpenPort", "Port", "SerialSettings", "open_serial", "serial_source"]

WRITE_S = 0.5
UNPLUGGED = message("{path} was unplugged: plug the device in again")
LOWEST_BAUD, HIGHEST_BAUD = 300, 4_000_000
GATHER_S = 0.004
SOON_ENOUGH = 64
"""A port without a buffer of its own gives byte after byte; fewer than this wait so long for those behind them."""

PAUSES = Pauses(first=0.5, longest=1.0)
"""Looking for a port costs nothing, so a device that was plugged in again is back within about a second."""


class Port(Protocol):
    """What is needed of an open serial port; pyserial's has it."""

    baudrate: int

    @property
    def in_waiting(self) -> int:
        """How many bytes wait to be read."""
        ...

    def read(self, size: int) -> bytes:
        """At most so many bytes; fewer, or none, after ``READ_S``."""
        ...

    def write(self, data: bytes) -> object:
        """Sends these bytes."""
        ...

    def close(self) -> None:
        """Gives the port back."""
        ...


OpenPort = Callable[[str, int], Port]


def open_port(path: str, baud: int) -> Port:
    """The port at ``path``, for us alone. Raises ``OSError`` as pyserial does."""
    return cast("Port", serial.Serial(path, baud, timeout=READ_S, write_timeout=WRITE_S, exclusive=True))


@dataclass(frozen=True, slots=True)
class SerialSettings:
    """Which port, at which baud rate (None: find it), and with what it is opened and found."""

    path: str
    baud: int | None = None
    open_port: OpenPort = open_port
    list_ports: ListPorts = found_ports
    memory: BaudMemory = field(default_factory=BaudMemory)
    pauses: Pauses = PAUSES
    clock: Callable[[], float] = time.monotonic


def open_serial(uri: str) -> Kept:
    """The source that ``serial:///dev/ttyUSB0?baud=115200`` or ``serial://COM3`` names. Raises ``SourceError``."""
    rule = sentence(
        "'{uri}' names no serial port: write it as serial:///dev/ttyUSB0, or serial://COM3 on "
        "Windows; the baud rate may follow, as in serial:///dev/ttyUSB0?baud=115200.",
        uri=uri,
    )
    parts = split(uri, rule)
    path = unquote(parts.netloc + parts.path)
    if not path.strip("/") or not (parts.netloc == "" or parts.path in ("", "/")):
        raise SourceError(rule)
    return serial_source(SerialSettings(path.rstrip("/"), _baud(uri, parts)))


def _baud(uri: str, parts: SplitResult) -> int | None:
    options = dict(parse_qsl(parts.query, keep_blank_values=True))
    text = options.pop("baud", "auto")
    if options:
        msg = sentence(
            "'{uri}': {names} is no option of a serial port; there is only baud, as in ?baud=115200.",
            uri=uri,
            names=", ".join(options),
        )
        raise SourceError(msg)
    if text == "auto":
        return None
    if not text.isdecimal() or not LOWEST_BAUD <= int(text) <= HIGHEST_BAUD:
        msg = sentence(
            "'{uri}': baud is {text!r}, but it is a number from {lowest_baud} to {highest_baud}, or auto "
            "to have it found.",
            uri=uri,
            text=text,
            lowest_baud=LOWEST_BAUD,
            highest_baud=HIGHEST_BAUD,
        )
        raise SourceError(msg)
    return int(text)


def serial_source(settings: SerialSettings) -> Kept:
    """The source at a port that is opened and found as the settings say."""
    finder = _Finder(settings)

    def connect(stop: threading.Event) -> _SerialLink:
        del stop
        return _SerialLink(finder.find(), settings)

    return Kept(settings.path, connect, settings.pauses)


class _Finder:
    """Finds the device again after it was unplugged, under whatever name it comes back."""

    def __init__(self, settings: SerialSettings) -> None:
        self._settings = settings
        self._seen: FoundPort | None = None

    def find(self) -> FoundPort:
        """The port to open. Raises ``LinkError`` when a known USB device is not plugged in."""
        path = self._settings.path
        ports = self._settings.list_ports()
        here = next((port for port in ports if os.path.realpath(path) == os.path.realpath(port.path)), None)
        if self._seen is None or self._seen.usb is None:
            self._seen = here
            return FoundPort(path) if here is None else FoundPort(path, here.name, here.usb, here.plug)
        alike = [port for port in ports if port.usb == self._seen.usb]
        if here in alike:
            alike = [here]
        if len(alike) > 1:
            alike = [port for port in alike if port.plug == self._seen.plug]
        if not alike:
            raise LinkError(sentence("{path} is unplugged: plug the device in again", path=path))
        return alike[0]


class _SerialLink:
    """An open port as a link."""

    def __init__(self, port: FoundPort, settings: SerialSettings) -> None:
        self._path = port.path
        self._device = port.usb or port.path
        self._settings = settings
        self._hunt = BaudHunt(settings.memory.recall(self._device)) if settings.baud is None else None
        self._rate = settings.baud or BAUD_RATES[0] if self._hunt is None else self._hunt.rate
        try:
            self._port = settings.open_port(port.path, self._rate)
        except (*PORT_ERRORS, ValueError) as error:
            raise LinkError(_why_not(error, port.path)) from None

    @property
    def what(self) -> str:
        """The port and its rate, or that the rate is looked for."""
        if self._hunt is not None and not self._hunt.found:
            return sentence("{path} (looking for its baud rate)", path=self._path)
        return sentence("{path} at {rate} baud", path=self._path, rate=self._rate)

    def read(self) -> bytes:
        """What has come. Raises ``LinkError`` when the device is gone."""
        try:
            data = self._port.read(self._port.in_waiting or 1)
            if data and len(data) < SOON_ENOUGH and not data.endswith(b"\n"):
                time.sleep(GATHER_S)
                data += self._port.read(self._port.in_waiting)
            if self._hunt is not None and self._hunt.hear(data, self._settings.clock()):
                self._follow(self._hunt)
        except PORT_ERRORS:
            raise LinkError(sentence(UNPLUGGED, path=self._path)) from None
        return data

    def _follow(self, hunt: BaudHunt) -> None:
        if hunt.found:
            self._settings.memory.keep(self._device, hunt.rate)
        elif hunt.rate != self._rate:
            self._port.baudrate = hunt.rate
        self._rate = hunt.rate

    def write(self, data: bytes) -> None:
        """Sends these bytes. Raises ``LinkError``."""
        try:
            self._port.write(data)
        except PORT_ERRORS as error:
            raise LinkError(sentence("{path} takes no data: {error}", path=self._path, error=str(error))) from None

    def close(self) -> None:
        """Gives the port back."""
        try:
            self._port.close()
        except PORT_ERRORS:
            return


def _why_not(error: Exception, path: str) -> Sentence:
    """Why a port could not be opened and what to do; pyserial's texts are its own affair."""
    number = getattr(error, "errno", None)
    text = str(error)
    if number in (errno.ENOENT, errno.ENXIO, errno.ENODEV) or "FileNotFoundError" in text:
        return sentence("{path} is not there: plug the device in, or choose another port", path=path)
    if number in (errno.EAGAIN, errno.EBUSY) or "PermissionError" in text:
        return sentence("{path} is in use by another program: close it", path=path)
    if number in (errno.EACCES, errno.EPERM):
        group = _group_of(path)
        return sentence(
            "no permission for {path}: add your user to the group {group} (sudo usermod -aG {group} $USER) and log in"
            " again",
            path=path,
            group=group,
        )
    if number == errno.EIO:
        return sentence(UNPLUGGED, path=path)
    if number in (errno.ENOTTY, errno.EISDIR) or "Could not configure port" in text:
        return sentence("{path} is not a serial port: choose another one", path=path)
    return sentence("{path} cannot be opened: {error}", path=path, error=text)


def _group_of(path: str) -> str:
    """The group that may use the port; that of Linux distributions where the port does not say."""
    try:
        name = Path(path).group()
    except (OSError, KeyError, NotImplementedError):
        return "dialout"
    return "dialout" if name == "root" else name
