"""The documents of a session, gathered: an operation by its name with all it refers to, or a field file as it is."""

import json
from pathlib import Path

from guidance_app.boundary import BoundaryError, checked_boundary
from guidance_app.documents import FieldDocument, Implement, Job, Operation, Receiver, Settings, Tractor
from guidance_app.exchange import ExchangeError, read_field
from guidance_app.language import sentence
from guidance_app.store.documents_folder import Store
from guidance_app.store.files import StoreError, read_bounded, why
from guidance_app.store.migrations import BrokenDocumentError, NewerDocumentError, decoded

__all__ = ["field_from_file", "load_job"]


def load_job(store: Store, operation: str, field: str | None = None) -> Job:
    """The job of a registered operation; ``field`` when several fields have one of that name. Raises ``StoreError``."""
    found = store.load(Operation, operation, field).document
    settings = store.settings()
    return Job(
        tractor=store.load(Tractor, found.tractor).document,
        implement=store.load(Implement, found.implement).document,
        receiver=(
            Receiver(name="Receiver") if found.receiver is None else store.load(Receiver, found.receiver).document
        ),
        field=store.load(FieldDocument, found.field).document,
        operation=found,
        settings=settings.document if settings is not None else Settings(),
    )


def field_from_file(path: Path) -> FieldDocument:
    """The field in a file: a document of this program's own, or any format of ``exchange``. Raises ``StoreError``."""
    try:
        content = read_bounded(path)
    except OSError as error:
        msg = sentence("{path} cannot be read: {reason}", path=path, reason=why(error))
        raise StoreError(msg) from error
    if path.suffix.lower() == ".json" and _is_own(content):
        try:
            document = decoded(content, FieldDocument)
            checked_boundary(document.boundary.coordinates)
        except (BrokenDocumentError, NewerDocumentError, BoundaryError) as error:
            msg = sentence("{path} holds no usable field: {reason}", path=path, reason=str(error))
            raise StoreError(msg) from error
        return document
    try:
        return read_field(path)
    except ExchangeError as error:
        raise StoreError(str(error)) from error


def _is_own(content: bytes) -> bool:
    """Whether this is one of our documents: they say their kind, GeoJSON its type."""
    try:
        members = json.loads(content)
    except (ValueError, RecursionError):
        return False
    return isinstance(members, dict) and "kind" in members and "type" not in members
