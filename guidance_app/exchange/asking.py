"""What a reader of field files may be told beforehand, what it asks back, and what it hands on.

A file that leaves something open (metres without a zone, a shapefile without its .prj) is answered with a question:
the error names the option that settles it, and the reader is called again with the option set. What a reader may
assume, it assumes aloud, in ``FieldDraft.assumptions``.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from pyproj import CRS

from guidance_app.boundary import BoundaryError
from guidance_app.coordinates import Order
from guidance_app.documents import FieldDocument, Geometry, GuidanceLineDocument, Position
from guidance_app.geodesy import CoordinateSystem, DatumError, lonlat_from
from guidance_app.language import sentence

__all__ = [
    "ExchangeError",
    "ImportedField",
    "OpenQuestionError",
    "QuestionError",
    "ReadOptions",
    "briefly",
    "changed_from",
]


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """What a person has said about a file. None is: look for yourself.

    ``system`` is for files that do not name their coordinate system; ``order`` for lists of corners; ``encoding`` for
    names in files that do not say theirs; ``inexact`` accepts a change of datum that is metres off.
    """

    system: CoordinateSystem | None = None
    order: Order | None = None
    encoding: str | None = None
    inexact: bool = False


@dataclass(frozen=True, slots=True)
class ImportedField:
    """A field that may be stored, and all that a person should know before saying yes.

    ``warnings`` say what was repaired or left out, ``assumptions`` what was guessed; both are sentences' beginnings in
    lower case. ``area`` is in m2 without the exclusions, ``perimeter`` is the outer ring's.
    """

    document: FieldDocument
    area: float
    perimeter: float
    warnings: tuple[str, ...] = ()
    assumptions: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """What the file calls the field, else the file's own name."""
        return self.document.name

    @property
    def geometry(self) -> Geometry:
        """The boundary with its exclusions."""
        return self.document.boundary

    @property
    def lines(self) -> Sequence[GuidanceLineDocument]:
        """The guidance lines that came with it."""
        return self.document.lines

    @property
    def remarks(self) -> tuple[str, ...]:
        """Warnings and assumptions, for a preview that tells them in one list."""
        return (*self.warnings, *self.assumptions)


class ExchangeError(Exception):
    """A file that cannot be read or written; the message is one sentence with the file's name."""


class QuestionError(ExchangeError):
    """A file that can be read once ``option`` (a member of ``ReadOptions``) is set; the message asks for it."""

    def __init__(self, sentence: str, option: str) -> None:
        super().__init__(sentence)
        self.option = option


class OpenQuestionError(BoundaryError):
    """The same inside a reader, which does not know the file's name."""

    def __init__(self, sentence: str, option: str) -> None:
        super().__init__(sentence)
        self.option = option


def briefly(error: Exception) -> str:
    """What a library says of damage, in at most a line."""
    return " ".join(str(error).split())[:80]


def changed_from(system: CoordinateSystem | CRS, options: ReadOptions) -> Callable[[list[Position]], list[Position]]:
    """What turns positions (east, north) of a system into WGS 84 degrees. Raises the question whether metres matter."""

    def change(positions: list[Position]) -> list[Position]:
        try:
            lonlat = lonlat_from(system, inexact=options.inexact)(np.asarray(positions, dtype=float))
        except DatumError as error:
            if error.accuracy is None:
                raise BoundaryError(sentence("its coordinate system {reason}", reason=str(error))) from error
            raise OpenQuestionError(
                sentence("its coordinate system {reason}; confirm to take it so", reason=str(error)), "inexact"
            ) from error
        return [(longitude, latitude) for longitude, latitude in lonlat.tolist()]

    return change
