"""A filter of the table that begins anew when the receiver's clock has been set back.

A filter ignores an epoch that is older than its last one, as a stray sentence is. The decoder lets time go back only
when several epochs agree on it: then the receiver has found out what time it is, and a filter that waited for the old
time to come again would stand still until then.
"""

from guidance_app.estimation.filter import Filter, FilterSettings, Start
from guidance_app.estimation.filters import make_filter
from guidance_app.model import Measurement, Pose

__all__ = ["RestartingFilter"]


class RestartingFilter:
    """The filter of this name, for measurements whose order has been judged. Raises ``ValueError`` for another name."""

    def __init__(self, name: str, settings: FilterSettings | None) -> None:
        self._name = name
        self._settings = settings
        self._start: Start | None = None
        self._t = float("-inf")
        self._filter: Filter = make_filter(name, settings)

    def step(self, z: Measurement) -> Pose | None:
        """The filter's pose; where time has gone back, that of a new one which knows the same start."""
        if z.t < self._t:
            self._filter = make_filter(self._name, self._settings)
            if self._start is not None:
                self._filter.begin(self._start)
        self._t = z.t
        return self._filter.step(z)

    def begin(self, start: Start) -> None:
        """Passed on, and kept for the next beginning."""
        self._start = start
        self._filter.begin(start)

    def fork(self) -> "RestartingFilter":
        """An independent copy."""
        other = RestartingFilter.__new__(RestartingFilter)
        vars(other).update(vars(self), _filter=self._filter.fork())
        return other
