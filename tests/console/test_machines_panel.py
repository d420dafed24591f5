"""The machines panel: register, change, rename, copy, put away and bring back; two consoles; names of any kind."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
from support.setup_place import SetupPlace, setup_place

from guidance_app.documents import Implement, Operation, Receiver, Settings, Tractor, Units
from guidance_app.store import Store, copy_sample


@pytest.fixture
def place(server: viser.ViserServer, tmp_path: Path) -> Iterator[SetupPlace]:
    """The sample's documents."""
    with setup_place(server, copy_sample(tmp_path)) as one:
        yield one


def opened(place: SetupPlace, shelf: str, document: str | None = None) -> None:
    place.press(shelf)
    if document is not None:
        place.until(lambda: any(document in str(one["props"].get("label")) for one in place.client.controls.values()))
        label = next(
            one["props"]["label"]
            for one in place.client.controls.values()
            if str(one["props"].get("label")).startswith(document)
        )
        place.press(label)
        place.until(lambda: place.newest("Copy"))


def anew(place: SetupPlace, words: str) -> None:
    place.open_form(words)


def test_a_tractor_is_registered(place: SetupPlace) -> None:
    opened(place, "Tractors")
    anew(place, "New tractor")
    place.fill("Name", "Iseki <b>TJ</b> 75")
    place.fill("Wheelbase (m)", "2,3")
    place.fill("Antenna right (m)", "-0.4")
    place.press("Save")
    place.says("&#x27; is stored")
    stored = place.store.load(Tractor, "Iseki <b>TJ</b> 75").document
    assert (stored.wheelbase, stored.antenna_right) == (2.3, -0.4)
    assert "<b>TJ</b>" not in "".join(str(one["props"].get("content", "")) for one in place.client.controls.values()), (
        "markup in a name is text"
    )


@pytest.mark.parametrize(
    ("label", "typed", "said"),
    [
        ("Name", "", "at least one character"),
        ("Wheelbase (m)", "9", "Must be 0.5 to 8 m"),
        ("Wheelbase (m)", "nan", "is not a number"),
        ("Wheelbase (m)", "", "A number is missing"),
        ("Turning radius (m)", "1e99", "Must be 0.5 to 30 m"),
    ],
)
def test_what_is_wrong_is_said_and_nothing_is_stored(place: SetupPlace, label: str, typed: str, said: str) -> None:
    opened(place, "Tractors", "Sample tractor")
    place.fill(label, typed)
    place.press("Save")
    place.says(said)
    place.says("Look again at")
    assert place.names(Tractor) == ["Sample tractor"]
    assert place.store.load(Tractor, "Sample tractor").document.wheelbase == pytest.approx(2.45)


def test_the_picture_follows_what_is_typed(place: SetupPlace) -> None:
    opened(place, "Tractors", "Sample tractor")
    place.fill("Antenna right (m)", "1.25")
    place.says(r"1\.25 m</text>")


def test_only_a_trailed_implement_has_a_drawbar(place: SetupPlace) -> None:
    opened(place, "Implements", "Sample implement")
    place.until(lambda: place.newest("Hitch"))
    place.until(lambda: place.newest("Hitch to implement axle (m)") is None)
    place.press("Trailed")
    place.until(lambda: place.newest("Hitch to implement axle (m)"))
    place.fill("Hitch to implement axle (m)", "5")
    place.press("Save")
    place.says("&#x27; is stored")
    stored = place.store.load(Implement, place.names(Implement)[0]).document
    assert (stored.hitch, stored.drawbar) == ("trailed", 5.0)


def test_a_new_name_goes_along_to_the_operations(place: SetupPlace) -> None:
    opened(place, "Tractors", "Sample tractor")
    place.fill("Name", "トラクター")
    place.press("Save")
    place.says("&#x27; is stored")
    assert place.names(Tractor) == ["トラクター"]
    assert {one.document.tractor for one in place.store.list(Operation)} == {"トラクター"}


def test_a_copy_asks_for_a_name_of_its_own(place: SetupPlace) -> None:
    opened(place, "Tractors", "Sample tractor")
    place.press("Copy")
    place.until(lambda: (one := place.newest("Name")) and one["value"] == "Sample tractor (copy)")
    place.fill("Name", "Sample tractor")
    place.fill("Wheelbase (m)", "2.6")
    place.press("Save")
    place.says("exists already")
    place.fill("Name", "Second")
    place.press("Save")
    place.says("&#x27; is stored")
    assert place.names(Tractor) == ["Sample tractor", "Second"]


def test_delete_says_what_misses_it_and_is_undone(place: SetupPlace) -> None:
    opened(place, "Tractors", "Sample tractor")
    place.press("Delete")
    place.says("It is missing in: Round trip")
    assert place.names(Tractor) == []
    place.press("Undo")
    place.says("It is back")
    assert place.names(Tractor) == ["Sample tractor"]


def test_archive_and_back(place: SetupPlace) -> None:
    opened(place, "Implements", "Sample implement")
    place.press("Archive")
    place.says("is archived")
    assert place.names(Implement) == []
    place.press("Archive (1)")
    place.press("Sample implement")
    place.says("is back")
    assert place.names(Implement) == ["Sample implement"]


def test_what_is_typed_is_not_left_by_one_press(place: SetupPlace) -> None:
    opened(place, "Tractors", "Sample tractor")
    place.fill("Wheelbase (m)", "3")
    place.press("Back")
    place.press("Leave without saving")
    place.until(lambda: place.newest("New tractor"))
    assert place.store.load(Tractor, "Sample tractor").document.wheelbase == pytest.approx(2.45)


def changed_elsewhere(place: SetupPlace, **update: object) -> None:
    """Another console saves the sample tractor."""
    other = Store(place.store.root)
    stored = other.load(Tractor, "Sample tractor")
    other.save(stored.document.model_copy(update=update), stored.revision)


@pytest.mark.parametrize(("choice", "kept"), [("Keep mine", 3.0), ("Take the other", 4.0)])
def test_two_consoles_see_both_versions_and_choose(place: SetupPlace, choice: str, kept: float) -> None:
    opened(place, "Tractors", "Sample tractor")
    place.fill("Wheelbase (m)", "3")
    changed_elsewhere(place, wheelbase=4.0)
    place.press("Save")
    place.says(r"Wheelbase \(m\)</td><td>3</td><td>4</td>")
    place.press(choice)
    place.until(lambda: place.newest("New tractor") or place.newest("Save"))
    place.until(lambda: place.store.load(Tractor, "Sample tractor").document.wheelbase == kept)


def test_a_name_is_not_changed_over_another_consoles_version(place: SetupPlace) -> None:
    opened(place, "Tractors", "Sample tractor")
    place.fill("Name", "Mine")
    changed_elsewhere(place, wheelbase=4.0)
    place.press("Save")
    place.says("was changed by another console")
    assert place.names(Tractor) == ["Sample tractor"]


def test_a_tractor_removed_elsewhere(place: SetupPlace) -> None:
    opened(place, "Tractors", "Sample tractor")
    place.fill("Wheelbase (m)", "3")
    Store(place.store.root).delete(Tractor, "Sample tractor")
    place.press("Save")
    place.says("was removed or renamed")
    place.press("Keep mine")
    place.says("&#x27; is stored")
    assert place.store.load(Tractor, "Sample tractor").document.wheelbase == 3


def test_a_receiver_is_taken_from_the_list(place: SetupPlace) -> None:
    opened(place, "Receivers")
    anew(place, "New receiver")
    place.fill("Name", "AgIO")
    place.until(
        lambda: (one := place.newest("Take from")) and "Network, UDP port 9999" in one["props"].get("options", ())
    )
    place.fill("Take from", "Network, UDP port 9999")
    place.until(lambda: (one := place.newest("Source")) and one["value"] == "udp://:9999")
    place.fill("Filter", "Rounded positions (Gomez-Gil)")
    place.says("writes few decimals")
    place.press("Tokyo")
    place.press("Plane rectangular")
    place.press("Save")
    place.says("&#x27; is stored")
    stored = place.store.load(Receiver, "AgIO").document
    assert (stored.source, stored.filter) == ("udp://:9999", "quantisation_kf")
    assert (stored.datum, stored.projection) == ("tokyo", "plane rectangular")


def test_a_source_of_no_known_kind_is_refused(place: SetupPlace) -> None:
    opened(place, "Receivers")
    anew(place, "New receiver")
    place.fill("Name", "x")
    place.fill("Source", "/dev/ttyUSB0")
    place.press("Save")
    place.says("with one of serial:, ")
    assert "x" not in place.names(Receiver)


def test_documents_that_cannot_be_read_are_said_in_words(server: viser.ViserServer, tmp_path: Path) -> None:
    copy_sample(tmp_path)
    (tmp_path / "tractors" / "later.json").write_text(
        json.dumps({"schema_version": 99, "kind": "tractor", "name": "Later"}), "utf-8"
    )
    (tmp_path / "tractors" / "broken.json").write_text("{", "utf-8")
    with setup_place(server, tmp_path) as place:
        place.says("newer version of the program")
        place.says("set aside because it cannot be read")


def test_feet_and_inches(server: viser.ViserServer, tmp_path: Path) -> None:
    Store(copy_sample(tmp_path)).save(Settings(units=Units.IMPERIAL))
    with setup_place(server, tmp_path) as place:
        opened(place, "Implements")
        anew(place, "New implement")
        place.fill("Name", "Drill")
        place.fill("Working width (ft)", "10")
        place.press("Save")
        place.says("is stored")
        place.until(lambda: place.newest("Drill · 10.00 ft"))
        assert place.store.load(Implement, "Drill").document.working_width == pytest.approx(3.048)


def test_without_documents_it_says_what_to_do(server: viser.ViserServer, tmp_path: Path) -> None:
    with setup_place(server, tmp_path) as place:
        opened(place, "Tractors")
        place.says("Press New tractor")
