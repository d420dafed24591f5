"""Where bytes come from. One source a file; a URI picks it: ``serial:///dev/ttyUSB0``, ``file:run.nmea``, ``sim:``.

A source only reads. It says what it opened (``SourceUp``), gives the bytes with their times (``Chunk``), and says why
it ended (``SourceDown``); it never raises once it is open. A source that is not ``live`` gives its chunks as fast as
they are taken, each with the time at which it belongs; ``pacing`` is the one place that waits, and ``open_source``
puts it in front of such a source. Opening raises ``SourceError`` with a sentence for the person at the screen.
"""

import importlib
import threading
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Protocol, cast

from guidance_app.language import sentence
from guidance_app.model import ATTITUDE, RECEIVER, Chunk, SourceDown, SourceUp

if TYPE_CHECKING:
    from guidance_app.documents import Job
    from guidance_app.sources.ntrip import Caster, Traffic

    Corrected = Callable[["Source", Caster, Traffic | None], Mapping[str, "Source"]]

__all__ = [
    "SOURCES",
    "Opener",
    "Source",
    "SourceError",
    "SourceEvent",
    "open_receiver",
    "open_source",
    "takes_corrections",
]

SourceEvent = Chunk | SourceUp | SourceDown


class SourceError(Exception):
    """What cannot be read and what to do about it, in one sentence for the person at the screen."""


class Source(Protocol):
    """Something to read a receiver's bytes from. ``duration`` in seconds is None when nobody knows the end.

    ``live`` says who keeps the time: a live source gives bytes when they come, another gives them at once and leaves
    the waiting to ``pacing``.
    """

    description: str
    duration: float | None
    live: bool

    def events(self, stop: threading.Event) -> Iterator[SourceEvent]:
        """From ``SourceUp`` to ``SourceDown``, or until ``stop`` is set."""
        ...


Opener = Callable[[str], Source]

SOURCES: Mapping[str, str] = {
    "serial": "guidance_app.sources.serial_port:open_serial",
    "tcp": "guidance_app.sources.tcp:open_tcp",
    "udp": "guidance_app.sources.udp:open_udp",
    "gpsd": "guidance_app.sources.gpsd:open_gpsd",
    "file": "guidance_app.sources.file:open_file",
    "sim": "guidance_app.sources.simulated:open_simulated",
}
"""URI scheme -> opener, as ``module:function``. Named, not imported: a source's own libraries load when it is used."""

TAKE_CORRECTIONS = frozenset({"serial", "tcp"})
"""Schemes whose other end is the receiver itself, so that what is sent there reaches it."""


SIMULATED = "sim"
SIMULATED_ON_FIELD = "guidance_app.sources.simulated:open_simulated_on"
"""The one source that wants to know what it is for."""


def takes_corrections(uri: str) -> bool:
    """Whether what is sent to this source reaches the receiver."""
    return uri.partition(":")[0].lower() in TAKE_CORRECTIONS


def open_receiver(
    job: "Job", number: int | None = None, caster: "Caster | None" = None, traffic: "Traffic | None" = None
) -> Source:
    """The source of a job's receiver, with its attitude sensor; a simulated tractor drives that job.

    That tractor stands where the plan's pass of this ``number`` begins, as after a stop on it; without one where the
    first does. ``caster`` is where corrections come from, ``traffic`` counts them. Raises ``SourceError``.
    """
    receiver = job.receiver
    if receiver.source.partition(":")[0].lower() != SIMULATED:
        return _beside(_open_one(receiver.source), receiver.source, receiver.attitude_source, caster, traffic)
    opener = cast("Callable[[str, Job, int | None], Source]", _named(SIMULATED_ON_FIELD))
    simulated = opener(receiver.source, job, number)
    return _beside(_in_time(simulated), receiver.source, receiver.attitude_source)


def open_source(uri: str, attitude: str | None = None, caster: "Caster | None" = None) -> Source:
    """The source that ``uri`` names, keeping its time by itself, with what stands beside it.

    ``attitude`` names that of an attitude sensor, ``caster`` is where corrections for the receiver come from. Raises
    ``SourceError``.
    """
    return _beside(_open_one(uri), uri, attitude, caster)


def _beside(
    receiver: Source,
    uri: str,
    attitude: str | None,
    caster: "Caster | None" = None,
    traffic: "Traffic | None" = None,
) -> Source:
    if attitude is None and caster is None:
        return receiver
    merged = cast("Callable[[Mapping[str, Source]], Source]", _named("guidance_app.sources.merged:Merged"))
    beside = {} if attitude is None else {ATTITUDE: _open_one(attitude)}
    if caster is None:
        return merged({RECEIVER: receiver, **beside})
    if not takes_corrections(uri):
        msg = sentence("'{uri}' takes no corrections: a receiver at a serial:// or tcp:// address does.", uri=uri)
        raise SourceError(msg)
    corrected = cast("Corrected", _named("guidance_app.sources.ntrip:corrected"))
    return merged({**corrected(receiver, caster, traffic), **beside})


def _open_one(uri: str) -> Source:
    scheme = uri.partition(":")[0].lower()
    if ":" not in uri or scheme not in SOURCES:
        known = ", ".join(f"{name}:" for name in SOURCES)
        msg = sentence(
            "'{uri}' is not a source that is known here: write it with one of {known} in front, as in file:run.nmea.",
            uri=uri,
            known=known,
        )
        raise SourceError(msg)
    return _in_time(cast("Opener", _named(SOURCES[scheme]))(uri))


def _in_time(source: Source) -> Source:
    if source.live:
        return source
    return cast("Callable[[Source], Source]", _named("guidance_app.sources.pacing:Paced"))(source)


def _named(place: str) -> object:
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(module), name)
