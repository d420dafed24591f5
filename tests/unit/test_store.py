"""The store: documents by name, conflicts seen, broken files set aside, nothing half written."""

import errno
import json
import os
import threading
import time
from pathlib import Path
from typing import Any, Literal

import pytest
from support.documents import field_named, operation_named, tractor_named

from guidance_app.documents import Document, FieldDocument, Implement, Operation, Receiver, Settings, Tractor
from guidance_app.store import Store, StoreConflictError, StoreError, load_job
from guidance_app.store.migrations import decoded, encoded

THOUSAND_FIELDS_S = 1.0


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "data")


def filled(store: Store) -> Store:
    """With a field, two operations and what they refer to."""
    for document in (field_named("North"), tractor_named("T"), Implement(name="I"), Receiver(name="R")):
        store.save(document)
    store.save(operation_named("Sow", "North"))
    store.save(operation_named("Spray", "North"))
    return store


def test_what_was_saved_is_loaded_whatever_its_kind(store: Store) -> None:
    filled(store)
    assert store.load(FieldDocument, "North").document == field_named("North")
    assert store.load(Operation, "Sow").document == operation_named("Sow", "North")
    assert [each.document.name for each in store.list(Operation, "North")] == ["Sow", "Spray"]
    assert store.problems == ()


def test_nothing_is_created_by_looking(store: Store) -> None:
    assert store.list(Tractor) == ()
    assert store.settings() is None
    assert not store.root.exists()


def test_files_lie_where_a_person_looks_for_them(store: Store) -> None:
    filled(store)
    store.save(Settings(night=True))
    assert (store.root / "fields" / "north" / "field.json").is_file()
    assert (store.root / "fields" / "north" / "operations" / "sow.json").is_file()
    assert json.loads((store.root / "settings.json").read_text())["night"] is True


def test_a_second_console_does_not_overwrite_the_first_ones_change(store: Store) -> None:
    store.save(tractor_named("T"))
    other = Store(store.root)
    mine, theirs = store.load(Tractor, "T"), other.load(Tractor, "T")
    other.save(theirs.document.model_copy(update={"wheelbase": 3.0}), theirs.revision)
    with pytest.raises(StoreConflictError, match="changed by another console") as caught:
        store.save(mine.document.model_copy(update={"wheelbase": 2.0}), mine.revision)
    assert caught.value.current is not None
    assert store.load(Tractor, "T").document.wheelbase == 3.0


def test_a_new_document_never_replaces_one_of_its_name(store: Store) -> None:
    store.save(tractor_named("T"))
    with pytest.raises(StoreConflictError, match="exists already"):
        store.save(tractor_named("T", 3.0))


def test_saving_the_same_again_is_no_conflict(store: Store) -> None:
    assert store.save(tractor_named("T")) == store.save(tractor_named("T"))


def test_changing_what_another_console_removed_is_a_conflict(store: Store) -> None:
    revision = store.save(tractor_named("T"))
    Store(store.root).delete(Tractor, "T")
    with pytest.raises(StoreConflictError, match="removed or renamed") as caught:
        store.save(tractor_named("T", 3.0), revision)
    assert caught.value.current is None


def test_revisions_follow_each_other(store: Store) -> None:
    revision = store.save(Settings())
    revision = store.save(Settings(night=True), revision)
    store.save(Settings(night=True, sounds=False), revision)
    stored = store.settings()
    assert stored is not None
    assert stored.document == Settings(night=True, sounds=False)


def test_one_broken_file_is_set_aside_and_named_and_the_rest_loads(store: Store) -> None:
    filled(store)
    broken = store.root / "tractors" / "bad.json"
    broken.write_text('{"kind": "tractor", "name": "Half')
    assert [each.document.name for each in store.list(Tractor)] == ["T"]
    (problem,) = store.problems
    assert "bad.json" in problem.sentence
    assert problem.set_aside == broken.with_name("bad.json.broken")
    assert problem.set_aside.read_text() == '{"kind": "tractor", "name": "Half'
    assert not broken.exists()
    assert Store(store.root).problems == (problem,)  # it is still named on the next day


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x00\xff\xfe",
        b"[]",
        b'{"kind": "tractor"}',
        b'{"kind": "implement", "name": "I"}',
        b'{"kind": "tractor", "name": "T", "wheelbase": NaN}',
        b'{"kind": "tractor", "name": "T", "wheelbase": 1e999}',
        b'{"kind": "tractor", "name": "T", "wheelbse": 2}',
        b'{"kind": "tractor", "name": "T", "schema_version": "1"}',
        b'{"kind": "tractor", "name": "T", "schema_version": 0}',
        b"[" * 100_000,
    ],
)
def test_every_kind_of_broken_file_is_set_aside(store: Store, content: bytes) -> None:
    path = store.root / "tractors" / "x.json"
    path.parent.mkdir(parents=True)
    path.write_bytes(content)
    assert store.list(Tractor) == ()
    assert len(store.problems) == 1
    assert path.with_name("x.json.broken").read_bytes() == content


def test_a_stored_field_that_crosses_itself_is_set_aside_with_the_place(store: Store) -> None:
    store.save(field_named("F"))
    path = store.root / "fields" / "f" / "field.json"
    members = json.loads(path.read_text())
    ring = members["boundary"]["coordinates"][0]
    ring[1], ring[2] = ring[2], ring[1]
    path.write_text(json.dumps(members))
    assert store.list(FieldDocument) == ()
    assert "crosses itself at latitude" in store.problems[0].sentence


def test_a_newer_document_is_left_in_place_and_never_overwritten(store: Store) -> None:
    store.save(tractor_named("T"))
    path = store.root / "tractors" / "t.json"
    newer = json.dumps({**json.loads(path.read_text()), "schema_version": 2, "colour": "red"})
    path.write_text(newer)
    assert store.list(Tractor) == ()
    assert "newer version of the program" in store.problems[0].sentence
    with pytest.raises(StoreError, match="newer version of the program"):
        store.save(tractor_named("T"))
    assert path.read_text() == newer


def test_an_older_document_is_lifted_and_its_file_waits_for_the_next_save(tmp_path: Path) -> None:
    """An invented history: version 0 kept millimetres."""

    def to_metres(members: dict[str, Any]) -> dict[str, Any]:
        wheelbase = members.pop("wheelbase_mm")
        return {**members, "wheelbase": wheelbase / 1000}

    path = tmp_path / "tractors" / "old.json"
    path.parent.mkdir()
    path.write_text('{"schema_version": 0, "kind": "tractor", "name": "Old", "wheelbase_mm": 2450}')
    store = Store(tmp_path, migrations={("tractor", 0): to_metres})
    stored = store.load(Tractor, "Old")
    assert stored.document == Tractor(name="Old", wheelbase=2.45)
    assert "wheelbase_mm" in path.read_text()
    store.save(stored.document.model_copy(update={"wheelbase": 2.5}), stored.revision)
    assert json.loads(path.read_text())["schema_version"] == 1


def test_a_rename_reaches_the_operations_that_refer_to_it(store: Store) -> None:
    filled(store).rename(Tractor, "T", "Old blue one")
    assert load_job(store, "Sow").tractor == tractor_named("Old blue one")
    assert (store.root / "tractors" / "old-blue-one.json").is_file()
    assert [each.document.name for each in store.list(Tractor)] == ["Old blue one"]


def test_a_renamed_field_takes_its_operations_along(store: Store) -> None:
    filled(store).rename(FieldDocument, "North", "北の畑")
    assert [each.document.field for each in store.list(Operation)] == ["北の畑", "北の畑"]
    job = load_job(store, "Spray", "北の畑")
    assert job.field is not None
    assert job.field.boundary == field_named("x").boundary
    assert not (store.root / "fields" / "north").exists()


def test_a_rename_to_a_name_in_use_changes_nothing(store: Store) -> None:
    filled(store).save(tractor_named("Other", 3.0))
    with pytest.raises(StoreError, match="in use"):
        store.rename(Tractor, "T", "Other")
    assert {each.document.name for each in store.list(Tractor)} == {"T", "Other"}


def test_a_copy_has_the_new_name_alone_changed(store: Store) -> None:
    filled(store).copy(Operation, "Sow", "Sow again", "North")
    copied = store.load(Operation, "Sow again").document
    assert copied == operation_named("Sow", "North").model_copy(update={"name": "Sow again"})


def test_a_name_of_nothing_is_refused(store: Store) -> None:
    filled(store)
    for name in ("", "  ", "a\x00b", "x" * 121):
        with pytest.raises(StoreError, match="cannot be a name"):
            store.copy(Tractor, "T", name)


def test_a_deletion_is_undone_whole(store: Store) -> None:
    removed = filled(store).delete(FieldDocument, "North")
    assert store.list(FieldDocument) == ()
    assert store.list(Operation) == ()
    store.undo(removed)
    assert len(store.list(Operation, "North")) == 2
    assert store.problems == ()


def test_an_undo_never_overwrites(store: Store) -> None:
    removed = filled(store).delete(Tractor, "T")
    store.save(tractor_named("T", 3.0))
    with pytest.raises(StoreError, match="in the way"):
        store.undo(removed)
    assert store.load(Tractor, "T").document.wheelbase == 3.0


def test_the_emptied_trash_is_gone(store: Store) -> None:
    removed = filled(store).delete(Tractor, "T")
    store.empty_trash()
    assert not removed.kept.exists()
    store.empty_trash()


def test_what_is_archived_is_out_of_the_lists_and_comes_back(store: Store) -> None:
    filled(store).archive(FieldDocument, "North")
    assert store.list(FieldDocument) == ()
    (kept,) = store.archived(FieldDocument)
    store.unarchive(kept)
    assert len(store.list(Operation, "North")) == 2
    store.archive(Operation, "Sow")
    assert [each.document.name for each in store.list(Operation)] == ["Spray"]
    store.unarchive(store.archived(Operation)[0])
    assert [each.document.name for each in store.list(Operation)] == ["Sow", "Spray"]


def test_a_file_copied_by_hand_is_named_not_hidden(store: Store) -> None:
    store.save(tractor_named("T"))
    twin = store.root / "tractors" / "t copy.json"
    twin.write_bytes(encoded(tractor_named("T", 3.0)))
    assert len(store.list(Tractor)) == 1
    assert any("another 'T'" in problem.sentence for problem in store.problems)


def test_an_operation_belongs_to_the_field_in_whose_folder_it_lies(store: Store) -> None:
    filled(store).save(field_named("South"))
    source = store.root / "fields" / "north" / "operations" / "sow.json"
    target = store.root / "fields" / "south" / "operations" / "sow.json"
    target.parent.mkdir()
    target.write_bytes(source.read_bytes())
    assert [each.document.field for each in store.list(Operation) if each.document.name == "Sow"] == ["North", "South"]
    with pytest.raises(StoreError, match=r"several fields have an operation 'Sow' \('North', 'South'\)"):
        store.load(Operation, "Sow")
    assert store.load(Operation, "Sow", "South").document.field == "South"


def test_an_operation_of_a_missing_field_is_refused(store: Store) -> None:
    filled(store)
    with pytest.raises(StoreError, match=r"there is no field 'West'.*there is 'North'"):
        store.save(operation_named("Sow", "West"))


def test_a_job_with_a_missing_part_says_which(store: Store) -> None:
    filled(store).delete(Implement, "I")
    with pytest.raises(StoreError, match="there is no implement 'I'"):
        load_job(store, "Sow")


def test_a_full_disk_is_a_sentence_and_leaves_the_old_document(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    revision = store.save(tractor_named("T"))

    def full(_descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", full)
        with pytest.raises(StoreError, match="the disk is full"):
            store.save(tractor_named("T", 3.0), revision)
    assert store.load(Tractor, "T").document == tractor_named("T")
    assert [path.name for path in (store.root / "tractors").iterdir()] == ["t.json"]


def test_the_file_is_on_the_disk_before_its_name_and_the_name_before_the_answer(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    store.save(tractor_named("T"))
    steps: list[str] = []
    fsync, replace = os.fsync, os.replace

    def noted_fsync(descriptor: int) -> None:
        steps.append(f"fsync {Path(f'/proc/self/fd/{descriptor}').readlink().name}")
        fsync(descriptor)

    def noted_replace(source: str, target: str) -> None:
        steps.append(f"rename {Path(source).name} {Path(target).name}")
        replace(source, target)

    if not Path("/proc/self/fd").is_dir():
        pytest.skip("the names of open files can be looked up on Linux only")
    monkeypatch.setattr(os, "fsync", noted_fsync)
    monkeypatch.setattr(os, "replace", noted_replace)
    store.replace(tractor_named("T", 3.0))
    assert steps == ["fsync .t.json.tmp", "rename .t.json.tmp t.json", "fsync tractors"]


def test_a_folder_that_cannot_be_written_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    store = Store(tmp_path / "file" / "data")
    with pytest.raises(StoreError, match=r"cannot be written: .*; choose another folder"):
        store.save(tractor_named("T"))


def test_many_threads_lose_nothing(store: Store) -> None:
    def write(number: int) -> None:
        for turn in range(8):
            store.save(tractor_named(f"T {number} {turn}"))

    threads = [threading.Thread(target=write, args=(number,)) for number in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(store.list(Tractor)) == 48
    assert store.problems == ()


def test_a_thousand_fields_list_and_open_in_a_second(store: Store) -> None:
    field = field_named("F")
    for number in range(1000):
        path = store.root / "fields" / f"f{number}" / "field.json"
        path.parent.mkdir(parents=True)
        path.write_bytes(encoded(field.model_copy(update={"name": f"Field {number}"})))
    begin = time.process_time()
    assert len(store.list(FieldDocument)) == 1000
    assert store.load(FieldDocument, "Field 977").document.name == "Field 977"
    assert time.process_time() - begin < THOUSAND_FIELDS_S


def test_migrations_follow_each_other_in_the_order_of_versions() -> None:
    class Plough(Document):
        schema_version: Literal[3] = 3  # type: ignore[assignment] # a later version than any kind has today
        kind: Literal["plough"] = "plough"
        name: str
        width: float

    def named(members: dict[str, Any]) -> dict[str, Any]:
        return {"kind": "plough", "name": members["label"], "width_cm": members["width_cm"]}

    def in_metres(members: dict[str, Any]) -> dict[str, Any]:
        return {"kind": "plough", "name": members["name"], "width": members["width_cm"] / 100}

    migrations = {("plough", 1): named, ("plough", 2): in_metres}
    wanted = Plough(name="Deep", width=1.5)
    for members in (
        {"schema_version": 1, "kind": "plough", "label": "Deep", "width_cm": 150},
        {"schema_version": 2, "kind": "plough", "name": "Deep", "width_cm": 150},
        {"schema_version": 3, "kind": "plough", "name": "Deep", "width": 1.5},
    ):
        assert decoded(json.dumps(members).encode(), Plough, migrations) == wanted
    with pytest.raises(StoreError, match="version 1 is older than this program can lift"):
        decoded(b'{"schema_version": 1}', Plough, {("plough", 2): in_metres})


def test_a_rename_to_the_same_name_changes_nothing(store: Store) -> None:
    revision = store.save(tractor_named("T"))
    assert store.rename(Tractor, "T", " T ") == revision


def test_a_name_that_is_taken_again_keeps_its_archive(store: Store) -> None:
    store.save(tractor_named("T"))
    store.archive(Tractor, "T")
    store.save(tractor_named("T", 3.0))
    with pytest.raises(StoreError, match="rename that first"):
        store.unarchive(store.archived(Tractor)[0])
    store.archive(Tractor, "T")
    assert {path.name for path in (store.root / "archive" / "tractors").iterdir()} == {"t.json", "t-2.json"}


def test_a_file_that_may_not_be_read_is_named_and_left_alone(store: Store) -> None:
    place = store.root / "tractors" / "folder.json"
    place.mkdir(parents=True)
    assert store.list(Tractor) == ()
    assert "folder.json cannot be read" in store.problems[0].sentence
    assert place.is_dir()


def test_a_repaired_file_that_was_set_aside_says_how_it_comes_back(store: Store) -> None:
    aside = store.root / "tractors" / "t.json.broken"
    aside.parent.mkdir(parents=True)
    aside.write_bytes(encoded(tractor_named("T")))
    assert "take '.broken' off its name" in store.problems[0].sentence
