"""The instant of the session clock that a picture shows."""

import math
from typing import Protocol

from guidance_app.model import Snapshot

__all__ = ["shown_instant"]

REPLAY_LAG_S = 0.1
"""How much a fast replay may lag behind its own clock, in true seconds, before its newest fix counts as old."""


class _Pace(Protocol):
    @property
    def speed(self) -> float: ...


class _Replay(Protocol):
    @property
    def state(self) -> _Pace: ...


class _Clocked(Protocol):
    @property
    def replay(self) -> _Replay | None: ...

    def now(self) -> float: ...


def shown_instant(session: _Clocked, snapshot: Snapshot) -> float:
    """Now, at the earliest the snapshot's own time.

    A fast replay's clock runs ahead of what has been worked through.
    """
    speed = 1.0 if session.replay is None else session.replay.state.speed
    if math.isinf(speed):
        return snapshot.arrival
    return max(snapshot.arrival, session.now() - REPLAY_LAG_S * max(0.0, speed - 1.0))
