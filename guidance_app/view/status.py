"""The words and numbers of the panels: how much, how fast, how good, how long. Rounded, with units, or a dash.

Absent is a dash. What ages shows its age. Nothing here decides what to do; it only says what is.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from guidance_app.documents import Units
from guidance_app.language import Words, message
from guidance_app.model import (
    POSITION_OFFSETS,
    FixQuality,
    Guidance,
    LinkState,
    LinkStatus,
    OffsetKind,
    Snapshot,
)
from guidance_app.view.bar_states import QUALITIES, STALE_AFTER_S
from guidance_app.view.drive import Press, work_press
from guidance_app.view.links import beside_notices
from guidance_app.view.units import INCH, area_text, offset_text, speed_text, speed_unit

__all__ = [
    "ABSENT",
    "OFFSETS",
    "Figure",
    "InfoView",
    "Level",
    "WorkView",
    "age_words",
    "clock",
    "fix_words",
    "info_view",
    "line_offset",
    "link_words",
    "neighbour",
    "nudge_steps",
    "pass_words",
    "replay_rows",
    "signed_text",
    "work_view",
]

ABSENT = "–"
SHORTEST_WORK = 30.0
"""A rate is shown after so many seconds of work; before, it jumps."""

GOOD, FAIR, BAD, OFF = "good", "fair", "bad", "off"
Level = str
"""How good something is, for its colour beside its words: one of the four above."""

LINE_OFFSETS = frozenset({OffsetKind.NUDGE, OffsetKind.SHIFT, OffsetKind.LINE_HERE})


@dataclass(frozen=True, slots=True)
class Figure:
    """One number of a panel with its name and unit."""

    name: str
    value: str
    unit: str = ""


@dataclass(frozen=True, slots=True)
class WorkView:
    """What the head of the panels and the work panel say."""

    figures: tuple[Figure, ...]
    fix: str
    fix_level: Level
    work: Press
    pass_words: str
    line_words: str
    notices: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class InfoView:
    """What the info panel says: the link in words, and rows of (name, value)."""

    link: str
    link_level: Level
    rows: tuple[tuple[str, str], ...]


# --- numbers -------------------------------------------------------------------------------------------------------


def clock(seconds: float | None) -> str:
    """Minutes and seconds, with hours from one hour on."""
    if seconds is None or not math.isfinite(seconds):
        return ABSENT
    hours, rest = divmod(int(max(seconds, 0.0)), 3600)
    minutes, left = divmod(rest, 60)
    return f"{hours}:{minutes:02d}:{left:02d}" if hours else f"{minutes:02d}:{left:02d}"


def age_words(seconds: float, words: Words) -> str:
    """An age in whole seconds, minutes from two on; a changing tenth draws the eye and says nothing."""
    if seconds < 1.0:
        return words("<1 s")
    whole = round(seconds)
    return words("{n} s", n=whole) if seconds < 120 else words("{n} min", n=round(seconds / 60))


def signed_text(metres: float, units: Units, words: Words) -> str:
    """A sideways distance with its side in words: "4 cm right"."""
    distance = offset_text(metres, units, words)
    if distance.startswith("0 "):
        return distance
    return words("{distance} right", distance=distance) if metres > 0 else words("{distance} left", distance=distance)


def nudge_steps(units: Units) -> tuple[tuple[str, float], ...]:
    """The four nudges of a line, from left to right: (words, metres to the right)."""
    small, large, unit = (1, 4, INCH) if units is Units.IMPERIAL else (2, 10, 0.01)
    return (
        (f"◀{large}", -large * unit),
        (f"◀{small}", -small * unit),
        (f"{small}▶", small * unit),
        (f"{large}▶", large * unit),
    )


# --- work ----------------------------------------------------------------------------------------------------------


def work_view(snapshot: Snapshot, now: float, units: Units, words: Words) -> WorkView:
    """Everything the head and the work panel say."""
    fix, level = fix_words(snapshot, now, words)
    return WorkView(
        figures=figures(snapshot, units, words),
        fix=fix,
        fix_level=level,
        work=work_press(snapshot, words),
        pass_words=pass_words(snapshot.guidance, words),
        line_words=words("Moved {distance}", distance=signed_text(line_offset(snapshot), units, words)),
        notices=(*beside_notices(snapshot, now, words), *(words.say(notice) for notice in snapshot.notices)),
    )


def figures(snapshot: Snapshot, units: Units, words: Words) -> tuple[Figure, ...]:
    """The numbers always in sight: the drive above, the work below."""
    totals = snapshot.totals
    rate = totals.worked / totals.working_s if totals.working_s >= SHORTEST_WORK else None
    remaining = totals.left / rate if rate and totals.left is not None else None
    speed = ABSENT if snapshot.pose is None else speed_text(snapshot.pose.speed, units, words)
    return (
        _place_in_order(snapshot.guidance, words),
        Figure(words("speed"), speed, speed_unit(units)),
        _area(words("overlap"), totals.overlap, units, words),
        _area(words("headland"), totals.headland, units, words),
        _area(words("done"), totals.worked, units, words),
        _area(words.within("still to do", "left"), totals.left, units, words),
        Figure(words("time left"), *_hours(remaining, words)),
        _area(words("per hour"), None if rate is None else rate * 3600, units, words),
    )


def _area(name: str, square_metres: float | None, units: Units, words: Words) -> Figure:
    number, unit = area_text(square_metres or 0.0, units, words).split(" ")
    return Figure(name, ABSENT if square_metres is None else number, unit)


def _hours(seconds: float | None, words: Words) -> tuple[str, str]:
    """(number, unit): minutes below 100 of them, hours and minutes from there on."""
    if seconds is None or not math.isfinite(seconds):
        return ABSENT, words("min")
    minutes = round(seconds / 60)
    if minutes < 100:
        return f"{minutes}", words("min")
    return f"{minutes // 60}:{minutes % 60:02d}", words("h")


def _place_in_order(guidance: Guidance | None, words: Words) -> Figure:
    if guidance is None:
        return Figure(words("pass"), ABSENT)
    order = guidance.target.order
    if order is None:
        return Figure(words("line"), f"{guidance.target.number}")
    of_all = "" if guidance.count is None else words("of {count}", count=guidance.count)
    return Figure(words("pass"), f"{order + 1}", of_all)


def pass_words(guidance: Guidance | None, words: Words) -> str:
    """Which line is guided, by the number painted beside it."""
    if guidance is None:
        return words("No line")
    number = guidance.target.number
    return words("Lap {number}", number=number) if guidance.target.lap else words("Line {number}", number=number)


def neighbour(snapshot: Snapshot, step: int) -> int | None:
    """The number of the line beside the target, to the side of ``step``; None without a line or at the last one."""
    if snapshot.guidance is None:
        return None
    at = snapshot.guidance.target.number
    numbers = [line.number for line in snapshot.passes if (line.number - at) * step > 0]
    return min(numbers, key=lambda number: abs(number - at), default=None)


def line_offset(snapshot: Snapshot) -> float:
    """How far the lines stand from where they were planned, metres to the right as the tractor drives."""
    return rightward(snapshot) * sum(offset.metres for offset in snapshot.offsets if offset.kind in LINE_OFFSETS)


def rightward(snapshot: Snapshot) -> float:
    """+1 where line offsets to the right are so for the driver too, -1 on the way back."""
    return -1.0 if snapshot.guidance is not None and snapshot.guidance.mirrored else 1.0


# --- fix and link --------------------------------------------------------------------------------------------------

_GOODNESS = {FixQuality.RTK_FIXED: GOOD, FixQuality.NONE: BAD, FixQuality.DEAD_RECKONING: BAD}


def fix_words(snapshot: Snapshot, now: float, words: Words) -> tuple[str, Level]:
    """The fix's quality with its age, satellites and HDOP, and how good it is; the link's state without a fix."""
    fix = snapshot.fix
    if fix is None or snapshot.link.status not in {LinkStatus.FIX, LinkStatus.ENDED}:
        return link_words(snapshot.link, now, words)
    age = max(now - fix.arrival, 0.0)
    parts = [words(QUALITIES[fix.quality]), age_words(age, words)]
    if fix.satellites is not None:
        parts.append(words.plural("{n} satellite", "{n} satellites", fix.satellites))
    if fix.hdop is not None:
        parts.append(f"HDOP {words.number(fix.hdop, 1)}")
    late = age > max(STALE_AFTER_S, 2 * (snapshot.fix_interval or 0.0))
    return " · ".join(parts), BAD if late else _GOODNESS.get(fix.quality, FAIR)


_LINK_WORDS = {
    LinkStatus.CONNECTING: (message("Connecting to the receiver"), FAIR),
    LinkStatus.NO_DATA: (message("The receiver sends nothing"), BAD),
    LinkStatus.NO_SENTENCE: (message("Data, but no valid sentence"), BAD),
    LinkStatus.NO_FIX: (message("The receiver has no position"), BAD),
    LinkStatus.FIX: (message("The receiver gives positions"), GOOD),
    LinkStatus.ATTITUDE: (message("The sensor gives its attitude"), GOOD),
    LinkStatus.CORRECTED: (message("Corrections arrive"), GOOD),
    LinkStatus.DOWN: (message("The receiver is gone"), BAD),
    LinkStatus.ENDED: (message("The recording has ended"), OFF),
    LinkStatus.UNUSED: (message("No receiver is in use"), OFF),
}


def link_words(link: LinkState, now: float, words: Words) -> tuple[str, Level]:
    """The state of the link in words, for how long, and the reason where there is one."""
    state, level = _LINK_WORDS[link.status]
    reason = f": {words.say(link.reason)}" if link.reason and link.status is not LinkStatus.ENDED else ""
    since = age_words(max(now - link.since, 0.0), words)
    return words("{state}, for {since}", state=words(state), since=since) + reason, level


def info_view(snapshot: Snapshot, now: float, units: Units, words: Words) -> InfoView:
    """Everything the info panel says."""
    state, level = link_words(snapshot.link, now, words)
    fix, link = snapshot.fix, snapshot.link
    correction = fix.correction_age if fix is not None else None
    rows = (
        (words("Last data"), ABSENT if link.last_data is None else _ago(now - link.last_data, words)),
        (words("Sentences"), words("{count}, {rejected} rejected", count=link.sentences, rejected=link.rejected)),
        (words("Fixes"), _fixes(link.fixes, snapshot.fix_interval, words)),
        (words("Receiver grid"), _grid(snapshot, words)),
        (words("Corrections"), ABSENT if correction is None else words("{age} old", age=age_words(correction, words))),
        (words("Filter"), snapshot.filter_name or ABSENT),
        (words("Uncertainty"), _uncertainty(snapshot, units, words)),
        (words("Offsets"), _offsets(snapshot, units, words)),
    )
    return InfoView(state, level, rows)


def _ago(seconds: float, words: Words) -> str:
    return words("{age} ago", age=age_words(max(seconds, 0.0), words))


def _fixes(count: int, interval: float | None, words: Words) -> str:
    if interval is None:
        return f"{count}"
    return words("{count}, every {interval} s", count=count, interval=words.digits(f"{interval:.2g}"))


def _grid(snapshot: Snapshot, words: Words) -> str:
    """The receiver's rounding; metric always, because it is a matter of decimals."""
    cell = snapshot.fix.cell if snapshot.fix is not None else None
    if cell is None:
        return ABSENT
    north, east = (_fine(side, words) for side in cell)
    return words("{north} north, {east} east", north=north, east=east)


def _fine(metres: float, words: Words) -> str:
    """A length from tenths of a millimetre up, two digits."""
    for unit, size in (("m", 1.0), ("cm", 0.01), ("mm", 0.001)):
        if metres >= 0.995 * size:
            return f"{words.digits(f'{metres / size:.2g}')} {unit}"
    return f"{words.digits(f'{metres / 0.001:.2g}')} mm"


def _uncertainty(snapshot: Snapshot, units: Units, words: Words) -> str:
    covariance = snapshot.pose.covariance if snapshot.pose is not None else None
    if covariance is None:
        return ABSENT
    return f"± {offset_text(math.sqrt(max(covariance[0], covariance[2], 0.0)), units, words)}"


OFFSETS: Mapping[OffsetKind, str] = {
    OffsetKind.NUDGE: message("nudge"),
    OffsetKind.SHIFT: message("shift"),
    OffsetKind.LINE_HERE: message("line here"),
    OffsetKind.MARK: message("mark"),
    OffsetKind.INITIALISATION: message("initialisation"),
}


def _offsets(snapshot: Snapshot, units: Units, words: Words) -> str:
    side = rightward(snapshot)
    parts = [
        f"{words(OFFSETS[offset.kind])} {offset_text(math.hypot(offset.east, offset.north), units, words)}"
        if offset.kind in POSITION_OFFSETS
        else f"{words(OFFSETS[offset.kind])} {signed_text(side * offset.metres, units, words)}"
        for offset in snapshot.offsets
    ]
    return ", ".join(parts) or words("none")


# --- replay --------------------------------------------------------------------------------------------------------


def replay_rows(
    position: float, duration: float, speed: float, catching_up: float | None, words: Words
) -> tuple[tuple[str, str], ...]:
    """Where the recording stands."""
    pace = words("{speed:g} × real time", speed=speed) if math.isfinite(speed) else words("as fast as it can")
    place = words("{position} of {duration}", position=clock(position), duration=clock(duration))
    rows = [(words("Position"), place), (words("Pace"), pace)]
    if catching_up is not None:
        rows.append((words("Catching up"), f"{catching_up * 100:.0f} %"))
    return tuple(rows)
