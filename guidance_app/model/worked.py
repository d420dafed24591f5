"""What grows: worked ground, the driven track, and their sums."""

from collections.abc import Callable
from dataclasses import dataclass

from guidance_app.model.arrays import FloatArray
from guidance_app.model.making import made_quickly

__all__ = [
    "CoverageTotals",
    "Strip",
    "Trail",
]


@made_quickly
@dataclass(frozen=True, slots=True, eq=False)
class Strip:
    """A bounded piece of worked ground: left and right edge of the implement, both of shape (N, 2), N at most 256.

    A strip with the same ``index`` only ever grows until it is ``sealed``; a sealed one never changes.
    """

    index: int
    left: FloatArray
    right: FloatArray
    pass_number: int | None
    sealed: bool


@made_quickly
@dataclass(frozen=True, slots=True, eq=False)
class Trail:
    """What grows: sealed pieces in a shared append-only list, of which the first ``count`` belong to this snapshot.

    ``pieces`` are arrays of shape (N, 2) for the track and ``Strip`` for worked ground. A reader remembers how many it
    has seen and takes the rest. ``growing`` gives the piece that still grows, as it was then and always the same one:
    it is only made when somebody looks, for most snapshots are never drawn.
    """

    pieces: list[FloatArray] | list[Strip]
    count: int
    growing: Callable[[], FloatArray | Strip] | None = None

    @property
    def open_piece(self) -> FloatArray | Strip | None:
        """The piece that still grows; None while there is none."""
        return None if self.growing is None else self.growing()


@made_quickly
@dataclass(frozen=True, slots=True)
class CoverageTotals:
    """Areas in m2. ``left`` is None without a field. ``headland`` is the part of ``worked`` outside the mainland."""

    worked: float = 0.0
    overlap: float = 0.0
    left: float | None = None
    headland: float = 0.0
    distance: float = 0.0
    working_s: float = 0.0
