"""What people read, in their language: sentences by catalogue, numbers, dates and times of day by locale.

The English sentence is the key. ``words("Pass {number} of {count}", number=3, count=24)`` gives it in the language of
``words``; ``message`` marks one that stands in a table, ``sentence`` one that is made where no language is known.
The catalogues are the ``.po`` files of this package, read as they are; ``python -m guidance_app.language`` brings them
up to the code. Pure but for reading its own files.
"""

from guidance_app.language.numerals import parse_number
from guidance_app.language.sentences import Sentence, message, sentence
from guidance_app.language.words import ENGLISH, LANGUAGES, Language, Words, words_for

__all__ = [
    "ENGLISH",
    "LANGUAGES",
    "Language",
    "Sentence",
    "Words",
    "message",
    "parse_number",
    "sentence",
    "words_for",
]
