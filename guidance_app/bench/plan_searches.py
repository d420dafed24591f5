"""How planning grows, how well the best direction is found, how fast the rest is planned again, and odd fields."""

import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
import shapely

from guidance_app.bench.plan_counter import counter_row
from guidance_app.bench.rows import Row
from guidance_app.documents import Direction
from guidance_app.guidance.cells import cut, strips_over
from guidance_app.guidance.direction import best_heading
from guidance_app.guidance.ground import ground_of
from guidance_app.guidance.headland import headland_of
from guidance_app.guidance.planning import PlanError, PlanRequest, plan_operation
from guidance_app.guidance.replanning import Standing, replan
from guidance_app.guidance.request import LastPass
from guidance_app.model import Plan, SegmentKind

__all__ = ["ODD_FIELDS", "search_rows"]

HEADINGS = np.radians(np.arange(0.0, 180.0, 0.5))
PASSES = 300
SMALL, LARGE = 500.0, 2000.0
"""Sides in metres of the squares between which growth is measured: sixteen times the area."""

ODD_FIELDS: dict[str, tuple[shapely.Polygon, PlanRequest]] = {
    "wider than the field": (shapely.box(0, 0, 30, 20), PlanRequest(width=24.0)),
    "narrow": (shapely.box(0, 0, 12, 160), PlanRequest(width=3.0, radius=5.0)),
    "no mainland": (shapely.box(0, 0, 60, 60), PlanRequest(width=6.0, laps=12)),
    "radius larger than the field": (shapely.box(0, 0, 40, 60), PlanRequest(width=3.0, radius=80.0)),
    "start outside": (shapely.box(0, 0, 100, 80), PlanRequest(width=6.0, start=(-50.0, -50.0))),
    "two parts": (
        shapely.Polygon([(0, 0), (60, 0), (60, 60), (60.01, 60), (120, 60), (120, 120), (60, 120), (60, 60), (0, 60)]),
        PlanRequest(width=6.0),
    ),
    "sliver": (shapely.Polygon([(0, 0), (300, 0), (300, 0.5)]), PlanRequest(width=6.0)),
    "hole at the border": (
        shapely.Polygon([(0, 0), (120, 0), (120, 90), (0, 90)], [[(0, 30), (30, 30), (30, 60), (0, 60)]]),
        PlanRequest(width=6.0),
    ),
    "duplicate points": (
        shapely.Polygon([(0, 0), (0, 0), (90, 0), (90, 0), (90, 70), (90, 70), (0, 70)]),
        PlanRequest(width=6.0),
    ),
    "10,000 vertices": (
        shapely.Polygon(
            [(150 * np.cos(angle), 120 * np.sin(angle)) for angle in np.linspace(0, 2 * np.pi, 10_000, endpoint=False)]
        ),
        PlanRequest(width=6.0),
    ),
}


def search_rows(fields: Sequence[tuple[str, shapely.Polygon]]) -> Iterator[Row]:
    """The rows that are not one field's plan at one width."""
    yield from _growth_rows()
    yield from _direction_rows(fields)
    yield _replanning_row()
    middling = sorted(fields, key=lambda field: field[1].area)[len(fields) // 2]
    yield counter_row(*middling)
    answered = sum(_answered(*odd) for odd in ODD_FIELDS.values())
    yield Row("plan", "odd fields with a plan or a sentence", answered, f"of {len(ODD_FIELDS)}", str(len(ODD_FIELDS)))


def _growth_rows() -> Iterator[Row]:
    small, large = (shapely.box(0, 0, side, side) for side in (SMALL, LARGE))
    request = PlanRequest(width=6.0)
    seconds = [min(_timed(partial(plan_operation, one, request)) for _ in range(3)) for one in (small, large)]
    count = SMALL / request.width, LARGE / request.width
    allowed = count[1] * np.log(count[1]) / (count[0] * np.log(count[0]))
    yield Row(
        "plan",
        "four times as many passes, CPU",
        seconds[1] / seconds[0],
        "times",
        f"<= {allowed:.1f} (N log N)",
        f"{seconds[0]:.3f} s for {SMALL**2 / 1e4:.0f} ha, {seconds[1]:.3f} s for {LARGE**2 / 1e4:.0f} ha",
    )
    hundred = min(_timed(partial(plan_operation, shapely.box(0, 0, 1000, 1000), request)) for _ in range(3))
    yield Row("plan", "100 ha at 6 m, CPU", hundred, "s", "<= 1")


def _direction_rows(fields: Sequence[tuple[str, shapely.Polygon]]) -> Iterator[Row]:
    """Direction 'best' at 6 m against every half degree, and against swaths on middle lines as the peer counts them."""
    more, seconds, ratios = [], [], []
    request = PlanRequest(width=6.0, direction=Direction.BEST)
    for name, polygon in fields:
        mainland = headland_of(ground_of(polygon, request), request).mainland
        if not mainland:
            continue
        begin = time.process_time()
        heading = best_heading(mainland, request)
        seconds.append(time.process_time() - begin)
        ours = _passes(mainland, heading, request.spacing)
        more.append((ours - min(_passes(mainland, float(one), request.spacing) for one in HEADINGS), name))
        fewest = min(_middle_lines(mainland, float(one), request.spacing) for one in HEADINGS)
        ratios.append(ours / fewest)
    yield Row("plan", "best direction, passes more than the fewest", max(more)[0], "", "<= 1", max(more)[1])
    yield Row("plan", "best direction, CPU", statistics.median(seconds), "s", "<= 0.02", f"most {max(seconds):.3f} s")
    yield Row("plan", "passes against the fewest middle lines, median", statistics.median(ratios), "", "<= 1.02")


def _passes(mainland: Sequence[shapely.Polygon], heading: float, spacing: float) -> int:
    return len(cut(mainland, strips_over(mainland, heading, spacing, LastPass.OVERLAP, None)))


def _middle_lines(mainland: Sequence[shapely.Polygon], heading: float, spacing: float) -> int:
    """Swaths as the peer makes them: stretches of parallel lines, the first half a spacing from the edge."""
    strips = strips_over(mainland, heading, spacing, LastPass.OVERLAP, None)
    turned = [shapely.transform(part, strips.along_across) for part in mainland]
    edges = np.concatenate(
        [
            np.stack([points[:-1, 1], points[1:, 1]], axis=1)
            for part in turned
            for points in map(shapely.get_coordinates, (part.exterior, *part.interiors))
        ]
    )
    crossed = np.abs(np.diff(np.ceil((edges - strips.first) / spacing), axis=1))
    return max(1, int(crossed.sum() / 2))


def _replanning_row() -> Row:
    field = shapely.box(0, 0, 400, (PASSES + 6) * 3.0)
    request = PlanRequest(width=3.0, direction=Direction.TYPED, heading=np.pi / 2)
    plan = plan_operation(field, request)
    done = [each.number for each in plan.segments if each.kind is SegmentKind.PASS][:2]
    standing = Standing(200.0, 450.0)
    seconds = min(_timed(partial(replan, plan, done, standing, field, request)) for _ in range(3))
    passes = _count(plan) - len(done)
    return Row("plan", "planning the rest again, CPU", seconds, "s", "<= 0.05", f"{passes} passes")


def _count(plan: Plan) -> int:
    return sum(each.kind is SegmentKind.PASS for each in plan.segments)


def _answered(polygon: shapely.Polygon, request: PlanRequest) -> bool:
    try:
        plan = plan_operation(polygon, request)
    except PlanError as error:
        return bool(str(error))
    return bool(plan.segments)


def _timed(action: Callable[[], object]) -> float:
    begin = time.process_time()
    action()
    return time.process_time() - begin
