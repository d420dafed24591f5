"""The satellites in view, from the rounds of sentences in which a receiver tells them.

A round is a system's (GPS, Galileo, ...) and, since version 4.10, a signal's: the same satellite comes once for each
signal, and its strongest one counts. A round that has not come again for some seconds is forgotten.
"""

from dataclasses import replace

from guidance_app.decode.sentence import InView
from guidance_app.model import Satellite

__all__ = ["Sky"]

FORGOTTEN_AFTER_S = 30.0
"""Receivers tell the sky every second to every ten seconds."""


class Sky:
    """Joins rounds. ``satellites`` is replaced whole when a round is complete."""

    def __init__(self) -> None:
        self.satellites: tuple[Satellite, ...] = ()
        self._open: dict[tuple[str, str], tuple[InView, ...]] = {}
        self._rounds: dict[tuple[str, str], tuple[float, tuple[Satellite, ...]]] = {}

    def fork(self) -> "Sky":
        """An independent copy."""
        other = Sky()
        other.satellites = self.satellites
        other._open, other._rounds = self._open.copy(), self._rounds.copy()
        return other

    def take(self, told: InView, arrival: float) -> None:
        """One more sentence. A round in which one was lost changes nothing."""
        key = (told.system, told.signal)
        before = self._open.get(key, ()) if told.number > 1 else ()
        self._open[key] = (*before, told)
        if told.number != told.count:
            return
        whole = self._open.pop(key)
        if [one.number for one in whole] != list(range(1, told.count + 1)):
            return
        self._rounds[key] = (arrival, tuple(satellite for one in whole for satellite in one.satellites))
        self._rounds = {
            key: kept
            for key, kept in self._rounds.items()
            if arrival - kept[0] <= FORGOTTEN_AFTER_S or kept[0] > arrival
        }
        self.satellites = self._joined()

    def _joined(self) -> tuple[Satellite, ...]:
        """Every satellite once, with its strongest signal, by system and number."""
        best: dict[tuple[str, int], Satellite] = {}
        for _, satellites in self._rounds.values():
            for one in satellites:
                seen = best.get((one.system, one.number))
                best[one.system, one.number] = one if seen is None else _with_stronger(seen, one)
        return tuple(best[key] for key in sorted(best))


def _with_stronger(one: Satellite, other: Satellite) -> Satellite:
    signals = [said for said in (one.signal, other.signal) if said is not None]
    return replace(one, signal=max(signals, default=None))
