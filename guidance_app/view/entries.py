"""The entries of a form, made from a document model: what each is called, how its value is written, what may be typed.

Pure. A form holds a *draft*: for each member the text in its input, the chosen value, or a switch's state. ``checked``
makes a document of it, or says under which entry what is wrong. Documents stay metric; only ``shown`` and ``read``
know the units of the screen. A text that nobody has changed gives its value back to the bit.
"""

import enum
import math
import types
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, Literal, TypeVar, Union, get_args, get_origin

from annotated_types import Ge, Le, MaxLen
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from guidance_app.documents import Units
from guidance_app.language import Words

__all__ = ["Checked", "Draft", "Entry", "EntryKind", "FormView", "bounds_text", "entries_of", "hint_text", "unit_text"]

M = TypeVar("M", bound=BaseModel)
Draft = Mapping[str, Any]

INCH, FOOT = 0.0254, 0.3048
INCHES_UP_TO = 10.0
"""Lengths whose bounds lie within this many metres are typed in inches, others in feet."""
LEFT_OUT = frozenset({"schema_version", "kind"})


class EntryKind(enum.StrEnum):
    """What is typed or touched."""

    NUMBER = "number"
    WHOLE = "whole"
    TEXT = "text"
    CHOICE = "choice"
    SWITCH = "switch"


@dataclass(frozen=True, slots=True)
class Entry:
    """One member of a document. Bounds are inclusive, in the document's unit; texts are English, to be said by words.

    ``choices`` are values with their labels; a ``secret`` is shown as dots. ``when`` names another member and the
    values of which it must have one.
    """

    member: str
    kind: EntryKind
    title: str
    help: str = ""
    unit: str = ""
    low: float | None = None
    high: float | None = None
    longest: int | None = None
    optional: bool = False
    choices: tuple[tuple[str, str], ...] = ()
    when: tuple[str, tuple[str, ...]] | None = None
    picture: str | None = None
    secret: bool = False


def entries_of(model: type[BaseModel], members: Sequence[str] | None = None) -> tuple[Entry, ...]:
    """Every member that a form can show, in the model's order, or those named in ``members`` in that order.

    Members of other types are the caller's to show.
    """
    fields = model.model_fields
    found = (_entry(member, fields[member]) for member in (fields if members is None else members))
    return tuple(entry for entry in found if entry is not None)


def _entry(member: str, info: FieldInfo) -> Entry | None:
    annotation, optional = _without_none(info.annotation)
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    choices = _choices(annotation, extra)
    kind = EntryKind.CHOICE if choices else _KINDS.get(annotation)
    if kind is None or member in LEFT_OUT:
        return None
    bounds = {type(one): one for one in info.metadata}
    return Entry(
        member=member,
        kind=kind,
        title=info.title or member,
        help=info.description or "",
        unit=str(extra.get("unit", "")),
        low=_bound(bounds.get(Ge), "ge"),
        high=_bound(bounds.get(Le), "le"),
        longest=getattr(bounds.get(MaxLen), "max_length", None),
        optional=optional,
        choices=choices,
        when=_when(extra.get("when")),
        picture=str(extra["picture"]) if "picture" in extra else None,
        secret=bool(extra.get("secret")),
    )


_KINDS: Mapping[object, EntryKind] = {
    float: EntryKind.NUMBER,
    int: EntryKind.WHOLE,
    str: EntryKind.TEXT,
    bool: EntryKind.SWITCH,
}


def _without_none(annotation: Any) -> tuple[Any, bool]:
    if get_origin(annotation) in (Union, types.UnionType):
        rest = [one for one in get_args(annotation) if one is not types.NoneType]
        return (rest[0] if len(rest) == 1 else annotation), len(rest) < len(get_args(annotation))
    return annotation, False


def _choices(annotation: Any, extra: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    labels = extra.get("labels", {})
    if get_origin(annotation) is Literal:
        values = [str(one) for one in get_args(annotation)]
    elif isinstance(annotation, type) and issubclass(annotation, enum.StrEnum):
        values = [str(one) for one in annotation]
    else:
        return ()
    return tuple((value, str(labels.get(value, value))) for value in values)


def _when(when: Any) -> tuple[str, tuple[str, ...]] | None:
    if not isinstance(when, (tuple, list)):
        return None
    values = when[1] if isinstance(when[1], (tuple, list)) else [when[1]]
    return str(when[0]), tuple(str(one) for one in values)


def _bound(bound: object, name: str) -> float | None:
    return None if bound is None else float(getattr(bound, name))


# --- numbers in the units of the screen ------------------------------------------------------------------------------


def _measure(entry: Entry, units: Units) -> tuple[str, float]:
    """The unit on the screen, and how much of the document's unit one of it is."""
    if entry.unit == "deg":
        return "°", 1.0
    if entry.unit != "m" or units is not Units.IMPERIAL:
        return entry.unit, 1.0
    farthest = max(abs(one) for one in (entry.low, entry.high) if one is not None)
    return ("in", INCH) if farthest <= INCHES_UP_TO else ("ft", FOOT)


def unit_text(entry: Entry, units: Units) -> str:
    """The unit as it stands behind the title; empty for a pure number."""
    return _measure(entry, units)[0]


def bounds_text(entry: Entry, words: Words, units: Units) -> str:
    """``0.5 to 8 m``; empty without bounds. Rounded so that what is shown may be typed."""
    if entry.low is None or entry.high is None:
        return ""
    unit, size = _measure(entry, units)
    low, high = math.ceil(_tenths(entry.low / size)) / 10, math.floor(_tenths(entry.high / size)) / 10
    texts = {"low": _plain(low, 1, words), "high": _plain(high, 1, words)}
    return words("{low} to {high} {unit}", unit=unit, **texts) if unit else words("{low} to {high}", **texts)


def _tenths(value: float) -> float:
    return round(value * 10, 6)


def hint_text(entry: Entry, words: Words, units: Units) -> str:
    """What stands under an entry: its help, then its bounds."""
    parts = (words.say(entry.help) if entry.help else "", bounds_text(entry, words, units))
    return " · ".join(part for part in parts if part)


def _plain(value: float, decimals: int, words: Words) -> str:
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return words.digits("0" if text == "-0" else text)


# --- drafts ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Checked(Generic[M]):
    """The document, or what is wrong: by member, '' for what belongs to none. Sentences in the driver's language."""

    document: M | None
    wrong: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class FormView(Generic[M]):
    """A model's entries in one language and one set of units; ``initial`` are the values the form began with."""

    model: type[M]
    entries: tuple[Entry, ...]
    initial: Mapping[str, Any]
    words: Words
    units: Units

    def draft(self) -> dict[str, Any]:
        """What the inputs show at first."""
        return {entry.member: self._shown(entry) for entry in self.entries}

    def applies(self, entry: Entry, draft: Draft) -> bool:
        """Whether it matters while the other entries are as they are; not if what it depends on does not."""
        if entry.when is None:
            return True
        on = next((other for other in self.entries if other.member == entry.when[0]), None)
        return str(draft.get(entry.when[0])) in entry.when[1] and (on is None or self.applies(on, draft))

    def _shown(self, entry: Entry) -> Any:
        value = self.initial.get(entry.member)
        match entry.kind:
            case EntryKind.SWITCH:
                return bool(value)
            case EntryKind.NUMBER | EntryKind.WHOLE:
                if value is None:
                    return ""
                unit, size = _measure(entry, self.units)
                return _plain(float(value) / size, 2 if unit in ("in", "ft") else 4, self.words)
            case _:
                return "" if value is None else str(value)

    def read(self, entry: Entry, shown: Any) -> Any:
        """The value of an input. Raises ``ValueError`` with a sentence for the driver."""
        if shown == self._shown(entry) and entry.member in self.initial:
            return self.initial[entry.member]
        if entry.kind is EntryKind.SWITCH:
            return bool(shown)
        text = str(shown).strip()
        if entry.optional and not text:
            return None
        if entry.kind not in (EntryKind.NUMBER, EntryKind.WHOLE):
            return text
        number = self._number(text)
        if entry.kind is EntryKind.WHOLE:
            if not number.is_integer():
                raise ValueError(self.words("Type a whole number."))
            return int(number)
        return number * _measure(entry, self.units)[1]

    def _number(self, text: str) -> float:
        try:
            return self.words.parse_number(text)
        except ValueError as error:
            raise ValueError(self.words.say(error.args[0])) from error

    def checked(self, draft: Draft) -> Checked[M]:
        """The document that the draft says. Entries that do not apply keep the value they began with."""
        values: dict[str, Any] = dict(self.initial)
        wrong: dict[str, str] = {}
        for entry in self.entries:
            if not self.applies(entry, draft):
                continue
            try:
                values[entry.member] = self.read(entry, draft[entry.member])
            except ValueError as error:
                wrong[entry.member] = str(error)
        if wrong:
            return Checked(None, wrong)
        try:
            return Checked(self.model.model_validate(values))
        except ValidationError as error:
            return Checked(None, self._said(error))

    def seen(self, draft: Draft) -> dict[str, Any]:
        """The values that can be read of the draft, the initial ones for the rest: for a picture while one types."""
        values = dict(self.initial)
        for entry in self.entries:
            try:
                value = self.read(entry, draft[entry.member])
            except ValueError:
                continue
            if not isinstance(value, float) or math.isfinite(value):
                values[entry.member] = value
        return values

    def _said(self, error: ValidationError) -> dict[str, str]:
        by_member = {entry.member: entry for entry in self.entries}
        wrong: dict[str, str] = {}
        for one in error.errors(include_url=False):
            loc = str(one["loc"][0]) if one["loc"] else ""
            member = loc if loc in by_member else one["type"]  # a model's own check names its member as its type
            entry = by_member.get(member)
            wrong.setdefault("" if entry is None else member, self._sentence(entry, one))
        return wrong

    def _sentence(self, entry: Entry | None, error: Any) -> str:
        words = self.words
        match error["type"]:
            case "greater_than_equal" | "less_than_equal" | "finite_number" if entry is not None:
                return words("Must be {bounds}.", bounds=bounds_text(entry, words, self.units))
            case "string_too_long" if entry is not None and entry.longest is not None:
                return words("At most {count} characters.", count=entry.longest)
            case "value_error":
                said = error["ctx"]["error"].args[0]
                return words.say(said) if isinstance(said, str) else str(said)
            case _:
                return words.say(str(error["msg"]))
