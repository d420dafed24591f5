"""Edge and exclusions in an operation's form: tapped on the map or chosen from the list, stored, and found again."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import shapely
import viser
from support.setup_place import SetupPlace, setup_place

from guidance_app.documents import Direction, FieldDocument, Method, Operation
from guidance_app.field_editing import with_exclusion
from guidance_app.guidance.picking import edge_words, picking_of
from guidance_app.guidance.wishes import exclusions_with
from guidance_app.store import Store, copy_sample

POND = [(0.0, -40.0), (25.0, -40.0), (25.0, -20.0), (0.0, -20.0)]
POLE = [(-30.0, -60.0), (-27.0, -60.0), (-27.0, -57.0), (-30.0, -57.0)]


@pytest.fixture
def store(tmp_path: Path) -> Store:
    """The sample's documents; its field has a pond and a pole beside the exclusion that it comes with."""
    made = Store(copy_sample(tmp_path))
    stored = made.load(FieldDocument, "Sample field")
    document = stored.document
    for hole in (POND, POLE):
        document = with_exclusion(picking_of(document).frame, document, hole)
    made.save(document, stored.revision)
    return made


@pytest.fixture
def place(server: viser.ViserServer, store: Store) -> Iterator[SetupPlace]:
    """A console on it."""
    with setup_place(server, store.root) as one:
        yield one


def field_of(place: SetupPlace) -> FieldDocument:
    return place.store.load(FieldDocument, "Sample field").document


def anew(place: SetupPlace, name: str) -> None:
    """An empty form with its name: before the map changes, for then the list of fields has a newer entry for one."""
    place.open_form("New operation")
    place.fill("Name", name)


def saved(place: SetupPlace, name: str) -> Operation:
    place.press("Save")
    place.until(lambda: name in place.names(Operation))
    return place.store.load(Operation, name).document


def chosen(place: SetupPlace, word: str) -> bool:
    """Whether a button is the chosen one of its row."""
    control = place.newest(word)
    return control is not None and f"● {word}" in control["props"]["options"]


def row(place: SetupPlace, number: int) -> str:
    """The label of an exclusion's row."""
    labels = [str(one["props"].get("label")) for one in place.client.controls.values()]
    return next((one for one in reversed(labels) if one.startswith(f"{number} · ")), "")


def row_says(place: SetupPlace, number: int) -> str:
    control = place.newest(row(place, number))
    options = [] if control is None else control["props"].get("options", [])
    return next((one for one in options if one.startswith("● ")), "").removeprefix("● ")


def choose_in_row(place: SetupPlace, number: int, word: str) -> None:
    control = place.newest(row(place, number))
    assert control is not None
    place._send(control, word)  # a row's words are those of every row


def test_a_tapped_edge_is_drawn_stored_and_planned_along(place: SetupPlace) -> None:
    anew(place, "along the edge")
    place.press("Tapped edge")
    place.says("Tap an edge of the field on the map")
    place.until(lambda: place.house.manager.snapshot().field_rings)
    place.press("Save")
    place.says("No edge is chosen yet")
    assert place.names(Operation) == ["Round trip"]
    tap_until(place, (60.0, 120.0), "/w/sketch/edge")
    place.says("Along the orange edge")
    made = saved(place, "along the edge")
    assert made.direction is Direction.EDGE
    assert made.edge_at is not None
    metres, _ = edge_words(picking_of(field_of(place)).edge_of(made.edge_at))
    assert metres == pytest.approx(83.4, abs=1.0)
    place.until(lambda: "/w/sketch/edge" not in place.client.nodes)
    place.press("along the edge · Sample field")
    place.until(lambda: "/w/sketch/edge" in place.client.nodes)
    place.press("Show the plan on the map")
    place.says("way worked")
    place.until(lambda: "/w/sketch/worked" in place.client.nodes)
    place.press("Back")


def tap(place: SetupPlace, east: float, north: float) -> None:
    """A tap on the field, whose world lies north along the root's x."""
    x, y, *_ = place.client.place_of("/w")
    place.client.tap(x + north, y - east)


def tap_until(place: SetupPlace, spot: tuple[float, float], node: str) -> None:
    """Taps are heard from the moment that the field is on the map."""

    def tapped() -> bool:
        tap(place, *spot)
        return node in place.client.nodes

    place.until(tapped)


def test_the_next_edge_is_one_press_away(place: SetupPlace) -> None:
    anew(place, "second longest")
    place.press("Tapped edge")
    for _ in range(2):
        place.press("Next edge")
    place.says("Along the orange edge")
    made = saved(place, "second longest")
    assert made.edge_at == picking_of(field_of(place)).longest_edges()[1]


def test_a_method_without_passes_asks_for_no_edge(place: SetupPlace) -> None:
    anew(place, "in laps")
    place.press("Tapped edge")
    place.until(lambda: place.newest("Next edge"))
    place.press("Surrounding")
    made = saved(place, "in laps")
    assert (made.method, made.direction, made.edge_at) == (Method.SURROUNDING, Direction.LONGEST_EDGE, None)


def test_exclusions_are_passable_one_by_one_by_list_and_by_tap(place: SetupPlace) -> None:
    anew(place, "over two")
    place.until(lambda: chosen(place, "Drive around"))
    place.press("One by one")
    place.says("Tap an exclusion on the map, or choose below")
    place.until(lambda: "/w/sketch/around" in place.client.nodes and "/w/sketch/numbers" in place.client.nodes)
    assert "/w/sketch/over" not in place.client.nodes
    areas = picking_of(field_of(place)).exclusion_areas()
    assert row(place, 2) == f"2 · {areas[1]:.0f} m²"
    choose_in_row(place, 2, "Passable")
    place.until(lambda: row_says(place, 2) == "Passable" and "/w/sketch/over" in place.client.nodes)
    tap(place, -25.0, -58.0)  # beside the pole: nearer than any other
    place.until(lambda: row_says(place, 3) == "Passable")
    assert row_says(place, 1) == "Drive around"
    made = saved(place, "over two")
    assert exclusions_with(field_of(place), made.passable) == {1, 2}
    assert made.over_exclusions is False
    place.press("over two · Sample field")
    place.until(lambda: row_says(place, 3) == "Passable")
    tap(place, -28.0, -58.0)
    place.until(lambda: row_says(place, 3) == "Drive around")
    place.press("Show the plan on the map")
    place.until(lambda: place.house.manager.snapshot().plan is not None)
    plan = place.house.manager.snapshot().plan
    assert plan is not None
    polygon = picking_of(field_of(place)).polygon
    pond = shapely.Polygon(polygon.interiors[1]).buffer(-0.01)
    assert any(shapely.LineString(np.asarray(one.points)).intersects(pond) for one in plan.segments)


def test_all_exclusions_are_passable_at_once_as_before(place: SetupPlace) -> None:
    anew(place, "over all")
    place.until(lambda: chosen(place, "Drive around"))
    place.press("Passable")
    place.until(lambda: chosen(place, "Passable"))
    made = saved(place, "over all")
    assert (made.over_exclusions, made.passable) == (True, [])
    place.press("over all · Sample field")
    place.until(lambda: chosen(place, "Passable"))


def test_an_exclusion_that_is_gone_is_said_and_forgotten(server: viser.ViserServer, store: Store) -> None:
    stored = store.load(Operation, "Round trip")
    corner = picking_of(store.load(FieldDocument, "Sample field").document).edge_at(0.0, -200.0)
    store.save(stored.document.model_copy(update={"passable": [corner]}), stored.revision)
    with setup_place(server, store.root) as place:
        place.press("Round trip · Sample field")
        place.says("An exclusion that was passable is not there any more")
        place.until(lambda: place.newest("Copy"))  # the form is whole: before, the newest Save is another page's
        place.press("Save")
        place.until(lambda: place.store.load(Operation, "Round trip").document.passable == [])


def test_a_field_without_exclusions_asks_nothing_about_them(place: SetupPlace) -> None:
    document = field_of(place)
    geometry = document.boundary.model_copy(update={"coordinates": document.boundary.coordinates[:1]})
    place.store.save(document.model_copy(update={"name": "Bare", "boundary": geometry}))
    anew(place, "x")
    place.fill("Field", "Bare")
    place.until(lambda: not place.newest("Exclusions"))
    place.fill("Field", "Sample field")
    place.until(lambda: place.newest("Exclusions"))
