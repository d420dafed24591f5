"""The operations panel: registered, planned on the map, changed, started; what is missing is said in words."""

from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
from support.setup_place import SetupPlace, setup_place

from guidance_app.documents import (
    Direction,
    FieldDocument,
    GuidanceLineDocument,
    Implement,
    LineGeometry,
    Method,
    Operation,
    Tractor,
)
from guidance_app.store import Store, copy_sample


@pytest.fixture
def place(server: viser.ViserServer, tmp_path: Path) -> Iterator[SetupPlace]:
    """The sample's documents."""
    with setup_place(server, copy_sample(tmp_path)) as one:
        yield one


def anew(place: SetupPlace, name: str) -> None:
    place.open_form("New operation")
    place.fill("Name", name)


def opened(place: SetupPlace, name: str = "Round trip") -> None:
    place.press(f"{name} · Sample field")
    place.until(lambda: place.newest("Copy"))


def stored(place: SetupPlace, name: str) -> Operation:
    place.says(f"{name}&#x27; is stored")
    return place.store.load(Operation, name).document


def test_an_operation_is_registered_with_its_methods_own_options(place: SetupPlace) -> None:
    anew(place, "春 <i>")
    place.press("Transfer")
    place.until(lambda: place.newest("Passes left out"))
    place.fill("Passes left out", "2")
    place.press("Typed")
    place.until(lambda: place.newest("Heading (°)"))
    place.fill("Heading (°)", "12,5")
    place.press("Laps")
    place.until(lambda: place.newest("Headland laps"))
    place.fill("Headland laps", "3")
    place.fill("Driver", "Ana")
    place.press("Save")
    place.until(lambda: "春 <i>" in place.names(Operation))
    made = place.store.load(Operation, "春 <i>").document
    assert (made.method, made.options) == (Method.TRANSFER, {"skip": 2, "one_way": False})
    assert (made.direction, made.direction_deg) == (Direction.TYPED, 12.5)
    assert (made.laps, made.turning_space) == (3, None)
    assert (made.field, made.tractor, made.receiver, made.driver) == (
        "Sample field",
        "Sample tractor",
        "Sample receiver",
        "Ana",
    )


def test_what_a_method_does_not_use_is_not_asked(place: SetupPlace) -> None:
    anew(place, "x")
    assert place.newest("Nearest")
    place.press("Surrounding")
    place.until(lambda: place.newest("From the middle to the edge"))
    place.until(lambda: not place.newest("Nearest") and not place.newest("Laps"))
    place.press("Line without a plan")
    place.until(lambda: not place.newest("From the middle to the edge"))
    place.until(lambda: not place.newest("The tractor may back up in a turn"))


def test_the_picture_follows_the_options(place: SetupPlace) -> None:
    anew(place, "x")
    place.press("Transfer")
    place.until(lambda: place.newest("Passes left out"))
    before = [one for one in place.client.words().splitlines() if "g-cards" in one]
    place.fill("Passes left out", "3")
    place.until(lambda: [one for one in place.client.words().splitlines() if "g-cards" in one] != before)


def test_laps_and_depth_want_their_number(place: SetupPlace) -> None:
    anew(place, "x")
    place.press("Depth")
    place.until(lambda: place.newest("Turning space (m)"))
    place.press("Save")
    place.says("A number is missing here")
    place.fill("Turning space (m)", "9")
    place.press("Save")
    assert stored(place, "x").turning_space == 9


@pytest.mark.parametrize(("typed", "said"), [("21", "Must be 0 to 20"), ("-1", "Must be"), ("2.5", "whole number")])
def test_wrong_options_store_nothing(place: SetupPlace, typed: str, said: str) -> None:
    anew(place, "x")
    place.press("Transfer")
    place.until(lambda: place.newest("Passes left out"))
    place.fill("Passes left out", typed)
    place.press("Save")
    place.says(said)
    assert place.names(Operation) == ["Round trip"]


def test_the_plan_is_shown_with_its_costs_before_anything_is_stored(place: SetupPlace) -> None:
    anew(place, "")
    place.press("Show the plan on the map")
    place.says("way worked")
    place.until(lambda: "/w/sketch/worked" in place.client.nodes)
    assert place.house.manager.snapshot().plan is not None
    assert place.names(Operation) == ["Round trip"]
    assert not place.house.driving
    place.press("Save")
    place.says("at least one character")
    place.fill("Driver", "look")  # the list of fields has an entry for a name too, and may be newer
    place.press("Back")
    place.press("Leave without saving")
    place.until(lambda: "/w/sketch/worked" not in place.client.nodes)


def test_a_plan_that_cannot_be_says_why(place: SetupPlace) -> None:
    place.store.save(Implement(name="Too wide", working_width=60.0))
    anew(place, "wide")
    place.fill("Implement", "Too wide")
    place.press("Show the plan on the map")
    place.says("No plan: |laps bend too tightly|cannot be worked")


def test_a_stored_operation_keeps_what_it_says_and_takes_a_change(place: SetupPlace) -> None:
    before = place.store.load(Operation, "Round trip").document
    opened(place)
    place.press("Save")
    assert stored(place, "Round trip").model_copy(update={"options": {}}) == before.model_copy(update={"options": {}})
    opened(place)
    place.press("Best found")
    place.press("Save")
    place.until(lambda: place.store.load(Operation, "Round trip").document.direction is Direction.BEST)


def test_rename_archive_and_delete_with_undo(place: SetupPlace) -> None:
    opened(place)
    place.fill("Name", "Autumn")
    place.press("Save")
    place.until(lambda: place.names(Operation) == ["Autumn"])
    opened(place, "Autumn")
    place.press("Archive")
    place.until(lambda: place.names(Operation) == [])
    place.press("Undo")
    place.until(lambda: place.names(Operation) == ["Autumn"])
    opened(place, "Autumn")
    place.press("Delete")
    place.until(lambda: place.names(Operation) == [])
    place.press("Undo")
    place.until(lambda: place.names(Operation) == ["Autumn"])


def test_an_operation_is_started_from_its_form(place: SetupPlace) -> None:
    opened(place)
    place.press("Start this operation")
    place.until(lambda: place.house.driving)
    assert place.house.manager.job.operation is not None


def test_a_machine_that_is_gone_is_named_and_not_replaced_unseen(place: SetupPlace) -> None:
    place.store.save(Tractor(name="Other"))
    place.store.delete(Tractor, "Sample tractor")
    opened(place)
    place.until(lambda: (one := place.newest("Tractor")) and one["value"] == "Sample tractor (not there)")
    place.press("Show the plan on the map")
    place.says("there is no tractor")


@pytest.mark.parametrize("gone", ["fields", "tractors", "implements"])
def test_what_has_to_be_registered_first_is_said(server: viser.ViserServer, tmp_path: Path, gone: str) -> None:
    data = copy_sample(tmp_path)
    (data / gone).rename(data / "aside")
    with setup_place(server, data) as place:
        if gone == "fields":
            place.says("No operation yet")
        place.press("New operation")
        place.says(f"There is no {gone[:-1]} yet")


def test_two_operations_of_one_name_on_two_fields(place: SetupPlace) -> None:
    other = Store(place.store.root)
    field = other.load(FieldDocument, "Sample field")
    other.save(field.document.model_copy(update={"name": "Second field"}))
    anew(place, "Round trip")
    place.fill("Field", "Second field")
    place.press("Save")
    place.until(lambda: place.names(Operation) == ["Round trip", "Round trip"])
    place.press("Round trip · Second field")
    place.until(lambda: (one := place.newest("Field")) and one["value"] == "Second field")


def test_a_guidance_line_is_chosen_by_its_name(place: SetupPlace) -> None:
    field = place.store.load(FieldDocument, "Sample field")
    (east, north), (to_east, to_north), *_ = field.document.boundary.coordinates[0]
    line = GuidanceLineDocument(
        name="Ditch", type="ab", geometry=LineGeometry(coordinates=[(east, north), (to_east, to_north)])
    )
    place.store.save(field.document.model_copy(update={"lines": [line]}), field.revision)
    anew(place, "along")
    place.press("Guidance line")
    place.until(lambda: (one := place.newest("Guidance line")) and one["type"] == "GuiDropdownMessage")
    place.fill("Guidance line", "Ditch")
    place.press("Save")
    place.until(lambda: "along" in place.names(Operation))
    made = place.store.load(Operation, "along").document
    assert (made.direction, made.guidance_line) == (Direction.LINE, "Ditch")
