"""The order in which bundles of passes are worked, and at which of its corners each is entered."""

import itertools
import math
from collections.abc import Sequence

from guidance_app.guidance.bundle import Run
from guidance_app.guidance.request import PlanRequest
from guidance_app.model import FloatArray

__all__ = ["preferred", "route"]

MOST_EXACT = 5
"""Bundles up to which every order is compared; with more the nearest is taken next."""

FIRSTS = 6
"""First runs from which a route is built when there are too many bundles to compare all orders."""

_Place = tuple[float, float] | None


def route(choices: Sequence[Sequence[Run]], request: PlanRequest, start: tuple[float, float] | None) -> list[Run]:
    """One way from each group, from ``start`` towards the request's exit, with little driving between."""
    if not choices:
        return []
    first = preferred(choices, request)
    if len(choices) <= MOST_EXACT:
        return _best_of_all(choices, first, (start, request.exit))
    return _nearest_next(choices, first, (start, request.exit))


def preferred(choices: Sequence[Sequence[Run]], request: PlanRequest) -> list[tuple[int, int]]:
    """The runs with which the work may begin, as (bundle, way); every one when any corner will do."""
    everything = [(cell, way) for cell, ways in enumerate(choices) for way in range(len(ways))]
    if request.start_corner == "nearest":
        return everything
    from_last = request.start_corner.startswith("last")
    along = request.start_corner.endswith("right")
    bundles = [ways[0].bundle for ways in choices]
    rows = {cell: bundle.rows for cell, bundle in enumerate(bundles) if bundle.rows is not None}
    if not rows:
        return everything
    edge = max(rows, key=lambda cell: rows[cell][1]) if from_last else min(rows, key=lambda cell: rows[cell][0])
    wanted = [
        (edge, way)
        for way, run in enumerate(choices[edge])
        if (run.from_last == from_last or len(run.lines) == 1) and run.along == along
    ]
    return wanted or everything


def _best_of_all(
    choices: Sequence[Sequence[Run]], first: Sequence[tuple[int, int]], ends: tuple[_Place, _Place]
) -> list[Run]:
    """The order with the least distance between runs, over all orders (dynamic programming over sets of cells)."""
    states: dict[tuple[int, int, int], tuple[float, tuple[Run, ...]]] = {}
    for cell, way in first:
        run = choices[cell][way]
        states[1 << cell, cell, way] = (_apart(ends[0], run.start) + run.empty, (run,))
    for _ in range(len(choices) - 1):
        states = _extended(states, choices)
    return list(min(states.values(), key=lambda state: state[0] + _apart(ends[1], state[1][-1].end))[1])


def _extended(
    states: dict[tuple[int, int, int], tuple[float, tuple[Run, ...]]], choices: Sequence[Sequence[Run]]
) -> dict[tuple[int, int, int], tuple[float, tuple[Run, ...]]]:
    longer: dict[tuple[int, int, int], tuple[float, tuple[Run, ...]]] = {}
    for (seen, _, _), (cost, runs) in states.items():
        for cell, ways in enumerate(choices):
            if seen >> cell & 1:
                continue
            for way, run in enumerate(ways):
                key = (seen | 1 << cell, cell, way)
                total = cost + _apart(runs[-1].end, run.start) + run.empty
                if key not in longer or total < longer[key][0]:
                    longer[key] = (total, (*runs, run))
    return longer


def _nearest_next(
    choices: Sequence[Sequence[Run]], first: Sequence[tuple[int, int]], ends: tuple[_Place, _Place]
) -> list[Run]:
    """Always the nearest run next, from each of the likeliest first ones; the best of these."""
    likeliest = sorted(first, key=lambda each: _apart(ends[0], choices[each[0]][each[1]].start))[:FIRSTS]
    routes = [_nearest_from(choices, cell, way) for cell, way in likeliest]
    return min(routes, key=lambda route: _empty_way(route, ends))


def _nearest_from(choices: Sequence[Sequence[Run]], cell: int, way: int) -> list[Run]:
    least = [min(run.empty for run in ways) for ways in choices]
    runs = [choices[cell][way]]
    left = set(range(len(choices))) - {cell}
    while left:
        cell, run = min(
            ((cell, run) for cell in left for run in choices[cell]),
            key=lambda each: _apart(runs[-1].end, each[1].start) + each[1].empty - least[each[0]],
        )
        runs.append(run)
        left.remove(cell)
    return runs


def _empty_way(runs: Sequence[Run], ends: tuple[_Place, _Place]) -> float:
    between = sum(_apart(before.end, after.start) for before, after in itertools.pairwise(runs))
    inside = sum(run.empty for run in runs)
    return _apart(ends[0], runs[0].start) + between + inside + _apart(ends[1], runs[-1].end)


def _apart(one: FloatArray | tuple[float, float] | None, other: FloatArray) -> float:
    return 0.0 if one is None else math.hypot(one[0] - other[0], one[1] - other[1])
