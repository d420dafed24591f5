"""What is possible in which state of the session, and the sentence that says why something is not. Pure."""

from guidance_app.language import message
from guidance_app.model import (
    ApplyRollZero,
    BeginInitialisation,
    BeginLine,
    BeginRollZero,
    CancelRollZero,
    Command,
    EndDrive,
    EndLine,
    FinishRollZero,
    NextRollZeroDrive,
    Pause,
    ReplanRest,
    Resume,
    SessionState,
    SetLookAhead,
    SetWork,
    SkipInitialisation,
)

__all__ = ["why_not"]

NOT_ENDED = frozenset(SessionState) - {SessionState.ENDED}
UNDER_WAY = frozenset({SessionState.DRIVING, SessionState.PAUSED})

POSSIBLE: dict[type[Command], frozenset[SessionState]] = {
    SetLookAhead: frozenset(SessionState),
    SetWork: frozenset({SessionState.IDLE, SessionState.DRIVING}),
    BeginInitialisation: NOT_ENDED - {SessionState.INITIALISING},
    SkipInitialisation: frozenset({SessionState.INITIALISING}),
    Pause: frozenset({SessionState.DRIVING}),
    Resume: frozenset({SessionState.PAUSED}),
    EndDrive: NOT_ENDED,
    ReplanRest: UNDER_WAY,
    BeginLine: UNDER_WAY,
    EndLine: UNDER_WAY,
    BeginRollZero: UNDER_WAY,
    NextRollZeroDrive: UNDER_WAY,
    FinishRollZero: UNDER_WAY,
    ApplyRollZero: UNDER_WAY,
    CancelRollZero: NOT_ENDED,
}
"""Where a command has an effect; one that is not named here has one until the drive has ended."""

WHY = {
    SessionState.IDLE: message("Not yet: there is no position."),
    SessionState.INITIALISING: message("Not now: the start point is being measured. Wait for it, or skip it."),
    SessionState.DRIVING: message("Nothing to do: the drive is under way."),
    SessionState.PAUSED: message("Not now: the drive is paused. Go on first."),
    SessionState.ENDED: message("The drive has ended. Start a new one."),
}


def why_not(state: SessionState, command: Command) -> str | None:
    """The sentence that says why the command changes nothing in this state; None when it may act."""
    return None if state in POSSIBLE.get(type(command), NOT_ENDED) else WHY[state]
