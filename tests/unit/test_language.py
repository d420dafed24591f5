"""Words: what is said in three languages, numbers as they are typed and read, and sentences that know their pattern."""

import copy
import datetime
import math
import pickle
import string
from zoneinfo import ZoneInfo

import pytest
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.documents import Settings
from guidance_app.language import ENGLISH, LANGUAGES, Language, parse_number, sentence, words_for

FULL_WIDTH = "\uff11\uff12\uff0e\uff15"
PLAIN = st.text(string.ascii_letters + " .,äßé行程", min_size=1, max_size=40)


def test_the_settings_offer_the_languages_there_are() -> None:
    assert Settings.model_json_schema()["properties"]["language"]["enum"] == list(LANGUAGES)


def test_words_of_a_language_are_made_once() -> None:
    assert words_for("es") is words_for("es")
    assert repr(words_for("ja")) == "Words('ja')"


@given(PLAIN)
def test_english_says_what_the_code_says(text: str) -> None:
    assert ENGLISH(text) == text
    assert ENGLISH.say(text) == text


@pytest.mark.parametrize("language", ["ja", "es"])
def test_a_catalogue_is_read_without_a_build_step(language: Language) -> None:
    assert words_for(language)("Tractor") != ""
    assert words_for(language)("Working width") != "Working width"


def test_what_no_catalogue_knows_is_said_in_english() -> None:
    assert words_for("ja")("Xyzzy {n}", n=3) == "Xyzzy 3"
    assert words_for("ja").within("nowhere", "Xyzzy") == "Xyzzy"
    assert words_for("es").plural("{n} xyzzy", "{n} xyzzies", 1) == "1 xyzzy"
    assert words_for("es").plural("{n} xyzzy", "{n} xyzzies", 2) == "2 xyzzies"


@pytest.mark.parametrize("language", LANGUAGES)
def test_nothing_stays_nothing(language: Language) -> None:
    assert words_for(language)("") == ""
    assert words_for(language).say("") == ""


# --- numbers ---


@pytest.mark.parametrize(("language", "shown"), [("en", "-12.50"), ("ja", "-12.50"), ("es", "-12,50")])
def test_decimals_have_the_sign_of_the_language(language: Language, shown: str) -> None:
    words = words_for(language)
    assert words.number(-12.5, 2) == shown
    assert words.digits("-12.50") == shown
    assert words("{x:.2f} xyzzy", x=-12.5) == f"{shown} xyzzy"
    assert words.say(sentence("{x:.2f} xyzzy.", x=-12.5)) == f"{shown} xyzzy."


def test_thousands_are_not_taken_for_decimals() -> None:
    assert words_for("es")("{size:,.1f} {n:,} xyzzy", size=1234.5, n=20_000) == "1\u00a0234,5 20\u00a0000 xyzzy"
    assert words_for("ja")("{size:,.1f} xyzzy", size=1234.5) == "1,234.5 xyzzy"


def test_names_and_whole_numbers_keep_their_points() -> None:
    assert words_for("es")("{file}: {n}", file="run.nmea", n=1000) == "run.nmea: 1000"


@given(st.floats(-1e6, 1e6), st.integers(0, 6))
def test_a_number_that_is_shown_is_read_back(value: float, decimals: int) -> None:
    rounded = float(f"{value:.{decimals}f}")
    for language in LANGUAGES:
        assert words_for(language).parse_number(words_for(language).number(value, decimals)) == rounded


@pytest.mark.parametrize(
    ("typed", "number"),
    [
        *(("12,5", 12.5), ("12.5", 12.5), (" 12.5 ", 12.5), (FULL_WIDTH, 12.5), ("\uff11\uff0c5", 1.5)),
        *(("−3", -3.0), ("ー3", -3.0), (",5", 0.5), ("7.", 7.0), ("1e-3", 0.001), ("+4", 4.0), ("0012", 12.0)),
    ],
)
def test_numbers_are_read_as_they_are_typed(typed: str, number: float) -> None:
    assert parse_number(typed) == number


@pytest.mark.parametrize(
    "typed", ["1.234,5", "1,234,567", "1_000", "nan", "inf", "12 m", "1 2", ".", "-", "0x10", "1e999", "9" * 41]
)
def test_what_is_no_number_is_refused_with_a_sentence(typed: str) -> None:
    with pytest.raises(ValueError, match="is not a number"):
        parse_number(typed)


@pytest.mark.parametrize("typed", ["", "  ", "\u3000"])
def test_an_empty_number_is_missing(typed: str) -> None:
    with pytest.raises(ValueError, match="missing"):
        parse_number(typed)


@given(st.text(max_size=60))
def test_no_text_makes_the_reader_of_numbers_fail_otherwise(text: str) -> None:
    try:
        value = parse_number(text)
    except ValueError as error:
        (why,) = error.args
    else:
        why = None
        assert math.isfinite(value)
    assert why is None or ENGLISH.say(why) == why


# --- dates and times of day ---

EVENING = datetime.datetime(2026, 3, 9, 18, 5, tzinfo=ZoneInfo("Asia/Tokyo"))


@pytest.mark.parametrize(("language", "day"), [("en", "9 Mar 2026"), ("ja", "2026/03/09"), ("es", "9 mar 2026")])
def test_dates_and_times_of_day(language: Language, day: str) -> None:
    words = words_for(language)
    assert words.date(EVENING.date()) == day
    assert words.time_of_day(EVENING) == "18:05"
    assert words.moment(EVENING) == f"{day} 18:05"


# --- sentences that know their pattern ---


def test_a_sentence_is_its_english_text() -> None:
    made = sentence("The {kind} has {n:.1f} m.", kind="mower", n=3)
    assert made == "The mower has 3.0 m."
    assert isinstance(made, str)
    assert made.pattern == "The {kind} has {n:.1f} m."
    assert dict(made.values) == {"kind": "mower", "n": 3}


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_sentence_keeps_its_pattern_when_it_is_copied(copied: object) -> None:
    made = sentence("The {kind}.", kind="mower")
    again = copied(made)  # type: ignore[operator]  # any of the three
    assert again == made
    assert again.pattern == made.pattern
    assert again.values == made.values


def test_a_sentence_within_a_sentence_is_said_too() -> None:
    words = words_for("es")
    inner = sentence("A number is missing here.")
    assert words.say(sentence("xyzzy: {why}", why=inner)) == f"xyzzy: {words.say(inner)}"
    assert words.say(inner) != inner


def test_text_with_braces_from_outside_is_left_alone() -> None:
    assert words_for("es").say("a {file} of somebody") == "a {file} of somebody"
