"""Backup and restore: the same folder comes back, and a strange archive changes nothing."""

import io
import shutil
import stat
import zipfile
from pathlib import Path

import pytest
from support.documents import field_named, operation_named, tractor_named

from guidance_app.documents import FieldDocument, Tractor
from guidance_app.store import Limits, Store, StoreError, finish_restore, restore, write_backup
from guidance_app.store.migrations import encoded

DOCUMENT = encoded(tractor_named("T"))


@pytest.fixture
def root(tmp_path: Path) -> Path:
    folder = tmp_path / "data"
    store = Store(folder)
    store.save(field_named("圃場"))
    store.save(tractor_named("T"))
    store.save(operation_named("Sow", "圃場"))
    (folder / "recordings" / "r").mkdir(parents=True)
    (folder / "recordings" / "r" / "receiver.nmea").write_bytes(b"$GP" * 100)
    return folder


def files_of(folder: Path) -> dict[str, bytes]:
    """Every visible file with its content."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and not any(part.startswith(".") for part in path.relative_to(folder).parts)
    }


def archive_of(members: dict[str, bytes]) -> io.BytesIO:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return packed


def test_a_backup_restored_elsewhere_is_the_same_folder(root: Path, tmp_path: Path) -> None:
    packed = io.BytesIO()
    assert write_backup(root, packed) == 4
    elsewhere = tmp_path / "elsewhere"
    assert restore(elsewhere, packed) is None
    assert files_of(elsewhere) == files_of(root)
    assert Store(elsewhere).problems == ()


def test_what_was_there_before_a_restore_is_kept(root: Path) -> None:
    packed = io.BytesIO()
    write_backup(root, packed)
    before = files_of(root)
    store = Store(root)
    store.save(tractor_named("New"))
    kept = restore(root, packed)
    assert kept is not None
    assert (kept / "tractors" / "new.json").is_file()
    assert {name: content for name, content in files_of(root).items() if not name.startswith(kept.name)} == before
    again = io.BytesIO()
    assert write_backup(root, again) == 4  # what was put aside is not in the next backup


@pytest.mark.parametrize(
    "name",
    [
        "../outside.json",
        "tractors/../../outside.json",
        "/etc/outside.json",
        "tractors\\..\\..\\outside.json",
        "C:/outside.json",
        "tractors/a:b.json",
        ".lock",
        "tractors/.hidden.json",
        "before-restore/x.json",
        "tractors/" + "x" * 300 + ".json",
        "tractors/" + "a/" * 30 + "x.json",
        "tractors/a\nb.json",
    ],
)
def test_a_member_that_leaves_the_folder_is_refused_and_nothing_changes(root: Path, name: str) -> None:
    before = files_of(root)
    with pytest.raises(StoreError, match="no place in a data folder"):
        restore(root, archive_of({"tractors/t.json": DOCUMENT, name: b"x"}))
    assert files_of(root) == before
    assert list(root.parent.iterdir()) == [root]


def test_links_in_an_archive_are_refused(root: Path) -> None:
    packed = archive_of({"tractors/t.json": DOCUMENT})
    with zipfile.ZipFile(packed, "a") as archive:
        link = zipfile.ZipInfo("tractors/link.json")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(link, "/etc/passwd")
    with pytest.raises(StoreError, match="is a link"):
        restore(root, packed)


def test_a_zip_bomb_is_refused_by_its_ratio(root: Path) -> None:
    bomb = archive_of({"tractors/t.json": DOCUMENT, "recordings/bomb": bytes(30_000_000)})
    with pytest.raises(StoreError, match="times its size"):
        restore(root, bomb)


def test_an_archive_that_lies_about_its_sizes_is_stopped_while_unpacking(root: Path) -> None:
    packed = archive_of({"tractors/t.json": DOCUMENT, "recordings/lie": bytes(range(256)) * 400})
    raw = bytearray(packed.getvalue())
    true_size, small = (256 * 400).to_bytes(4, "little"), (16).to_bytes(4, "little")
    raw = bytearray(bytes(raw).replace(true_size, small))
    before = files_of(root)
    with pytest.raises(StoreError):
        restore(root, io.BytesIO(bytes(raw)), Limits(file_bytes=10_000))
    assert files_of(root) == before


@pytest.mark.parametrize("limits", [Limits(files=1), Limits(total_bytes=10), Limits(file_bytes=10)])
def test_each_limit_holds(root: Path, limits: Limits) -> None:
    packed = archive_of({"tractors/t.json": DOCUMENT, "tractors/u.json": DOCUMENT})
    before = files_of(root)
    with pytest.raises(StoreError):
        restore(root, packed, limits)
    assert files_of(root) == before


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 no", b"x" * 1000])
def test_what_is_no_zip_is_refused(root: Path, content: bytes) -> None:
    with pytest.raises(StoreError, match="no backup that can be restored"):
        restore(root, io.BytesIO(content))


def test_an_archive_without_documents_is_refused(root: Path) -> None:
    with pytest.raises(StoreError, match="holds no document"):
        restore(root, archive_of({"holiday/beach.jpg": b"x"}))


def test_names_that_are_one_on_some_systems_are_refused(root: Path) -> None:
    with pytest.raises(StoreError, match="twice"):
        restore(root, archive_of({"tractors/t.json": DOCUMENT, "tractors/T.json": DOCUMENT}))


def test_a_damaged_archive_is_refused_or_harmless_whatever_byte_is_wrong(root: Path, tmp_path: Path) -> None:
    packed = io.BytesIO()
    write_backup(root, packed)
    raw = packed.getvalue()
    present, target = files_of(root), tmp_path / "target"
    refused = 0
    for place in range(0, len(raw), 23):
        damaged = bytearray(raw)
        damaged[place] ^= 0x5A
        try:
            restore(target, io.BytesIO(bytes(damaged)))
        except StoreError:
            refused += 1
            assert files_of(target) == {}
        else:  # only where names and times are written may a byte be wrong unseen
            assert set(files_of(target).values()) <= set(present.values())
            shutil.rmtree(target)
    assert refused > len(raw) // 23 // 2


def test_a_restore_that_was_cut_off_at_any_step_is_finished_or_forgotten(root: Path, tmp_path: Path) -> None:
    wanted = {"tractors/new.json": encoded(tractor_named("New"))}
    for state, expected in ((".restore-unpacking", "T"), (".restore-ready", "New"), (".restore-moving", "New")):
        folder = tmp_path / state
        restore(folder, archive_of({"tractors/t.json": DOCUMENT}))
        if state == ".restore-moving":  # the present data is out of the way already
            (folder / "tractors").rename(folder / "before-restore")
        for name, content in wanted.items():
            (folder / state / name).parent.mkdir(parents=True)
            (folder / state / name).write_bytes(content)
        finish_restore(folder)
        assert [each.document.name for each in Store(folder).list(Tractor)] == [expected]
        assert not any(path.name.startswith(".restore") for path in folder.iterdir())


def test_a_store_finishes_a_restore_before_it_looks(tmp_path: Path) -> None:
    Store(tmp_path).save(tractor_named("T"))
    place = tmp_path / ".restore-ready" / "fields" / "f"
    place.mkdir(parents=True)
    (place / "field.json").write_bytes(encoded(field_named("F")))
    store = Store(tmp_path)
    assert [each.document.name for each in store.list(FieldDocument)] == ["F"]
    assert store.list(Tractor) == ()
