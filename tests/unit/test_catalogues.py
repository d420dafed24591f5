"""The catalogues are whole: every message of the code is translated, with the same places in braces, and no other."""

import io
from pathlib import Path

import pytest
from babel.messages.catalog import Catalog
from babel.messages.pofile import read_po

from guidance_app.language import Language
from guidance_app.language.catalogues import (
    CATALOGUES,
    TRANSLATED,
    bring_up,
    faults_of,
    read_catalogue,
    template,
    updated,
)
from guidance_app.language.extraction import ExtractionError, Message, messages_in, places_of


@pytest.fixture(scope="module")
def code() -> Catalog:
    """What the code asks for; reading all of it takes a second."""
    return template()


@pytest.mark.parametrize("language", TRANSLATED)
def test_every_message_is_translated_and_no_other(code: Catalog, language: Language) -> None:
    faults = faults_of(read_catalogue(language), code)
    assert not faults, "\n".join(["python -m guidance_app.language", *faults])


@pytest.mark.parametrize("language", TRANSLATED)
def test_a_catalogue_lies_as_the_command_writes_it(code: Catalog, language: Language) -> None:
    text = (CATALOGUES / f"{language}.po").read_bytes()
    assert updated(text, language, code) == text


def test_the_command_brings_a_folder_of_catalogues_up_to_the_code(tmp_path: Path) -> None:
    for language in TRANSLATED:
        text = (CATALOGUES / f"{language}.po").read_text("utf-8")
        (tmp_path / f"{language}.po").write_text(text.replace('msgid "Working width"', 'msgid "gone"'), "utf-8")
    assert bring_up(tmp_path) == [f"{language}.po: missing: 'Working width'" for language in TRANSLATED]
    assert 'msgid "gone"' not in (tmp_path / "ja.po").read_text("utf-8")


SOURCE = """
words("one"); self._words("two {n}", n=2); hands.words("three" if x else "four")
words.plural("{n} pass", "{n} passes", n); words.within("verb", "Work")
TABLE = {1: message("five")}; title = message("six"); raise PlanError(sentence("seven {a}", a=1))
x: float = quantity("eight", "m", 0, 1, help="nine", picture="no"); y: int = Field(1, title="ten", description="eleven")
words(name); words(""); print("no"); words_for("no"); words.number(1.0, 2)
"""


def test_messages_are_found_where_they_are_marked() -> None:
    found = set(messages_in(SOURCE, "here"))
    plain = {"one", "two {n}", "three", "four", "five", "six", "seven {a}", "eight", "nine", "ten", "eleven"}
    assert found == {Message(text) for text in plain} | {
        Message("{n} pass", many="{n} passes"),
        Message("Work", context="verb"),
    }


@pytest.mark.parametrize(
    "source", ['words(f"pass {n}")', 'message("a" + name)', "words.plural(one, many, 3)", 'sentence("%s" % n)']
)
def test_a_message_that_is_put_together_is_refused_with_its_place(source: str) -> None:
    with pytest.raises(ExtractionError, match="here, line 1: "):
        messages_in(source, "here")


def test_places_in_braces_with_their_formats() -> None:
    assert places_of("{a} and {b:.1f}") == {"a:", "b:.1f"}
    assert places_of("{{no}}") == frozenset()


HEADER = 'msgid ""\nmsgstr ""\n"Content-Type: text/plain; charset=utf-8\\n"\n'


@pytest.fixture
def wanted() -> Catalog:
    """Three messages that the code would ask for."""
    catalogue = Catalog()
    catalogue.add("plain")
    catalogue.add("with {n}")
    catalogue.add(("{n} pass", "{n} passes"))
    return catalogue


def _read(*entries: str) -> Catalog:
    return read_po(io.BytesIO("\n\n".join([HEADER, *entries]).encode()), locale="es")


WHOLE = (
    'msgid "plain"\nmsgstr "llano"',
    'msgid "with {n}"\nmsgstr "con {n}"',
    'msgid "{n} pass"\nmsgid_plural "{n} passes"\nmsgstr[0] "{n} pasada"\nmsgstr[1] "{n} pasadas"',
)


def test_a_whole_catalogue_has_no_faults(wanted: Catalog) -> None:
    assert faults_of(_read(*WHOLE), wanted) == []


@pytest.mark.parametrize(
    ("place", "entry", "fault"),
    [
        (0, "", "missing: 'plain'"),
        (0, 'msgid "plain"\nmsgstr ""', "missing: 'plain'"),
        (0, '#, fuzzy\nmsgid "plain"\nmsgstr "llano"', "unsure: 'plain'"),
        (1, 'msgid "with {n}"\nmsgstr "con {m}"', "other places in braces: 'with {n}' -> ('con {m}',)"),
        (1, 'msgid "with {n}"\nmsgstr "con"', "other places in braces: 'with {n}' -> ('con',)"),
        (2, 'msgid "{n} pass"\nmsgid_plural "{n} passes"\nmsgstr[0] "{n} p"\nmsgstr[1] ""', "missing: '{n} pass'"),
    ],
)
def test_a_fault_is_named(wanted: Catalog, place: int, entry: str, fault: str) -> None:
    entries = [*WHOLE]
    entries[place] = entry
    assert faults_of(_read(*entries), wanted) == [fault]


def test_what_the_code_no_longer_says_is_named_and_dropped(wanted: Catalog) -> None:
    entries = (*WHOLE, 'msgid "gone"\nmsgstr "ido"')
    assert faults_of(_read(*entries), wanted) == ["not in the code: 'gone'"]
    text = updated("\n\n".join([HEADER.strip(), *entries]).encode(), "es", wanted)
    assert text.startswith(HEADER.strip().encode())
    assert b"gone" not in text
    assert faults_of(read_po(io.BytesIO(text), locale="es"), wanted) == []
