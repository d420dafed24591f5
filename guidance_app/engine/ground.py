"""What there is to guide along: the field, its plan, or the lines beside a first straight stretch."""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from guidance_app.boundary import frame_of, polygon_in
from guidance_app.documents import Job, Method
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.family import PassFamily
from guidance_app.guidance.itinerary import passes_of
from guidance_app.guidance.planning import PlanError, plan_operation
from guidance_app.guidance.replanning import Standing, replan
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.wishes import request_of
from guidance_app.language import sentence
from guidance_app.model import FloatArray, Pass, Plan

__all__ = ["Ground", "ground_of", "ground_with", "mainland_of", "rest_of", "shown_beside"]

SHOWN_TO_A_SIDE = 12
"""Without a field so many passes are shown to either side of the target."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """The field's polygon in its frame, and the plan or the family of passes on it. All may be None but the frame.

    ``request`` is what the plan was made from, so that its rest can be planned again.
    """

    frame: FieldFrame
    polygon: shapely.Polygon | None = None
    rings: tuple[FloatArray, ...] = ()
    plan: Plan | None = None
    request: PlanRequest | None = None
    family: PassFamily | None = None
    passes: tuple[Pass, ...] = ()
    notices: tuple[str, ...] = ()


def ground_of(job: Job) -> Ground | None:
    """The ground of a job's field, with the operation planned; None without a field.

    A field that cannot be planned is driven along a line instead, and the reason is a notice.
    """
    if job.field is None:
        return None
    frame = frame_of(job.field.boundary)
    polygon = polygon_in(frame, job.field.boundary)
    rings = tuple(_read_only(shapely.get_coordinates(ring)) for ring in (polygon.exterior, *polygon.interiors))
    if job.operation is not None and job.operation.method is Method.LINE:
        return Ground(frame, polygon, rings)
    try:
        request = request_of(job)
        plan = plan_operation(polygon, request)
    except PlanError as error:
        return Ground(
            frame,
            polygon,
            rings,
            notices=(sentence("No plan: {reason}. Guiding along the first straight stretch.", reason=str(error)),),
        )
    return Ground(frame, polygon, rings, plan, request, passes=passes_of(plan), notices=plan.warnings)


def rest_of(ground: Ground, done: frozenset[int], standing: Standing) -> Ground | None:
    """The same ground with what is left planned again; None without a plan. Raises ``PlanError`` when all is done."""
    if ground.plan is None or ground.request is None or ground.polygon is None:
        return None
    plan = replan(ground.plan, done, standing, ground.polygon, ground.request)
    return replace(ground, plan=plan, passes=passes_of(plan), notices=plan.warnings)


def ground_with(ground: Ground, family: PassFamily) -> Ground:
    """The same ground with the passes of a family instead of what there was to guide along."""
    return Ground(
        ground.frame,
        ground.polygon,
        ground.rings,
        family=family,
        passes=shown_beside(family, 0),
        notices=ground.notices,
    )


def shown_beside(family: PassFamily, number: int) -> tuple[Pass, ...]:
    """The passes of a family that a screen shows around this one."""
    numbers = range(number - SHOWN_TO_A_SIDE, number + SHOWN_TO_A_SIDE + 1)
    made = (family.pass_numbered(one) for one in numbers)
    return tuple(one for one in made if one is not None)


def mainland_of(plan: Plan | None) -> shapely.MultiPolygon | None:
    """The mainland of a plan as one geometry."""
    if plan is None or not plan.mainland:
        return None
    return shapely.MultiPolygon([shapely.Polygon(part[0], part[1:]) for part in plan.mainland])


def _read_only(points: FloatArray) -> FloatArray:
    held = np.ascontiguousarray(points)
    held.setflags(write=False)
    return held
