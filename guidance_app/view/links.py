"""What is to be known of the links beside the receiver's: an attitude sensor or a caster that is lost or silent.

A receiver without its sensor goes on to guide, a little worse: the driver is told, and nothing is blanked.
"""

from guidance_app.language import Words
from guidance_app.model import ATTITUDE, CORRECTIONS, LinkState, LinkStatus, Snapshot

__all__ = ["beside_notices", "sensor_words"]

SILENT_AFTER_S = 1.0
"""An attitude older than this is not used any more."""

PATIENCE_S = 5.0
"""So long a link may take to say its first reading."""

LOST, SILENT, WORKS = "lost", "silent", "works"


def beside_notices(snapshot: Snapshot, now: float, words: Words) -> tuple[str, ...]:
    """What the driver has to know now; nothing while every link beside the receiver's does its work."""
    found = []
    for link, state in snapshot.links_beside.items():
        notice = _notice(link, state, now, words)
        if notice:
            found.append(notice)
    return tuple(found)


def _notice(link: str, state: LinkState, now: float, words: Words) -> str:
    reason = words.say(state.reason)
    if link == CORRECTIONS and state.status is LinkStatus.DOWN:
        return words("No corrections: {reason}", reason=reason)
    if link == ATTITUDE:
        condition = _condition(state, now)
        if condition == LOST:
            return words("No attitude, so roll is not corrected: {reason}", reason=reason)
        if condition == SILENT:
            return words("The attitude sensor is silent, so roll is not corrected.")
    return ""


def _condition(state: LinkState, now: float) -> str:
    match state.status:
        case LinkStatus.ATTITUDE:
            silent = state.last_data is not None and now - state.last_data > SILENT_AFTER_S
            return SILENT if silent else WORKS
        case LinkStatus.DOWN | LinkStatus.NO_SENTENCE:
            return LOST
        case LinkStatus.ENDED:
            return WORKS
    return SILENT if now - state.since > PATIENCE_S else WORKS


def sensor_words(state: LinkState, now: float, words: Words) -> str:
    """The state of an attitude sensor's link in a few words."""
    condition = _condition(state, now)
    if condition == LOST:
        return words.say(state.reason)
    if condition == SILENT:
        return words("silent")
    return words("gives roll and heading") if state.status is LinkStatus.ATTITUDE else words("connecting")
