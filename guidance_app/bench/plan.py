"""Plans of real fields: what is worked, what lies outside, what turns do not fit, what planning costs, beside peers.

The columns ``peer`` are what Fields2Cover 2.1.0 reached on 79 real fields (26 convex, 27 concave, 26 with holes) at
6 and 12 m with turning radii of 5 and 6 m: its path never works the headland, and 4 to 81 % of its plans leave the
field. Planners with wheels run beside ours where they are installed.
"""

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely

from guidance_app.bench.errors import BenchError
from guidance_app.bench.plan_cases import Case, case_of
from guidance_app.bench.plan_peers import installed, peer_case
from guidance_app.bench.plan_searches import search_rows
from guidance_app.bench.rows import Row, Subparsers, add_bench
from guidance_app.boundary import frame_of, polygon_in
from guidance_app.documents import Direction, Method
from guidance_app.guidance.planning import PlanError, PlanRequest, plan_operation
from guidance_app.guidance.request import LastPass
from guidance_app.store import StoreError, field_from_file

__all__ = ["add_parser", "measured"]

WIDTHS = (3.0, 6.0, 12.0, 24.0)
RADII = {3.0: 5.0, 6.0: 5.0, 12.0: 6.0, 24.0: 6.0}
PEER_WORKED = {6.0: 0.57, 12.0: 0.48}
PEER_MAINLAND = {6.0: 0.984, 12.0: 0.970}
MEDIAN_WORKED = 0.995
P10_WORKED = {3.0: 0.985, 6.0: 0.985, 12.0: 0.98, 24.0: 0.98}
MOST_TWICE = {3.0: 0.03, 6.0: 0.04, 12.0: 0.07, 24.0: 0.12}
TWICE_UNLENGTHENED = 0.015
PEER_LAPS = 2

Fields = Sequence[tuple[str, shapely.Polygon]]


def add_parser(subparsers: Subparsers) -> None:
    """Describes the bench."""
    parser = add_bench(
        subparsers,
        "plan",
        lambda given: measured(given.fields),
        about="plans of a folder of fields: worked, outside, turns that do not fit, time",
        does="Plans every field of a folder at 3, 6, 12 and 24 m by round trip in the best direction, and prints"
        " median, tenth or ninetieth percentile and the worst field of each quantity; the other methods at 6 m.",
    )
    parser.add_argument("--fields", type=Path, required=True, metavar="DIR", help="folder of GeoJSON polygons")


def measured(folder: Path) -> list[Row]:
    """Every row of this bench. Raises ``BenchError`` for a folder without fields."""
    fields = list(_fields(folder))
    if not fields:
        msg = f"{folder} holds no GeoJSON polygon that can be planned"
        raise BenchError(msg)
    plan_operation(fields[0][1], PlanRequest(width=24.0))  # libraries load what they load on the first plan
    rows = [row for width in WIDTHS for row in _rows_for(width, fields)]
    rows.extend(_rows_of_methods(fields))
    rows.extend(_rows_of_peers(fields))
    rows.extend(search_rows(fields))
    return rows


def _fields(folder: Path) -> Iterator[tuple[str, shapely.Polygon]]:
    for path in sorted(folder.glob("*.geojson")):
        try:
            boundary = field_from_file(path).boundary
        except StoreError:
            continue
        yield path.stem, polygon_in(frame_of(boundary), boundary)


def _request(width: float) -> PlanRequest:
    return PlanRequest(width=width, radius=RADII[width], direction=Direction.BEST)


def _cases(fields: Fields, request: PlanRequest) -> tuple[list[Case], list[str]]:
    """The fields' plans, and why there is none for the others."""
    cases, refused = [], []
    for name, polygon in fields:
        try:
            cases.append(case_of(name, polygon, request))
        except PlanError as error:
            refused.append(f"{name}: {error}")
    return cases, refused


def _rows_for(width: float, fields: Fields) -> Iterator[Row]:
    cases, refused = _cases(fields, _request(width))
    title = f"{width:g} m: "
    yield Row("plan", f"{title}fields planned", len(cases), f"of {len(fields)}", note="; ".join(refused))
    if not cases:
        return
    yield from _inside_rows(title, cases)
    yield from _worked_rows(title, width, cases)
    yield from _twice_rows(title, width, cases, fields)
    yield from _time_rows(title, cases)


def _inside_rows(title: str, cases: Sequence[Case]) -> Iterator[Row]:
    out = [case for case in cases if case.outside]
    names = ", ".join(f"{case.field} ({case.outside})" for case in out[:6])
    yield Row("plan", f"{title}plans with a point outside", len(out), "", "0", names or "peer 4-81 % of fields")
    joins, unfit = sum(case.joins for case in cases), sum(case.unfit for case in cases)
    worst = max(cases, key=lambda case: case.unfit)
    note = f"{unfit} of {joins}" + (f", most {worst.field} {worst.unfit}" if unfit else "")
    yield Row("plan", f"{title}turns that do not fit", unfit / max(joins, 1), "", "<= 0.02", note)
    bent = max(cases, key=lambda case: case.tightest)
    yield Row("plan", f"{title}tightest bend", bent.tightest, "1/R", "<= 1", f"{bent.field}, vertex by vertex")


def _worked_rows(title: str, width: float, cases: Sequence[Case]) -> Iterator[Row]:
    poorest = min(cases, key=lambda case: case.mainland_worked)
    peer = f"; peer {PEER_MAINLAND[width]} median" if width in PEER_MAINLAND else ""
    yield Row(
        "plan",
        f"{title}mainland worked, least",
        poorest.mainland_worked,
        "",
        ">= 0.9999",
        f"{poorest.field}{peer}",
    )
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
    idle = [case.idle_ratio for case in cases]
    yield Row(
        "plan",
        f"{title}not worked over worked, median",
        statistics.median(idle),
        "",
        "<= 0.16-0.28",
        f"p90 {np.percentile(idle, 90):.2f}; peer 0.16-0.28 without the headland",
    )


def _twice_rows(title: str, width: float, cases: Sequence[Case], fields: Fields) -> Iterator[Row]:
    most = max(cases, key=lambda case: case.twice)
    yield Row(
        "plan",
        f"{title}worked twice, median",
        statistics.median(case.twice for case in cases),
        "",
        f"<= {MOST_TWICE[width]}",
        f"p90 {np.percentile([case.twice for case in cases], 90):.3f}, most {most.field} {most.twice:.3f}",
    )
    without = replace(_request(width), lengthen=False, leftovers=False, square_corners=False, last_pass=LastPass.GAP)
    plain, _ = _cases(fields, without)
    yield Row(
        "plan",
        f"{title}worked twice without lengthening, median",
        statistics.median(case.twice for case in plain),
        "",
        f"<= {TWICE_UNLENGTHENED}",
        f"field worked {statistics.median(case.worked for case in plain):.3f}",
    )


def _time_rows(title: str, cases: Sequence[Case]) -> Iterator[Row]:
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


def _rows_of_methods(fields: Fields) -> Iterator[Row]:
    """The other methods at 6 m: what must hold whatever the method."""
    for method in (Method.TRANSFER, Method.INTERMEDIATE_DIVISION, Method.SURROUNDING):
        cases, _ = _cases(fields, replace(_request(6.0), method=method))
        title = f"6 m, {method.value}: "
        yield from _inside_rows(title, cases)
        poorest = min(cases, key=lambda case: case.mainland_worked)
        least = poorest.mainland_worked
        yield Row("plan", f"{title}mainland worked, least", least, "", ">= 0.9999", poorest.field)
        yield Row("plan", f"{title}field worked, median", statistics.median(case.worked for case in cases), "")
        yield Row("plan", f"{title}CPU, median", statistics.median(case.cpu_s for case in cases), "s", "<= 0.1")


def _rows_of_peers(fields: Fields) -> Iterator[Row]:
    planners = installed()
    if not planners:
        yield Row("plan", "peers beside ours", 0, "", note="none is installed: pip install 'guidance-app[peers]'")
    for name, planner in planners.items():
        cases = [peer_case(planner, polygon, 6.0, RADII[6.0], PEER_LAPS) for _, polygon in fields]
        made = [case for case in cases if not case.failed]
        failures = sorted({case.failed[:60] for case in cases if case.failed})
        title = f"6 m, {name}: "
        yield Row("plan", f"{title}fields planned", len(made), f"of {len(fields)}", note="; ".join(failures[:2]))
        if made:
            yield Row("plan", f"{title}plans with a point outside", sum(case.outside > 0 for case in made), "")
            yield Row("plan", f"{title}field worked, median", statistics.median(case.worked for case in made), "")
            yield Row("plan", f"{title}CPU, median", statistics.median(case.cpu_s for case in made), "s")
