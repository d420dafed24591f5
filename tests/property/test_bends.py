"""No plan of any method, on any field, bends tighter than the turning circle, and it never turns on the spot."""

import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from support.star_fields import stars

from guidance_app.bench.plan_cases import tightest
from guidance_app.documents import Direction, Method
from guidance_app.guidance.planning import PlanError, PlanRequest, plan_operation


@settings(max_examples=10, deadline=None)
@given(
    stars(),
    st.sampled_from([3.0, 6.0, 12.0, 30.0]),
    st.sampled_from([2.0, 5.0, 9.0]),
    st.sampled_from([method for method in Method if method is not Method.LINE]),
    st.sampled_from([0.0, 0.4]),
    st.booleans(),
)
def test_what_fits_bends_no_tighter_than_the_turning_circle(
    polygon: shapely.Polygon, width: float, radius: float, method: Method, offset: float, reverse: bool
) -> None:
    request = PlanRequest(
        width=width,
        radius=radius,
        method=method,
        direction=Direction.BEST,
        offset_right=offset,
        reverse_allowed=reverse,
        square_corners=reverse,
    )
    try:
        plan = plan_operation(polygon, request)
    except PlanError:
        return
    assert tightest(plan.segments, request.path_radius) <= 1.0
