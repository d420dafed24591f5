"""An AB line comes from the first 30 m that are straight, along the line of least squares."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.passes import a_pose

from guidance_app.angles import heading_between, wrap_pi
from guidance_app.guidance.straight import StraightStretch
from guidance_app.model import Pose

Line = tuple[tuple[float, float], tuple[float, float]]
SPEED, INTERVAL = 2.0, 0.2
METRES = 30.0


def first_line(stretch: StraightStretch, poses: list[Pose]) -> tuple[int, Line] | None:
    """How many poses it took, and the line."""
    for i, pose in enumerate(poses):
        line = stretch.step(pose)
        if line is not None:
            return i, line
    return None


def straight(metres: float, heading: float, *, start: Pose | None = None, speed: float = SPEED) -> list[Pose]:
    """Poses 0.4 m apart, one interval and one step after ``start``."""
    before = start or a_pose(-INTERVAL, -math.sin(heading) * SPEED * INTERVAL, -math.cos(heading) * SPEED * INTERVAL)
    step = SPEED * INTERVAL
    return [
        a_pose(
            before.t + INTERVAL * i,
            before.east + step * i * math.sin(heading),
            before.north + step * i * math.cos(heading),
            heading,
            speed,
        )
        for i in range(1, int(metres / step) + 2)
    ]


@given(st.floats(-math.pi, math.pi), st.floats(-1000, 1000), st.floats(-1000, 1000))
def test_a_straight_drive_gives_its_own_line(heading: float, east: float, north: float) -> None:
    poses = [replace(pose, east=pose.east + east, north=pose.north + north) for pose in straight(50.0, heading)]
    found = first_line(StraightStretch(), poses)
    assert found is not None
    i, (start, end) = found
    assert i * SPEED * INTERVAL == pytest.approx(METRES, abs=1.1 * SPEED * INTERVAL)
    assert start == pytest.approx((poses[0].east, poses[0].north), abs=1e-6)
    assert end == pytest.approx((poses[i].east, poses[i].north), abs=1e-6)


@settings(max_examples=30)
@given(st.floats(-math.pi, math.pi), st.integers(0, 2**32 - 1))
def test_noise_of_the_position_turns_the_line_by_less_than_a_degree(heading: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    poses = [
        replace(pose, east=pose.east + rng.normal(0, 0.1), north=pose.north + rng.normal(0, 0.1))
        for pose in straight(60.0, heading)
    ]
    found = first_line(StraightStretch(), poses)
    assert found is not None
    assert abs(wrap_pi(heading_between(*found[1]) - heading)) < math.radians(1.0)


@settings(max_examples=30)
@given(st.floats(4.0, 60.0), st.booleans())
def test_a_bend_is_not_straight_however_long(radius: float, right: bool) -> None:
    turn = (SPEED * INTERVAL / radius) * (1 if right else -1)
    heading = turn * np.arange(800)
    places = np.cumsum(SPEED * INTERVAL * np.column_stack([np.sin(heading), np.cos(heading)]), axis=0)
    poses = [
        a_pose(INTERVAL * i, east, north, wrap_pi(float(heading[i]))) for i, (east, north) in enumerate(places.tolist())
    ]
    assert first_line(StraightStretch(), poses) is None


def test_the_stretch_after_a_bend_begins_behind_it() -> None:
    first = straight(20.0, 0.0)
    second = straight(60.0, math.radians(40.0), start=first[-1])
    found = first_line(StraightStretch(), [*first, *second])
    assert found is not None
    assert heading_between(*found[1]) == pytest.approx(math.radians(40.0), abs=1e-6)


def test_a_heading_beside_north_is_as_straight_as_any() -> None:
    poses = [replace(pose, heading=0.02 * (-1) ** i) for i, pose in enumerate(straight(40.0, 0.0))]
    assert first_line(StraightStretch(), poses) is not None


@pytest.mark.parametrize("speed", [0.4, -2.0], ids=["slow", "in reverse"])
def test_only_work_forward_counts(speed: float) -> None:
    assert first_line(StraightStretch(), straight(100.0, 0.3, speed=speed)) is None


def test_an_unknown_heading_does_not_count() -> None:
    poses = [replace(pose, heading_known=False) for pose in straight(100.0, 0.3)]
    assert first_line(StraightStretch(), poses) is None


def test_a_jump_begins_again() -> None:
    first = straight(25.0, 0.0)
    away = replace(first[-1], east=first[-1].east + 50.0)
    found = first_line(StraightStretch(), [*first, *straight(60.0, 0.0, start=away)])
    assert found is not None
    assert found[1][0][0] == pytest.approx(50.0)


@pytest.mark.parametrize("name", ["t", "east", "north", "heading", "speed"])
def test_what_is_not_a_number_is_left_out(name: str) -> None:
    poses = straight(50.0, 0.3)
    poses[10] = replace(poses[10], **{name: math.nan})
    found = first_line(StraightStretch(), poses)
    assert found is not None
    assert np.isfinite(found[1]).all()


def test_a_fork_goes_its_own_way() -> None:
    poses = straight(50.0, 0.3)
    stretch = StraightStretch()
    assert first_line(stretch, poses[:50]) is None
    fork = stretch.fork()
    assert first_line(fork, straight(20.0, 2.0)) is None
    found, expected = first_line(stretch, poses[50:]), first_line(StraightStretch(), poses)
    assert found is not None
    assert expected is not None
    assert found[1] == expected[1]
