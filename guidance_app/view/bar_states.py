"""Whether there is something to steer by, and if not, why: the states of the two bars, and their words. Pure."""

import math
from collections.abc import Mapping
from enum import StrEnum

from guidance_app.language import Words, message
from guidance_app.model import FixQuality, Guidance, LinkState, LinkStatus, SessionState, Snapshot

__all__ = ["QUALITIES", "REASONS", "STALE_AFTER_S", "TROUBLES", "BarState", "reason_of", "state_of"]

ACROSS = math.sin(math.radians(60))
"""Turned farther from a line nobody drives along it."""

STALE_AFTER_S = 1.0
"""A fix older than this, or than two intervals of a slower receiver, is no longer steered by."""


class BarState(StrEnum):
    """Whether there is something to steer by, and if not, why."""

    GUIDE = "guide"
    CONNECTING = "connecting"
    NO_DATA = "no-data"
    NO_SENTENCE = "no-sentence"
    NO_FIX = "no-fix"
    DOWN = "down"
    ENDED = "ended"
    STALE = "stale"
    NOT_READY = "not-ready"
    NO_DIRECTION = "no-direction"
    NO_LINE = "no-line"
    ACROSS = "across"
    MEASURING = "measuring"
    FINISHED = "finished"
    IDLE = "idle"


REASONS = {
    BarState.CONNECTING: message("waiting for the receiver"),
    BarState.NO_DATA: message("the receiver sends nothing"),
    BarState.NO_SENTENCE: message("data, but no valid sentence"),
    BarState.NO_FIX: message("no fix"),
    BarState.DOWN: message("receiver lost"),
    BarState.ENDED: message("end of the recording"),
    BarState.NOT_READY: message("finding the position"),
    BarState.NO_DIRECTION: message("direction unknown: drive 2 m"),
    BarState.NO_LINE: message("no line"),
    BarState.ACROSS: message("across the lines"),
    BarState.MEASURING: message("measuring: stand still"),
    BarState.FINISHED: message("the drive has ended"),
    BarState.IDLE: message("no receiver in use: start a drive"),
}

TROUBLES: Mapping[LinkStatus, BarState | None] = {
    LinkStatus.CONNECTING: BarState.CONNECTING,
    LinkStatus.NO_DATA: BarState.NO_DATA,
    LinkStatus.NO_SENTENCE: BarState.NO_SENTENCE,
    LinkStatus.NO_FIX: BarState.NO_FIX,
    LinkStatus.FIX: None,
    LinkStatus.ATTITUDE: BarState.NO_FIX,
    LinkStatus.CORRECTED: BarState.NO_FIX,
    LinkStatus.DOWN: BarState.DOWN,
    LinkStatus.ENDED: BarState.ENDED,
    LinkStatus.UNUSED: BarState.IDLE,
}
QUALITIES = {
    FixQuality.NONE: message("no fix"),
    FixQuality.AUTONOMOUS: message("GPS"),
    FixQuality.DGPS: message("DGPS"),
    FixQuality.PPS: message("PPS"),
    FixQuality.RTK_FIXED: message("RTK fixed"),
    FixQuality.RTK_FLOAT: message("RTK float"),
    FixQuality.DEAD_RECKONING: message("dead reckoning"),
    FixQuality.MANUAL: message("manual"),
    FixQuality.SIMULATED: message("simulated"),
}


STANDING_STATES: Mapping[SessionState, BarState] = {
    SessionState.INITIALISING: BarState.MEASURING,
    SessionState.ENDED: BarState.FINISHED,
}
"""States of the drive in which nothing is guided."""


def state_of(snapshot: Snapshot, fix_age: float | None) -> BarState:
    """``fix_age`` in seconds, None before the first fix."""
    trouble = TROUBLES[snapshot.link.status]
    if trouble is not None:
        return trouble
    if fix_age is None:
        return BarState.NO_FIX
    if fix_age > max(STALE_AFTER_S, 2.0 * (snapshot.fix_interval or 0.0)):
        return BarState.STALE
    if snapshot.pose is None:
        return BarState.NOT_READY
    if snapshot.state in STANDING_STATES:
        return STANDING_STATES[snapshot.state]
    if not snapshot.pose.heading_known:
        return BarState.NO_DIRECTION
    if snapshot.guidance is None:
        return BarState.NO_LINE
    return BarState.ACROSS if _leads_across(snapshot.guidance) else BarState.GUIDE


def _leads_across(guidance: Guidance) -> bool:
    """Whether the tractor drives away from the target across the lines, where no plan says which it looks for."""
    aside = math.sin(guidance.heading_error)
    away = guidance.cross_track * aside > 0
    return guidance.target.order is None and not guidance.on_pass and away and abs(aside) > ACROSS


def reason_of(state: BarState, link: LinkState, fix_age: float | None, words: Words) -> str:
    """Why there is nothing to steer by. The link's own words belong to it where it broke, and are kept short."""
    if state is BarState.GUIDE:
        return ""
    if state is BarState.STALE and fix_age is not None:
        return words("no position for {age}", age=words("{n} s", n=round(fix_age)))
    if state is BarState.DOWN and link.reason:
        return f"{words(REASONS[state])}: {words.say(link.reason)}"[:60]
    return words(REASONS[state])
