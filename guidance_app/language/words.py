"""``Words``: one language, made once. Sentences from its catalogue, numbers and dates as its readers write them.

A sentence that the catalogue does not have is said in English; a test holds the catalogues complete. GNU gettext does
the looking up, Babel reads the ``.po`` files and knows the locales.
"""

import datetime
import gettext
import io
import string
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any, Literal, get_args

from babel import Locale
from babel.dates import format_date, format_time
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po

from guidance_app.language.numerals import parse_number
from guidance_app.language.sentences import Sentence

__all__ = ["ENGLISH", "LANGUAGES", "Language", "Words", "words_for"]

Language = Literal["en", "ja", "es"]
LANGUAGES: tuple[Language, ...] = get_args(Language)

LOCALES: Mapping[Language, str] = {"en": "en_GB", "ja": "ja_JP", "es": "es_ES"}
"""How numbers, dates and times of day are written: day before month in English, 24 hours everywhere."""


NO_BREAK_SPACE = "\u00a0"
"""Between thousands where the comma is the decimal sign."""


class _Formatter(string.Formatter):
    """``str.format`` with the locale's decimal sign in every number that has decimals."""

    def __init__(self, sign: str) -> None:
        self._sign = sign

    def format_field(self, value: Any, format_spec: str) -> str:
        """One value; numbers of other types and words stay as they are."""
        text: str = super().format_field(value, format_spec)
        if "," in format_spec:
            text = text.replace(",", NO_BREAK_SPACE)
        return text.replace(".", self._sign) if isinstance(value, float) else text


class Words:
    """Says things in one language. Immutable; made by ``words_for``."""

    __slots__ = ("_catalogue", "_formatter", "_locale", "_sign", "language")

    def __init__(self, language: Language) -> None:
        self.language: Language = language
        self._locale = Locale.parse(LOCALES[language])
        self._catalogue = _catalogue(language)
        self._sign: str = self._locale.number_symbols["latn"]["decimal"]
        self._formatter = None if self._sign == "." else _Formatter(self._sign)

    def __repr__(self) -> str:
        return f"Words({self.language!r})"

    # --- sentences -------------------------------------------------------------------------------------------------

    def __call__(self, message: str, /, **values: object) -> str:
        """The message in this language, its ``{places}`` filled in."""
        return self._filled(self._catalogue.gettext(message) if message else "", values)

    def within(self, context: str, message: str, /, **values: object) -> str:
        """The same where one English word means two things: ``context`` says which, and is never shown."""
        return self._filled(self._catalogue.pgettext(context, message), values)

    def plural(self, one: str, many: str, n: int, /, **values: object) -> str:
        """``one`` or ``many`` as ``n`` asks for in this language; ``{n}`` stands for the number."""
        return self._filled(self._catalogue.ngettext(one, many, n), {"n": n, **values})

    def say(self, text: str, /) -> str:
        """A ``Sentence``, or a marked message, in this language; any other text as it is."""
        if not isinstance(text, Sentence):
            return self(text) if text and "{" not in text else text
        values = {name: self.say(one) if isinstance(one, Sentence) else one for name, one in text.values.items()}
        return self._filled(self._catalogue.gettext(text.pattern), values)

    def _filled(self, pattern: str, values: Mapping[str, object]) -> str:
        if not values:
            return pattern
        return pattern.format(**values) if self._formatter is None else self._formatter.vformat(pattern, (), values)

    # --- numbers ---------------------------------------------------------------------------------------------------

    def number(self, value: float, decimals: int = 0) -> str:
        """``value`` with so many decimals and this language's decimal sign; no groups of thousands."""
        return f"{value:.{decimals}f}".replace(".", self._sign)

    def digits(self, text: str, /) -> str:
        """A number already written with a decimal point, with this language's sign instead."""
        return text.replace(".", self._sign)

    @staticmethod
    def parse_number(text: str, /) -> float:
        """The number that was typed, with comma or point in any language; see ``language.parse_number``."""
        return parse_number(text)

    # --- dates and times of day ------------------------------------------------------------------------------------

    def date(self, day: datetime.date, /) -> str:
        """``22 Nov 2026``, ``2026/11/22``, ``22 nov 2026``."""
        return format_date(day, "medium", locale=self._locale)

    def time_of_day(self, moment: datetime.datetime, /) -> str:
        """``18:29``, in the zone that the moment carries."""
        return format_time(moment, "HH:mm", tzinfo=moment.tzinfo, locale=self._locale)

    def moment(self, moment: datetime.datetime, /) -> str:
        """Date and time of day, in the zone that the moment carries."""
        return f"{self.date(moment.date())} {self.time_of_day(moment)}"


def _catalogue(language: Language) -> gettext.NullTranslations:
    if language == "en":
        return gettext.NullTranslations()
    with (resources.files("guidance_app.language") / "catalogues" / f"{language}.po").open("rb") as file:
        read = read_po(file, locale=LOCALES[language])
    compiled = io.BytesIO()
    write_mo(compiled, read)
    compiled.seek(0)
    return gettext.GNUTranslations(compiled)


@cache
def words_for(language: Language) -> Words:
    """The words of this language; made at the first call, then always the same object."""
    return Words(language)


ENGLISH = words_for("en")
"""For what is not on a driver's screen: tables of the command line, and tests."""
