"""The state of each link in the driver's words, from what came over it. Pure; ages are the view's."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from guidance_app.engine.hearing import Counts
from guidance_app.language import message, sentence
from guidance_app.model import (
    CORRECTIONS,
    RECEIVER,
    Attitude,
    Chunk,
    Fix,
    LinkState,
    LinkStatus,
    NoFix,
    Observation,
    Snapshot,
    SourceDown,
    SourceUp,
)

__all__ = ["after_chunk", "after_down", "after_up", "changed_link", "link_of"]


SILENT = frozenset({LinkStatus.CONNECTING, LinkStatus.NO_DATA, LinkStatus.NO_SENTENCE, LinkStatus.DOWN})


def link_of(snapshot: Snapshot, link: str) -> LinkState:
    """The state of the link of this name; of one that has not been heard of, the first one."""
    return snapshot.link if link == RECEIVER else snapshot.links_beside.get(link, LinkState())


def changed_link(link: str, beside: Mapping[str, LinkState], state: LinkState) -> dict[str, Any]:
    """The members of the snapshot that say this of the link. ``beside`` are the links beside the receiver's so far."""
    return {"link": state} if link == RECEIVER else {"links_beside": {**beside, link: state}}


def _changed(state: LinkState, status: LinkStatus, arrival: float, reason: str) -> LinkState:
    since = state.since if status is state.status else arrival
    return replace(state, status=status, since=since, reason=reason)


def after_up(state: LinkState, event: SourceUp) -> LinkState:
    """The source is open; no data yet. A caster gives none that is read here: that it is connected is all."""
    state = replace(state, what=event.what)
    if event.link == CORRECTIONS:
        return _changed(state, LinkStatus.CORRECTED, event.arrival, event.what)
    return _changed(state, LinkStatus.NO_DATA, event.arrival, sentence("waiting for data from {what}", what=event.what))


def after_down(state: LinkState, event: SourceDown) -> LinkState:
    """The source broke, or its file has ended."""
    status = LinkStatus.ENDED if event.ended else LinkStatus.DOWN
    return _changed(state, status, event.arrival, event.reason)


def after_chunk(state: LinkState, chunk: Chunk, closed: tuple[Observation, ...], counts: Counts) -> LinkState:
    """What came in may change the state. ``counts`` are the decoder's so far."""
    if not chunk.data and not closed:
        return state
    fixes = len([one for one in closed if isinstance(one, Fix)])
    status, reason = _told(state, chunk.link, closed, counts[2])
    return LinkState(
        status=status,
        since=state.since if status is state.status else chunk.arrival,
        reason=reason,
        last_data=chunk.arrival if chunk.data else state.last_data,
        sentences=counts[0],
        rejected=counts[1],
        fixes=state.fixes + fixes,
        what=state.what,
    )


def _told(state: LinkState, link: str, closed: tuple[Observation, ...], read: int) -> tuple[LinkStatus, str]:
    """What the link says of itself now, and why."""
    if link != RECEIVER and any(isinstance(one, Attitude) for one in closed):
        return LinkStatus.ATTITUDE, ""
    if any(isinstance(one, Fix) for one in closed):
        return LinkStatus.FIX, ""
    without = next((one for one in closed if isinstance(one, NoFix)), None)
    if without is not None:
        return LinkStatus.NO_FIX, without.reason
    if read == 0:
        return LinkStatus.NO_SENTENCE, _noise(state.what)
    if state.status in SILENT:
        if link != RECEIVER:
            return LinkStatus.NO_FIX, message("sentences arrive, but no reading yet")
        return LinkStatus.NO_FIX, message("sentences arrive, but no position yet")
    return state.status, state.reason


def _noise(what: str) -> str:
    """A receiver set to another baud rate sends what looks like this."""
    if not what:
        return message("bytes arrive but no sentence is valid: is the baud rate right?")
    return sentence("bytes arrive from {what} but no sentence is valid: is the baud rate right?", what=what)
