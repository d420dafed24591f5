"""The entries of a ledger of several drives: of a day, a time, a field."""

import datetime
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from guidance_app.batch.reviewing import additions_of, entry_of, opened_review
from guidance_app.reports import LedgerEntry
from guidance_app.store import StoreError
from guidance_app.store.recordings_list import ListedRecording

__all__ = ["Choice", "Gathered", "day_of", "ledger_entries"]


@dataclass(frozen=True, slots=True)
class Choice:
    """Which drives: from ``first`` to ``last`` day, both included, on ``field``; None is any.

    A drive's day is the one that stands in the list: when it began by this machine's clock, in its time zone.
    """

    first: datetime.date | None = None
    last: datetime.date | None = None
    field: str | None = None

    def takes(self, listed: ListedRecording) -> bool:
        """Whether this recording is among them. One without a time is not, where days are asked for."""
        summary = listed.summary
        if summary is None or listed.being_written or self.field not in (None, summary.field):
            return False
        if self.first is None and self.last is None:
            return True
        day = day_of(listed)
        if day is None:
            return False
        return (self.first is None or day >= self.first) and (self.last is None or day <= self.last)


@dataclass(frozen=True, slots=True, eq=False)
class Gathered:
    """The entries by their time, and a sentence for each recording that could not be opened."""

    entries: tuple[LedgerEntry, ...]
    left_out: tuple[str, ...]

    @property
    def worked(self) -> float:
        """In all, m2."""
        return sum(one.worked for one in self.entries)


def day_of(listed: ListedRecording) -> datetime.date | None:
    """The day in this machine's time zone on which a recording began; None where its time is none."""
    if listed.summary is None:
        return None
    try:
        return datetime.datetime.fromisoformat(listed.summary.started_utc).astimezone().date()
    except ValueError:
        return None


def ledger_entries(
    paths: Sequence[Path],
    data: Path,
    progress: Callable[[int, float], None] | None = None,
) -> Gathered:
    """What was done in these recordings. ``progress`` hears which one it is at, and how far."""
    entries: list[LedgerEntry] = []
    left_out: list[str] = []
    for number, path in enumerate(paths):
        told = None if progress is None else _of_one(progress, number)
        try:
            additions = additions_of(path) if path.is_dir() else None
            entries.append(entry_of(opened_review(path, data, told), additions))
        except StoreError as error:
            left_out.append(error.args[0])
    entries.sort(key=lambda one: (math.inf if one.start is None else one.start.timestamp(), one.name))
    return Gathered(tuple(entries), tuple(left_out))


def _of_one(progress: Callable[[int, float], None], number: int) -> Callable[[float], None]:
    return lambda done: progress(number, done)
