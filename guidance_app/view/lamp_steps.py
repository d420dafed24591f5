"""The light bar's steps as a person types them: eight numbers from the middle outward, in centimetres or inches."""

import re

from guidance_app.documents import LightBarSteps, Units
from guidance_app.language import Words

__all__ = ["PRESETS", "steps_from_text", "steps_text", "steps_unit"]

COUNT = 8
CENTIMETRE, INCH = 0.01, 0.0254
_BETWEEN = re.compile(r"[;\s]+|,\s+")
"""Between two numbers; a comma without a space behind it is a decimal comma."""

PRESETS: dict[str, LightBarSteps] = {
    "fine": (0.01, 0.02, 0.03, 0.05, 0.08, 0.12, 0.20, 0.30),
    "usual": (0.02, 0.05, 0.10, 0.20, 0.30, 0.50, 0.75, 1.00),
    "coarse": (0.05, 0.10, 0.20, 0.30, 0.50, 0.75, 1.00, 1.50),
}
"""For a receiver of centimetres, of decimetres, and for spreading."""


def steps_unit(units: Units) -> str:
    """The unit they are typed in."""
    return "in" if units is Units.IMPERIAL else "cm"


def _size(units: Units) -> float:
    return INCH if units is Units.IMPERIAL else CENTIMETRE


def steps_text(steps: LightBarSteps, units: Units, words: Words) -> str:
    """``2 5 10 20 30 50 75 100``."""
    numbers = (f"{step / _size(units):.1f}".removesuffix(".0") for step in steps)
    return " ".join(words.digits(one) for one in numbers)


def steps_from_text(text: str, units: Units, words: Words) -> LightBarSteps:
    """Metres. Raises ``ValueError`` with a sentence for the driver; whether they grow is the document's to judge."""
    parts = [part for part in _BETWEEN.split(text.strip()) if part]
    if len(parts) != COUNT:
        raise ValueError(words("Type eight numbers with spaces between them; these are {count}.", count=len(parts)))
    try:
        first, second, third, fourth, fifth, sixth, seventh, eighth = (
            round(words.parse_number(part) * _size(units), 6) for part in parts
        )
    except ValueError as error:
        raise ValueError(words.say(error.args[0])) from error
    return first, second, third, fourth, fifth, sixth, seventh, eighth
