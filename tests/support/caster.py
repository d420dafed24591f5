"""A caster on this machine: it asks for user and password, answers as version 1 or 2, and notes what it is told."""

import base64
import contextlib
import socket
import threading
import time
from collections.abc import Iterator

from support.servers import Server, server

__all__ = ["FRAMES", "MOUNT", "PASSWORD", "USER", "LocalCaster", "local_caster"]

USER, PASSWORD, MOUNT = "farmer@home", "s3cret:wörd", "NEAREST"
FRAMES = tuple(b"\xd3\x00" + bytes([number]) * 40 for number in range(30))
"""What it sends: no real corrections, but bytes as binary as those."""
TABLE = f"CAS;local;2101;Local;\r\nSTR;{MOUNT};Near;RTCM 3.2;\r\nSTR;FAR;Far;RTCM 3.2;\r\nNET;local;\r\n"
AGAIN_S = 1.0


class LocalCaster:
    """Answers with ``FRAMES``, once a connection or, with ``again``, every second, as casters do.

    Keeps the connection open until it is told to break it.
    """

    def __init__(self, version: int, *, cut: int = 1000, again: bool = False) -> None:
        self.version = version
        self.requests: list[bytes] = []
        self.positions: list[bytes] = []
        self.told = threading.Event()
        self.breaks = threading.Event()
        self.cut = cut
        self.again = again
        self.server: Server

    def answer(self, connection: socket.socket, _number: int) -> None:
        request = b""
        while b"\r\n\r\n" not in request:
            request += connection.recv(4096)
        self.requests.append(request)
        secret = base64.b64encode(f"{USER}:{PASSWORD}".encode())
        if b"Authorization: Basic " + secret not in request:
            connection.sendall(
                b"ERROR - Bad Password\r\n" if self.version == 1 else b"HTTP/1.1 401 Unauthorized\r\n\r\n"
            )
            return
        if f"GET /{MOUNT} ".encode() not in request:
            head = "SOURCETABLE 200 OK" if self.version == 1 else "HTTP/1.1 200 OK\r\nContent-Type: gnss/sourcetable"
            self._send_cut(connection, f"{head}\r\n\r\n{TABLE}ENDSOURCETABLE\r\n".encode())
            return
        self._send(connection)
        self._hear(connection)

    def _send(self, connection: socket.socket) -> None:
        header = b"HTTP/1.1 200 OK\r\nContent-Type: gnss/data\r\nTransfer-Encoding: chunked\r\n\r\n"
        self._send_cut(connection, (b"ICY 200 OK\r\n" if self.version == 1 else header) + self._frames())

    def _frames(self) -> bytes:
        if self.version == 1:
            return b"".join(FRAMES)
        return b"".join(b"%X\r\n%s\r\n" % (len(one), one) for one in FRAMES)

    def _send_cut(self, connection: socket.socket, stream: bytes) -> None:
        for start in range(0, len(stream), self.cut):
            connection.sendall(stream[start : start + self.cut])

    def _hear(self, connection: socket.socket) -> None:
        connection.settimeout(0.05)
        sent = time.monotonic()
        while not self.breaks.is_set():
            if self.again and time.monotonic() - sent >= AGAIN_S:
                sent = time.monotonic()
                self._send_cut(connection, self._frames())
            with contextlib.suppress(TimeoutError):
                data = connection.recv(4096)
                if not data:
                    return
                self.positions.append(data)
                self.told.set()
        self.breaks.clear()


@contextlib.contextmanager
def local_caster(version: int, *, cut: int = 1000, again: bool = False) -> Iterator[LocalCaster]:
    """Meanwhile it answers."""
    caster = LocalCaster(version, cut=cut, again=again)
    with server(caster.answer) as running:
        caster.server = running
        try:
            yield caster
        finally:
            caster.breaks.set()
