"""The words of the position panel: every offset in force, the measuring time, and the roll sensor's zero."""

import math
from dataclasses import dataclass

from guidance_app.documents import Units
from guidance_app.language import Words
from guidance_app.model import (
    POSITION_OFFSETS,
    ApplyRollZero,
    BeginRollZero,
    Command,
    FinishRollZero,
    NextRollZeroDrive,
    OffsetKind,
    OffsetRecord,
    RollZeroFound,
    RollZeroStage,
    Snapshot,
)
from guidance_app.view.status import OFFSETS, age_words, signed_text
from guidance_app.view.units import distance_text, offset_text

__all__ = ["RollZeroView", "measured_words", "measuring_words", "offset_words", "offsets_in_force", "roll_zero_view"]


def offsets_in_force(snapshot: Snapshot, now: float, units: Units, words: Words) -> dict[OffsetKind, str]:
    """What each offset in force is, how large, and how old."""
    return {one.kind: offset_words(one, now, units, words) for one in snapshot.offsets}


def offset_words(offset: OffsetRecord, now: float, units: Units, words: Words) -> str:
    """``mark 1.24 m, 2 min ago``."""
    if offset.kind in POSITION_OFFSETS:
        size = offset_text(math.hypot(offset.east, offset.north), units, words)
    else:
        size = signed_text(offset.metres, units, words)
    since = age_words(max(now - offset.arrival, 0.0), words)
    return words("{offset} {size}, {since} ago", offset=words(OFFSETS[offset.kind]), size=size, since=since)


def measuring_words(snapshot: Snapshot, words: Words) -> str:
    """How far the measuring time is, or why it has begun again; empty when nothing is measured."""
    progress = snapshot.initialising
    if progress is None:
        return ""
    if progress.refused is not None:
        return words("Measuring again: {reason}.", reason=words.say(progress.refused))
    percent = round(100 * progress.done)
    return words("Stand still: {percent} %, {samples} fixes", percent=percent, samples=progress.samples)


def measured_words(snapshot: Snapshot, units: Units, words: Words) -> tuple[tuple[str, str], ...]:
    """What the last measuring time has found, as rows of (name, value)."""
    found = snapshot.initialised
    if found is None:
        return ()
    rows = [
        (words("Measured"), words("{samples} fixes in {seconds:.0f} s", samples=found.samples, seconds=found.seconds)),
        (words("Scatter of the fixes"), f"± {offset_text(math.hypot(*found.scatter), units, words)}"),
    ]
    if found.east is not None and found.north is not None:
        moved = offset_text(math.hypot(found.east, found.north), units, words)
        rows.insert(1, (words("Position moved by"), moved))
    if found.gyro_bias is not None:
        bias = words.number(math.degrees(found.gyro_bias), 2)
        rows.append((words("Gyro bias"), words("{bias} °/s", bias=bias)))
    return tuple(rows)


@dataclass(frozen=True, slots=True)
class RollZeroView:
    """What the calibration says, and what its button does next."""

    said: str
    press: str
    command: Command
    under_way: bool


def roll_zero_view(snapshot: Snapshot, units: Units, words: Words) -> RollZeroView:
    """The next step of the calibration."""
    progress = snapshot.roll_zero
    if progress is None:
        said = words(
            "Roll zero {degrees}°. To find it, drive a straight line of 30 m or more, and the same line back.",
            degrees=words.number(snapshot.roll_zero_deg, 2),
        )
        return RollZeroView(said, words("Begin the first drive"), BeginRollZero(), under_way=False)
    match progress.stage:
        case RollZeroStage.THERE:
            said = words("First drive: {metres}. Drive straight.", metres=distance_text(progress.there, units, words))
            return RollZeroView(said, words("Now the way back"), NextRollZeroDrive(), under_way=True)
        case RollZeroStage.BACK:
            driven = distance_text(progress.back, units, words)
            said = words("Way back: {metres}. Drive in the same wheel tracks.", metres=driven)
            return RollZeroView(said, words("Compare both drives"), FinishRollZero(), under_way=True)
        case RollZeroStage.FOUND:
            return _found(progress.found, units, words)


def _found(found: RollZeroFound | None, units: Units, words: Words) -> RollZeroView:
    assert found is not None, "the last stage has a result"
    said = words(
        "Found over {metres}: {degrees}°, sure to ± {sigma}°; {change}° from the zero in use.",
        metres=distance_text(found.metres, units, words),
        degrees=words.number(found.roll_zero_deg, 2),
        sigma=words.number(found.sigma_deg, 2),
        change=words.digits(f"{found.correction_deg:+.2f}"),
    )
    return RollZeroView(said, words("Use it"), ApplyRollZero(), under_way=True)
