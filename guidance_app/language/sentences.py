"""Sentences that are made where no language is known: in tables, errors and notices.

A ``Sentence`` is its English text, and a string wherever one is wanted; beside it keeps the pattern and the values, so
that whoever shows it can say it in the driver's language.
"""

from collections.abc import Mapping
from types import MappingProxyType

__all__ = ["Sentence", "message", "sentence"]


class Sentence(str):
    """English text that knows the ``pattern`` and the ``values`` it was made from."""

    __slots__ = ("pattern", "values")

    pattern: str
    values: Mapping[str, object]

    def __new__(cls, pattern: str, values: Mapping[str, object]) -> "Sentence":
        """Fills the pattern in, as ``str.format`` does."""
        made = super().__new__(cls, pattern.format(**values))
        made.pattern = pattern
        made.values = MappingProxyType(dict(values))
        return made

    def __str__(self) -> str:
        """Itself, so that ``str(error)`` still knows the pattern of the sentence that the error was raised with."""
        return self

    def __reduce__(self) -> tuple[type["Sentence"], tuple[str, dict[str, object]]]:
        """Survives a copy, and the way to another process and back."""
        return Sentence, (self.pattern, dict(self.values))


def message(text: str, /) -> str:
    """``text`` itself, marked for the catalogues; whoever shows it says ``words(text)``."""
    return text


def sentence(pattern: str, /, **values: object) -> Sentence:
    """The English sentence with its values in it; whoever shows it says ``words.say(sentence)``."""
    return Sentence(pattern, values)
