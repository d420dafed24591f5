"""The settings panel: what changes at once, what from the next drive on; backup, restore with undo, and the trash."""

import io
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
from support.setup_place import SetupPlace, setup_place

from guidance_app.console.backups import contents_of, in_trash
from guidance_app.documents import Settings, Tractor, Units
from guidance_app.language import ENGLISH, words_for
from guidance_app.store import Store, StoreError, copy_sample, load_job
from guidance_app.view.lamp_steps import PRESETS, steps_from_text, steps_text


@pytest.fixture
def place(server: viser.ViserServer, tmp_path: Path) -> Iterator[SetupPlace]:
    """The sample's documents, with the settings in sight."""
    with setup_place(server, copy_sample(tmp_path)) as one:
        one.until(lambda: one.newest("Light bar steps"))
        yield one


def stored(place: SetupPlace) -> Settings:
    found = place.store.settings()
    assert found is not None
    return found.document


def test_units_and_language_change_every_panel_at_once(place: SetupPlace) -> None:
    place.press("Imperial")
    place.press("Español")
    place.press("Save")
    place.until(lambda: place.newest("Conducir ya"))
    assert (stored(place).units, stored(place).language) == (Units.IMPERIAL, "es")
    assert place.house.manager.job.settings.units is Units.IMPERIAL


def test_steps_are_typed_in_centimetres_or_taken(place: SetupPlace) -> None:
    place.press("Coarse")
    place.until(lambda: (one := place.newest("Light bar steps")) and one["value"] == "5 10 20 30 50 75 100 150")
    place.press("Save")
    place.says("Stored")
    assert stored(place).light_bar_steps == PRESETS["coarse"]
    place.fill("Light bar steps", "2,5 5 10 20 30 50 75 100")
    place.press("Save")
    place.until(lambda: stored(place).light_bar_steps[0] == 0.025)
    assert place.house.manager.job.settings.light_bar_steps[0] == 0.025


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ("1 2 3", "Type eight numbers"),
        ("1 2 3 4 5 6 7 x", "is not a number"),
        ("10 5 20 30 40 50 60 70", "must be larger than the one before"),
        ("1 2 3 4 5 6 7 5000", "must be larger|from 0.5 cm to 10 m"),
    ],
)
def test_steps_that_cannot_be_are_refused(place: SetupPlace, typed: str, said: str) -> None:
    place.fill("Light bar steps", typed)
    place.press("Save")
    place.says(said)
    assert place.store.settings() is None


@pytest.mark.parametrize("units", list(Units))
@pytest.mark.parametrize("language", ["en", "es"])
@pytest.mark.parametrize("steps", list(PRESETS.values()))
def test_steps_are_read_as_they_are_written(
    units: Units, language: str, steps: tuple[float, float, float, float, float, float, float, float]
) -> None:
    words = words_for(language)  # type: ignore[arg-type]
    read = steps_from_text(steps_text(steps, units, words), units, words)
    assert read == pytest.approx(steps, abs=0.0013)
    assert steps_from_text("1, 2, 3, 4, 5, 6, 7, 8", Units.METRIC, ENGLISH)[1] == 0.02


def test_the_guided_point_waits_for_the_next_drive(place: SetupPlace) -> None:
    place.house.drive(load_job(place.store, "Round trip"))
    place.press("Guide the implement instead of the tractor")
    place.press("Night")
    place.press("Save")
    place.says("implement is guided from the next drive on")
    assert stored(place).guide_implement
    assert not place.house.manager.job.settings.guide_implement
    place.house.end()
    place.house.drive(load_job(place.store, "Round trip"))
    assert place.house.manager.job.settings.guide_implement


def test_another_consoles_settings_are_not_lost_unseen(place: SetupPlace) -> None:
    Store(place.store.root).save(Settings(sounds=False))
    place.press("Imperial")
    place.press("Save")
    place.says("Press Save again to keep yours")
    assert stored(place).units is Units.METRIC
    place.press("Save")
    place.until(lambda: stored(place).units is Units.IMPERIAL)


def backup_link(place: SetupPlace) -> str:
    found: list[str] = []

    def there() -> bool:
        found[:] = re.findall(r'href="/download/(backup\.zip)"', place.client.words())
        return bool(found)

    place.until(there)
    return found[0]


def the_backup(place: SetupPlace) -> bytes:
    make = place.house.files.maker(backup_link(place))
    assert make is not None
    made = make()
    assert made is not None
    assert re.fullmatch(r"guidance-backup-\d{4}-\d\d-\d\d\.zip", made.name)
    return made.data


def brought(place: SetupPlace, name: str, content: bytes) -> None:
    """Sends a file to where the settings await one."""
    backup_link(place)
    page = place.client.words()
    token = re.findall(r'data-upload="([^"]+)"', page[page.index("backup.zip") :])[0]
    take = place.house.files.taker(token)
    assert take is not None
    take(name, content)


def test_backup_restore_and_back(place: SetupPlace) -> None:
    archive = the_backup(place)
    assert contents_of(archive)["fields"] == 1
    place.store.save(Tractor(name="Newer"))
    brought(place, "<b>b.zip", archive)
    place.says("It holds fields: 1, operations: 1, tractors: 1")
    assert "<b>b.zip" not in place.client.words()
    assert "Newer" in place.names(Tractor)
    place.press("Yes, replace everything")
    place.says("The backup is restored")
    assert place.names(Tractor) == ["Sample tractor"]
    place.press("Undo the restore")
    place.says("as it was before the restore")
    assert place.names(Tractor) == ["Newer", "Sample tractor"]


def test_what_is_no_backup_is_refused(place: SetupPlace) -> None:
    brought(place, "x.zip", b"nothing of the kind")
    place.says("This file is no backup")
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w") as archive:
        archive.writestr("holiday.jpg", b"x")
    brought(place, "y.zip", held.getvalue())
    place.says("it is no backup")
    assert place.names(Tractor) == ["Sample tractor"]


def test_nothing_is_restored_under_a_drive(place: SetupPlace) -> None:
    archive = the_backup(place)
    place.house.drive(load_job(place.store, "Round trip"))
    brought(place, "b.zip", archive)
    place.press("Yes, replace everything")
    place.says("end it first, then restore")
    place.house.end()


def test_a_restore_may_be_left(place: SetupPlace) -> None:
    brought(place, "b.zip", the_backup(place))
    place.press("No, leave it")
    place.until(lambda: place.newest("Light bar steps"))


def test_the_trash_is_emptied_after_a_question(server: viser.ViserServer, tmp_path: Path) -> None:
    store = Store(copy_sample(tmp_path))
    removed = store.delete(Tractor, "Sample tractor")
    with setup_place(server, tmp_path) as place:
        place.press("Empty the trash (1)")
        place.says("can then never be brought back")
        assert in_trash(tmp_path) == 1
        place.press("Yes, forget them for good")
        place.says("The trash is empty")
        assert in_trash(tmp_path) == 0
        with pytest.raises(StoreError):
            store.undo(removed)
