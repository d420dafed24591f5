"""Numbers as a driver types them: with a decimal comma or a decimal point, in half-width or full-width digits.

Groups of thousands are refused: ``1.234`` is a bit more than one, everywhere, and ``1.234,5`` is a question.
"""

import re
import unicodedata

from guidance_app.language.sentences import sentence

__all__ = ["parse_number"]

_NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)(e[+-]?\d{1,2})?", re.ASCII | re.IGNORECASE)
_MINUS = str.maketrans("−–ー", "---")
"""Minus sign, dash, and the long vowel mark that a Japanese keyboard gives for it."""

LONGEST = 40


def parse_number(text: str) -> float:
    """The number that was typed. Raises ``ValueError`` with a sentence for the driver when it is none."""
    plain = unicodedata.normalize("NFKC", text).translate(_MINUS).strip()
    if not plain:
        raise ValueError(sentence("A number is missing here."))
    if len(plain) > LONGEST or not _NUMBER.fullmatch(plain):
        raise ValueError(sentence('"{text}" is not a number. Type digits and one decimal point.', text=text[:LONGEST]))
    return float(plain.replace(",", "."))
