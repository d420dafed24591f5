"""A QR code made of text, for the terminal: a tablet's camera opens the console without typing. Made by segno."""

import segno

__all__ = ["terminal_qr"]

BLACK_ON_WHITE = "\x1b[30;107m"
AS_BEFORE = "\x1b[0m"
HALF_BLOCKS = {(0, 0): " ", (1, 0): "▀", (0, 1): "▄", (1, 1): "█"}
QUIET = 2
"""Empty modules around the code. Four are the standard's; two are read by every camera and fit a small terminal."""


def terminal_qr(text: str, *, colour: bool = True) -> str:
    """The code as lines of half blocks, two modules a character.

    With ``colour`` it is black on white whatever the terminal's colours are. Without, it is drawn for a dark terminal
    (the paper is what is printed), for files and terminals that know no colours.
    """
    modules = [list(row) for row in segno.make(text, error="m", micro=False).matrix_iter(border=QUIET)]
    if len(modules) % 2:
        modules.append([0] * len(modules[0]))
    lines = []
    for upper, lower in zip(modules[::2], modules[1::2], strict=True):
        if colour:
            line = "".join(HALF_BLOCKS[bool(a), bool(b)] for a, b in zip(upper, lower, strict=True))
            lines.append(f"{BLACK_ON_WHITE}{line}{AS_BEFORE}")
        else:
            lines.append("".join(HALF_BLOCKS[not a, not b] for a, b in zip(upper, lower, strict=True)))
    return "\n".join(lines)
