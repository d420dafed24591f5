"""What a stream usually sends, so that an epoch closes at its last sentence instead of waiting for silence.

A kind of sentence has a rhythm: it comes with every epoch, or with every tenth. It is expected in an epoch when its
last two gaps say so; one that was lost is still expected next time, and one that has stayed away for five of its
gaps is forgotten. Until a rhythm is known nothing is expected and silence closes the epoch.

An attitude sensor with a rate of its own, higher than the fixes', is told apart by the same bookkeeping: two readings
of a kind in one epoch, twice running, and its readings are no longer part of a fix.
"""

__all__ = ["Habits"]

FORGOTTEN_AFTER = 5
CROWDED = 2
"""From so many crowded epochs on a sensor counts as one with its own rate."""
MOST_CROWDED = 4


class Habits:
    """Counts epochs and remembers for each kind when it came last and at what gaps."""

    __slots__ = ("_crowd", "_crowded", "_epoch", "_rhythm")

    def __init__(self) -> None:
        self._epoch = 0
        self._rhythm: dict[str, tuple[int, int, int]] = {}
        """Kind -> epoch of its last coming, last gap, gap before that (0: not known)."""
        self._crowd: dict[str, int] = {}
        self._crowded: dict[str, int] = {}

    def fork(self) -> "Habits":
        """An independent copy."""
        copy = Habits()
        copy._epoch = self._epoch
        copy._rhythm = self._rhythm.copy()
        copy._crowd, copy._crowded = self._crowd.copy(), self._crowded.copy()
        return copy

    def begin_epoch(self) -> frozenset[str]:
        """Counts on; the kinds that this epoch should hold."""
        self._settle_crowd()
        self._epoch += 1
        return frozenset([kind for kind, rhythm in self._rhythm.items() if self._is_due(*rhythm)])

    def saw(self, kind: str) -> None:
        """A sentence of this kind belongs to the present epoch."""
        last, gap, before = self._rhythm.get(kind, (0, 0, 0))
        if last == 0:
            self._rhythm[kind] = (self._epoch, 0, 0)
        elif last != self._epoch:
            self._rhythm[kind] = (self._epoch, self._epoch - last, gap or before)

    def reads_attitude(self, kind: str) -> bool:
        """Counts a reading of an attitude sensor; whether it may be part of the epoch's fix."""
        count = self._crowd.get(kind, 0) + 1
        self._crowd[kind] = count
        return count == 1 and self._crowded.get(kind, 0) < CROWDED

    def _is_due(self, last: int, gap: int, before: int) -> bool:
        if gap == 0:
            return False
        rhythm = min(gap, before or gap)
        since = self._epoch - last
        return since % rhythm == 0 and since <= FORGOTTEN_AFTER * rhythm

    def _settle_crowd(self) -> None:
        for kind, count in self._crowd.items():
            crowded = self._crowded.get(kind, 0)
            self._crowded[kind] = min(crowded + 1, MOST_CROWDED) if count > 1 else max(crowded - 1, 0)
            if self._crowded[kind] >= CROWDED:
                self._rhythm.pop(kind, None)
        self._crowd.clear()
