"""Several sources as one: the receiver, and beside it an attitude sensor on a port of its own or a caster.

Each is read on a thread of its own; their events come out one by one, each with its link's name, in the order in
which they came in, with times that never step back.
"""

import logging
import queue
import threading
from collections.abc import Iterator, Mapping
from dataclasses import replace

from guidance_app.language import sentence
from guidance_app.model import RECEIVER, SourceDown
from guidance_app.sources import Source, SourceEvent

__all__ = ["Merged"]

log = logging.getLogger(__name__)

LOOK_S = 0.1
"""How soon the end is noticed while nothing comes."""

END_S = 5.0


class Merged:
    """A live source made of several live ones, by the name of their link; the receiver's is the first."""

    live = True

    def __init__(self, sources: Mapping[str, Source]) -> None:
        receiver = sources[RECEIVER]
        self.duration = receiver.duration
        beside = [f"{link} from {source.description}" for link, source in sources.items() if link != RECEIVER]
        self.description = ", ".join((receiver.description, *beside))
        self._sources = sources

    def events(self, stop: threading.Event) -> Iterator[SourceEvent]:
        """The events of all until each has ended, or until ``stop`` is set."""
        given: queue.SimpleQueue[SourceEvent | None] = queue.SimpleQueue()
        ended = threading.Event()
        threads = [
            threading.Thread(target=_read, args=(link, source, ended, given), name=f"source {link}", daemon=True)
            for link, source in self._sources.items()
        ]
        for thread in threads:
            thread.start()
        try:
            yield from _ordered(given, len(threads), stop)
        finally:
            ended.set()
            for thread in threads:
                thread.join(END_S)


def _ordered(
    given: "queue.SimpleQueue[SourceEvent | None]", reading: int, stop: threading.Event
) -> Iterator[SourceEvent]:
    latest = 0.0
    while reading and not stop.is_set():
        try:
            event = given.get(timeout=LOOK_S)
        except queue.Empty:
            continue
        if event is None:
            reading -= 1
            continue
        latest = max(latest, event.arrival)
        yield event if event.arrival == latest else replace(event, arrival=latest)


def _read(link: str, source: Source, stop: threading.Event, given: "queue.SimpleQueue[SourceEvent | None]") -> None:
    last = 0.0
    try:
        for event in source.events(stop):
            last = event.arrival
            given.put(event if event.link == link else replace(event, link=link))
    except Exception as error:
        log.exception("the source of the %s failed", link)
        given.put(
            SourceDown(
                last,
                sentence("{description} failed: {reason}", description=source.description, reason=str(error)),
                link,
            )
        )
    given.put(None)
