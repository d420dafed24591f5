"""What one plan of one field comes to, measured from its segments alone."""

import itertools
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from guidance_app.guidance.costs import joins_of
from guidance_app.guidance.planning import PlanRequest, plan_operation
from guidance_app.model import FloatArray, Plan, Segment, SegmentKind

__all__ = ["Case", "case_of", "line_of", "mainland_of", "outside", "tightest"]

SAMPLE = 0.25
"""Metres between the points of a path that must lie inside."""

GRID = 1e-4
"""Metres to which strips are snapped before they are joined; without it ground is lost between adjacent ones."""

SAME = 1e-6
"""Metres; nearer points of a path are one."""


@dataclass(frozen=True, slots=True)
class Case:
    """One plan in numbers. ``tightest`` is its tightest bend in bends of the turning circle."""

    field: str
    mainland_worked: float
    worked: float
    twice: float
    outside: int
    joins: int
    unfit: int
    tightest: float
    passes: int
    idle_ratio: float
    cpu_s: float


def case_of(field: str, polygon: shapely.Polygon, request: PlanRequest) -> Case:
    """Plans one field. Raises ``PlanError``."""
    begin = time.process_time()
    plan = plan_operation(polygon, request)
    seconds = time.process_time() - begin
    joins = joins_of(plan.segments)
    swaths = [_swath(each, request.width) for each in plan.segments if each.implement_down]
    union = shapely.union_all(swaths, grid_size=GRID)
    return Case(
        field=field,
        mainland_worked=_mainland_worked(plan, request.width),
        worked=union.intersection(polygon).area / polygon.area,
        twice=(sum(each.area for each in swaths) - union.area) / union.area,
        outside=sum(outside(line_of(each), polygon) for each in plan.segments),
        joins=len(joins),
        unfit=sum(not all(each.fits for each in join) for join in joins),
        tightest=tightest(plan.segments, request.radius),
        passes=sum(each.kind is SegmentKind.PASS for each in plan.segments),
        idle_ratio=plan.costs.idle_m / plan.costs.work_m,
        cpu_s=seconds,
    )


def outside(line: shapely.LineString, polygon: shapely.Polygon) -> int:
    """How many samples of a path lie outside the field or in an obstacle."""
    shapely.prepare(polygon)
    points = shapely.get_coordinates(shapely.segmentize(line, SAMPLE))
    return int(np.count_nonzero(~shapely.contains_xy(polygon, points[:, 0], points[:, 1])))


def line_of(segment: Segment) -> shapely.LineString:
    """A segment as a line, a closed lap back to its first point."""
    points = segment.points
    return shapely.LineString(np.vstack([points, points[:1]]) if segment.closed else points)


def mainland_of(plan: Plan) -> shapely.MultiPolygon:
    """The mainland as one geometry, empty where there is none."""
    return shapely.MultiPolygon([shapely.Polygon(part[0], part[1:]) for part in plan.mainland])


def _mainland_worked(plan: Plan, width: float) -> float:
    mainland = mainland_of(plan)
    if mainland.is_empty:
        return 1.0
    passes: Sequence[shapely.Geometry] = [
        _swath(each, width) for each in plan.segments if each.kind is SegmentKind.PASS
    ]
    return float(shapely.union_all(passes, grid_size=GRID).intersection(mainland).area / mainland.area)


def _swath(segment: Segment, width: float) -> BaseGeometry:
    swath = line_of(segment).buffer(width / 2, cap_style="flat")
    assert isinstance(swath, BaseGeometry)
    return swath


def tightest(segments: Sequence[Segment], radius: float) -> float:
    """The tightest bend of what fits, in bends of the turning circle: at every point, from segment to segment too.

    A bend is the turn at a point over the mean of the chords before and after it. Where the gear changes the tractor
    stands, and a path may turn back.
    """
    fitting = itertools.groupby(segments, key=lambda each: (each.fits, each.reverse))
    paths = [_path_of(list(run)) for (fits, _), run in fitting if fits]
    paths.extend(np.vstack([each.points, each.points[:2]]) for each in segments if each.closed)
    return max((float(radius * _bends(path).max(initial=0.0)) for path in paths), default=0.0)


def _path_of(run: Sequence[Segment]) -> FloatArray:
    """The points (N, 2) of segments driven on end; one that is closed comes back to its first point."""
    return np.vstack([np.vstack([each.points, each.points[:1]]) if each.closed else each.points for each in run])


def _bends(path: FloatArray) -> FloatArray:
    steps = np.diff(path, axis=0)
    steps = steps[np.hypot(steps[:, 0], steps[:, 1]) > SAME]
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    turn = np.diff(np.arctan2(steps[:, 1], steps[:, 0]))
    bends: FloatArray = np.abs(np.mod(turn + np.pi, 2 * np.pi) - np.pi) * 2 / (lengths[1:] + lengths[:-1])
    return bends
