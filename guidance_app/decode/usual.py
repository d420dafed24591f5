"""Which sentence a stream's positions usually come from, so that losing one does not make the track jump.

A receiver may say in RMC, to three decimals, what it says in GGA to seven: when a GGA is lost, the RMC beside it is
right and still moves the tractor by half a metre. A poorer sentence with a coarser rounding takes the place of the
usual one only when that has stayed away for good.
"""

from guidance_app.decode.epoch import POSITION_KINDS
from guidance_app.decode.sentence import Sentence

__all__ = ["Usual"]

GIVEN_UP_AFTER = 5
"""So many epochs without the usual sentence, and the poorer one becomes the usual."""

SAME_CELL = 1.01

_RANK = {kind: rank for rank, kind in enumerate(POSITION_KINDS)}


class Usual:
    """Remembers the usual kind, its rounding and how long it has been missing."""

    __slots__ = ("_cell", "_kind", "_missing")

    def __init__(self) -> None:
        self._kind: str | None = None
        self._cell = 0.0
        self._missing = 0

    def fork(self) -> "Usual":
        """An independent copy."""
        copy = Usual()
        copy._kind, copy._cell, copy._missing = self._kind, self._cell, self._missing
        return copy

    def accepts(self, position: Sentence) -> bool:
        """Whether this sentence's position may stand for its epoch."""
        cell = position.cell[0] if position.cell is not None else 0.0
        if self._kind is not None and _RANK[position.kind] > _RANK[self._kind]:
            self._missing += 1
            if self._missing <= GIVEN_UP_AFTER:
                return cell <= self._cell * SAME_CELL
        self._kind, self._cell, self._missing = position.kind, cell, 0
        return True
