"""What a plan costs: distances, turns, minutes, and what of the field is worked, worked twice and missed."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

from guidance_app.guidance.layout import Layout
from guidance_app.guidance.request import PlanRequest
from guidance_app.model import PlanCosts, Segment, SegmentKind

__all__ = ["costs_of", "driven_costs", "joins_of"]


def costs_of(segments: Sequence[Segment], layout: Layout, request: PlanRequest) -> PlanCosts:
    """Sums over the segments, and the layout's areas."""
    ground, worked = layout.ground, layout.worked
    inside = ground.area - layout.rest.area
    areas = PlanCosts(
        work_m=0.0,
        idle_m=0.0,
        turns=0,
        tight_turns=0,
        minutes=0.0,
        worked_fraction=min(1.0, inside / ground.area),
        overlap_fraction=max(0.0, layout.swaths_area - worked.area) / worked.area if worked.area else 0.0,
        missed_m2=max(0.0, ground.area - inside),
    )
    return driven_costs(segments, areas, request)


def driven_costs(segments: Sequence[Segment], areas: PlanCosts, request: PlanRequest) -> PlanCosts:
    """The costs with the sums over these segments; areas stay as they are.

    A turn is tight when the machine backs up in it, or its ends are nearer to each other than the turning circle.
    """
    work = sum(each.length for each in segments if each.implement_down)
    idle = sum(each.length for each in segments if not each.implement_down)
    joins = joins_of(segments)
    gear_changes = sum(_gear_changes(join) for join in joins)
    seconds = work / request.work_speed + idle / request.turn_speed + gear_changes * request.stop_s
    return replace(
        areas,
        work_m=work,
        idle_m=idle,
        turns=len(joins),
        tight_turns=sum(_tight(join, request.path_radius) for join in joins),
        minutes=seconds / 60,
    )


def _gear_changes(join: Sequence[Segment]) -> int:
    """Times that the tractor stops to change between forward and backward, coming from and going on to work."""
    gears = [False, *(each.reverse for each in join), False]
    return sum(before != after for before, after in itertools.pairwise(gears))


def joins_of(segments: Sequence[Segment]) -> list[list[Segment]]:
    """Turns and transfers, each as its segments in driving order."""
    joins: list[list[Segment]] = []
    joining = False
    for each in segments:
        if each.kind not in (SegmentKind.TURN, SegmentKind.TRANSFER):
            joining = False
        elif joining:
            joins[-1].append(each)
        else:
            joins.append([each])
            joining = True
    return joins


def _tight(join: Sequence[Segment], radius: float) -> bool:
    apart = math.dist(join[0].points[0], join[-1].points[-1])
    return any(each.reverse for each in join) or apart < 2 * radius
