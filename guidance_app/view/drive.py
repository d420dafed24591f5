"""The words of the drive itself: its state, what the large button does next, sections, and how the present pass is.

Nothing here decides; a press that cannot be done is answered by the engine.
"""

from dataclasses import dataclass

from guidance_app.documents import Units
from guidance_app.language import Words, message
from guidance_app.model import (
    Command,
    LineBegun,
    Pause,
    Resume,
    SessionState,
    SetWork,
    SkipInitialisation,
    Snapshot,
)
from guidance_app.view.units import distance_text, small_area_text

__all__ = ["Press", "line_begun_words", "pass_work_words", "pause_press", "state_words", "work_press"]

STATES = {
    SessionState.IDLE: message("Waiting"),
    SessionState.INITIALISING: message("Measuring"),
    SessionState.DRIVING: message("Driving"),
    SessionState.PAUSED: message("Paused"),
    SessionState.ENDED: message("Ended"),
}


@dataclass(frozen=True, slots=True)
class Press:
    """What a button says, and what a press on it asks for; nothing once the drive has ended."""

    words: str
    command: Command | None
    lit: bool = False


def state_words(state: SessionState, words: Words) -> str:
    """The state of the drive in one word."""
    return words(STATES[state])


def work_press(snapshot: Snapshot, words: Words) -> Press:
    """The large button: lowers and lifts, leads out of a pause, skips the measuring time."""
    match snapshot.state:
        case SessionState.PAUSED:
            return Press(words("Paused · press to go on"), Resume())
        case SessionState.INITIALISING:
            return Press(words("Measuring · press to skip"), SkipInitialisation())
        case SessionState.ENDED:
            return Press(words("The drive has ended"), None)
        case SessionState.IDLE | SessionState.DRIVING:
            said = words("Working · press to lift" if snapshot.working else "Lifted · press to work")
            return Press(said, SetWork(down=not snapshot.working), snapshot.working)


def pause_press(snapshot: Snapshot, words: Words) -> Press:
    """The small button beside the state: into a pause and out of it."""
    if snapshot.state is SessionState.PAUSED:
        return Press(words("Go on"), Resume())
    return Press(words("Pause"), Pause())


def line_begun_words(begun: LineBegun, units: Units, words: Words) -> str:
    """How far the line has come that is being drawn: for the bar, where there is nothing to steer by meanwhile."""
    if begun.start is None:
        return words("drive the first pass")
    return words("{distance} from A", distance=distance_text(begun.metres, units, words))


def pass_work_words(snapshot: Snapshot, units: Units, words: Words) -> str:
    """How much of the present pass is worked, worked twice, and was driven by with the implement up; empty without."""
    totals = snapshot.pass_totals
    if totals is None:
        return ""
    return words(
        "Pass: {worked} worked, {twice} twice, {missed} missed",
        worked=small_area_text(totals.worked, units, words),
        twice=small_area_text(totals.overlap, units, words),
        missed=small_area_text(totals.left or 0.0, units, words),
    )
