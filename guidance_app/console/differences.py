"""Where two versions of a document differ, as a table of mine and theirs."""

import html
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from guidance_app.documents import Units
from guidance_app.language import Words
from guidance_app.view.entries import FormView, entries_of, unit_text

__all__ = ["differences", "differences_html"]


def differences(mine: BaseModel, theirs: BaseModel, words: Words, units: Units) -> list[tuple[str, str, str]]:
    """Title, my value and theirs of every member that differs; members that no form shows go by their own name."""
    entries = entries_of(type(mine))
    values, others = mine.model_dump(mode="json"), theirs.model_dump(mode="json")
    drafts = [FormView(type(mine), entries, one, words, units).draft() for one in (values, others)]
    found = []
    for entry in entries:
        if values[entry.member] == others[entry.member]:
            continue
        labels: Mapping[str, str] = {value: words.say(label) for value, label in entry.choices}
        unit = unit_text(entry, units)
        title = f"{words(entry.title)} ({unit})" if unit else words(entry.title)
        shown = [_shown(draft[entry.member], labels, words) for draft in drafts]
        found.append((title, shown[0], shown[1]))
    known = {entry.member for entry in entries}
    rest = [member for member in values if member not in known and values[member] != others[member]]
    return found + [(member, str(values[member])[:60], str(others[member])[:60]) for member in rest]


def _shown(value: Any, labels: Mapping[str, str], words: Words) -> str:
    if isinstance(value, bool):
        return words("yes") if value else words("no")
    return labels.get(str(value), str(value)) or "–"


def differences_html(mine: BaseModel, theirs: BaseModel, words: Words, units: Units) -> str:
    """The table."""
    head = "".join(f"<th>{html.escape(one)}</th>" for one in ("", words("Mine"), words("The other")))
    rows = "".join(
        "<tr>" + "".join(f"<td>{html.escape(one)}</td>" for one in row) + "</tr>"
        for row in differences(mine, theirs, words, units)
    )
    return f'<table class="g-table"><tr>{head}</tr>{rows}</table>'
