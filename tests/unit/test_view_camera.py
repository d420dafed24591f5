"""Views: the world lies right under the camera, the whole field always fits, and the world turns calmly."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.angles import wrap_pi
from guidance_app.view.camera import (
    FIELD_OF_VIEW,
    CameraHome,
    Extent,
    ViewMode,
    camera_home,
    eased_heading,
    extent_of,
    world_pose,
)

MILLIMETRE = 1e-3
HEADINGS = st.floats(-math.pi, math.pi)
PLACES = st.floats(-900.0, 900.0)
ASPECTS = st.floats(0.35, 2.6)


def in_root(mode: ViewMode, centre: tuple[float, float], heading: float, point: tuple[float, float]) -> np.ndarray:
    """A point of the field in the root frame."""
    world = world_pose(mode, centre, heading)
    turn = np.array([[math.cos(world.yaw), -math.sin(world.yaw)], [math.sin(world.yaw), math.cos(world.yaw)]])
    return turn @ point + (world.x, world.y)


def on_screen(home: CameraHome, aspect: float, point: tuple[float, float, float]) -> tuple[float, float]:
    """Where a point of the root frame is seen: (right, up), each -1 to 1 inside the window."""
    position, target = np.array(home.position), np.array(home.look_at)
    ahead = (target - position) / np.linalg.norm(target - position)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    seen = np.array(point) - position
    depth = seen @ ahead
    half = math.tan(FIELD_OF_VIEW / 2)
    return float(seen @ right / depth / half / aspect), float(seen @ up / depth / half)


@given(PLACES, PLACES, HEADINGS)
def test_the_tractor_is_at_the_roots_origin_in_views_that_follow(east: float, north: float, heading: float) -> None:
    for mode in (ViewMode.DRIVER, ViewMode.HEADING_UP, ViewMode.NORTH_UP):
        assert in_root(mode, (east, north), heading, (east, north)) == pytest.approx([0.0, 0.0], abs=MILLIMETRE)


@given(PLACES, PLACES, HEADINGS)
def test_ahead_is_up_or_north_is_up(east: float, north: float, heading: float) -> None:
    ahead = (east + math.sin(heading), north + math.cos(heading))
    for mode in (ViewMode.DRIVER, ViewMode.HEADING_UP):
        assert in_root(mode, (east, north), heading, ahead) == pytest.approx([1.0, 0.0], abs=MILLIMETRE)
    for mode in (ViewMode.NORTH_UP, ViewMode.WHOLE_FIELD):
        assert in_root(mode, (east, north), heading, (east, north + 1.0)) == pytest.approx([1.0, 0.0], abs=MILLIMETRE)
        assert in_root(mode, (east, north), heading, (east + 1.0, north)) == pytest.approx([0.0, -1.0], abs=MILLIMETRE)


@given(ASPECTS, st.floats(20.0, 2500.0), st.floats(20.0, 2500.0))
def test_the_whole_field_fits_in_every_window(aspect: float, across: float, along: float) -> None:
    extent = Extent(-across / 2, -along / 2, across / 2, along / 2)
    home = camera_home(ViewMode.WHOLE_FIELD, width=6.0, extent=extent, aspect=aspect)
    for east in (extent.west, extent.east):
        for north in (extent.south, extent.north):
            point = in_root(ViewMode.WHOLE_FIELD, extent.middle, 0.0, (east, north))
            right, up = on_screen(home, aspect, (*point, 0.0))
            assert abs(right) < 1.0
            assert -1.0 < up < 1.0
    assert home.near < home.position[2] < home.far


@given(ASPECTS, st.floats(0.3, 60.0))
def test_the_driver_sees_the_whole_implement_and_the_way_ahead(aspect: float, width: float) -> None:
    home = camera_home(ViewMode.DRIVER, width=width, extent=Extent(0, 0, 1, 1), aspect=aspect)
    for side in (-0.5, 0.5):
        right, up = on_screen(home, aspect, (-1.5, side * width, 0.0))
        assert abs(right) < 1.0
        assert -1.0 < up < 1.0
    assert on_screen(home, aspect, (10_000.0, 0.0, 0.0))[1] < 1.0


@pytest.mark.parametrize("mode", [ViewMode.HEADING_UP, ViewMode.NORTH_UP])
@pytest.mark.parametrize("aspect", [0.53, 0.88, 1.2, 2.0, 2.6])
def test_the_tractor_is_in_sight_from_above(mode: ViewMode, aspect: float) -> None:
    home = camera_home(mode, width=24.0, extent=Extent(0, 0, 1, 1), aspect=aspect)
    for side in (-12.0, 12.0):
        right, up = on_screen(home, aspect, (-2.0, side, 0.0))
        assert abs(right) < 1.0
        assert -1.0 < up < 1.0


@given(HEADINGS, HEADINGS, st.floats(0.0, 5.0))
def test_the_world_follows_the_heading_the_short_way_and_never_beyond(shown: float, to: float, seconds: float) -> None:
    eased = eased_heading(shown, to, seconds)
    assert abs(wrap_pi(to - eased)) <= abs(wrap_pi(to - shown)) + 1e-9
    assert wrap_pi(to - eased_heading(shown, to, 10.0)) == pytest.approx(0.0, abs=1e-6)


def test_a_first_heading_and_a_jump_back_in_time_are_shown_at_once() -> None:
    assert eased_heading(None, 1.0, 0.0) == 1.0
    assert eased_heading(0.2, 1.0, -3.0) == 1.0


def test_a_box_holds_its_points_and_grows_to_hold_more() -> None:
    box = extent_of(np.array([[0.0, 5.0], [30.0, -4.0]]))
    assert box == Extent(0.0, -4.0, 30.0, 5.0)
    assert box.holds(Extent(1.0, 0.0, 2.0, 1.0))
    assert not box.holds(box.with_point(31.0, 0.0))
    assert box.grown(0.1).holds(box.with_point(32.9, 0.0))
    assert box.middle == (15.0, 0.5)
    assert Extent(0, 0, 1, 1).size == (20.0, 20.0)
