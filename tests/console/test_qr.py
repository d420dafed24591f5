"""The QR code in the terminal holds the link, module for module, in colour and without."""

import re

import pytest
import segno

from guidance_app.console.qr import QUIET, terminal_qr

LINK = "http://192.168.43.117:8080/?pin=480215"
UPPER, LOWER = "▀█", "▄█"


def modules_of(text: str) -> list[list[bool]]:
    """The marked halves of a picture of half blocks."""
    rows = []
    for line in text.splitlines():
        rows.append([character in UPPER for character in line])
        rows.append([character in LOWER for character in line])
    return rows


@pytest.mark.parametrize("link", [LINK, "x", LINK * 4])
def test_the_picture_is_the_code(link: str) -> None:
    code = [
        [bool(module) for module in row] for row in segno.make(link, error="m", micro=False).matrix_iter(border=QUIET)
    ]
    coloured = modules_of(re.sub("\x1b\\[[0-9;]*m", "", terminal_qr(link)))
    plain = modules_of(terminal_qr(link, colour=False))
    assert coloured[: len(code)] == code
    assert [[not paper for paper in row] for row in plain[: len(code)]] == code
    assert not any(any(row) for row in coloured[len(code) :])


def test_in_colour_it_is_black_on_white_on_any_terminal() -> None:
    lines = terminal_qr(LINK).splitlines()
    assert all(line.startswith("\x1b[30;107m") and line.endswith("\x1b[0m") for line in lines)
    assert "\x1b" not in terminal_qr(LINK, colour=False)


def test_it_fits_a_small_terminal() -> None:
    lines = terminal_qr(LINK, colour=False).splitlines()
    assert len(lines) <= 20
    assert max(map(len, lines)) <= 40
