"""The bars on the wire to the page: one short message a redraw, and what changes only when the driver changes it."""

import json
import math

from guidance_app.documents import Settings
from guidance_app.language import Words, words_for
from guidance_app.view.bar import BarView, Steering
from guidance_app.view.units import speed_unit

__all__ = ["bar_json", "lamp_zones", "style_json"]


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


def lamp_zones(steps: tuple[float, ...]) -> str:
    """One letter a lamp from the middle outward: g, y, r. The third of the steps nearest the line is green."""
    green, yellow = len(steps) * 3 // 8, len(steps) * 6 // 8
    return "".join("g" if lamp < green else "y" if lamp < yellow else "r" for lamp in range(len(steps)))
