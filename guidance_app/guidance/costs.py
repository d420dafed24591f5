"""What a plan costs: distances, turns, minutes, and what of the field is worked, worked twice and missed."""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely import Polygon

from guidance_app.guidance.request import PlanRequest
from guidance_app.model import PlanCosts, Segment, SegmentKind

__all__ = ["costs_of", "worked_ground"]

GRID = 1e-4
"""Metres to which strips are snapped before they are joined: without it GEOS loses ground between adjacent strips."""


def costs_of(segments: Sequence[Segment], ground: Polygon, request: PlanRequest) -> PlanCosts:
    """The sums over the segments, and areas from the union of what is worked."""
    work = sum(each.length for each in segments if each.implement_down)
    idle = sum(each.length for each in segments if not each.implement_down)
    stops = 2 * sum(each.reverse for each in segments)
    joins = _joins(segments)
    swaths = worked_ground(segments, request.width)
    united = shapely.union_all(swaths, grid_size=GRID) if len(swaths) else Polygon()
    inside = united.intersection(ground).area
    twice = float(shapely.area(swaths).sum()) - united.area
    seconds = work / request.work_speed + idle / request.turn_speed + stops * request.stop_s
    return PlanCosts(
        work_m=work,
        idle_m=idle,
        turns=len(joins),
        tight_turns=sum(any(each.reverse for each in join) for join in joins),
        minutes=seconds / 60,
        worked_fraction=inside / ground.area,
        overlap_fraction=twice / united.area if united.area else 0.0,
        missed_m2=max(0.0, ground.area - inside),
    )


def worked_ground(segments: Sequence[Segment], width: float) -> np.ndarray:
    """One polygon for each worked segment."""
    return np.array(
        [
            shapely.buffer(_line(each), width / 2, cap_style="flat", quad_segs=8)
            for each in segments
            if each.implement_down
        ]
    )


def _line(segment: Segment) -> shapely.Geometry:
    return shapely.linearrings(segment.points) if segment.closed else shapely.linestrings(segment.points)


def _joins(segments: Sequence[Segment]) -> list[list[Segment]]:
    """Runs of segments that are not worked, each between two worked ones."""
    joins: list[list[Segment]] = []
    before_worked = True
    for each in segments:
        if each.kind not in (SegmentKind.TURN, SegmentKind.TRANSFER):
            before_worked = True
        elif before_worked:
            joins.append([each])
            before_worked = False
        else:
            joins[-1].append(each)
    return joins
