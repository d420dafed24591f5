"""A table of plans to choose from: every method, in several directions, begun at every corner.

It is a generator: whoever draws it shows each row as it comes, and stops the search by asking for no more.
"""

import itertools
import math
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from shapely import Polygon

from guidance_app.documents import Direction, Method
from guidance_app.guidance.planning import Groundwork, groundwork_of, plan_on
from guidance_app.guidance.request import PlanError, PlanRequest, StartCorner
from guidance_app.model import Plan

__all__ = ["CORNERS", "METHODS", "PreviewRow", "best_of", "preview"]

METHODS = (Method.ROUND_TRIP, Method.TRANSFER, Method.INTERMEDIATE_DIVISION, Method.SURROUNDING)

CORNERS: tuple[StartCorner, ...] = ("first-left", "first-right", "last-left", "last-right")

SAME_HEADING = math.radians(0.1)
"""Directions nearer to each other are one, whichever way round."""


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
) -> Generator[PreviewRow]:
    """A row for each method, direction and start corner; the request's own options go with its own method only.

    Directions are the request's, the longest edge and the best; those that come to the same heading are one. Laps begin
    at no corner, so the surrounding method has a single row.
    """
    directions = dict.fromkeys((request.direction, Direction.LONGEST_EDGE, Direction.BEST))
    passes = replace(request, method=Method.ROUND_TRIP, options={})
    laid = [(direction, _laid(polygon, replace(passes, direction=direction))) for direction in directions]
    grounds = list(_distinct(laid))
    wishes = list(_wishes(polygon, request, (methods, corners), grounds))
    for number, (wish, ground) in enumerate(wishes, start=1):
        plan, reason = _planned(ground(), wish)
        yield PreviewRow(number, len(wishes), wish, plan, reason)


def best_of(rows: Iterable[PreviewRow]) -> PreviewRow | None:
    """The row with the fewest turns that do not fit, and of these the quickest; None where nothing could be planned."""
    planned = [(row, row.plan.costs) for row in rows if row.plan is not None]
    if not planned:
        return None
    return min(planned, key=lambda each: (each[0].unfit, each[1].minutes))[0]


_Ground = Groundwork | PlanError


def _distinct(grounds: Sequence[tuple[Direction, _Ground]]) -> Iterator[tuple[Direction, _Ground]]:
    """Without a direction that comes to the heading of one before."""
    headings: list[float] = []
    for direction, ground in grounds:
        if isinstance(ground, Groundwork):
            heading = ground.layout.heading
            if any(abs(math.sin(heading - one)) < SAME_HEADING for one in headings):
                continue
            headings.append(heading)
        yield direction, ground


def _wishes(
    polygon: Polygon,
    request: PlanRequest,
    choices: tuple[Sequence[Method], Sequence[StartCorner]],
    grounds: Sequence[tuple[Direction, _Ground]],
) -> Iterator[tuple[PlanRequest, Callable[[], _Ground]]]:
    """What is to be planned, and on which ground; that of laps is laid out when its row comes."""
    methods, corners = choices
    for method in methods:
        own = replace(request, method=method, options=request.options if method is request.method else {})
        if method is Method.SURROUNDING:
            yield own, partial(_laid, polygon, own)
            continue
        for (direction, ground), corner in itertools.product(grounds, corners):
            yield replace(own, direction=direction, start_corner=corner), partial(_same, ground)


def _same(ground: _Ground) -> _Ground:
    return ground


def _laid(polygon: Polygon, wish: PlanRequest) -> _Ground:
    try:
        return groundwork_of(polygon, wish)
    except PlanError as error:
        return error


def _planned(ground: _Ground, wish: PlanRequest) -> tuple[Plan | None, str]:
    if isinstance(ground, PlanError):
        return None, str(ground)
    try:
        return plan_on(ground, wish), ""
    except PlanError as error:
        return None, str(error)
