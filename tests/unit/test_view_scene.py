"""The ground's shapes: triangles cover the field, dashes leave gaps, passes have their states, numbers their places."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from support.snapshots import FIELD, TREES, field_snapshot, straight_passes, trail

from guidance_app.model import LinkState, Pass, Pose, Snapshot, TurnGuide
from guidance_app.view.camera import ViewMode
from guidance_app.view.colours import DAY, vertex_source
from guidance_app.view.field import everything, exclusion_mesh, ground_mesh, mainland_strokes, ring_strokes
from guidance_app.view.numerals import painted
from guidance_app.view.polyline import along, cut, dashed, lengths, point_at, segments, stretched, thinned
from guidance_app.view.scene import (
    MOST_NUMBERS,
    PassState,
    Shown,
    ellipse,
    number_layout,
    numbers,
    pass_lines,
    pass_state,
    pass_strokes,
    shown_pose,
    turn_colour,
)

MILLIMETRE = 1e-3
CENTIMETRE = 1e-2
SQUARE_CENTIMETRE = 1e-4
LINES = arrays(
    float, st.tuples(st.integers(2, 30), st.just(2)), elements=st.integers(-2000, 2000).map(lambda tenths: tenths / 10)
)


# --- field ---------------------------------------------------------------------------------------------------------


def test_triangles_cover_the_field_without_its_exclusions() -> None:
    mesh = ground_mesh((FIELD, TREES))
    assert mesh is not None
    a, b, c = (mesh.vertices[mesh.faces[:, k], :2].astype(float) for k in range(3))
    doubled = np.cross(np.column_stack([b - a, np.zeros(len(a))]), np.column_stack([c - a, np.zeros(len(a))]))[:, 2]
    assert (doubled > 0).all()
    assert doubled.sum() / 2 == pytest.approx(shapely.Polygon(FIELD, [TREES]).area, rel=1e-6)
    holes = exclusion_mesh((FIELD, TREES))
    assert holes is not None
    assert holes.vertices[:, 2].min() > mesh.vertices[:, 2].max()


def test_without_a_field_there_is_no_ground() -> None:
    assert ground_mesh(()) is None
    assert exclusion_mesh((FIELD,)) is None
    assert ring_strokes(()).shape == (0, 2, 3)
    assert mainland_strokes(Snapshot(0, 0.0, LinkState())).shape == (0, 2, 3)


def test_the_box_of_everything_holds_field_and_tractor() -> None:
    outside = field_snapshot(pose=Pose(1.0, 1.0, -300.0, 50.0, 0.0, 1.0))
    assert everything(outside).west == -300.0
    assert everything(outside).north == 200.0
    driven = replace(outside, field_rings=(), passes=(), track=trail([np.array([[0.0, 0.0], [0.0, 700.0]])]))
    assert everything(driven).north == 700.0
    assert everything(Snapshot(0, 0.0, LinkState())).size == (100.0, 100.0)


# --- lines ---------------------------------------------------------------------------------------------------------


@given(LINES, st.floats(0.01, 5.0))
def test_thinning_keeps_the_ends_and_stays_within_its_tolerance(points: np.ndarray, tolerance: float) -> None:
    kept = thinned(points, tolerance)
    assert (kept[0] == points[0]).all()
    assert (kept[-1] == points[-1]).all()
    line = shapely.LineString(kept)
    assert max(line.distance(shapely.Point(point)) for point in points) <= tolerance + MILLIMETRE


@given(LINES)
def test_dashes_lie_on_the_line_and_leave_about_half_of_it_open(points: np.ndarray) -> None:
    total = float(lengths(points)[-1])
    dashes = dashed(points, 3.0, 3.0)
    inked = float(np.hypot(*(dashes[:, 1] - dashes[:, 0]).T).sum()) if len(dashes) else 0.0
    assert inked <= total + CENTIMETRE
    if total > 60.0:
        assert inked == pytest.approx(total / 2, abs=0.1 * total)


@given(LINES.filter(lambda points: float(lengths(points)[-1]) > 1.0), st.floats(0.0, 1.0))
def test_a_place_along_a_line_is_found_again(points: np.ndarray, share: float) -> None:
    metres = share * float(lengths(points)[-1])
    place, direction = point_at(points, metres)
    assert math.hypot(*direction) == pytest.approx(1.0)
    _, gap = along(points, *place)
    assert gap == pytest.approx(0.0, abs=MILLIMETRE)


@given(LINES.filter(lambda points: float(lengths(points)[-1]) > 1.0), st.floats(1.0, 90.0))
def test_cutting_a_line_leaves_it_where_it_was(points: np.ndarray, longest: float) -> None:
    finer = cut(points, longest)
    assert np.hypot(*np.diff(finer, axis=0).T).max() <= longest + MILLIMETRE
    assert float(lengths(finer)[-1]) == pytest.approx(float(lengths(points)[-1]), abs=CENTIMETRE)
    line = shapely.LineString(points)
    assert max(line.distance(shapely.Point(point)) for point in finer) < MILLIMETRE


def test_strokes_join_the_points() -> None:
    strokes = segments(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]]), 0.5)
    assert strokes.tolist() == [[[0, 0, 0.5], [1, 0, 0.5]], [[1, 0, 0.5], [1, 2, 0.5]]]
    assert stretched(np.array([[0.0, 0.0], [0.0, 1.0]]), 9.0).tolist() == [[0, -9], [0, 0], [0, 1], [0, 10]]


# --- passes --------------------------------------------------------------------------------------------------------


def test_every_pass_has_its_state() -> None:
    guidance = field_snapshot(target=3).guidance
    states = [pass_state(n, guidance) for n in (1, 2, 3, 4, 5)]
    assert states == [PassState.DONE, PassState.DONE, PassState.TARGET, PassState.NEXT, PassState.TO_DO]
    assert pass_state(1, None) is PassState.TO_DO


def test_all_passes_are_one_array_with_a_colour_for_each_end() -> None:
    snapshot = field_snapshot(target=3, count=12)
    lines = pass_lines(snapshot.passes, snapshot.guidance, DAY)
    assert lines.points.shape[1:] == (2, 3)
    assert lines.colours.shape == lines.points.shape
    assert tuple(lines.colours[0, 0]) == vertex_source(DAY.pass_done)
    dashes = (lines.colours[:, 0] == vertex_source(DAY.pass_next)).all(axis=1).sum()
    assert dashes > 10
    assert len(lines.points) == 11 * 4 + dashes
    assert len(pass_lines((), None, DAY).points) == 0


def test_a_lap_is_closed_and_an_endless_line_is_long() -> None:
    square = np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]])
    assert len(pass_strokes(Pass(1, square, closed=True))) == 4
    assert np.abs(np.diff(pass_strokes(field_snapshot().passes[0]), axis=1)).max() <= 40.0
    endless = pass_strokes(Pass(0, square[:2], endless=True))
    assert np.ptp(endless[..., 0]) > 2000


# --- numbers -------------------------------------------------------------------------------------------------------


@given(st.integers(-99, 999), st.floats(0.0, math.tau), st.floats(0.2, 5.0))
def test_a_number_is_as_large_as_asked_and_turns_with_its_line(number: int, angle: float, size: float) -> None:
    up = (math.sin(angle), math.cos(angle))
    strokes = painted(number, (40.0, 7.0), up, size=size)
    along_up = (strokes - (40.0, 7.0)) @ up
    across = (strokes - (40.0, 7.0)) @ (up[1], -up[0])
    assert np.ptp(along_up) <= 1.61 * size
    assert np.ptp(across) <= (1.45 * (len(str(number)) - 1) + 1.01) * size
    assert abs(along_up).max() <= 0.81 * size


def test_different_numbers_look_different() -> None:
    drawn = {painted(n, (0.0, 0.0), (0.0, 1.0), size=1.0).tobytes() for n in range(-20, 120)}
    assert len(drawn) == 140


@pytest.mark.parametrize("mode", list(ViewMode))
@pytest.mark.parametrize("count", [1, 12, 300])
def test_numbers_are_few_enough_to_read(mode: ViewMode, count: int) -> None:
    snapshot = replace(field_snapshot(target=1), passes=straight_passes(count, spacing=3.0))
    layout = number_layout(mode, 60.0, 6.0)
    shown = Shown(10.0, 60.0, 0.0, heading_known=True, stale=False)
    lines = numbers(snapshot, shown, mode, layout, DAY)
    assert 0 < len(lines.points) <= MOST_NUMBERS * 3 * 24
    assert np.isfinite(lines.points).all()


def test_numbers_stand_upright_for_a_driver_who_comes_back() -> None:
    snapshot = field_snapshot()
    layout = number_layout(ViewMode.DRIVER, 17.0, 6.0)
    there = numbers(snapshot, Shown(18.0, 60.0, 0.0, heading_known=True, stale=False), ViewMode.DRIVER, layout, DAY)
    back = numbers(snapshot, Shown(18.0, 90.0, math.pi, heading_known=True, stale=False), ViewMode.DRIVER, layout, DAY)
    assert there.points[..., 1].mean() > 60.0
    assert back.points[..., 1].mean() < 90.0


@pytest.mark.parametrize("number", [-12, -1, 3])
def test_a_number_stands_between_its_line_and_the_next_one(number: int) -> None:
    """Of an implement 3 m wide: beside another line it would be read as that one's."""
    layout = number_layout(ViewMode.DRIVER, 20.0, 3.0)
    line = Pass(number, np.array([[0.0, 0.0], [0.0, 100.0]]), endless=True)
    shown = Shown(0.0, 0.0, 0.0, heading_known=True, stale=False)
    snapshot = replace(field_snapshot(), passes=(line,), guidance=None)
    strokes = numbers(snapshot, shown, ViewMode.DRIVER, layout, DAY).points
    assert strokes[..., 0].min() > 0.0
    assert strokes[..., 0].max() < 3.0


def test_numbers_of_the_whole_field_stand_outside_of_it() -> None:
    snapshot = field_snapshot()
    lines = numbers(snapshot, None, ViewMode.WHOLE_FIELD, number_layout(ViewMode.WHOLE_FIELD, 260.0, 6.0), DAY)
    field = shapely.Polygon(FIELD)
    assert not any(field.contains(shapely.Point(stroke[0, :2])) for stroke in lines.points)


def test_numbers_of_the_whole_field_do_not_stand_on_each_other() -> None:
    short = [
        Pass(number=number, points=np.array([[east, 20.0], [east, 20.0 + number % 3]]), order=number)
        for number, east in enumerate(np.linspace(40.0, 43.0, 12), start=1)
    ]
    snapshot = replace(field_snapshot(), passes=(*straight_passes(6), *short))
    layout = number_layout(ViewMode.WHOLE_FIELD, 260.0, 6.0)
    lines = numbers(snapshot, None, ViewMode.WHOLE_FIELD, layout, DAY)
    strokes = shapely.union_all([shapely.LineString(one[:, :2]).buffer(0.2 * layout.size) for one in lines.points])
    heights = [part.bounds[3] - part.bounds[1] for part in shapely.get_parts(strokes)]
    assert max(heights) < 2.5 * layout.size


@pytest.mark.parametrize("mode", [ViewMode.DRIVER, ViewMode.HEADING_UP, ViewMode.NORTH_UP])
def test_numbers_of_lines_that_lie_close_do_not_stand_on_each_other(mode: ViewMode) -> None:
    layout = number_layout(mode, 20.0, 6.0)
    close = straight_passes(20, spacing=0.4 * layout.size)
    snapshot = replace(field_snapshot(), passes=close)
    shown = Shown(6.0, 60.0, 0.0, heading_known=True, stale=False)
    lines = numbers(snapshot, shown, mode, layout, DAY)
    glyphs = shapely.union_all([shapely.LineString(one[:, :2]).buffer(0.1 * layout.size) for one in lines.points])
    widths = [part.bounds[2] - part.bounds[0] for part in shapely.get_parts(glyphs)]
    assert len(widths) > 2
    assert max(widths) < 1.4 * layout.size


def test_the_target_has_its_number_in_the_whole_field_whatever_is_left_out() -> None:
    snapshot = field_snapshot()
    assert snapshot.guidance is not None
    colour = vertex_source(DAY.pass_target)
    for number in (1, 2, 3):
        target = next(one for one in snapshot.passes if one.number == number)
        driven = replace(snapshot, guidance=replace(snapshot.guidance, target=target))
        lines = numbers(driven, None, ViewMode.WHOLE_FIELD, number_layout(ViewMode.WHOLE_FIELD, 2000.0, 6.0), DAY)
        assert (lines.colours == colour).all(axis=-1).any()


# --- what moves ----------------------------------------------------------------------------------------------------


def test_the_shown_pose_is_carried_on_and_then_becomes_stale() -> None:
    snapshot = field_snapshot(100.0)
    at_fix, later, stale = (shown_pose(snapshot, now) for now in (100.0, 100.4, 130.0))
    assert at_fix is not None
    assert later is not None
    assert stale is not None
    assert later.north - at_fix.north == pytest.approx(1.0, abs=CENTIMETRE)
    assert not later.stale
    assert stale.stale
    assert stale.north - at_fix.north == pytest.approx(2.5, abs=CENTIMETRE)
    assert shown_pose(replace(snapshot, pose=None), 100.0) is None
    before = shown_pose(snapshot, 90.0)
    assert before is not None
    assert before.north == at_fix.north


def test_a_slow_receiver_is_given_two_epochs() -> None:
    slow = replace(field_snapshot(100.0), fix_interval=2.0)
    shown = shown_pose(slow, 103.5)
    assert shown is not None
    assert not shown.stale


def test_a_turn_is_yellow_then_red_and_red_where_it_does_not_fit() -> None:
    def colour(seconds: float | None, *, fits: bool = True) -> tuple[int, int, int]:
        return turn_colour(TurnGuide(10.0, seconds, np.zeros((2, 2)), fits=fits), DAY)

    assert colour(30.0) == colour(None) == DAY.turn
    assert colour(9.0) == DAY.turn_soon
    assert colour(1.0) == DAY.turn_now
    assert colour(30.0, fits=False) == DAY.turn_now


@given(st.floats(0.003, 4.0), st.floats(0.003, 4.0), st.floats(-0.99, 0.99))
def test_the_ellipse_holds_two_standard_deviations(var_east: float, var_north: float, correlation: float) -> None:
    cov = correlation * math.sqrt(var_east * var_north)
    outline = ellipse((var_east, cov, var_north))
    assert outline is not None
    inverse = np.linalg.inv(np.array([[var_east, cov], [cov, var_north]]))
    distance = np.einsum("ni,ij,nj->n", outline, inverse, outline)
    assert distance == pytest.approx(4.0, rel=1e-3)


def test_a_small_or_unknown_uncertainty_is_not_drawn() -> None:
    assert ellipse(None) is None
    assert ellipse((0.0004, 0.0, 0.0004)) is None
