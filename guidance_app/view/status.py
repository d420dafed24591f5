"""The words and numbers of the panels: how much, how fast, how good, how long. Rounded, with units, or a dash.

Absent is a dash. What ages shows its age. Nothing here decides what to do; it only says what is.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from guidance_app.documents import Units
from guidance_app.model import (
    POSITION_OFFSETS,
    Guidance,
    LinkState,
    LinkStatus,
    OffsetKind,
    OffsetRecord,
    Snapshot,
)
from guidance_app.view.bar import QUALITIES, STALE_AFTER_S
from guidance_app.view.units import INCH, area_text, offset_text, speed_text, speed_unit

__all__ = [
    "ABSENT",
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
    working: bool
    work_words: str
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


def age_words(seconds: float) -> str:
    """An age in whole seconds, minutes from two on; a changing tenth draws the eye and says nothing."""
    if seconds < 1.0:
        return "<1 s"
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"


def _signed(metres: float, units: Units) -> str:
    """A sideways distance with its side in words: "4 cm right"."""
    text = offset_text(metres, units)
    if text.startswith("0 "):
        return text
    return f"{text} {'right' if metres > 0 else 'left'}"


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


def work_view(snapshot: Snapshot, now: float, units: Units) -> WorkView:
    """Everything the head and the work panel say."""
    words, level = fix_words(snapshot, now)
    return WorkView(
        figures=figures(snapshot, units),
        fix=words,
        fix_level=level,
        working=snapshot.working,
        work_words="Working · press to lift" if snapshot.working else "Lifted · press to work",
        pass_words=pass_words(snapshot.guidance),
        line_words=f"Moved {_signed(line_offset(snapshot.offsets), units)}",
        notices=snapshot.notices,
    )


def figures(snapshot: Snapshot, units: Units) -> tuple[Figure, ...]:
    """The numbers always in sight: the drive above, the work below."""
    totals = snapshot.totals
    rate = totals.worked / totals.working_s if totals.working_s >= SHORTEST_WORK else None
    remaining = totals.left / rate if rate and totals.left is not None else None
    speed = ABSENT if snapshot.pose is None else speed_text(snapshot.pose.speed, units)
    return (
        _place_in_order(snapshot.guidance),
        Figure("speed", speed, speed_unit(units)),
        _area("overlap", totals.overlap, units),
        _area("headland", totals.headland, units),
        _area("done", totals.worked, units),
        _area("left", totals.left, units),
        Figure("time left", *_hours(remaining)),
        _area("per hour", None if rate is None else rate * 3600, units),
    )


def _area(name: str, square_metres: float | None, units: Units) -> Figure:
    number, unit = area_text(square_metres or 0.0, units).split(" ")
    return Figure(name, ABSENT if square_metres is None else number, unit)


def _hours(seconds: float | None) -> tuple[str, str]:
    """(number, unit): minutes below 100 of them, hours and minutes from there on."""
    if seconds is None or not math.isfinite(seconds):
        return ABSENT, "min"
    minutes = round(seconds / 60)
    return (f"{minutes}", "min") if minutes < 100 else (f"{minutes // 60}:{minutes % 60:02d}", "h")


def _place_in_order(guidance: Guidance | None) -> Figure:
    if guidance is None:
        return Figure("pass", ABSENT)
    order = guidance.target.order
    if order is None:
        return Figure("line", f"{guidance.target.number}")
    return Figure("pass", f"{order + 1}", "" if guidance.count is None else f"of {guidance.count}")


def pass_words(guidance: Guidance | None) -> str:
    """Which line is guided, by the number painted beside it."""
    if guidance is None:
        return "No line"
    return f"{'Lap' if guidance.target.lap else 'Line'} {guidance.target.number}"


def neighbour(snapshot: Snapshot, step: int) -> int | None:
    """The number of the line beside the target, to the side of ``step``; None without a line or at the last one."""
    if snapshot.guidance is None:
        return None
    at = snapshot.guidance.target.number
    numbers = [line.number for line in snapshot.passes if (line.number - at) * step > 0]
    return min(numbers, key=lambda number: abs(number - at), default=None)


def line_offset(offsets: Iterable[OffsetRecord]) -> float:
    """How far the lines stand from where they were planned, metres to the right."""
    return sum(offset.metres for offset in offsets if offset.kind in LINE_OFFSETS)


# --- fix and link --------------------------------------------------------------------------------------------------

_GOODNESS = {"RTK fixed": GOOD, "no fix": BAD, "dead reckoning": BAD}


def fix_words(snapshot: Snapshot, now: float) -> tuple[str, Level]:
    """The fix's quality with its age, satellites and HDOP, and how good it is; the link's state without a fix."""
    fix = snapshot.fix
    if fix is None or snapshot.link.status not in {LinkStatus.FIX, LinkStatus.ENDED}:
        return link_words(snapshot.link, now)
    quality = QUALITIES[fix.quality]
    age = max(now - fix.arrival, 0.0)
    parts = [quality, age_words(age)]
    if fix.satellites is not None:
        parts.append(f"{fix.satellites} satellites")
    if fix.hdop is not None:
        parts.append(f"HDOP {fix.hdop:.1f}")
    late = age > max(STALE_AFTER_S, 2 * (snapshot.fix_interval or 0.0))
    return " · ".join(parts), BAD if late else _GOODNESS.get(quality, FAIR)


_LINK_WORDS = {
    LinkStatus.CONNECTING: ("Connecting to the receiver", FAIR),
    LinkStatus.NO_DATA: ("The receiver sends nothing", BAD),
    LinkStatus.NO_SENTENCE: ("Data, but no valid sentence", BAD),
    LinkStatus.NO_FIX: ("The receiver has no position", BAD),
    LinkStatus.FIX: ("The receiver gives positions", GOOD),
    LinkStatus.ATTITUDE: ("The sensor gives its attitude", GOOD),
    LinkStatus.CORRECTED: ("Corrections arrive", GOOD),
    LinkStatus.DOWN: ("The receiver is gone", BAD),
    LinkStatus.ENDED: ("The recording has ended", OFF),
}


def link_words(link: LinkState, now: float) -> tuple[str, Level]:
    """The state of the link in words, for how long, and the reason where there is one."""
    words, level = _LINK_WORDS[link.status]
    reason = f": {link.reason}" if link.reason and link.status is not LinkStatus.ENDED else ""
    return f"{words}, for {age_words(max(now - link.since, 0.0))}{reason}", level


def info_view(snapshot: Snapshot, now: float, units: Units) -> InfoView:
    """Everything the info panel says."""
    words, level = link_words(snapshot.link, now)
    fix, link = snapshot.fix, snapshot.link
    correction = fix.correction_age if fix is not None else None
    interval = snapshot.fix_interval
    rows = (
        ("Last data", ABSENT if link.last_data is None else f"{age_words(max(now - link.last_data, 0.0))} ago"),
        ("Sentences", f"{link.sentences}, {link.rejected} rejected"),
        ("Fixes", f"{link.fixes}" if interval is None else f"{link.fixes}, every {interval:.2g} s"),
        ("Receiver grid", _grid(snapshot)),
        ("Corrections", ABSENT if correction is None else f"{age_words(correction)} old"),
        ("Filter", snapshot.filter_name or ABSENT),
        ("Uncertainty", _uncertainty(snapshot, units)),
        ("Offsets", _offsets(snapshot.offsets, units)),
    )
    return InfoView(words, level, rows)


def _grid(snapshot: Snapshot) -> str:
    """The receiver's rounding; metric always, because it is a matter of decimals."""
    cell = snapshot.fix.cell if snapshot.fix is not None else None
    if cell is None:
        return ABSENT
    north, east = (_fine(side) for side in cell)
    return f"{north} north, {east} east"


def _fine(metres: float) -> str:
    """A length from tenths of a millimetre up, two digits."""
    for unit, size in (("m", 1.0), ("cm", 0.01), ("mm", 0.001)):
        if metres >= 0.995 * size:
            return f"{metres / size:.2g} {unit}"
    return f"{metres / 0.001:.2g} mm"


def _uncertainty(snapshot: Snapshot, units: Units) -> str:
    covariance = snapshot.pose.covariance if snapshot.pose is not None else None
    if covariance is None:
        return ABSENT
    return f"± {offset_text(math.sqrt(max(covariance[0], covariance[2], 0.0)), units)}"


def _offsets(offsets: Iterable[OffsetRecord], units: Units) -> str:
    words = [
        f"{offset.kind.value} {offset_text(math.hypot(offset.east, offset.north), units)}"
        if offset.kind in POSITION_OFFSETS
        else f"{offset.kind.value} {_signed(offset.metres, units)}"
        for offset in offsets
    ]
    return ", ".join(words) or "none"


# --- replay --------------------------------------------------------------------------------------------------------


def replay_rows(
    position: float, duration: float, speed: float, catching_up: float | None
) -> tuple[tuple[str, str], ...]:
    """Where the recording stands."""
    pace = "as fast as it can" if math.isinf(speed) else f"{speed:g} × real time"
    rows = [("Position", f"{clock(position)} of {clock(duration)}"), ("Pace", pace)]
    if catching_up is not None:
        rows.append(("Catching up", f"{catching_up * 100:.0f} %"))
    return tuple(rows)
