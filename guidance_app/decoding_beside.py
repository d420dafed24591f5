"""A recorded drive's bytes decoded by a process beside, so that a long drive is taken again in less time.

Decoding is a third of the engine's work and needs nothing of the rest. The process does it in order, ahead by what its
pipe holds; what it says is what the engine would have heard itself, to the bit. Short drives are decoded in place: a
process takes a second to begin.
"""

import logging
import multiprocessing
import os
import signal
from collections.abc import Iterator, Sequence
from multiprocessing.connection import Connection

from guidance_app.engine.hearing import Heard, Hearing
from guidance_app.model import Chunk, Event, SourceDown

__all__ = ["LONG", "DecodedEvents"]

log = logging.getLogger(__name__)

LONG = 20_000
"""Events from which on a process beside is worth its beginning: half an hour at 10 Hz."""
BATCH = 200
PATIENCE_S = 5.0


class DecodedEvents:
    """Goes once over events, each with what was heard, or with None where the engine has to listen itself.

    ``hearing`` is what was heard before them, None for nothing; it is left as it is. There is a process for ``long``
    events or more (else ``LONG``), where there is a second processor. If it ends early the rest is decoded here.
    Afterwards ``hearing`` is how to go on; None where the engine has listened.
    """

    def __init__(self, events: Sequence[Event], long: int | None = None, hearing: Hearing | None = None) -> None:
        self._events = events
        self._before = Hearing() if hearing is None else hearing
        alone = (os.cpu_count() or 1) < 2 or multiprocessing.current_process().daemon
        self._beside = len(events) >= (LONG if long is None else long) and not alone
        self.hearing: Hearing | None = None

    def __iter__(self) -> Iterator[tuple[Event, Heard | None]]:
        if not self._beside:
            for event in self._events:
                yield event, None
            return
        context = multiprocessing.get_context("spawn")
        receiving, sending = context.Pipe(duplex=False)
        process = context.Process(
            target=_decode, args=(sending, self._events, self._before), name="decoding", daemon=True
        )
        process.start()
        sending.close()
        try:
            yield from self._heard_beside(receiving)
        finally:
            receiving.close()
            process.terminate()
            process.join(PATIENCE_S)

    def _heard_beside(self, receiving: Connection) -> Iterator[tuple[Event, Heard | None]]:
        done = 0
        while done < len(self._events):
            batch = _received(receiving)
            if not isinstance(batch, list):
                log.warning("the process that decodes beside has ended early; the rest is decoded here")
                yield from self._heard_here(done)
                return
            for heard in batch:
                yield self._events[done], heard
                done += 1
        last = _received(receiving)
        self.hearing = last if isinstance(last, Hearing) else self._listened(done)

    def _heard_here(self, done: int) -> Iterator[tuple[Event, Heard | None]]:
        self.hearing = self._listened(done)
        for index in range(done, len(self._events)):
            event = self._events[index]
            yield event, _heard(self.hearing, event)

    def _listened(self, count: int) -> Hearing:
        """As the process was after so many events."""
        hearing = self._before.fork()
        for index in range(count):
            _heard(hearing, self._events[index])
        return hearing


def _heard(hearing: Hearing, event: Event) -> Heard | None:
    return hearing.hear(event) if isinstance(event, Chunk | SourceDown) else None


def _received(receiving: Connection) -> "list[Heard | None] | Hearing | None":
    """What the process sends next; None when it has ended."""
    try:
        return receiving.recv()  # type: ignore[no-any-return]  # only ``_decode`` sends
    except (EOFError, OSError):
        return None


def _decode(sending: Connection, events: Sequence[Event], hearing: Hearing) -> None:
    """The process: what is heard of all events, then how to go on."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the program that waits for this
    batch: list[Heard | None] = []
    try:
        for event in events:
            batch.append(_heard(hearing, event))
            if len(batch) == BATCH:
                sending.send(batch)
                batch = []
        if batch:
            sending.send(batch)
        sending.send(hearing)
    except BrokenPipeError:
        return  # nobody waits any longer
    finally:
        sending.close()
