"""The rows that ``evaluate`` gives: what a paper printed, what a peer does, what we do, and the goal."""

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

__all__ = ["Goal", "Row", "as_dicts", "as_table", "at_least", "at_most", "between", "unmet"]


@dataclass(frozen=True, slots=True)
class Goal:
    """Bounds, both inclusive; None is open."""

    low: float | None = None
    high: float | None = None

    def met_by(self, value: float) -> bool:
        """Whether ``value`` is inside, to the digits that are printed."""
        rounded = round(value, 2)
        return (self.low is None or rounded >= self.low) and (self.high is None or rounded <= self.high)

    def __str__(self) -> str:
        """As the table prints it."""
        match self.low, self.high:
            case None, None:
                return ""
            case None, high:
                return f"<= {high:g}"
            case low, None:
                return f">= {low:g}"
            case low, high:
                return f"{low:g} to {high:g}"


def at_most(high: float) -> Goal:
    """A goal that smaller values meet."""
    return Goal(high=high)


def at_least(low: float) -> Goal:
    """A goal that larger values meet."""
    return Goal(low=low)


def between(low: float, high: float) -> Goal:
    """A goal that only values inside meet: a printed number that is to be reproduced."""
    return Goal(low, high)


@dataclass(frozen=True, slots=True)
class Row:
    """One number. ``paper`` is as printed there, ``peer`` another program's on the same data, None where there is none.

    ``note`` says in a few words what a reader would otherwise ask.
    """

    protocol: str
    quantity: str
    unit: str
    ours: float
    paper: float | None = None
    peer: float | None = None
    goal: Goal | None = None
    note: str = ""

    @property
    def met(self) -> bool | None:
        """Whether the goal is reached; None without a goal."""
        return None if self.goal is None else self.goal.met_by(self.ours)


def as_dicts(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """The rows for JSON. ``goal`` is the upper bound where there is one, ``goal_low`` the lower."""
    listed = []
    for row in rows:
        entry = asdict(row)
        goal = entry.pop("goal") or {"low": None, "high": None}
        only_low = goal["high"] is None
        entry["goal"] = goal["low"] if only_low else goal["high"]
        entry["goal_low"] = goal["low"]
        entry["goal_high"] = goal["high"]
        entry["met"] = row.met
        listed.append(entry)
    return listed


def as_table(rows: Iterable[Row]) -> str:
    """The rows as lines of text, a heading for each protocol; a star marks a goal that is not reached."""
    lines: list[str] = []
    protocol = None
    for row in rows:
        if row.protocol != protocol:
            protocol = row.protocol
            lines += ["" if lines else None, protocol, _line("", "unit", "paper", "peer", "ours", "goal")]  # type: ignore[list-item]  # None is dropped below
        mark = "*" if row.met is False else " "
        numbers = (_number(row.paper), _number(row.peer), _number(row.ours) + mark, str(row.goal or ""))
        line = _line(row.quantity, row.unit, *numbers)
        lines.append(f"{line}  {row.note}".rstrip())
    return "\n".join(line for line in lines if line is not None)


def unmet(rows: Iterable[Row]) -> list[Row]:
    """The rows whose goal is not reached."""
    return [row for row in rows if row.met is False]


def _line(quantity: str, unit: str, paper: str, peer: str, ours: str, goal: str) -> str:
    return f"  {quantity:<52}{unit:>6}{paper:>9}{peer:>9}{ours:>10}  {goal:<14}".rstrip()


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.2f}"
