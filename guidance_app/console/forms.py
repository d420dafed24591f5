"""A form made from any document model: titles, units, help, bounds and choices all come from the model.

Numbers are typed as text, because a browser's number input refuses either the comma or the point. Nothing is stored
here and nothing is checked twice: ``read`` lets the model judge and puts its answer, in words, under the entry that it
is about. Pictures are made anew from what has been typed so far.

viser's callbacks only note that something was touched; ``show``, on the screen's thread, brings the form up to it.
"""

import html
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Generic, TypeVar

import viser
from pydantic import BaseModel

from guidance_app.console.desk import Desk
from guidance_app.console.widgets import Choice, Shown
from guidance_app.documents import Units
from guidance_app.language import Words
from guidance_app.view.drawing_machines import PICTURES
from guidance_app.view.entries import Entry, EntryKind, FormView, entries_of, hint_text, unit_text
from guidance_app.view.units import length_text

__all__ = ["FORM_STYLE", "Form", "Options", "heading_html", "hint_html", "message_html", "picture_html"]

M = TypeVar("M", bound=BaseModel)
Options = Mapping[str, Sequence[tuple[str, str]]]
"""By member: values that may be chosen, with what a person reads for each."""

FORM_STYLE = """<style>
label[for]{color:var(--mantine-color-text);letter-spacing:0;font-size:1.05em}
[style*="flex-shrink: 0"]:has(>p>label[for]){width:42%!important}
.mantine-InputWrapper-root .mantine-Input-input{min-height:1.9rem!important;height:1.9rem!important;font-size:.82rem;
 border-color:var(--mantine-color-gray-6)}
.mantine-Textarea-root .mantine-Input-input{height:auto!important}
.mantine-Checkbox-root .mantine-Checkbox-input{width:1.5rem;height:1.5rem}
.mantine-Checkbox-root .mantine-Checkbox-inner{width:1.5rem;height:1.5rem}
.mantine-Checkbox-root .mantine-Checkbox-icon{width:.9rem}
.mantine-Select-option{font-size:.86rem;padding:.5rem}
.g-hint{margin:-.3em .75em .5em;font-size:.6em;line-height:1.3;color:var(--mantine-color-dimmed)}
.g-hint b{display:block;font-weight:600;color:var(--mantine-color-error);font-size:1.12em}
.g-hint b::before{content:"\\25B2  "}
.g-title{margin:.35em .6em .35em;font-size:1em;font-weight:650;overflow-wrap:anywhere}
.g-sub{margin:.7em .75em .35em;font-size:.8em;font-weight:650;border-bottom:1px solid
 var(--mantine-color-default-border);padding-bottom:.15em}
.g-picture{margin:0 .6em .5em}.g-drawing{display:block;width:100%;max-height:14em}
.mantine-Button-root{height:auto!important;min-height:1.9rem}
.mantine-Button-label{white-space:normal!important;overflow-wrap:anywhere;padding:.2em 0;line-height:1.25}
[style*="flex-shrink: 0"]:has(>p>label:empty){display:none}
.g-table{margin:0 .75em .6em;font-size:.7em;border-collapse:collapse;width:calc(100% - 1.5em)}
.g-table td,.g-table th{border-bottom:1px solid var(--mantine-color-default-border);padding:.25em .3em;text-align:left;
 overflow-wrap:anywhere}
*:has(+div>.g-hint[data-keys=cards]){position:absolute;width:1px;height:1px;overflow:hidden;opacity:0}
.g-cards{display:grid;grid-template-columns:repeat(2,1fr);gap:.4em;margin:0 .75em .4em}
.g-card{border:2px solid var(--mantine-color-default-border);border-radius:.35em;padding:.25em;cursor:pointer;
 font-size:.62em;text-align:center;line-height:1.2}
.g-card.g-chosen{border-color:#e8590c;font-weight:650}
.g-said{margin:.1em .75em .45em;font-size:.72em;line-height:1.35;overflow-wrap:anywhere}
</style>"""
"""Sizes for gloves and a shaking seat; only in sight while forms are."""


def heading_html(words: str) -> str:
    """What a page of forms is about."""
    return f'<div class="g-title">{html.escape(words)}</div>'


def hint_html(words: str) -> str:
    """What helps to fill an entry in, below it."""
    return f'<div class="g-hint">{html.escape(words)}</div>'


def message_html(sentence: str) -> str:
    """What is wrong, where no entry can be named."""
    return f'<div class="g-hint"><b>{html.escape(sentence)}</b></div>' if sentence else ""


def picture_html(svg: str) -> str:
    """A drawing as wide as the panel."""
    return f'<div class="g-picture">{svg}</div>'


class Form(Generic[M]):
    """The inputs of one document in the panel that is open now. ``read`` gives the document or shows what is wrong.

    ``initial`` are values to begin with. ``options`` make a list to choose from of a text member, ``members`` are those
    that are shown, in that order; others keep their value. ``after`` adds what a panel has to say below an entry;
    ``cards`` are choices whose buttons are out of sight because pictures below them are pressed instead. ``touched`` is
    called on viser's loop after each change.
    """

    def __init__(  # noqa: PLR0913 - a call names each
        self,
        gui: viser.GuiApi,
        model: type[M],
        initial: Mapping[str, Any],
        words: Words,
        units: Units,
        *,
        options: Options | None = None,
        members: Sequence[str] | None = None,
        after: Mapping[str, Callable[[], None]] | None = None,
        cards: Sequence[str] = (),
        touched: Callable[[], None] | None = None,
    ) -> None:
        self._view = FormView(model, entries_of(model, members), dict(initial), words, units)
        self._touched = touched or (lambda: None)
        self._wrong: Mapping[str, str] = {}
        self._drawn: dict[str, Any] | None = None
        self._inputs: dict[str, _Input] = {}
        self._pictures: dict[str, Shown] = {}
        draft = self._view.draft()
        last_with = {entry.picture: entry.member for entry in self._view.entries if entry.picture}
        for entry in self._view.entries:
            made = _Input(gui, self._view, entry, draft[entry.member], (options or {}))
            made.on_touch(self._touch)
            made.cards = entry.member in cards
            self._inputs[entry.member] = made
            if entry.picture and last_with[entry.picture] == entry.member:
                self._pictures[entry.picture] = Shown(gui)
            if after is not None and entry.member in after:
                after[entry.member]()
        self._wrong_whole = Shown(gui)
        self.show()

    @property
    def draft(self) -> dict[str, Any]:
        """What the inputs hold now."""
        return {member: one.value for member, one in self._inputs.items()}

    def values(self) -> dict[str, Any]:
        """What can be read of it now, as far as it can."""
        return self._view.seen(self.draft)

    @property
    def changed(self) -> bool:
        """Whether anything stands in it that was not there at first."""
        return self.draft != self._view.draft()

    def set(self, member: str, value: Any) -> None:
        """Puts a value into an input, as a finger would."""
        self._inputs[member].set(value)
        self._touch(member)

    def read(self, instead: Mapping[str, str] | None = None) -> M | None:
        """The document; None when something is wrong, which then stands under its entry.

        ``instead`` holds what is taken for texts that are still empty, where the document is only looked at.
        """
        draft = self.draft
        draft |= {member: text for member, text in (instead or {}).items() if not str(draft[member]).strip()}
        checked = self._view.checked(draft)
        self.say(checked.wrong)
        return checked.document

    def say(self, wrong: Mapping[str, str]) -> None:
        """Puts sentences under entries, by member; '' for what belongs to none."""
        self._wrong = wrong
        self._drawn = None
        self._touched()

    def _touch(self, member: str) -> None:
        self._wrong = {name: words for name, words in self._wrong.items() if name not in (member, "")}
        self._touched()

    def show(self, desk: Desk | None = None) -> None:
        """Which entries apply, what is wrong with them, and the pictures, as they are; cheap when nothing is new."""
        del desk
        draft = self.draft
        drawn = {"draft": draft, "wrong": dict(self._wrong)}
        if drawn == self._drawn:
            return
        self._drawn = drawn
        for entry in self._view.entries:
            self._inputs[entry.member].show(
                applies=self._view.applies(entry, draft), wrong=self._wrong.get(entry.member, "")
            )
        values = self._view.seen(draft)
        for name, shown in self._pictures.items():
            shown.show(picture_html(PICTURES[name](values, self._view.words, self._length)))
        self._wrong_whole.show(message_html(self._wrong_anywhere()))

    def close(self) -> None:
        """A plain form draws nothing outside of its panel."""

    def _wrong_anywhere(self) -> str:
        """What belongs to no entry; else where to look, because the entry itself may be out of sight."""
        words = self._view.words
        titles = [words(entry.title) for entry in self._view.entries if entry.member in self._wrong]
        named = words("Look again at: {titles}.", titles=", ".join(titles)) if titles else ""
        return self._wrong.get("", "") or named

    def _length(self, metres: float) -> str:
        return length_text(metres, self._view.units, self._view.words)


class _Input:
    """One entry: its input, and what stands under it. Few choices are buttons side by side, names are a list."""

    def __init__(self, gui: viser.GuiApi, view: FormView[Any], entry: Entry, value: Any, options: Options) -> None:
        self._entry = entry
        words = view.words
        unit = unit_text(entry, view.units)
        title = words("{title} ({unit})", title=words(entry.title), unit=unit) if unit else words(entry.title)
        labels = entry.choices or tuple(options.get(entry.member, ()))
        if labels and value and all(one != value for one, _ in labels):
            labels = (*labels, (str(value), words("{name} (not there)", name=value)))
        self._values = {words.say(label): one for one, label in labels}
        self._chosen = str(value)
        self._handle: Any
        if entry.kind is EntryKind.SWITCH:
            self._handle = gui.add_checkbox(title, bool(value))
        elif entry.choices:
            self._handle = gui.add_button_group(title, self._marked())
        elif labels:
            first = next((label for label, one in self._values.items() if one == value), next(iter(self._values)))
            self._handle = gui.add_dropdown(title, tuple(self._values), initial_value=first)
        else:
            self._handle = gui.add_text(title, str(value))
        self._under = Shown(gui)
        self._hint = hint_text(entry, words, view.units)
        self.cards = False

    def _marked(self) -> tuple[str, ...]:
        return tuple(f"{Choice.MARK}{label}" if one == self._chosen else label for label, one in self._values.items())

    @property
    def value(self) -> Any:
        """The text, the chosen value or the switch."""
        if self._entry.choices:
            return self._chosen
        value = self._handle.value
        return self._values.get(value, value) if self._values else value

    def set(self, value: Any) -> None:
        """Shows another value."""
        if self._entry.choices:
            self._chosen = str(value)
        else:
            self._handle.value = next((label for label, one in self._values.items() if one == value), value)

    def on_touch(self, touched: Callable[[str], None]) -> None:
        """Calls ``touched`` with the member, on viser's loop."""
        listen = self._handle.on_click if self._entry.choices else self._handle.on_update

        @listen  # type: ignore[untyped-decorator]  # any of viser's inputs
        async def _(event: viser.GuiEvent[Any]) -> None:
            if self._entry.choices:
                pressed = str(event.target.value).removeprefix(Choice.MARK)
                self._chosen = self._values.get(pressed, self._chosen)
            touched(self._entry.member)

    def show(self, *, applies: bool, wrong: str) -> None:
        """There or not, and what stands under it."""
        self._handle.visible = applies
        if self._entry.choices and tuple(self._handle.options) != self._marked():
            self._handle.options = self._marked()
        self._under.show(self._under_html(wrong) if applies else "")

    def _under_html(self, wrong: str) -> str:
        """The kind of keyboard goes along, for the page's script."""
        if self.cards:
            return '<div class="g-hint" data-keys="cards"></div>'
        whole = self._entry.kind is EntryKind.WHOLE
        plain = self._entry.kind in (EntryKind.NUMBER, EntryKind.WHOLE) and (self._entry.low or 0.0) >= 0.0
        keys = ("numeric" if whole else "decimal") if plain else "secret" if self._entry.secret else "text"
        said = f"<b>{html.escape(wrong)}</b>" if wrong else ""
        return f'<div class="g-hint" data-keys="{keys}">{said}{html.escape(self._hint)}</div>'
