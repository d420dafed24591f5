"""Field files as they come from and go to a browser: bytes with a name, through a folder that lives for a moment."""

import mimetypes
import tempfile
from pathlib import Path, PurePosixPath, PureWindowsPath

from guidance_app.boundary import CheckedField
from guidance_app.console.files import Download
from guidance_app.documents import FieldDocument
from guidance_app.exchange import ExchangeError, checked_fields, write_field

__all__ = ["fields_in", "file_of"]


def fields_in(content: bytes, name: str) -> tuple[CheckedField, ...]:
    """Every field in a file that a browser sent under ``name``. Raises ``ExchangeError`` with that name in it."""
    bare = PurePosixPath(PureWindowsPath(name).name).name or "file"
    with tempfile.TemporaryDirectory(prefix="guidance-upload-") as folder:
        path = Path(folder) / bare[-100:].lstrip(".")
        path.write_bytes(content)
        try:
            return checked_fields(path)
        except ExchangeError as error:
            raise ExchangeError(str(error).replace(str(path), bare)) from error


def file_of(document: FieldDocument, suffix: str) -> Download:
    """The field in the format of this ending, as a file to download. Raises ``ExchangeError``."""
    with tempfile.TemporaryDirectory(prefix="guidance-export-") as folder:
        path = Path(folder) / f"field{suffix}"
        write_field(document, path)
        media_type = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
        return Download(f"{document.name}{suffix}", media_type, path.read_bytes())
