"""Forms as values: a document shown and read again is the same; what is wrong stands under its entry."""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.documents import Implement, Operation, Receiver, Tractor, Units
from guidance_app.guidance.patterns import METHODS
from guidance_app.language import ENGLISH, LANGUAGES, words_for
from guidance_app.view.entries import Entry, EntryKind, FormView, bounds_text, entries_of, hint_text

MODELS = (Tractor, Implement, Receiver, Operation)
MILLIMETRE = 0.001
NOT_TYPED = {"schema_version", "kind", "options", "edge_at", "passable"}
"""Members of the store, of the method's own form, and places that are tapped on the map."""
TRACTOR = Tractor(name="John", wheelbase=2.4567891)


def form(model=Tractor, units=Units.METRIC, words=ENGLISH, **values):  # type: ignore[no-untyped-def]
    initial = {**TRACTOR.model_dump(), **values} if model is Tractor else values
    return FormView(model, entries_of(model), initial, words, units)


def test_every_member_of_every_document_is_an_entry_with_a_title() -> None:
    for model in MODELS:
        shown = {entry.member for entry in entries_of(model)}
        assert shown == set(model.model_fields) - NOT_TYPED
        assert all(entry.title != entry.member for entry in entries_of(model))


def test_every_choice_has_a_label_of_its_own() -> None:
    options = [method.options for method in METHODS.values()]
    for model in (*MODELS, *options):
        for entry in entries_of(model):
            labels = [label for _, label in entry.choices]
            assert len(set(labels)) == len(labels)
            assert all(label[0].isupper() for label in labels), entry


@given(
    wheelbase=st.floats(0.5, 8),
    right=st.floats(-5, 5),
    units=st.sampled_from(list(Units)),
    language=st.sampled_from(LANGUAGES),
)
def test_what_nobody_has_changed_comes_back_to_the_bit(
    wheelbase: float, right: float, units: Units, language: str
) -> None:
    tractor = Tractor(name="a", wheelbase=wheelbase, antenna_right=right)
    view = FormView(Tractor, entries_of(Tractor), tractor.model_dump(), words_for(language), units)  # type: ignore[arg-type]
    assert view.checked(view.draft()).document == tractor


@given(metres=st.floats(0.5, 8), units=st.sampled_from(list(Units)))
def test_a_number_typed_as_it_is_shown_is_the_same_to_a_millimetre(metres: float, units: Units) -> None:
    shown = form(wheelbase=metres, units=units).draft()["wheelbase"]
    read = form(wheelbase=1.0, units=units).checked({**form(units=units).draft(), "wheelbase": shown})
    value = metres if read.document is None else read.document.wheelbase
    assert value == pytest.approx(metres, abs=MILLIMETRE)


@pytest.mark.parametrize(("typed", "metres"), [("2,5", 2.5), ("2.5", 2.5), ("２．５", 2.5), (" 3 ", 3.0)])
def test_comma_and_point_and_wide_digits(typed: str, metres: float) -> None:
    read = form().checked({**form().draft(), "wheelbase": typed}).document
    assert read is not None
    assert read.wheelbase == metres


def test_inches_and_feet_are_read_as_what_they_are() -> None:
    view = form(units=Units.IMPERIAL)
    read = view.checked({**view.draft(), "wheelbase": "100", "turning_radius": "20"}).document
    assert read is not None
    assert read.wheelbase == pytest.approx(2.54)
    assert read.turning_radius == pytest.approx(6.096)


@pytest.mark.parametrize("typed", ["", "nan", "inf", "1e999", "2.4.5", "<b>", "9" * 60, "０x1"])
def test_what_is_no_number_is_said_under_its_entry(typed: str) -> None:
    checked = form().checked({**form().draft(), "wheelbase": typed})
    assert checked.document is None
    assert set(checked.wrong) == {"wheelbase"}


@pytest.mark.parametrize("typed", ["0.4", "8.1", "1e30", "-3"])
def test_what_is_out_of_bounds_names_them(typed: str) -> None:
    checked = form().checked({**form().draft(), "wheelbase": typed})
    assert checked.wrong == {"wheelbase": "Must be 0.5 to 8 m."}


def test_a_rule_of_the_whole_document_stands_under_its_entry() -> None:
    view = FormView(Implement, entries_of(Implement), Implement(name="a").model_dump(), ENGLISH, Units.METRIC)
    checked = view.checked({**view.draft(), "overlap": "3"})
    assert checked.wrong == {"overlap": "The overlap must be less than the working width."}


@pytest.mark.parametrize("name", ["", "   ", "a\x00b", "\x1b[31m", "n" * 121])
def test_names_that_cannot_be(name: str) -> None:
    checked = form().checked({**form().draft(), "name": name})
    assert checked.document is None
    assert set(checked.wrong) == {"name"}


@pytest.mark.parametrize("name", ["<script>alert(1)</script>", "トラクター 一号", "جرّار", "🚜", 'O\'Neil & "son"'])
def test_names_of_any_script(name: str) -> None:
    read = form().checked({**form().draft(), "name": name}).document
    assert read is not None
    assert read.name == name


def test_entries_that_do_not_apply_keep_their_value_and_are_not_checked() -> None:
    view = FormView(Implement, entries_of(Implement), Implement(name="a").model_dump(), ENGLISH, Units.METRIC)
    by_member = {entry.member: entry for entry in view.entries}
    draft = {**view.draft(), "drawbar": "nonsense"}
    assert not view.applies(by_member["drawbar"], draft)
    assert view.checked(draft).document == Implement(name="a")
    trailed = {**draft, "hitch": "trailed"}
    assert view.applies(by_member["drawbar"], trailed)
    assert set(view.checked(trailed).wrong) == {"drawbar"}


def test_an_optional_number_may_be_empty() -> None:
    operation = Operation(name="a", field="f", tractor="t", implement="i", laps=2)
    view = FormView(Operation, entries_of(Operation), operation.model_dump(), ENGLISH, Units.METRIC)
    read = view.checked({**view.draft(), "laps": ""}).document
    assert read is not None
    assert read.laps is None
    assert set(view.checked({**view.draft(), "laps": "1.5"}).wrong) == {"laps"}


def test_bounds_that_are_shown_may_be_typed() -> None:
    for model in MODELS:
        for entry in entries_of(model):
            if entry.kind is not EntryKind.NUMBER:
                continue
            for units in Units:
                for words in map(words_for, LANGUAGES):
                    shown = re.findall(r"-?\d+(?:[.,]\d+)?", bounds_text(entry, words, units))
                    view = FormView(model, (entry,), {}, words, units)
                    low, high = (view.read(entry, one) for one in shown)
                    assert low >= (entry.low or 0.0) - 1e-9
                    assert high <= (entry.high or 0.0) + 1e-9


def test_a_picture_gets_the_values_that_can_be_read() -> None:
    view = form()
    seen = view.seen({**view.draft(), "wheelbase": "x", "antenna_right": "1e999", "antenna_height": "3"})
    assert seen["wheelbase"] == TRACTOR.wheelbase
    assert math.isfinite(seen["antenna_right"])
    assert seen["antenna_height"] == 3


def test_a_hint_is_help_and_bounds() -> None:
    entry = Entry("m", EntryKind.NUMBER, "M", help="Rear axle to front axle", unit="m", low=0.5, high=8)
    assert hint_text(entry, ENGLISH, Units.METRIC) == "Rear axle to front axle · 0.5 to 8 m"
    assert hint_text(entry, ENGLISH, Units.IMPERIAL) == "Rear axle to front axle · 19.7 to 314.9 in"
