"""Pictures of forms: well-formed whatever is typed, escaped, and true to the orders that are driven."""

import re

import pytest
from defusedxml import ElementTree
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.documents import Implement, Tractor
from guidance_app.guidance.patterns import METHODS
from guidance_app.language import ENGLISH, LANGUAGES, words_for
from guidance_app.view.drawing import Drawing
from guidance_app.view.drawing_machines import PICTURES
from guidance_app.view.drawing_orders import LAPS, PASSES, line_picture, method_picture

TYPED = st.one_of(st.none(), st.floats(), st.floats(-20, 60))
VALUES = {**Tractor(name="a").model_dump(), **Implement(name="b").model_dump()}


def say(metres: float) -> str:
    return f"{metres:.2f} m"


def numbers(svg: str) -> list[int]:
    """The numbers written beside the passes, in the order of drawing."""
    return [int(text) for text in re.findall(r">(\d+)</text>", svg)]


@given(
    values=st.fixed_dictionaries({name: TYPED for name, value in VALUES.items() if isinstance(value, float)}),
    hitch=st.sampled_from(["mounted", "trailed"]),
)
def test_whatever_is_typed_gives_a_picture(values: dict[str, float | None], hitch: str) -> None:
    for draw in PICTURES.values():
        svg = draw({**values, "hitch": hitch}, ENGLISH, say)
        ElementTree.fromstring(svg)
        assert not re.search(r"[\"\s,>-](nan|inf)[\"\s,<]", svg)


def test_every_picture_that_a_document_names_is_drawn() -> None:
    named = {
        (info.json_schema_extra or {}).get("picture")  # type: ignore[union-attr]  # ours are dictionaries
        for model in (Tractor, Implement)
        for info in model.model_fields.values()
    }
    assert named - {None} == set(PICTURES)


def test_the_picture_says_the_numbers() -> None:
    svg = PICTURES["antenna"]({**VALUES, "antenna_right": -0.37, "antenna_height": 2.9}, ENGLISH, say)
    assert "0.37 m" in svg
    assert "2.90 m" in svg


@pytest.mark.parametrize("name", list(METHODS))
def test_a_method_is_drawn_as_it_is_driven(name: str) -> None:
    method = METHODS[name]
    options = method.options()
    svg = method_picture(method, options, ENGLISH)
    ElementTree.fromstring(svg)
    count = PASSES if method.inward is None else LAPS
    assert sorted(numbers(svg)) == list(range(1, count + 1))


def test_passes_stand_where_the_order_has_them() -> None:
    method = METHODS["transfer"]
    svg = method_picture(method, method.options_from({"skip": 1}), ENGLISH)
    places = {int(text): float(x) for x, text in re.findall(r'<text x="([\d.]+)"[^>]*>(\d+)</text>', svg)}
    order = method.pass_order(PASSES, method.options_from({"skip": 1})).sequence
    assert [number for number, _ in sorted(places.items(), key=lambda one: one[1])] == [
        place + 1 for place in sorted(range(PASSES), key=lambda place: order[place])
    ]


def test_words_are_text() -> None:
    drawing = Drawing(10, 10, '"><script>')
    drawing.words((1, 1), "<b>&")
    root = ElementTree.fromstring(drawing.svg())
    assert root.attrib["aria-label"] == '"><script>'
    assert [one.text for one in root] == ["<b>&"]


def test_an_arrow_of_no_length_is_none() -> None:
    drawing = Drawing(10, 10, "")
    drawing.arrow((1, 1), (1, 1))
    assert len(ElementTree.fromstring(drawing.svg())) == 0


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_line_without_a_plan(language: str) -> None:
    ElementTree.fromstring(line_picture(words_for(language)))  # type: ignore[arg-type]
