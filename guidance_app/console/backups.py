"""The whole data folder out and in: what an archive holds, a restore with its way back, and the trash."""

import datetime
import io
import zipfile
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from guidance_app.console.files import Download
from guidance_app.language import message, sentence
from guidance_app.store import StoreError, restore, write_backup

__all__ = ["CONTENTS", "backup_of", "contents_of", "in_trash", "put_back", "restored_from"]

CONTENTS: Mapping[str, str] = {
    message("fields"): "fields/*/field.json",
    message("operations"): "fields/*/operations/*.json",
    message("tractors"): "tractors/*.json",
    message("implements"): "implements/*.json",
    message("receivers"): "receivers/*.json",
    message("recordings"): "recordings/*/session.json",
}
"""What a person counts in a data folder, by where it lies."""


def backup_of(root: Path) -> Download:
    """Everything of the folder as one zip. Raises ``StoreError``."""
    held = io.BytesIO()
    write_backup(root, held)
    today = datetime.datetime.now().astimezone().date().isoformat()
    return Download(f"guidance-backup-{today}.zip", "application/zip", held.getvalue())


def contents_of(archive: bytes) -> dict[str, int]:
    """How much of what an archive holds. Raises ``StoreError`` for what is no archive or holds nothing of ours."""
    try:
        with zipfile.ZipFile(io.BytesIO(archive)) as opened:
            names = [PurePosixPath(name) for name in opened.namelist()]
    except (zipfile.BadZipFile, ValueError, OSError, NotImplementedError) as error:
        raise StoreError(sentence("This file is no backup: it is not a zip archive, or it is damaged.")) from error
    counts = {
        words: sum(name.match(pattern) and len(name.parts) == pattern.count("/") + 1 for name in names)
        for words, pattern in CONTENTS.items()
    }
    if not any(counts.values()):
        raise StoreError(sentence("This archive holds no fields, machines or recordings: it is no backup."))
    return counts


def restored_from(root: Path, archive: bytes) -> Path | None:
    """Replaces the folder's content; gives where the content before it lies now. Raises ``StoreError``."""
    return restore(root, io.BytesIO(archive))


def put_back(root: Path, before: Path) -> None:
    """Undoes a restore: what was there before it is there again. Raises ``StoreError``."""
    held = io.BytesIO()
    write_backup(before, held)
    held.seek(0)
    restore(root, held)


def in_trash(root: Path) -> int:
    """How many deleted documents could still be brought back."""
    return sum(1 for path in (root / ".trash").rglob("*.json") if path.is_file())
