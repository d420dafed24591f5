"""Plans of real fields: what is worked, what lies outside, what turns do not fit, and what planning costs.

The columns ``peer`` are what Fields2Cover 2.1.0 reached on 79 real fields (26 convex, 27 concave, 26 with holes) at
6 and 12 m: its path never works the headland, and 4 to 81 % of its plans leave the field.
"""

import argparse
import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from guidance_app.bench.errors import BenchError
from guidance_app.bench.rows import Row, add_json_option, shown
from guidance_app.boundary import frame_of, polygon_in
from guidance_app.guidance.planning import PlanError, PlanRequest, plan_operation
from guidance_app.model import FloatArray, Plan, SegmentKind
from guidance_app.store import StoreError, field_from_file

__all__ = ["add_parser", "measured"]

WIDTHS = (3.0, 6.0, 12.0, 24.0)
RADII = {3.0: 4.0, 6.0: 5.0, 12.0: 6.0, 24.0: 8.0}
SAMPLE = 0.25
"""Metres between the points of a path that must lie inside."""
INSIDE = 0.01
"""Metres by which a point may be outside: below what the boundary is known to."""
PEER_WORKED = {6.0: 0.57, 12.0: 0.48}
MEDIAN_WORKED = 0.995
P10_WORKED = {3.0: 0.985, 6.0: 0.985, 12.0: 0.98, 24.0: 0.98}
MOST_TWICE = {3.0: 0.03, 6.0: 0.04, 12.0: 0.07, 24.0: 0.12}


@dataclass(frozen=True, slots=True)
class _Case:
    """What one field's plan came to."""

    field: str
    worked: float
    twice: float
    outside: int
    turns: int
    unfit: int
    idle_ratio: float
    cpu_s: float


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the bench."""
    parser = subparsers.add_parser(
        "plan",
        help="plans of a folder of fields: worked, outside, turns that do not fit, time",
        description="Plans every field of a folder at 3, 6, 12 and 24 m by round trip, and prints median, tenth or"
        " ninetieth percentile and the worst field of each quantity.",
    )
    parser.add_argument("--fields", type=Path, required=True, metavar="DIR", help="folder of GeoJSON polygons")
    add_json_option(parser)
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Prints the rows."""
    print(shown(measured(arguments.fields), as_json=arguments.json))  # noqa: T201 - a bench is a command
    return 0


def measured(folder: Path) -> list[Row]:
    """Every row of this bench. Raises ``BenchError`` for a folder without fields."""
    fields = list(_fields(folder))
    if not fields:
        msg = f"{folder} holds no GeoJSON polygon that can be planned"
        raise BenchError(msg)
    return [row for width in WIDTHS for row in _rows_for(width, fields)]


def _fields(folder: Path) -> Iterator[tuple[str, shapely.Polygon]]:
    for path in sorted(folder.glob("*.geojson")):
        try:
            boundary = field_from_file(path).boundary
        except StoreError:
            continue
        yield path.stem, polygon_in(frame_of(boundary), boundary)


def _rows_for(width: float, fields: list[tuple[str, shapely.Polygon]]) -> Iterator[Row]:
    cases, refused = [], []
    for name, polygon in fields:
        try:
            cases.append(_case(name, polygon, PlanRequest(width=width, radius=RADII[width])))
        except PlanError as error:
            refused.append(f"{name}: {error}")
    title = f"{width:g} m: "
    yield Row("plan", f"{title}fields planned", len(cases), f"of {len(fields)}", note="; ".join(refused))
    if cases:
        yield from _worked_rows(title, width, cases)
        yield from _drive_rows(title, cases)
        yield from _time_rows(title, cases)


def _worked_rows(title: str, width: float, cases: list[_Case]) -> Iterator[Row]:
    worked = [case.worked for case in cases]
    worst = min(cases, key=lambda case: case.worked)
    peer = f"peer {PEER_WORKED[width]}" if width in PEER_WORKED else ""
    yield Row("plan", f"{title}field worked, median", statistics.median(worked), "", f">= {MEDIAN_WORKED}", peer)
    yield Row(
        "plan",
        f"{title}field worked, p10",
        float(np.percentile(worked, 10)),
        "",
        f">= {P10_WORKED[width]}",
        f"worst {worst.field} {worst.worked:.3f}",
    )
    most = max(cases, key=lambda case: case.twice)
    yield Row(
        "plan",
        f"{title}worked twice, median",
        statistics.median(case.twice for case in cases),
        "",
        f"<= {MOST_TWICE[width]}",
        f"most {most.field} {most.twice:.3f}",
    )


def _drive_rows(title: str, cases: list[_Case]) -> Iterator[Row]:
    out = [case for case in cases if case.outside]
    names = ", ".join(f"{case.field} ({case.outside})" for case in out[:6])
    yield Row("plan", f"{title}plans with a point outside", len(out), "", "0", names)
    turns, unfit = sum(case.turns for case in cases), sum(case.unfit for case in cases)
    yield Row("plan", f"{title}turns that do not fit", unfit / max(turns, 1), "", "<= 0.02", f"{unfit} of {turns}")
    yield Row(
        "plan",
        f"{title}not worked over worked, median",
        statistics.median(case.idle_ratio for case in cases),
        "",
        note="peer 0.16-0.28",
    )


def _time_rows(title: str, cases: list[_Case]) -> Iterator[Row]:
    seconds = [case.cpu_s for case in cases]
    slowest = max(cases, key=lambda case: case.cpu_s)
    yield Row("plan", f"{title}CPU, median", statistics.median(seconds), "s", "<= 0.1", "peer 0.13-0.27")
    yield Row(
        "plan",
        f"{title}CPU, p95",
        float(np.percentile(seconds, 95)),
        "s",
        "<= 0.5",
        f"worst {slowest.field} {slowest.cpu_s:.2f} s, peer 27 s",
    )


def _case(name: str, polygon: shapely.Polygon, request: PlanRequest) -> _Case:
    begin = time.process_time()
    plan = plan_operation(polygon, request)
    seconds = time.process_time() - begin
    ways = [one for one in plan.segments if one.kind in {SegmentKind.TURN, SegmentKind.TRANSFER}]
    return _Case(
        field=name,
        worked=plan.costs.worked_fraction,
        twice=plan.costs.overlap_fraction,
        outside=_points_outside(plan, polygon),
        turns=len(ways),
        unfit=sum(not one.fits for one in ways),
        idle_ratio=plan.costs.idle_m / plan.costs.work_m,
        cpu_s=seconds,
    )


def _points_outside(plan: Plan, polygon: shapely.Polygon) -> int:
    """How many samples of the path that claims to fit lie outside the field or in an obstacle."""
    room = polygon.buffer(INSIDE)
    shapely.prepare(room)
    samples = np.vstack([_sampled(one.points, closed=one.closed) for one in plan.segments if one.fits])
    return int(np.count_nonzero(~shapely.contains_xy(room, samples[:, 0], samples[:, 1])))


def _sampled(points: FloatArray, *, closed: bool) -> FloatArray:
    line = shapely.linestrings(np.vstack([points, points[:1]]) if closed else points)
    places = np.arange(0.0, float(shapely.length(line)), SAMPLE)
    return np.asarray(shapely.get_coordinates(shapely.line_interpolate_point(line, places)), dtype=np.float64)
