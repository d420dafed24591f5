"""Whether a machine stays inside, by the compiled check, is what polygons laid along the path say."""

import math

import numpy as np
import pytest
import shapely
import shapely.affinity

from guidance_app.guidance.manoeuvres import Manoeuvres, join, poses_along
from guidance_app.guidance.request import PlanRequest
from guidance_app.guidance.room import TOUCH, Room
from guidance_app.model import FloatArray

CENTIMETRE = 0.01
CHORDS = 0.1
"""Metres by which a corner of the machine swings out between two places at which it is tried."""
POND = shapely.Point(70, 40).buffer(12, quad_segs=3)
FIELDS = {
    "angled": shapely.Polygon([(0, 0), (150, 0), (170, 90), (80, 60), (0, 80)]),
    "with a pond": shapely.box(0, 0, 140, 90).difference(POND),
    "with many corners": shapely.Point(60, 50).buffer(55, quad_segs=400),
}
WIDTHS = (3.0, 24.0)


def outline_at(pose: FloatArray, request: PlanRequest, grown: float) -> shapely.Polygon:
    """Implement and tractor at a pose as one polygon, ``grown`` metres larger."""
    body = request.body
    half, wide = body.half_width, body.implement_half_width
    parts = [
        shapely.Polygon(
            [(-0.6, half), (-0.6, -half), (body.implement_front, -wide), (body.implement_front, wide)],
        ),
        shapely.box(-0.6, -body.half_width, body.front, body.half_width),
        shapely.box(body.implement_rear, -body.implement_half_width, body.implement_front, body.implement_half_width),
    ]
    east, north, yaw = pose
    turned = shapely.affinity.rotate(shapely.union_all(parts), yaw, origin=(0, 0), use_radians=True)
    placed = shapely.affinity.translate(turned, east, north).buffer(grown, join_style="mitre")
    assert isinstance(placed, shapely.Polygon)
    return placed


def some_moves(field: shapely.Polygon, radius: float) -> Manoeuvres:
    rng = np.random.default_rng(7)
    west, south, east, north = field.bounds
    starts = rng.uniform([west, south, -math.pi], [east, north, math.pi], (10, 3))
    moves = join(starts, starts + rng.uniform([-25, -25, -3], [25, 25, 3], (10, 3)), radius, reverse=True)
    return moves.take(np.flatnonzero(np.isfinite(moves.total)))


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("width", WIDTHS)
def test_a_move_fits_where_its_outlines_do(name: str, width: float) -> None:
    field, request = FIELDS[name], PlanRequest(width=width, radius=6.0)
    moves = some_moves(field, 6.0)
    fits = Room(field, request.body).fits(moves)
    poses = poses_along(moves, moves.total[:, None] * np.linspace(0.0, 1.0, 30))
    assert 0 < fits.sum() < len(fits)
    for fit, along in zip(fits, poses, strict=True):
        grown = -CHORDS if fit else CHORDS
        inside = all(field.buffer(TOUCH).covers(outline_at(pose, request, grown)) for pose in along)
        assert inside or not fit
        assert fit or not inside


@pytest.mark.parametrize("name", FIELDS)
def test_a_pose_fits_where_its_outline_does(name: str) -> None:
    field, request = FIELDS[name], PlanRequest(width=6.0)
    poses = some_moves(field, 6.0).start
    fits = Room(field, request.body).fits_each(poses)
    assert 0 < fits.sum() < len(fits)
    for fit, pose in zip(fits, poses, strict=True):
        grown = -CENTIMETRE if fit else CENTIMETRE
        assert field.buffer(TOUCH).covers(outline_at(pose, request, grown)) is bool(fit)


def test_what_is_missing_is_how_far_the_machine_sticks_out() -> None:
    request = PlanRequest(width=6.0)
    room = Room(shapely.box(0, 0, 100, 100), request.body)
    poses = np.array([[[50.0, 50.0, 0.0], [98.0, 50.0, 0.0]], [[50.0, 50.0, 0.0], [60.0, 50.0, 0.0]]])
    assert room.missing(poses) == pytest.approx([98.0 + request.body.front - 100.0, 0.0])


@pytest.mark.parametrize("aside", [-9.0, 0.0, 9.0])
def test_a_straight_does_not_run_over_an_obstacle_that_its_corners_pass(aside: float) -> None:
    request = PlanRequest(width=24.0)
    field = shapely.box(0, 0, 100, 60)
    straight = Manoeuvres(np.array([[20.0, 30.0, 0.0]]), np.zeros((1, 1)), np.full((1, 1), 60.0), 6.0)
    assert Room(field, request.body).fits(straight).all()
    pole = shapely.Point(50, 30 + aside).buffer(0.7)
    assert not Room(field.difference(pole), request.body).fits(straight).any()


def test_nothing_to_check_is_no_trouble() -> None:
    room = Room(FIELDS["angled"], PlanRequest(width=6.0).body)
    nothing = some_moves(FIELDS["angled"], 6.0).take(np.zeros(0, dtype=np.intp))
    assert room.fits(nothing).shape == (0,)
    assert room.fits_each(np.zeros((0, 3))).shape == (0,)
