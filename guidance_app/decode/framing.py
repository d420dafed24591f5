"""Bytes -> lines, however they were cut on the way.

A sentence begins with ``$`` (or, where a line begins, with ``#`` and the name of a Unicore log) and ends at a line
feed, a carriage return or the next ``$``. What stands in front of it on its line, such as a logger's time, is
dropped, and so is everything between sentences: binary frames (UBX, RTCM), JSON, empty lines. A line of text that
begins with ``#`` and is no such log is a comment, whatever sentences it quotes.

Only the bytes decide, never where they were cut, and memory stays bounded: a sentence longer than ``MAX_LENGTH``
is noise, so no more than that is ever kept of bytes without an end.
"""

import re

__all__ = ["MAX_LENGTH", "Framer"]

MAX_LENGTH = 1024
"""NMEA allows 82 characters; the longest known log line of a receiver has about 500."""

_split_lines = re.compile(rb"[\r\n]+").split
_find_starts = re.compile(rb"\$").finditer
_match_log_name = re.compile(rb"#[A-Z0-9]{3,}A,").match
_match_damaged_name = re.compile(rb"\$[A-Z0-9]{3,},|#").match
_match_begin = re.compile(rb"\$[A-Z0-9]{2}|#").match
_find_control = re.compile(rb"[\x00-\x08\x0b-\x1f\x7f]").search
_DOLLAR = 0x24


class Framer:
    """Cuts a stream into sentences, as text of one character a byte."""

    __slots__ = ("_comment", "_fresh", "_rest")

    def __init__(self) -> None:
        self._rest = b""
        self._fresh = True
        """Whether ``_rest`` begins where a line begins."""
        self._comment = False
        """Whether ``_rest`` belongs to a line that was a comment so far."""

    def fork(self) -> "Framer":
        """An independent copy."""
        copy = Framer()
        copy._rest, copy._fresh, copy._comment = self._rest, self._fresh, self._comment
        return copy

    def feed(self, data: bytes) -> list[str]:
        """The sentences that these bytes have completed, in order."""
        lines = _split_lines(self._rest + data) if self._rest else _split_lines(data)
        found: list[str] = []
        for line in lines[:-1]:
            self._take_line(line, found)
            self._fresh, self._comment = True, False
        self._rest = lines[-1]
        if len(self._rest) > MAX_LENGTH or self._rest.rfind(b"$") > 0:
            self._shorten(found)
        return found

    def finish(self) -> list[str]:
        """The sentence that had no end, if there is one; afterwards the framer is as new."""
        found: list[str] = []
        self._take_line(self._rest, found)
        self._rest, self._fresh, self._comment = b"", True, False
        return found

    def _take_line(self, line: bytes, found: list[str]) -> None:
        """Collects the sentences of one line, or of what is left of one."""
        if self._comment or not line:
            return
        if line[0] == _DOLLAR and line.find(b"$", 1) < 0:
            _keep(line, found)
            return
        for piece in self._pieces(line):
            _keep(piece, found)

    def _pieces(self, line: bytes) -> list[bytes]:
        """The line cut where sentences begin; nothing for a comment."""
        starts = [match.start() for match in _find_starts(line)]
        head = line[: starts[0]] if starts else line
        if self._fresh and head[:1] == b"#":
            if _is_comment(head):
                return []
            if _match_log_name(head):
                starts.insert(0, 0)
        ends = [*starts[1:], len(line)]
        return [line[start:end] for start, end in zip(starts, ends, strict=False)]

    def _shorten(self, found: list[str]) -> None:
        """Takes the sentences of an unfinished line that another has ended; keeps what may still become one."""
        rest = self._rest
        last = rest.rfind(b"$")
        if self._comment or (last < 0 and not self._fresh):
            self._rest = b""
            return
        if last > 0:
            self._take_line(rest[:last], found)
        self._comment = self._fresh and _is_comment(rest.partition(b"$")[0])
        if self._comment or last < 0:
            self._rest = b"" if self._comment else rest[: MAX_LENGTH + 1]
            return
        self._rest = rest[last : last + MAX_LENGTH + 1]
        self._fresh = False


def _is_comment(head: bytes) -> bool:
    """Whether a line that begins like this, up to its first ``$``, is a comment. Its first bytes decide."""
    return head[:1] == b"#" and not _match_log_name(head) and _find_control(head, 0, MAX_LENGTH) is None


def _keep(piece: bytes, found: list[str]) -> None:
    """Takes a piece that is a sentence, or was one before it was damaged, not a chance ``$`` between binary bytes."""
    if len(piece) > MAX_LENGTH:
        return
    text = piece.decode("latin-1").rstrip(" \t")
    printable = text.isascii() and text.isprintable()
    if (_match_begin if printable else _match_damaged_name)(piece):
        found.append(text)
