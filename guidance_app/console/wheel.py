"""Who has the wheel: of several browsers one operates, the others follow. Pure, but for ``Helm``'s lock and clock.

The first browser has the wheel and with it alone nobody hears of all this. Who wants it asks; it is free when the
holder gives it, says nothing for ten seconds, or has gone. A browser that vanishes changes nothing in the drive.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace

__all__ = ["ANSWER_S", "Helm", "Wheel", "WheelView"]

ANSWER_S = 10.0
"""So long the holder may think about it."""


@dataclass(frozen=True, slots=True)
class WheelView:
    """What one browser is to know. Tablets go by their number; ``holder`` is None while nobody has the wheel.

    ``asking`` is who asks, ``seconds`` how long the holder may still answer.
    """

    number: int
    alone: bool
    mine: bool
    holder: int | None = None
    others: int = 0
    asking: int | None = None
    seconds: float = 0.0


@dataclass(frozen=True, slots=True)
class Wheel:
    """``tablets`` are the browsers that are there, with their numbers, in the order in which they came."""

    tablets: tuple[tuple[int, int], ...] = ()
    holder: int | None = None
    asking: int | None = None
    asked_at: float = 0.0

    @property
    def _clients(self) -> tuple[int, ...]:
        return tuple(client for client, _ in self.tablets)

    def came(self, client: int) -> "Wheel":
        """One more; who finds the wheel free has it."""
        if client in self._clients:
            return self
        taken = {number for _, number in self.tablets}
        number = next(free for free in range(1, len(taken) + 2) if free not in taken)
        return replace(
            self,
            tablets=(*self.tablets, (client, number)),
            holder=client if self.holder is None else self.holder,
        )

    def left(self, client: int) -> "Wheel":
        """One less. After the holder comes who asks, or who is alone then; else the wheel is free."""
        rest = tuple(one for one in self.tablets if one[0] != client)
        asking = None if self.asking == client else self.asking
        if self.holder not in (client, None):
            return replace(self, tablets=rest, asking=asking)
        alone = rest[0][0] if len(rest) == 1 else None
        return Wheel(rest, alone if asking is None else asking)

    def at(self, now: float) -> "Wheel":
        """After the time for an answer the wheel goes to who asks."""
        if self.asking is None or now - self.asked_at < ANSWER_S:
            return self
        return replace(self, holder=self.asking, asking=None)

    def asks(self, client: int, now: float) -> "Wheel":
        """A free wheel is taken at once; while somebody asks, nobody else can."""
        if client not in self._clients or client == self.holder:
            return self
        if self.holder is None:
            return replace(self, holder=client, asking=None)
        return self if self.asking is not None else replace(self, asking=client, asked_at=now)

    def gives(self, client: int) -> "Wheel":
        """Only the holder gives, and only to who asks."""
        if client != self.holder or self.asking is None:
            return self
        return replace(self, holder=self.asking, asking=None)

    def keeps(self, client: int) -> "Wheel":
        """Only the holder keeps; who asked may ask again."""
        return replace(self, asking=None) if client == self.holder else self

    def view(self, client: int, now: float) -> WheelView:
        """What this browser is to know."""
        numbers = dict(self.tablets)
        return WheelView(
            number=numbers.get(client, 0),
            alone=len(self.tablets) <= 1,
            mine=self.holder == client,
            holder=None if self.holder is None else numbers[self.holder],
            others=len(self.tablets) - 1,
            asking=None if self.asking is None else numbers[self.asking],
            seconds=0.0 if self.asking is None else max(0.0, ANSWER_S - (now - self.asked_at)),
        )


class Helm:
    """The wheel of one console. Its methods may be called from any thread."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._wheel = Wheel()
        self._clock = clock
        self._lock = threading.Lock()

    def _change(self, change: Callable[[Wheel, float], Wheel]) -> None:
        with self._lock:
            now = self._clock()
            self._wheel = change(self._wheel.at(now), now)

    def came(self, client: int) -> None:
        """A browser is there."""
        self._change(lambda wheel, _: wheel.came(client))

    def left(self, client: int) -> None:
        """A browser has gone."""
        self._change(lambda wheel, _: wheel.left(client))

    def ask(self, client: int) -> None:
        """A browser wants the wheel."""
        self._change(lambda wheel, now: wheel.asks(client, now))

    def give(self, client: int) -> None:
        """The holder gives it."""
        self._change(lambda wheel, _: wheel.gives(client))

    def keep(self, client: int) -> None:
        """The holder keeps it."""
        self._change(lambda wheel, _: wheel.keeps(client))

    def has(self, client: int) -> bool:
        """Whether this browser operates."""
        return self.view(client).mine

    def view(self, client: int) -> WheelView:
        """What this browser is to know now."""
        self._change(lambda wheel, _: wheel)
        with self._lock:
            return self._wheel.view(client, self._clock())
