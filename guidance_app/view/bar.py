"""What the light bar and the prediction bar say, from a snapshot: every word, rounding, side and lamp. Pure.

The two bars never share a strip. The lamps say where to **steer**: right of the line they light on the left. The
prediction bar says where the tractor is **heading**: its mark stands right of the middle when the look-ahead ends
right of the line, and in the middle when the wheel may stay as it is.

Whatever is not known is absent. When there is nothing to steer by, the view has no cross-track error, no lamps and no
number at all, and ``reason`` says in words why: a last value never stays standing.
"""

import math
from bisect import bisect_right
from dataclasses import dataclass, replace
from enum import StrEnum

from guidance_app.documents import Settings, Units
from guidance_app.language import Words, words_for
from guidance_app.model import Guidance, Pose, SessionState, Snapshot
from guidance_app.view.bar_states import QUALITIES, REASONS, BarState, reason_of, state_of
from guidance_app.view.drive import line_begun_words
from guidance_app.view.instant import moved_right
from guidance_app.view.units import area_text, distance_text, offset_text, speed_text

__all__ = ["TURN_NOW_S", "TURN_SOON_S", "BarView", "Steering", "TurnLevel", "TurnView", "bar_of"]

TURN_SOON_S = 10.0
TURN_NOW_S = 3.0


MOVING = frozenset(
    {BarState.GUIDE, BarState.NO_LINE, BarState.ACROSS, BarState.NO_DIRECTION, BarState.MEASURING, BarState.FINISHED}
)
"""States in which the pose is of now, so that the speed may be shown."""


class TurnLevel(StrEnum):
    """How near the turn is: shown plain, yellow, red."""

    FAR = "far"
    SOON = "soon"
    NOW = "now"


@dataclass(frozen=True, slots=True)
class TurnView:
    """The end of the pass: how far, in how many seconds (empty: far or standing), how urgent, whether the turn fits."""

    distance: str
    seconds: str
    level: TurnLevel
    fits: bool


@dataclass(frozen=True, slots=True)
class Steering:
    """What exists only while there is a line to steer by. Lengths in metres, positive right of the line.

    ``lamps`` counts lit lamps, positive on the right: steer right; 0 is the middle alone. ``number`` is the unsigned
    distance with its unit. ``predicted`` is the mark's place on the prediction bar, from -1 (left end) to 1, on the
    lamps' own scale; ``lean`` its heading error in radians, positive turned right of the line. In a turn that is being
    driven all of these are against its path, and ``turning`` says where it leads.
    """

    cross_track: float
    lamps: int
    number: str
    pass_text: str
    predicted: float | None = None
    predicted_number: str = ""
    lean: float | None = None
    turn: TurnView | None = None
    turning: str = ""


@dataclass(frozen=True, slots=True)
class BarView:
    """All that the bars show. ``steering`` is there if and only if the state is ``GUIDE``; if not, ``reason`` is."""

    sequence: int
    state: BarState
    reason: str
    steering: Steering | None
    fix_age: float | None
    fix: str
    speed: str
    area: str
    working: bool | None
    """None when the position is not of now: then nobody knows whether ground is being worked."""
    paused: bool = False


def bar_of(snapshot: Snapshot, now: float, settings: Settings) -> BarView:
    """The bars at the instant ``now`` of the session clock: the newest pose is carried forward to it."""
    words = words_for(settings.language)
    fix_age = None if snapshot.fix is None else max(0.0, now - snapshot.fix.arrival)
    state = state_of(snapshot, fix_age)
    pose = snapshot.pose if state in MOVING else None
    steering = None
    if state is BarState.GUIDE and pose is not None and snapshot.guidance is not None:
        steering = _steering(snapshot, pose, snapshot.guidance, now, settings)
    return BarView(
        sequence=snapshot.sequence,
        state=state,
        reason=_reason(snapshot, state, fix_age, settings.units, words),
        steering=steering,
        fix_age=fix_age,
        fix=_fix_text(snapshot, fix_age, state, words),
        speed="" if pose is None else speed_text(pose.speed, settings.units, words),
        area=area_text(snapshot.totals.worked, settings.units, words),
        working=None if pose is None else snapshot.working,
        paused=snapshot.state is SessionState.PAUSED,
    )


def _reason(snapshot: Snapshot, state: BarState, fix_age: float | None, units: Units, words: Words) -> str:
    """Why there is nothing to steer by; a line that is being drawn says how far it has come."""
    begun = snapshot.line_begun
    if state is BarState.NO_LINE and begun is not None:
        return line_begun_words(begun, units, words)
    if state is BarState.ACROSS and snapshot.guidance is not None:
        return words("across line {number}", number=snapshot.guidance.target.number)
    return reason_of(state, snapshot.link, fix_age, words)


def _fix_text(snapshot: Snapshot, fix_age: float | None, state: BarState, words: Words) -> str:
    """Fix quality with its age; whole seconds, because a changing tenth draws the eye and says nothing."""
    if snapshot.fix is None or fix_age is None:
        return words(REASONS[BarState.NO_FIX])
    if state in (BarState.NO_FIX, BarState.STALE, BarState.DOWN, BarState.NO_DATA, BarState.NO_SENTENCE):
        return words("last fix {age} ago", age=_age_text(fix_age, words))
    return f"{words(QUALITIES[snapshot.fix.quality])}, {_age_text(fix_age, words)}"


def _age_text(age: float, words: Words) -> str:
    if age < 1.0:
        return words("<1 s")
    return words("{n} s", n=int(age)) if age < 100 else words("{n} min", n=int(age / 60))


def _steering(snapshot: Snapshot, pose: Pose, guidance: Guidance, now: float, settings: Settings) -> Steering:
    seconds = now - pose.arrival
    point = snapshot.implement[:2] if settings.guide_implement and snapshot.implement else (pose.east, pose.north)
    steps, units, words = settings.light_bar_steps, settings.units, words_for(settings.language)
    turn = guidance.turn if guidance.turn is not None and guidance.turn.cross_track is not None else None
    if turn is None or turn.cross_track is None:
        off = guidance.cross_track + moved_right(guidance, pose, point, seconds)
    else:
        off = turn.cross_track + pose.speed * math.sin(turn.heading_error or 0.0) * seconds
    steering = Steering(
        cross_track=off,
        turning="" if turn is None else _turning_text(guidance, words),
        lamps=_lit(off, steps),
        number=offset_text(off, units, words),
        pass_text=_pass_text(guidance, words),
        turn=_turn(guidance, pose, units, words),
    )
    ahead = snapshot.prediction
    if ahead is None or ahead.cross_track is None:
        return steering
    predicted = ahead.cross_track
    if turn is None:
        predicted += moved_right(guidance, ahead.pose, (ahead.pose.east, ahead.pose.north), seconds)
    return replace(
        steering,
        predicted=_place(predicted, steps),
        predicted_number=offset_text(predicted, units, words),
        lean=ahead.heading_error,
    )


def _lit(off: float, steps: tuple[float, ...]) -> int:
    """How many lamps are lit on the side to steer to: one a step reached. Zero is the middle lamp alone."""
    reached = bisect_right(steps, abs(off))
    return -reached if off > 0 else reached


def _place(off: float, steps: tuple[float, ...]) -> float:
    """-1 to 1: the same steps as the lamps, joined by straight lines."""
    size = min(abs(off), steps[-1])
    reached = bisect_right(steps, size)
    if reached == len(steps):
        return math.copysign(1.0, off)
    below = steps[reached - 1] if reached else 0.0
    part = (size - below) / (steps[reached] - below)
    return math.copysign((reached + part) / len(steps), off)


def _pass_text(guidance: Guidance, words: Words) -> str:
    """``pass 3 of 24 (line +2)``: its place in the driving order, and its number counted from the guidance line."""
    target = guidance.target
    number = f"{target.number:+d}" if target.number and not target.lap else f"{target.number}"
    name = words("lap {number}", number=number) if target.lap else words("line {number}", number=number)
    if target.order is None:
        return name
    place = target.order + 1
    if guidance.count is None:
        return f"{words('pass {number}', number=place)} ({name})"
    return f"{words('pass {number} of {count}', number=place, count=guidance.count)} ({name})"


def _turning_text(guidance: Guidance, words: Words) -> str:
    """``turn to pass 4``, by the place in the driving order where there is one."""
    target = guidance.target
    if target.order is not None:
        return words("turn to pass {number}", number=target.order + 1)
    return words("turn to line {number}", number=target.number)


def _turn(guidance: Guidance, pose: Pose, units: Units, words: Words) -> TurnView | None:
    turn = guidance.turn
    if turn is not None and turn.to_go is not None:
        return TurnView(distance_text(turn.to_go, units, words), "", TurnLevel.FAR, turn.fits)
    if turn is not None:
        distance, seconds, fits = turn.distance, turn.seconds, turn.fits
    elif guidance.remaining is not None:
        distance, fits = max(0.0, guidance.remaining), True
        seconds = distance / abs(pose.speed) if not pose.standing and abs(pose.speed) > 0.1 else None
    else:
        return None
    return TurnView(distance_text(distance, units, words), _seconds_text(seconds, words), _turn_level(seconds), fits)


def _seconds_text(seconds: float | None, words: Words) -> str:
    """Empty when it is not known, and when it is so long that only the distance means something."""
    return "" if seconds is None or seconds >= 99.5 else words("{n} s", n=round(seconds))


def _turn_level(seconds: float | None) -> TurnLevel:
    if seconds is None or seconds >= TURN_SOON_S:
        return TurnLevel.FAR
    return TurnLevel.SOON if seconds >= TURN_NOW_S else TurnLevel.NOW
