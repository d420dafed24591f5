"""Where a tap meets the ground, whichever way the map lies under the camera."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.console.sketch import ground_point
from guidance_app.view.camera import WorldPose

MILLIMETRE = 1e-3
place = st.floats(-400.0, 400.0)


@given(east=place, north=place, x=place, y=place, yaw=st.floats(-math.pi, math.pi))
def test_a_ray_through_a_point_of_the_field_finds_that_point(
    east: float, north: float, x: float, y: float, yaw: float
) -> None:
    world = WorldPose(x, y, yaw)
    seen = (
        x + math.cos(yaw) * east - math.sin(yaw) * north,
        y + math.sin(yaw) * east + math.cos(yaw) * north,
    )
    eye = (seen[0] - 12.0, seen[1] + 7.0, 30.0)
    ray = (12.0, -7.0, -30.0)
    assert ground_point(eye, ray, world) == pytest.approx((east, north), abs=MILLIMETRE)


def test_a_ray_to_the_sky_meets_nothing() -> None:
    assert ground_point((0.0, 0.0, 5.0), (1.0, 0.0, 0.0), WorldPose(0.0, 0.0, 0.0)) is None
    assert ground_point((0.0, 0.0, 5.0), (1.0, 0.0, 0.3), WorldPose(0.0, 0.0, 0.0)) is None
