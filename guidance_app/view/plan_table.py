"""What the table of plans says: one row a plan, in the driver's language and units. Pure."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from guidance_app.documents import Direction, Method, Units
from guidance_app.guidance.preview import PreviewRow, best_of
from guidance_app.language import Words, message
from guidance_app.view.units import area_text, distance_text

__all__ = ["CORNERS", "HEADINGS", "METHODS", "PlanRow", "plan_rows"]

METHODS = {
    Method.ROUND_TRIP: message("Round trip"),
    Method.TRANSFER: message("Transfer"),
    Method.INTERMEDIATE_DIVISION: message("Intermediate division"),
    Method.SURROUNDING: message("Surrounding"),
    Method.LINE: message("Along a line"),
}
CORNERS = {
    "nearest": message("nearest corner"),
    "first-left": message("first side, left"),
    "first-right": message("first side, right"),
    "last-left": message("last side, left"),
    "last-right": message("last side, right"),
}
HEADINGS = {
    Direction.BEST: message("best"),
    Direction.LONGEST_EDGE: message("longest edge"),
    Direction.TYPED: message("typed"),
    Direction.LINE: message("line"),
    Direction.EDGE: message("tapped edge"),
}


@dataclass(frozen=True, slots=True)
class PlanRow:
    """One row, with an upper and a lower text in each cell.

    They are minutes, the way worked over the empty one, turns over tight ones, and what is worked twice over what is
    missed; a failure has no cells. ``unfit`` counts turns that do not fit.
    """

    number: int
    title: str
    where: str
    cells: tuple[tuple[str, str], ...]
    unfit: int = 0
    best: bool = False
    reason: str = ""


def plan_rows(rows: Sequence[PreviewRow], units: Units, words: Words) -> tuple[PlanRow, ...]:
    """The rows in the order in which they were planned, the best one marked."""
    best = best_of(rows)
    return tuple(_row(row, units, words, best=row is best) for row in rows)


def _row(row: PreviewRow, units: Units, words: Words, *, best: bool) -> PlanRow:
    title = words(METHODS[row.request.method])
    if row.plan is None:
        return PlanRow(row.number, title, words(HEADINGS[row.request.direction]), (), reason=row.reason)
    costs = row.plan.costs
    twice = words("{percent} %", percent=words.number(100 * costs.overlap_fraction, 1))
    cells = (
        (words.number(costs.minutes), ""),
        (distance_text(costs.work_m, units, words), distance_text(costs.idle_m, units, words)),
        (str(costs.turns), str(costs.tight_turns)),
        (twice, area_text(costs.missed_m2, units, words)),
    )
    return PlanRow(row.number, title, _where(row, words), cells, row.unfit, best)


def _where(row: PreviewRow, words: Words) -> str:
    if row.request.method is Method.SURROUNDING or row.plan is None:
        return words("in laps")
    return words(
        "{degrees}° ({direction}), {corner}",
        degrees=round(math.degrees(row.plan.direction)) % 360,
        direction=words(HEADINGS[row.request.direction]),
        corner=words(CORNERS[row.request.start_corner]),
    )
