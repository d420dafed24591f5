"""Offsets of the guidance lines that the driver has given: nudge, shift and line here, each kept by its name.

Metres count to the right of a reference direction (A to B of the guidance line, or the direction of the plan), so
that an offset stays on the same side of the ground whichever way a pass is driven.
"""

from dataclasses import dataclass, replace

from guidance_app.language import sentence
from guidance_app.model import POSITION_OFFSETS, OffsetKind, OffsetRecord

__all__ = ["LineOffsets"]

LARGEST = 1000.0
"""Lines are not moved farther than this in all."""


@dataclass(frozen=True, slots=True)
class LineOffsets:
    """At most one record of each kind, in the order in which they were first given."""

    records: tuple[OffsetRecord, ...] = ()

    @property
    def total(self) -> float:
        """Metres to the right by all offsets together."""
        return sum(record.metres for record in self.records)

    def allows(self, metres: float) -> bool:
        """Whether the lines may be moved by so much more; not for a number that is none."""
        return abs(self.total + metres) <= LARGEST

    def plus(self, kind: OffsetKind, metres: float, arrival: float) -> "LineOffsets":
        """Moved on by ``metres``. ``ValueError`` for a position offset and for what is not allowed."""
        if kind in POSITION_OFFSETS or not self.allows(metres):
            msg = sentence(
                "lines are moved by line offsets and by at most {most:g} m in all, not by {metres:g} m ({kind})",
                most=LARGEST,
                metres=metres,
                kind=kind,
            )
            raise ValueError(msg)
        before = next((record.metres for record in self.records if record.kind is kind), None)
        record = OffsetRecord(kind, arrival, (before or 0.0) + metres)
        if before is None:
            return LineOffsets((*self.records, record))
        return LineOffsets(tuple(record if old.kind is kind else old for old in self.records))

    def without(self, kind: OffsetKind) -> "LineOffsets":
        """All but those of one kind."""
        return replace(self, records=tuple(record for record in self.records if record.kind is not kind))
