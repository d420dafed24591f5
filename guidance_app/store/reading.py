"""What lies in a data folder: every document that can be read, and a problem for every file that cannot.

A file's own name is only a hint: the name inside the document counts, so that a file may be copied or renamed by hand.
"""

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Generic, TypeVar, cast

from guidance_app.documents import Document, FieldDocument, Implement, Operation, Receiver, Settings, Tractor
from guidance_app.language import sentence
from guidance_app.store.files import FolderLock, StoreError, free_path, move, read_bounded, revision_of, why
from guidance_app.store.migrations import BrokenDocumentError, Migration, NewerDocumentError, decoded

__all__ = ["PATTERNS", "Problem", "Reader", "Stored", "home_of", "name_of"]

D = TypeVar("D", bound=Document)

PATTERNS: Mapping[type[Document], str] = MappingProxyType(
    {
        Tractor: "tractors/*.json",
        Implement: "implements/*.json",
        Receiver: "receivers/*.json",
        FieldDocument: "fields/*/field.json",
        Operation: "fields/*/operations/*.json",
        Settings: "settings.json",
    }
)
"""Where the documents of each kind lie."""

BROKEN = ".broken"
"""What is added to the name of a file that could not be read."""


@dataclass(frozen=True, slots=True)
class Stored(Generic[D]):
    """A document as it was loaded. ``revision`` goes back with the next save."""

    document: D
    revision: str
    path: Path


@dataclass(frozen=True, slots=True)
class Problem:
    """A file that did not load, and why. ``set_aside`` is where it lies now, None when it was left in its place.

    ``newer`` is the name of the document in it, '' if unknown, when only a newer program can read it; else None.
    """

    path: Path
    sentence: str
    set_aside: Path | None = None
    newer: str | None = None


def name_of(document: Document) -> str:
    """The document's name; settings have none and give ''."""
    return str(getattr(document, "name", ""))


def home_of(document: Document) -> str:
    """The field of an operation, '' for everything else."""
    return document.field if isinstance(document, Operation) else ""


class Reader:
    """Reads the documents under ``root``; what has the bytes that it had is not decoded again.

    The bytes are read each time: two files written within a tick of the disk's clock may share time, size and inode.
    """

    def __init__(self, lock: FolderLock, migrations: Mapping[tuple[str, int], Migration]) -> None:
        self.root = lock.root
        self._lock = lock
        self._migrations = migrations
        self._problems: dict[Path, Problem] = {}
        self._seen: dict[Path, Stored[Document]] = {}

    def problems(self) -> tuple[Problem, ...]:
        """What is wrong now, after a look at every document."""
        with self._lock.reading():
            self._problems = {}
            for kind in PATTERNS:
                self._scan(kind)
            return tuple(self._problems[path] for path in sorted(self._problems))

    def newer(self, kind: type[Document]) -> dict[str, Problem]:
        """By name the documents of this kind that only a newer program can read, after a scan of the kind."""
        paths = set(self.root.glob(PATTERNS[kind]))
        return {each.newer: each for path, each in self._problems.items() if path in paths and each.newer is not None}

    def scan(self, kind: type[D]) -> list[Stored[D]]:
        """Every document of this kind that can be read, one for each name, in the order of their paths."""
        with self._lock.reading():
            return self._scan(kind)

    def _scan(self, kind: type[D]) -> list[Stored[D]]:
        for aside in sorted(self.root.glob(f"{PATTERNS[kind]}{BROKEN}*")):
            if aside not in self._problems:
                self._problems[aside] = Problem(aside, self._why_aside(aside, kind), aside)
        found: dict[tuple[str, str], Stored[D]] = {}
        for path in sorted(self.root.glob(PATTERNS[kind])):
            stored = self._read(path, kind)
            if stored is None:
                continue
            key = (name_of(stored.document), home_of(stored.document))
            first = found.setdefault(key, stored)
            if first is not stored:
                said = sentence(
                    "{path} holds another '{key}' than {path_2}, which is used: rename or delete one",
                    path=path,
                    key=key[0],
                    path_2=first.path,
                )
                self._problems[path] = Problem(path, said)
        return list(found.values())

    def _read(self, path: Path, kind: type[D]) -> Stored[D] | None:
        """The document in the file, None with a problem noted when there is none."""
        try:
            stored = self._unchanged_or_new(path, kind)
        except FileNotFoundError:
            return None  # another console has just moved it
        except OSError as error:
            self._problems[path] = Problem(
                path, sentence("{path} cannot be read: {reason}", path=path, reason=why(error))
            )
            return None
        except BrokenDocumentError as error:
            self._set_aside(path, kind, str(error))
            return None
        except NewerDocumentError as error:
            self._problems[path] = Problem(
                path, sentence("{path} is left out: {reason}", path=path, reason=str(error)), newer=error.name or ""
            )
            return None
        except StoreError as error:
            self._problems[path] = Problem(path, str(error))
            return None
        self._problems.pop(path, None)
        return self._at_home(stored)

    def _unchanged_or_new(self, path: Path, kind: type[D]) -> Stored[D]:
        content = read_bounded(path)
        revision = revision_of(content)
        seen = self._seen.get(path)
        if seen is not None and seen.revision == revision:
            return cast("Stored[D]", seen)  # a path belongs to one kind
        stored = Stored(decoded(content, kind, self._migrations), revision, path)
        self._seen[path] = cast("Stored[Document]", stored)
        return stored

    def _at_home(self, stored: Stored[D]) -> Stored[D]:
        """An operation belongs to the field in whose folder it lies, whatever it says."""
        document = stored.document
        if not isinstance(document, Operation):
            return stored
        field = self._read(stored.path.parent.parent / "field.json", FieldDocument)
        if field is None or field.document.name == document.field:
            return stored
        return Stored(document.model_copy(update={"field": field.document.name}), stored.revision, stored.path)

    def _set_aside(self, path: Path, kind: type[Document], reason: str) -> None:
        """Moves a broken file out of the way, unless another console has repaired it meanwhile."""
        self._problems[path] = Problem(path, sentence("{path} cannot be read: {reason}", path=path, reason=reason))
        with contextlib.suppress(StoreError, OSError), self._lock.writing():
            if self._is_broken(path, kind):
                aside = free_path(path.parent, path.name + BROKEN)
                move(path, aside)
                self._problems[aside] = Problem(aside, self._why_aside(aside, kind), aside)
                del self._problems[path]

    def _why_aside(self, aside: Path, kind: type[Document]) -> str:
        try:
            decoded(read_bounded(aside), kind, self._migrations)
        except StoreError as error:
            return sentence("{aside} was set aside because it cannot be read: {reason}", aside=aside, reason=str(error))
        except OSError as error:
            return sentence("{aside} was set aside and cannot be read: {reason}", aside=aside, reason=why(error))
        return sentence(
            "{aside} was set aside, but can be read: take '{broken}' off its name", aside=aside, broken=BROKEN
        )

    def _is_broken(self, path: Path, kind: type[Document]) -> bool:
        try:
            decoded(read_bounded(path), kind, self._migrations)
        except BrokenDocumentError:
            return True
        return False
