"""What the light bar and the prediction bar say, from a snapshot: every word, rounding, side and lamp. Pure.

The two bars never share a strip. The lamps say where to **steer**: right of the line they light on the left. The
prediction bar says where the tractor is **heading**: its mark stands right of the middle when the look-ahead ends
right of the line, and in the middle when the wheel may stay as it is.

Whatever is not known is absent. When there is nothing to steer by, the view has no cross-track error, no lamps and no
number at all, and ``reason`` says in words why: a last value never stays standing.
"""

import json
import math
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

from guidance_app.documents import Settings, Units
from guidance_app.language import Words, message, words_for
from guidance_app.model import FixQuality, Guidance, LinkState, LinkStatus, Pose, SessionState, Snapshot
from guidance_app.view.instant import moved_right
from guidance_app.view.units import area_text, distance_text, offset_text, speed_text, speed_unit

__all__ = ["BarState", "BarView", "Steering", "TurnLevel", "TurnView", "bar_json", "bar_of", "lamp_zones", "style_json"]

STALE_AFTER_S = 1.0
"""A fix older than this, or than two intervals of a slower receiver, is no longer steered by."""

TURN_SOON_S = 10.0
TURN_NOW_S = 3.0


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
    MEASURING = "measuring"
    FINISHED = "finished"


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
    BarState.MEASURING: message("measuring: stand still"),
    BarState.FINISHED: message("the drive has ended"),
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
}
MOVING = frozenset({BarState.GUIDE, BarState.NO_LINE, BarState.NO_DIRECTION, BarState.MEASURING, BarState.FINISHED})
"""States in which the pose is of now, so that the speed may be shown."""

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
    state = _state(snapshot, fix_age)
    pose = snapshot.pose if state in MOVING else None
    steering = None
    if state is BarState.GUIDE and pose is not None and snapshot.guidance is not None:
        steering = _steering(snapshot, pose, snapshot.guidance, now, settings)
    return BarView(
        sequence=snapshot.sequence,
        state=state,
        reason=_reason(state, snapshot.link, fix_age, words),
        steering=steering,
        fix_age=fix_age,
        fix=_fix_text(snapshot, fix_age, state, words),
        speed="" if pose is None else speed_text(pose.speed, settings.units, words),
        area=area_text(snapshot.totals.worked, settings.units, words),
        working=None if pose is None else snapshot.working,
        paused=snapshot.state is SessionState.PAUSED,
    )


def _state(snapshot: Snapshot, fix_age: float | None) -> BarState:
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
    return BarState.NO_LINE if snapshot.guidance is None else BarState.GUIDE


def _reason(state: BarState, link: LinkState, fix_age: float | None, words: Words) -> str:
    """Why there is nothing to steer by. The link's own words belong to it where it broke, and are kept short."""
    if state is BarState.GUIDE:
        return ""
    if state is BarState.STALE and fix_age is not None:
        return words("no position for {age}", age=words("{n} s", n=round(fix_age)))
    if state is BarState.ENDED and not link.fixes and link.reason:
        return words.say(link.reason)
    if state is BarState.DOWN and link.reason:
        return f"{words(REASONS[state])}: {words.say(link.reason)}"[:60]
    return words(REASONS[state])


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


def lamp_zones(steps: tuple[float, ...]) -> str:
    """One letter a lamp from the middle outward: g, y, r. The third of the steps nearest the line is green."""
    green, yellow = len(steps) * 3 // 8, len(steps) * 6 // 8
    return "".join("g" if lamp < green else "y" if lamp < yellow else "r" for lamp in range(len(steps)))


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


# --- on the wire ---------------------------------------------------------------------------------------------------


def bar_json(view: BarView, sent_ms: float | None = None) -> str:
    """One message to the page, about 200 bytes whatever the length of the day. What is absent has no member.

    ``q`` snapshot, ``t`` when it was sent (ms on the server's clock), ``s`` state, ``a`` age of the fix (ms), ``x``
    cross-track error (mm, positive right), ``k`` lamps (positive: steer right), ``d`` number, ``p`` place of the
    prediction (thousandths), ``e`` its number, ``h`` its lean (degrees), ``n`` pass, ``v`` speed, ``f`` fix, ``c``
    area, ``w`` 1 while working, ``u`` turn (distance, seconds, level, 1 if it fits), ``m`` where the turn leads that is
    being driven, ``z`` 1 in a pause, ``r`` reason.
    """
    message: dict[str, object] = {
        "q": view.sequence,
        "t": None if sent_ms is None else round(sent_ms, 1),
        "s": view.state.value,
        "r": view.reason or None,
        "a": None if view.fix_age is None else round(view.fix_age * 1000),
        **({} if view.steering is None else _steering_members(view.steering)),
        "v": view.speed or None,
        "f": view.fix,
        "c": view.area,
        "w": None if view.working is None else int(view.working),
        "z": 1 if view.paused else None,
    }
    known = {name: value for name, value in message.items() if value is not None}
    return json.dumps(known, separators=(",", ":"), ensure_ascii=False)


def _steering_members(steering: Steering) -> dict[str, object]:
    turn = steering.turn
    return {
        "x": round(steering.cross_track * 1000),
        "k": steering.lamps,
        "d": steering.number,
        "p": None if steering.predicted is None else round(steering.predicted * 1000),
        "e": steering.predicted_number or None,
        "h": None if steering.lean is None else round(math.degrees(steering.lean)),
        "n": steering.pass_text,
        "m": steering.turning or None,
        "u": None if turn is None else [turn.distance, turn.seconds, turn.level.value, int(turn.fits)],
    }


def page_words(words: Words, look_ahead_s: float) -> dict[str, str]:
    """What the page itself says on and beside the bars, by the names that its script uses."""
    return {
        "connecting": words("Connecting"),
        "noData": words("NO DATA"),
        "noAnswer": words("The console does not answer"),
        "onTheLine": words("on the line"),
        "steerLeft": words("steer left"),
        "steerRight": words("steer right"),
        "heading": words("heading"),
        "ahead": words("IN {seconds:g} s", seconds=look_ahead_s),
        "turn": words("end in {distance}"),
        "inTurn": words("turn, {distance} to go"),
        "onTheTurn": words("on the turn"),
        "tight": words("tight"),
        "working": words("working"),
        "lifted": words("implement up"),
        "paused": words("paused"),
        "notSent": words("{file} could not be sent: too large, or the connection broke."),
    }


def style_json(settings: Settings, look_ahead_s: float) -> str:
    """What changes only when the driver changes it: sent when a page joins and after a change."""
    words = words_for(settings.language)
    style = {
        "speed": speed_unit(settings.units),
        "zones": lamp_zones(settings.light_bar_steps),
        "guided": words("implement") if settings.guide_implement else words("tractor"),
        "sounds": settings.sounds,
        "language": settings.language,
        "words": page_words(words, look_ahead_s),
    }
    return json.dumps({"style": style}, separators=(",", ":"), ensure_ascii=False)
