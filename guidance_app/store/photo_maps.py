"""Photos on the ground, kept: ``maps/<name>/map.json`` with the picture beside it."""

from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from guidance_app.documents import PhotoMap
from guidance_app.store.files import (
    FolderLock,
    StoreError,
    free_path,
    move,
    read_bounded,
    safe_stem,
    why,
    write_atomically,
)

__all__ = ["StoredMap", "delete_map", "list_maps", "picture_of", "save_map"]

MAPS = "maps"
DOCUMENT = "map.json"
PICTURE = "picture.jpg"
TRASH = ".trash"


@dataclass(frozen=True, slots=True)
class StoredMap:
    """A map and the folder in which it lies."""

    document: PhotoMap
    folder: Path


def list_maps(root: Path) -> tuple[StoredMap, ...]:
    """Every map that can be read, by name; one that cannot be is left where it is."""
    found = []
    for path in sorted((root / MAPS).glob(f"*/{DOCUMENT}")):
        try:
            found.append(StoredMap(PhotoMap.model_validate_json(read_bounded(path)), path.parent))
        except (OSError, ValidationError):
            continue
    return tuple(sorted(found, key=lambda one: one.document.name.casefold()))


def picture_of(stored: StoredMap) -> bytes:
    """The picture's bytes. Raises ``StoreError``."""
    path = stored.folder / PICTURE
    try:
        return path.read_bytes()
    except OSError as error:
        msg = f"the picture {path} cannot be read: {why(error)}"
        raise StoreError(msg) from error


def save_map(root: Path, document: PhotoMap, picture: bytes) -> Path:
    """Stores the map, in place of one with the same name, and gives its folder. Raises ``StoreError``."""
    with FolderLock(root).writing():
        for stored in list_maps(root):
            if stored.document.name == document.name:
                folder = stored.folder
                break
        else:
            folder = free_path(root / MAPS, safe_stem(document.name))
        # The picture first: a document is never without it.
        write_atomically(folder / PICTURE, picture)
        write_atomically(folder / DOCUMENT, document.model_dump_json(indent=1).encode() + b"\n")
    return folder


def delete_map(root: Path, stored: StoredMap) -> None:
    """Moves the map to the trash. Raises ``StoreError``."""
    with FolderLock(root).writing():
        place = root / TRASH / MAPS
        move(stored.folder, free_path(place, stored.folder.name))
