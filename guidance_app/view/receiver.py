"""The receiver's page in words and figures: link, fix, grid, what it sends, and where its satellites stand. Pure."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from guidance_app.decode.nmea import SENTENCES
from guidance_app.language import Words
from guidance_app.model import ATTITUDE, CORRECTIONS, LinkState, LinkStatus, Satellite, Snapshot
from guidance_app.view.bar_states import QUALITIES
from guidance_app.view.links import sensor_words
from guidance_app.view.status import ABSENT, Level, age_words, link_words

__all__ = [
    "ReceiverView",
    "SkyDot",
    "caster_words",
    "grid_words",
    "raw_text",
    "receiver_view",
    "sent_words",
    "sky_dots",
    "sky_words",
]

COARSE, FINE = 0.03, 0.003
"""Metres of rounding: from the first on a driver sees it jump, below the second it is lost in the noise."""

STRONG, WEAK = 40.0, 30.0
"""dB-Hz: an open sky gives more than the first, a tree line less than the second."""

SYSTEMS: Mapping[str, str] = {"GP": "G", "GL": "R", "GA": "E", "GB": "C", "BD": "C", "GQ": "J", "QZ": "J", "GI": "I"}
"""Talker -> the letter that RINEX gives its system; others are shown by their talker."""

FIRST_SBAS, LAST_SBAS = 33, 64
"""Numbers that a GPS talker uses for the satellites of WAAS, EGNOS and MSAS."""

SPARSE_S = 15.0
"""Casters send something every second, at least the reference position every ten."""

MOST_KINDS = 14
_SEVERAL = ("PTNL", "PSXN", "PASHR", "UNIHEADINGA")


@dataclass(frozen=True, slots=True)
class SkyDot:
    """One satellite on a round sky: ``x`` right, ``y`` down, in radii from its middle, where the zenith is.

    ``level`` is good, fair or bad by the signal, off when it is not tracked.
    """

    x: float
    y: float
    label: str
    level: Level


@dataclass(frozen=True, slots=True)
class ReceiverView:
    """What the page says: the link, what to know of the grid, rows of (name, value), and the sky."""

    link: str
    link_level: Level
    grid: str
    rows: tuple[tuple[str, str], ...]
    sky: tuple[SkyDot, ...]
    sky_words: str


def receiver_view(snapshot: Snapshot, rate: float, now: float, words: Words) -> ReceiverView:
    """Everything but the raw stream. ``rate`` is in bytes a second."""
    link, level = link_words(snapshot.link, now, words)
    fix = snapshot.fix
    return ReceiverView(
        link=link,
        link_level=level,
        grid="" if fix is None or fix.cell is None else grid_words(fix.cell, words),
        rows=(*_fix_rows(snapshot, now, words), *_link_rows(snapshot, rate, now, words)),
        sky=sky_dots(snapshot.sky),
        sky_words=sky_words(snapshot.sky, words) if snapshot.link.sentences else "",
    )


def _fix_rows(snapshot: Snapshot, now: float, words: Words) -> tuple[tuple[str, str], ...]:
    fix = snapshot.fix
    if fix is None:
        return ((words("Fix"), ABSENT),)
    interval = snapshot.fix_interval
    age = age_words(max(now - fix.arrival, 0.0), words)
    satellites = ABSENT if fix.satellites is None else f"{fix.satellites}"
    corrections = ABSENT
    if fix.correction_age is not None:
        corrections = words("{age} old", age=age_words(fix.correction_age, words))
    return (
        (words("Fix"), f"{words(QUALITIES[fix.quality])} · {words('{age} old', age=age)}"),
        (words("Rate"), ABSENT if not interval else f"{words.digits(f'{1 / interval:.3g}')} Hz"),
        (words("Satellites used"), satellites),
        ("HDOP", ABSENT if fix.hdop is None else words.number(fix.hdop, 1)),
        (words("Corrections"), corrections),
    )


def caster_words(state: LinkState, received: int, age: float | None, words: Words) -> tuple[str, Level]:
    """What comes from the caster: ``received`` bytes in this drive, the newest ``age`` seconds ago."""
    if state.status is LinkStatus.DOWN:
        return words("No corrections: {reason}", reason=words.say(state.reason)), "bad"
    if state.status is not LinkStatus.CORRECTED:
        return words("connecting"), "fair"
    if age is None:
        return words("{what} is connected and has sent nothing yet.", what=state.what), "fair"
    size = f"{words.number(received / 1000, 1)} kB"
    said = words(
        "{what}: {size} received, the newest {age} ago.", what=state.what, size=size, age=age_words(age, words)
    )
    return said, "good" if age < SPARSE_S else "fair"


def _link_rows(snapshot: Snapshot, rate: float, now: float, words: Words) -> tuple[tuple[str, str], ...]:
    link = snapshot.link
    data = ABSENT
    if link.last_data is not None:
        age = words("{age} old", age=age_words(max(now - link.last_data, 0.0), words))
        data = f"{words.number(rate / 1000, 1)} kB/s · {age}"
    rows = [
        (words("Source"), link.what or ABSENT),
        (words("Data"), data),
        (words("Sentences"), words("{count}, {rejected} rejected", count=link.sentences, rejected=link.rejected)),
    ]
    sensor = snapshot.links_beside.get(ATTITUDE)
    if sensor is not None:
        rows.append((words("Attitude sensor"), sensor_words(sensor, now, words)))
    caster = snapshot.links_beside.get(CORRECTIONS)
    if caster is not None:
        connected = caster.status is LinkStatus.CORRECTED
        rows.append((words("Caster"), caster.what if connected else words.say(caster.reason)))
    return tuple(rows)


# --- grid ----------------------------------------------------------------------------------------------------------


def grid_words(cell: tuple[float, float], words: Words) -> str:
    """What the receiver's rounding (north, east) in metres means for guidance."""
    size = words("{north} × {east}", north=_length(cell[0], words), east=_length(cell[1], words))
    if max(cell) >= COARSE:
        return words("This receiver rounds to {size}: the adaptive filter is worth it.", size=size)
    if max(cell) >= FINE:
        return words("This receiver rounds to {size}: fine enough to steer by, and the filter calms it.", size=size)
    return words("This receiver rounds to {size}: its rounding does not matter.", size=size)


def _length(metres: float, words: Words) -> str:
    unit, size = next(((unit, size) for unit, size in (("m", 1.0), ("cm", 0.01)) if metres >= size), ("mm", 0.001))
    return f"{words.digits(f'{metres / size:.2g}')} {unit}"


# --- sky -----------------------------------------------------------------------------------------------------------


def sky_dots(satellites: Sequence[Satellite]) -> tuple[SkyDot, ...]:
    """Those whose place is known, the tracked ones last so that they are drawn over the others."""
    dots = []
    for one in satellites:
        if one.elevation is None or one.azimuth is None or one.elevation < 0:
            continue
        radius = 1.0 - one.elevation / (math.pi / 2)
        x, y = radius * math.sin(one.azimuth), -radius * math.cos(one.azimuth)
        dots.append(SkyDot(x, y, _label(one), _level(one.signal)))
    return tuple(sorted(dots, key=lambda dot: dot.level != "off"))


def _label(one: Satellite) -> str:
    if one.system == "GP" and FIRST_SBAS <= one.number <= LAST_SBAS:
        return f"S{one.number + 87}"
    return f"{SYSTEMS.get(one.system, one.system)}{one.number:02d}"


def _level(signal: float | None) -> Level:
    if not signal:
        return "off"
    if signal >= STRONG:
        return "good"
    return "fair" if signal >= WEAK else "bad"


def sky_words(satellites: Sequence[Satellite], words: Words) -> str:
    """How many satellites there are, how many are tracked, and the strongest."""
    if not satellites:
        return words("The receiver does not say where its satellites are (no GSV sentences).")
    signals = [one.signal for one in satellites if one.signal]
    if not signals:
        n = len(satellites)
        return words.plural("{n} satellite in view, none tracked", "{n} satellites in view, none tracked", n)
    return words(
        "{tracked} of {count} satellites tracked, the strongest with {signal:.0f} dB-Hz",
        tracked=len(signals),
        count=len(satellites),
        signal=max(signals),
    )


# --- what it sends -------------------------------------------------------------------------------------------------


def sent_words(kinds: Mapping[str, int], words: Words) -> tuple[tuple[str, str], ...]:
    """Rows of a sentence's name and how often it came; those that are not read are marked."""
    rows = [
        (name, f"{count}" if _is_read(name) else words("{count} (not used)", count=count))
        for name, count in list(kinds.items())[:MOST_KINDS]
    ]
    if len(kinds) > MOST_KINDS:
        rows.append((words("others"), f"{sum(list(kinds.values())[MOST_KINDS:])}"))
    return tuple(rows)


def _is_read(name: str) -> bool:
    return name in SENTENCES or name in _SEVERAL or (len(name) == 5 and name[2:] in SENTENCES)


def raw_text(lines: Sequence[bytes], most: int) -> str:
    r"""The last lines as they came; what is no printable character is written as ``\x80``."""
    return "\n".join(
        "".join(chr(byte) if 0x20 <= byte < 0x7F else f"\\x{byte:02x}" for byte in line) for line in lines[-most:]
    )
