"""Boundaries that are driven: the ring is where the edge was, bad fixes are left out, and the last metres come back."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import shapely

from guidance_app.guidance.boundary_drive import BoundaryDrive, DrivenEdge, QualityGate
from guidance_app.model import FixQuality, Pose

SIDE = 100.0
STEP = 0.5
SPEED = 2.5
WIDTH = 6.0
PER_CENT = 0.01


def around(laps: float = 1.0) -> Iterator[Pose]:
    """Clockwise around a square of 100 m from its south-west corner, 5 fixes a second."""
    corners = [(0.0, 0.0), (0.0, SIDE), (SIDE, SIDE), (SIDE, 0.0)]
    count = int(laps * 4 * SIDE / STEP)
    for index in range(count):
        side, along = divmod(index * STEP, SIDE)
        east, north = corners[int(side) % 4]
        heading = (int(side) % 4) * math.pi / 2
        yield Pose(
            t=index * STEP / SPEED,
            arrival=index * STEP / SPEED,
            east=east + along * math.sin(heading),
            north=north + along * math.cos(heading),
            heading=heading,
            speed=SPEED,
        )


def driven(drive: BoundaryDrive, poses: Iterator[Pose], quality: FixQuality = FixQuality.RTK_FIXED) -> BoundaryDrive:
    for pose in poses:
        drive.step(pose, (pose.east, pose.north, pose.heading), quality)
    return drive


def a_drive(edge: DrivenEdge = DrivenEdge.TRACK, gate: QualityGate = QualityGate.ANY) -> BoundaryDrive:
    return BoundaryDrive(edge, gate, WIDTH)


@pytest.mark.parametrize(
    ("edge", "side"), [(DrivenEdge.TRACK, 0.0), (DrivenEdge.LEFT, WIDTH / 2), (DrivenEdge.RIGHT, -WIDTH / 2)]
)
def test_the_ring_is_the_line_that_the_chosen_edge_drew(edge: DrivenEdge, side: float) -> None:
    drive = driven(a_drive(edge), around())
    area = shapely.Polygon(drive.ring()).buffer(0).area
    assert area == pytest.approx((SIDE + 2 * side) ** 2, rel=5 * PER_CENT)


def test_driving_on_past_the_start_closes_where_the_ways_meet() -> None:
    poses = list(around(1.04))
    weaving = [replace(pose, east=pose.east + 0.3 * math.sin(pose.t)) for pose in poses]
    ring = shapely.Polygon(driven(a_drive(), iter(weaving)).ring())
    assert ring.is_valid
    assert ring.area == pytest.approx(SIDE**2, rel=PER_CENT)


def test_a_fix_below_the_wanted_quality_gives_no_point_and_is_counted() -> None:
    drive = driven(a_drive(gate=QualityGate.RTK), around(), FixQuality.DGPS)
    assert len(drive.points) == 0
    assert drive.refused["fix quality"] > 100
    assert len(driven(a_drive(gate=QualityGate.DGPS), around(), FixQuality.RTK_FLOAT).points) > 100


def test_a_jump_of_the_receiver_leaves_no_spike() -> None:
    poses = [replace(pose, east=pose.east + (25.0 if index == 300 else 0.0)) for index, pose in enumerate(around())]
    drive = driven(a_drive(), iter(poses))
    assert drive.refused["jump"] == 1
    assert drive.points[:, 0].max() < SIDE + 1.0


def test_the_last_metres_come_back_one_by_one_to_the_first() -> None:
    drive = driven(a_drive(), around(0.5))
    before = drive.length
    drive.undo(10.0)
    assert before - drive.length == pytest.approx(10.0, abs=2 * STEP)
    for _ in range(100):
        drive.undo(10.0)
    assert len(drive.points) == 0
    with pytest.raises(ValueError, match="drive on"):
        drive.ring()


def test_a_pause_is_bridged_by_a_straight_line() -> None:
    drive = a_drive()
    for index, pose in enumerate(around()):
        drive.paused = 100 < index < 140
        drive.step(pose, (pose.east, pose.north, pose.heading), FixQuality.RTK_FIXED)
    assert not drive.refused
    assert np.hypot(*np.diff(drive.points, axis=0).T).max() == pytest.approx(40 * STEP, abs=2 * STEP)


def test_standing_and_an_unknown_direction_give_nothing() -> None:
    drive = a_drive()
    still = Pose(t=0.0, arrival=0.0, east=0.0, north=0.0, heading=0.0, speed=0.0)
    assert not drive.step(still, (0.0, 0.0, 0.0), FixQuality.RTK_FIXED)
    assert not drive.step(replace(still, speed=2.0, heading_known=False), (0.0, 0.0, 0.0), FixQuality.RTK_FIXED)
    assert drive.refused == {"direction unknown": 1}
    assert (drive.area, drive.gap, drive.length) == (0.0, 0.0, 0.0)
