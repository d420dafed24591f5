"""A table of plans to choose from: every method, in several directions, begun at every corner.

It is a generator: whoever draws it shows each row as it comes, and stops the search by asking for no more.
"""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from shapely import Polygon

from guidance_app.documents import Direction, Method
from guidance_app.guidance.planning import Groundwork, groundwork_of, plan_on
from guidance_app.guidance.request import PlanError, PlanRequest, StartCorner
from guidance_app.model import Plan

__all__ = ["CORNERS", "METHODS", "PreviewRow", "best_of", "preview"]

METHODS = (Method.ROUND_TRIP, Method.TRANSFER, Method.INTERMEDIATE_DIVISION, Method.SURROUNDING)

CORNERS: tuple[StartCorner, ...] = ("first-left", "first-right", "last-left", "last-right")


@dataclass(frozen=True, slots=True, eq=False)
class PreviewRow:
    """One plan of the table, the ``number``-th of ``count``; without a plan the reason in a sentence."""

    number: int
    count: int
    request: PlanRequest
    plan: Plan | None
    reason: str = ""

    @property
    def unfit(self) -> int:
        """Turns and transfers that do not fit."""
        if self.plan is None:
            return 0
        return len({each.number for each in self.plan.segments if not each.fits})


def preview(
    polygon: Polygon,
    request: PlanRequest,
    methods: Sequence[Method] = METHODS,
    corners: Sequence[StartCorner] = CORNERS,
) -> Iterator[PreviewRow]:
    """A row for each method, direction and start corner; the request's own options go with its own method only.

    Directions are the request's, the longest edge and the best, each once. Laps begin at no corner, so the surrounding
    method has a single row.
    """
    wishes = list(_wishes(request, methods, corners))
    laid: dict[tuple[Direction, bool], Groundwork | PlanError] = {}
    for number, wish in enumerate(wishes, start=1):
        key = (wish.direction, wish.method is Method.SURROUNDING)
        if key not in laid:
            laid[key] = _laid(polygon, wish)
        plan, reason = _planned(laid[key], wish)
        yield PreviewRow(number, len(wishes), wish, plan, reason)


def best_of(rows: Iterable[PreviewRow]) -> PreviewRow | None:
    """The row with the fewest turns that do not fit, and of these the quickest; None where nothing could be planned."""
    planned = [(row, row.plan.costs) for row in rows if row.plan is not None]
    if not planned:
        return None
    return min(planned, key=lambda each: (each[0].unfit, each[1].minutes))[0]


def _wishes(request: PlanRequest, methods: Sequence[Method], corners: Sequence[StartCorner]) -> Iterator[PlanRequest]:
    directions = dict.fromkeys((request.direction, Direction.LONGEST_EDGE, Direction.BEST))
    for method in methods:
        own = replace(request, method=method, options=request.options if method is request.method else {})
        if method is Method.SURROUNDING:
            yield own
            continue
        for direction, corner in itertools.product(directions, corners):
            yield replace(own, direction=direction, start_corner=corner)


def _laid(polygon: Polygon, wish: PlanRequest) -> Groundwork | PlanError:
    try:
        return groundwork_of(polygon, wish)
    except PlanError as error:
        return error


def _planned(ground: Groundwork | PlanError, wish: PlanRequest) -> tuple[Plan | None, str]:
    if isinstance(ground, PlanError):
        return None, str(ground)
    try:
        return plan_on(ground, wish), ""
    except PlanError as error:
        return None, str(error)
