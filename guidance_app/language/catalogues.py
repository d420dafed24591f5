"""The catalogues beside the code: what the code asks for, what a catalogue lacks, and bringing it up to the code."""

import io
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.pofile import read_po, write_po

from guidance_app.language.extraction import messages_in, places_of
from guidance_app.language.words import LANGUAGES, LOCALES, Language

__all__ = ["CATALOGUES", "PACKAGE", "TRANSLATED", "bring_up", "faults_of", "read_catalogue", "template", "updated"]

PACKAGE = Path(__file__).parent.parent
CATALOGUES = Path(__file__).parent / "catalogues"
TRANSLATED: tuple[Language, ...] = tuple(language for language in LANGUAGES if language != "en")
WIDTH = 110


def template() -> Catalog:
    """Every message of the package's code, each with the files where it stands."""
    catalogue = Catalog(charset="utf-8")
    for path in sorted(PACKAGE.rglob("*.py")):
        name = path.relative_to(PACKAGE).as_posix()
        for one in messages_in(path.read_text("utf-8"), name):
            key = one.text if one.many is None else (one.text, one.many)
            catalogue.add(key, locations=[(name, 0)], context=one.context)
    return catalogue


def read_catalogue(language: Language, folder: Path = CATALOGUES) -> Catalog:
    """The catalogue as it is."""
    return _parsed((folder / f"{language}.po").read_bytes(), language)


def bring_up(folder: Path = CATALOGUES) -> list[str]:
    """Writes every catalogue of a folder anew with the messages of the code; what is left to do, one line each."""
    wanted = template()
    left = []
    for language in TRANSLATED:
        path = folder / f"{language}.po"
        path.write_bytes(updated(path.read_bytes(), language, wanted))
        left += [f"{path.name}: {fault}" for fault in faults_of(read_catalogue(language, folder), wanted)]
    return left


def _parsed(text: bytes, language: Language) -> Catalog:
    return read_po(io.BytesIO(text), locale=LOCALES[language])


def updated(text: bytes, language: Language, wanted: Catalog) -> bytes:
    """The catalogue with every message of ``wanted`` and no other; its header and what was translated stay."""
    catalogue = _parsed(text, language)
    catalogue.update(wanted, no_fuzzy_matching=True)
    catalogue.obsolete.clear()
    written = io.BytesIO()
    write_po(written, catalogue, width=WIDTH, omit_header=True, sort_output=True, include_lineno=False)
    header, _, _ = text.partition(b"\n\n")
    return header.rstrip(b"\n") + b"\n\n" + written.getvalue().strip(b"\n") + b"\n"


def faults_of(catalogue: Catalog, wanted: Catalog) -> list[str]:
    """What is missing, unsure, superfluous or wrongly filled in, one line each; empty when all is well."""
    faults = []
    for one in wanted:
        keys = _texts(one.id)
        if not all(keys):
            continue  # the header
        had = catalogue.get(keys[0], one.context)
        texts = () if had is None else _texts(had.string)
        if had is None or not all(texts):
            faults.append(f"missing: {keys[0]!r}")
        elif had.fuzzy:
            faults.append(f"unsure: {keys[0]!r}")
        elif any(places_of(text) not in {places_of(key) for key in keys} for text in texts):
            faults.append(f"other places in braces: {keys[0]!r} -> {texts!r}")
    known = {(_texts(one.id), one.context) for one in wanted}
    had_keys = ((_texts(one.id), one.context) for one in catalogue)
    return [*faults, *(f"not in the code: {keys[0]!r}" for keys, context in had_keys if (keys, context) not in known)]


def _texts(texts: object) -> tuple[str, ...]:
    """One text or its plural forms, as Babel keeps them."""
    return (texts,) if isinstance(texts, str) else tuple(texts) if isinstance(texts, list | tuple) else ("",)
