"""The store: documents by name, saved so that nothing acknowledged is lost and nobody is overwritten unseen.

``fields/<field>/field.json``, ``fields/<field>/operations/<operation>.json``, ``tractors/``, ``implements/``,
``receivers/``, ``settings.json``; what is archived lies under ``archive/`` in the same order, what is deleted under
``.trash/`` until the trash is emptied.
"""

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from guidance_app.documents import Document, FieldDocument, Implement, Operation, Receiver, Settings, Tractor
from guidance_app.language import sentence
from guidance_app.store.backup import finish_restore
from guidance_app.store.files import FolderLock, StoreError, free_path, move, safe_stem, why, write_atomically
from guidance_app.store.migrations import MIGRATIONS, Migration, encoded, kind_words
from guidance_app.store.reading import PATTERNS, Problem, Reader, Stored, home_of, name_of

__all__ = ["Named", "Removed", "Store", "StoreConflictError"]

Named = Tractor | Implement | Receiver | FieldDocument | Operation
N = TypeVar("N", Tractor, Implement, Receiver, FieldDocument, Operation)

_REFERRED: Mapping[type[Document], str] = {Tractor: "tractor", Implement: "implement", Receiver: "receiver"}
"""The member of an operation that names a document of this kind."""
TRASH = ".trash"
ARCHIVE = "archive"


@dataclass(frozen=True, slots=True)
class Removed:
    """What undoes a removal."""

    name: str
    path: Path
    kept: Path


class StoreConflictError(StoreError):
    """Another console has changed the document meanwhile. ``current`` is what is stored now, None when it is gone."""

    def __init__(self, message: str, current: Stored[Document] | None) -> None:
        super().__init__(message)
        self.current = current


class Store:
    """The documents under one data folder. Several threads and several programs may use it at once.

    Nothing is created before the first save, but a restore that was cut off is finished. ``migrations`` lift older
    documents.
    """

    def __init__(self, root: Path, migrations: Mapping[tuple[str, int], Migration] = MIGRATIONS) -> None:
        finish_restore(root)
        self.root = root
        self._migrations = migrations
        self._lock = FolderLock(root)
        self._reader = Reader(self._lock, migrations)

    @property
    def problems(self) -> tuple[Problem, ...]:
        """Every file that cannot be read, after a look at all of them; broken ones are set aside by this."""
        return self._reader.problems()

    def list(self, kind: type[N], field: str | None = None) -> tuple[Stored[N], ...]:
        """Every document of this kind that can be read, by name; for operations those of ``field`` if it is given."""
        found = [each for each in self._reader.scan(kind) if field is None or home_of(each.document) == field]
        return tuple(sorted(found, key=lambda each: each.document.name.casefold()))

    def load(self, kind: type[N], name: str, field: str | None = None) -> Stored[N]:
        """The document of this name; operations may need the name of their field. Raises ``StoreError``."""
        stored = self.list(kind, field)
        found = [each for each in stored if each.document.name == name]
        if len(found) == 1:
            return found[0]
        if found:
            fields = ", ".join(f"'{home_of(each.document)}'" for each in found)
            msg = sentence(
                "several fields have an operation '{name}' ({fields}); name the field too", name=name, fields=fields
            )
            raise StoreError(msg)
        known = ", ".join(f"'{each.document.name}'" for each in stored[:5]) + (", ..." if len(stored) > 5 else "")
        values = {"kind": kind_words(kind), "name": name, "root": self.root}
        if not known:
            raise StoreError(sentence("there is no {kind} '{name}' in {root}", **values))
        raise StoreError(sentence("there is no {kind} '{name}' in {root}; there is {known}", known=known, **values))

    def settings(self) -> Stored[Settings] | None:
        """The driver's settings; None when none are stored (the defaults hold then)."""
        return next(iter(self._reader.scan(Settings)), None)

    # --- saving ------------------------------------------------------------------------------------------------------

    def save(self, document: Named | Settings, expected: str | None = None) -> str:
        """Stores the document and gives its new revision; once it returns, a power cut cannot take the document away.

        ``expected`` is the revision it was loaded with, None for a new document. Raises ``StoreConflictError`` when
        something else is stored now, ``StoreError`` when the folder cannot be written.
        """
        with self._lock.writing():
            return self._save(document, expected)

    def replace(self, document: Named | Settings) -> str:
        """Stores the document whatever was there, and gives its revision. Not for what a person may have changed."""
        with self._lock.writing():
            current = self._current(document)
            return self._save(document, current.revision if current is not None else None)

    def copy(self, kind: type[N], name: str, new_name: str, field: str | None = None) -> str:
        """Stores the same document under a new name and gives its revision. Raises ``StoreError``."""
        return self.save(_renamed(self.load(kind, name, field).document, new_name))

    def rename(self, kind: type[N], name: str, new_name: str, field: str | None = None) -> str:
        """Gives the document a new name, in the operations that refer to it too, and gives its new revision."""
        with self._lock.writing():
            stored = self.load(kind, name, field)
            document = _renamed(stored.document, new_name)
            if document.name == name:
                return stored.revision
            if self._current(document) is not None:
                msg = sentence(
                    "the name '{name}' is in use by another {kind}", name=document.name, kind=kind_words(kind)
                )
                raise StoreError(msg)
            if isinstance(document, FieldDocument):
                return self._rename_field(stored.path, document)
            # Old and new are both there until every operation refers to the new one: a power cut loses nothing.
            revision = self._save(document, None)
            self._refer_anew(type(document), name, document.name)
            self._remove(stored.path)
        return revision

    def _save(self, document: Named | Settings, expected: str | None) -> str:
        content, current = encoded(document), self._current(document)
        if current is not None and encoded(current.document) == content:
            return current.revision
        self._check_revision(document, current, expected)
        path = current.path if current is not None else self._new_path(document)
        return write_atomically(path, content)

    def _current(self, document: Document) -> Stored[Document] | None:
        key = (name_of(document), home_of(document))
        for stored in self._reader.scan(type(document)):
            if (name_of(stored.document), home_of(stored.document)) == key:
                return stored
        return None

    def _check_revision(self, document: Document, current: Stored[Document] | None, expected: str | None) -> None:
        name, kind = name_of(document), kind_words(type(document))
        what = sentence("the {kind} '{name}'", kind=kind, name=name) if name else sentence("the settings")
        newer = self._reader.newer(type(document)).get(name_of(document))
        if current is None and newer is not None:
            raise StoreError(newer.sentence)
        if current is None and expected is not None:
            msg = sentence("{what} was removed or renamed by another console", what=what)
            raise StoreConflictError(msg, None)
        if current is not None and expected is None:
            msg = sentence("{what} exists already; choose another name, or open it and change it", what=what)
            raise StoreConflictError(msg, current)
        if current is not None and current.revision != expected:
            msg = sentence("{what} was changed by another console meanwhile; look at its version first", what=what)
            raise StoreConflictError(msg, current)

    def _new_path(self, document: Named | Settings) -> Path:
        match document:
            case Settings():
                return self.root / PATTERNS[Settings]
            case Operation():
                folder = self.load(FieldDocument, document.field).path.parent / "operations"
                return _path_for(folder, document.name, ".json")
            case FieldDocument():
                return _path_for(self.root / "fields", document.name, "") / "field.json"
            case _:
                return _path_for(self.root / Path(PATTERNS[type(document)]).parent, document.name, ".json")

    def _rename_field(self, path: Path, document: FieldDocument) -> str:
        """The folder moves last: its operations belong to the field in whose folder they lie."""
        revision = write_atomically(path, encoded(document))
        for each in self.list(Operation, document.name):
            write_atomically(each.path, encoded(each.document))
        move(path.parent, _path_for(self.root / "fields", document.name, ""))
        return revision

    def _refer_anew(self, kind: type[Document], name: str, new_name: str) -> None:
        member = _REFERRED.get(kind)
        if member is None:
            return
        for each in self.list(Operation):
            if getattr(each.document, member) == name:
                write_atomically(each.path, encoded(each.document.model_copy(update={member: new_name})))

    # --- putting away ------------------------------------------------------------------------------------------------

    def delete(self, kind: type[N], name: str, field: str | None = None) -> Removed:
        """Takes the document away, a field with its operations; ``undo`` brings it back. Raises ``StoreError``."""
        with self._lock.writing():
            return self._remove(self.load(kind, name, field).path)

    def undo(self, removed: Removed) -> None:
        """Brings back what was deleted or archived. Raises ``StoreError`` when its place has been taken."""
        with self._lock.writing():
            move(removed.kept, removed.path)

    def empty_trash(self) -> None:
        """Forgets for good what was deleted. Raises ``StoreError``."""
        with self._lock.writing():
            try:
                if (self.root / TRASH).exists():
                    shutil.rmtree(self.root / TRASH)
            except OSError as error:
                msg = sentence("the trash in {root} cannot be emptied: {reason}", root=self.root, reason=why(error))
                raise StoreError(msg) from error

    def archive(self, kind: type[N], name: str, field: str | None = None) -> Removed:
        """Puts the document out of the lists, a field with its operations, for ``archived`` and ``unarchive``."""
        with self._lock.writing():
            path = _whole(self.load(kind, name, field).path)
            place = self.root / ARCHIVE / path.relative_to(self.root)
            kept = free_path(place.parent, place.stem, place.suffix)
            move(path, kept)
            return Removed(name, path, kept)

    def archived(self, kind: type[N]) -> tuple[Stored[N], ...]:
        """Every archived document of this kind, by name."""
        return Store(self.root / ARCHIVE, self._migrations).list(kind)

    def unarchive(self, stored: Stored[N]) -> None:
        """Brings an archived document back. Raises ``StoreError`` when its name is in use again."""
        document = stored.document
        with self._lock.writing():
            if self._current(document) is not None:
                msg = sentence(
                    "the name '{name}' is in use by another {kind}; rename that first",
                    name=document.name,
                    kind=kind_words(type(document)),
                )
                raise StoreError(msg)
            move(_whole(stored.path), _whole(self._new_path(document)))

    def _remove(self, path: Path) -> Removed:
        whole = _whole(path)
        place = self.root / TRASH / whole.relative_to(self.root)
        kept = free_path(place.parent, place.stem, place.suffix)
        move(whole, kept)
        return Removed(whole.stem, whole, kept)


def _whole(path: Path) -> Path:
    """What goes away with a document: a field's folder, else the file itself."""
    return path.parent if path.name == "field.json" else path


def _path_for(folder: Path, name: str, suffix: str) -> Path:
    """A free place for a document of this name, the plain one if possible."""
    plain = folder / f"{safe_stem(name)}{suffix}"
    return plain if not plain.exists() else free_path(folder, safe_stem(name, distinct=True), suffix)


def _renamed(document: N, name: str) -> N:
    """The same document under another name, with the name checked."""
    try:
        return type(document).model_validate({**document.model_dump(), "name": name})
    except ValueError as error:
        msg = sentence(
            "'{name}' cannot be a name: 1 to 120 letters without control characters are needed", name=name[:40]
        )
        raise StoreError(msg) from error
