"""Bytes to documents: older schema versions are lifted step by step, newer ones refused, broken ones told apart.

A migration takes the members of one version and gives those of the next; ``MIGRATIONS`` finds it by the document's
kind and the version it lifts from. A file on the disk keeps its version until the document is saved.
"""

import json
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NoReturn, TypeVar

import shapely
from pydantic import ValidationError

from guidance_app.boundary import BoundaryError, checked_boundary
from guidance_app.documents import Document, FieldDocument
from guidance_app.language import message, sentence
from guidance_app.store.files import StoreError

__all__ = [
    "MIGRATIONS",
    "BrokenDocumentError",
    "Migration",
    "NewerDocumentError",
    "decoded",
    "encoded",
    "kind_words",
]

D = TypeVar("D", bound=Document)

Migration = Callable[[dict[str, Any]], dict[str, Any]]
MIGRATIONS: Mapping[tuple[str, int], Migration] = MappingProxyType({})
"""From (kind, version). Empty while every kind is in its first version."""


class BrokenDocumentError(StoreError):
    """The file holds no document of this kind."""


class NewerDocumentError(StoreError):
    """The file was written by a newer version of the program. ``name`` is the document's, where it can be read."""

    def __init__(self, message: str, name: str | None) -> None:
        super().__init__(message)
        self.name = name


KIND_WORDS: Mapping[str, str] = {
    "field": message("field"),
    "tractor": message("tractor"),
    "implement": message("implement"),
    "receiver": message("receiver"),
    "operation": message("operation"),
    "settings": message("settings"),
}


def _kind_name(kind: type[Document]) -> str:
    """The name of this kind of document, as its file says it."""
    return str(kind.model_fields["kind"].default)


def kind_words(kind: type[Document]) -> str:
    """The word for this kind of document, for a sentence."""
    return sentence(KIND_WORDS[_kind_name(kind)])


def encoded(document: Document) -> bytes:
    """The document as its file holds it."""
    members = document.model_dump(mode="json")
    return (json.dumps(members, ensure_ascii=False, allow_nan=False, indent=1) + "\n").encode()


def decoded(content: bytes, kind: type[D], migrations: Mapping[tuple[str, int], Migration] = MIGRATIONS) -> D:
    """The document in these bytes. Raises ``BrokenDocumentError`` or ``NewerDocumentError``."""
    members = _members(content)
    current = int(kind.model_fields["schema_version"].default)
    version = members.get("schema_version", current)
    if not isinstance(version, int) or isinstance(version, bool) or version < 0:
        msg = sentence("its schema version is {version!r}, not a number", version=version)
        raise BrokenDocumentError(msg)
    if version > current:
        name = members.get("name")
        msg = sentence(
            "it has schema version {version} and this program knows up to {current}: it was written by a "
            "newer version of the program; update this one",
            version=version,
            current=current,
        )
        raise NewerDocumentError(msg, name if isinstance(name, str) else None)
    for step in range(version, current):
        migration = migrations.get((_kind_name(kind), step))
        if migration is None:
            msg = sentence(
                "its schema version {version} is older than this program can lift to {current}",
                version=version,
                current=current,
            )
            raise BrokenDocumentError(msg)
        members = {**migration(members), "schema_version": step + 1}
    try:
        document = kind.model_validate(members, strict=False)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        refused = f"{where}: {first['msg']}" if where else first["msg"]
        raise BrokenDocumentError(refused) from error
    if isinstance(document, FieldDocument):
        _check_ground(document)
    return document


def _members(content: bytes) -> dict[str, Any]:
    try:
        members = json.loads(content, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        msg = sentence("it is not JSON ({reason})", reason=str(error))
        raise BrokenDocumentError(msg) from error
    if not isinstance(members, dict):
        msg = sentence("it is JSON, but not a document")
        raise BrokenDocumentError(msg)
    return members


def _no_constant(text: str) -> NoReturn:
    msg = sentence("{text} stands where a number belongs", text=text)
    raise ValueError(msg)


def _check_ground(document: FieldDocument) -> None:
    """The full check only where a quick look in degrees is not satisfied: a thousand fields open in a second."""
    outer, *holes = document.boundary.coordinates
    if shapely.Polygon(outer, holes).is_valid:
        return
    try:
        checked_boundary(document.boundary.coordinates)
    except BoundaryError as error:
        raise BrokenDocumentError(str(error)) from error
