"""The receiver's clock: a second of the day becomes a time that runs on over midnight, and with a date UTC.

``t`` counts seconds since midnight UTC of the day the stream began. A second of the day is placed at most one hour
before and less than 23 hours after the last time that was believed, so a night's pause is fourteen hours and not ten
hours back. A date may change what UTC says, never ``t``: a week rollover or the garbage that receivers send before
their first fix does not break a track. A date that contradicts the one in force counts when it is said again.
"""

import math

__all__ = ["DayClock"]

SECONDS_PER_DAY = 86400.0
LATEST_BACK = 3600.0
"""A time of day up to this much before the last one is a step back; more is the next day."""

SAME_DATE = 1.0
"""Two dates agree when they put UTC within this many seconds: fixes lag their sentences by less, days are longer."""


class DayClock:
    """Remembers the last believed time and what the date is."""

    __slots__ = ("_doubted", "_offset", "last")

    def __init__(self) -> None:
        self.last: float | None = None
        self._offset: float | None = None
        self._doubted: float | None = None

    def fork(self) -> "DayClock":
        """An independent copy."""
        copy = DayClock()
        copy.last, copy._offset, copy._doubted = self.last, self._offset, self._doubted
        return copy

    def stamp(self, second_of_day: float) -> float:
        """The continuous time of a second of the day."""
        if self.last is None:
            return second_of_day
        end = self.last + SECONDS_PER_DAY - LATEST_BACK
        return second_of_day + SECONDS_PER_DAY * (math.ceil((end - second_of_day) / SECONDS_PER_DAY) - 1)

    def believe(self, t: float) -> None:
        """Takes ``t`` as the stream's present."""
        self.last = t

    def tell_date(self, days: int, second_of_day: float) -> None:
        """A sentence has said the date, in days since 1970, at this second of it."""
        offset = days * SECONDS_PER_DAY + second_of_day - self.stamp(second_of_day)
        known = self._offset
        if known is None or abs(offset - known) < SAME_DATE:
            self._offset, self._doubted = offset if known is None else known, None
        elif self._doubted is not None and abs(offset - self._doubted) < SAME_DATE:
            self._offset, self._doubted = offset, None
        else:
            self._doubted = offset

    def utc(self, t: float) -> float | None:
        """POSIX time of ``t``; None until a date was said."""
        return None if self._offset is None else t + self._offset
