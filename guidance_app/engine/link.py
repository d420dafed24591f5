"""The state of a receiver's link in the driver's words, from what came over it. Pure; ages are the view's."""

from dataclasses import replace

from guidance_app.model import Chunk, Fix, LinkState, LinkStatus, NoFix, Observation, SourceDown, SourceUp

__all__ = ["after_chunk", "after_down", "after_up"]


SILENT = frozenset({LinkStatus.CONNECTING, LinkStatus.NO_DATA, LinkStatus.NO_SENTENCE, LinkStatus.DOWN})


def _changed(state: LinkState, status: LinkStatus, arrival: float, reason: str) -> LinkState:
    since = state.since if status is state.status else arrival
    return replace(state, status=status, since=since, reason=reason)


def after_up(state: LinkState, event: SourceUp) -> LinkState:
    """The source is open; no data yet."""
    return _changed(state, LinkStatus.NO_DATA, event.arrival, f"waiting for data from {event.what}")


def after_down(state: LinkState, event: SourceDown) -> LinkState:
    """The source broke, or its file has ended."""
    status = LinkStatus.ENDED if event.ended else LinkStatus.DOWN
    return _changed(state, status, event.arrival, event.reason)


def after_chunk(state: LinkState, chunk: Chunk, closed: tuple[Observation, ...], counts: tuple[int, int]) -> LinkState:
    """What came in may change the state. ``counts`` are the decoder's (sentences, rejected) so far."""
    if not chunk.data and not closed:
        return state
    fixes = sum(isinstance(one, Fix) for one in closed)
    status, reason = _told(state, closed, counts[0], fixes)
    return LinkState(
        status=status,
        since=state.since if status is state.status else chunk.arrival,
        reason=reason,
        last_data=chunk.arrival if chunk.data else state.last_data,
        sentences=counts[0],
        rejected=counts[1],
        fixes=state.fixes + fixes,
    )


def _told(state: LinkState, closed: tuple[Observation, ...], sentences: int, fixes: int) -> tuple[LinkStatus, str]:
    """What the link says of itself now, and why."""
    if fixes:
        return LinkStatus.FIX, ""
    without = next((one for one in closed if isinstance(one, NoFix)), None)
    if without is not None:
        return LinkStatus.NO_FIX, without.reason
    if sentences == 0:
        return LinkStatus.NO_SENTENCE, "bytes arrive but no sentence is valid: is the baud rate right?"
    if state.status in SILENT:
        return LinkStatus.NO_FIX, "sentences arrive, but no position yet"
    return state.status, state.reason
