"""One step of an engine whatever happens: a failure inside is a snapshot that says so, and the same in every replay."""

import logging
from collections.abc import Callable

from guidance_app.engine import Engine
from guidance_app.engine.hearing import Heard
from guidance_app.model import Event, Snapshot

__all__ = ["stepped"]

log = logging.getLogger(__name__)


def stepped(
    engine: Engine, event: Event, hear: Callable[[Snapshot], None] | None = None, heard: Heard | None = None
) -> Snapshot:
    """The snapshot after one more event; ``hear`` gets each of them, when it closed several fixes. Never raises.

    ``heard`` as in ``Engine.steps``.
    """
    try:
        for snapshot in engine.steps(event, heard):
            if hear is not None:
                hear(snapshot)
    except Exception as error:
        before, failed = engine.snapshot.link.reason, engine.failed(event.arrival, str(error))
        if failed.link.reason != before:  # the same failure ten times a second is told once
            log.exception("the engine failed on %s", type(event).__name__)
        return failed
    return engine.snapshot
