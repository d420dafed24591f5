"""From one plan's passes to another's on the same field: what was worked stays worked, a line stays the line it was."""

from collections.abc import Iterable

from guidance_app.guidance.itinerary import GuideLine, Itinerary
from guidance_app.guidance.progress import Progress, Stretches
from guidance_app.guidance.replanning import First

__all__ = ["carried_over", "keys_of", "rest_of"]


def keys_of(itinerary: Itinerary, numbers: Iterable[int]) -> frozenset[int]:
    """The keys of the passes of these numbers."""
    return frozenset(key for number in numbers for key in itinerary.keys(number))


def carried_over(progress: Progress, before: Itinerary, after: Itinerary, done: Iterable[int]) -> Progress:
    """What is worked of the passes of ``after``: those of the numbers ``done``, and stretches of open passes.

    Stretches of a lap are left out: its line may begin elsewhere now.
    """
    carried = Progress(keys_of(after, done))
    for key in progress.open_keys():
        old = before.line(key)
        if old is None or old.target.closed:
            continue
        for number in after.keys(old.target.number):
            new = after.line(number)
            if new is not None:
                _carry(carried, progress.spans(key), old, new)
    return carried


def _carry(carried: Progress, spans: Stretches, old: GuideLine, new: GuideLine) -> None:
    for span in spans:
        ends = [new.polyline.foot(*old.polyline.at(along)).along for along in span]
        low, high = (min(max(end, 0.0), new.polyline.length) for end in sorted(ends))
        if high > low:
            carried.add(new.key, low, high)


def rest_of(line: GuideLine, spans: Stretches, *, against: bool, turned: bool, behind: float) -> First:
    """A pass being worked, as what comes first of the rest; the implement works ``behind`` the guided point.

    ``turned`` by the driver, it was worked the other way until now: its rest ends where that work did.
    A lap worked in several stretches is whole again: its rest is not one line.
    """
    if not spans or (line.target.closed and len(spans) > 1):
        return First(line.target.number, against)
    low, high = spans[0][0], spans[-1][1]
    back = min(behind, high - low)
    place = line.polyline.at(low + back if against != turned else high - back)
    return First(line.target.number, against, *((None, place) if turned else (place,)))
