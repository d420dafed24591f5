"""Foot points, signs, the choice of the pass: what holds for every line, pose and drive."""

import copy
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from support.passes import a_pose, drive, poses_along, round_trip, rounded_ring

from guidance_app.geodesy import MAX_REACH
from guidance_app.guidance.family import Circles, OffsetCurves, ParallelLines
from guidance_app.guidance.offsets import LineOffsets
from guidance_app.guidance.polyline import Polyline
from guidance_app.guidance.tracking import Tracker, cross_track
from guidance_app.model import FloatArray, Guidance, OffsetKind

MICROMETRE = 1e-6
MILLIMETRE = 1e-3
NOT_CLOSED_NOR_ENDLESS = (False, False)
SPACING = 4.0

metres = st.floats(-500.0, 500.0)
places = st.tuples(metres, metres)
headings = st.floats(-math.pi, math.pi)


@st.composite
def bent_lines(draw: st.DrawFn) -> FloatArray:
    """Lines of 2 to 30 points that bend by at most 60 degrees a corner."""
    turns = draw(st.lists(st.floats(-1.05, 1.05), min_size=1, max_size=29))
    steps = draw(st.lists(st.floats(0.5, 40.0), min_size=len(turns), max_size=len(turns)))
    heading = np.cumsum(turns)
    moves = np.column_stack([np.sin(heading), np.cos(heading)]) * np.array(steps)[:, None]
    return np.vstack([[0.0, 0.0], np.cumsum(moves, axis=0)])


@given(bent_lines(), places)
def test_distance_is_that_to_the_line(points: FloatArray, place: tuple[float, float]) -> None:
    line = Polyline.through(points)
    foot = line.foot(*place)
    assert foot.distance == pytest.approx(shapely.LineString(points).distance(shapely.Point(place)), abs=MICROMETRE)
    if 0 <= foot.along <= line.length:
        assert abs(foot.cross) == pytest.approx(foot.distance, abs=MICROMETRE)


@pytest.mark.parametrize(
    "points", [[], [[1.0, 2.0]], [[1.0, 2.0], [1.0, 2.0]], [[0.0, 0.0], [math.nan, 1.0]], [[0.0, 0.0], [math.inf, 1.0]]]
)
@pytest.mark.parametrize("closed", [False, True])
def test_what_has_no_direction_is_no_line(points: list[list[float]], closed: bool) -> None:
    with pytest.raises(ValueError, match="a line to follow needs"):
        Polyline.through(np.array(points).reshape(-1, 2), closed=closed)


@given(bent_lines(), places)
def test_mirrored_world_mirrored_sign(points: FloatArray, place: tuple[float, float]) -> None:
    mirror = np.array([-1.0, 1.0])
    foot = Polyline.through(points).foot(*place)
    mirrored = Polyline.through(points * mirror).foot(-place[0], place[1])
    assert mirrored.cross == pytest.approx(-foot.cross, abs=MICROMETRE)
    assert math.sin(mirrored.direction + foot.direction) == pytest.approx(0, abs=MICROMETRE)
    assert mirrored.along == pytest.approx(foot.along, abs=MICROMETRE)


@given(bent_lines(), st.floats(-1.0, 1.0), st.floats(0.0, 1.0))
def test_turned_round_the_line_has_its_sides_changed(points: FloatArray, side: float, part: float) -> None:
    line = Polyline.through(points)
    on_it = shapely.LineString(points).interpolate(part, normalized=True)
    place = (on_it.x + side, on_it.y)
    there, back = line.foot(*place), Polyline.through(points[::-1]).foot(*place)
    assert back.distance == pytest.approx(there.distance, abs=MICROMETRE)
    assert abs(back.cross) == pytest.approx(abs(there.cross), abs=MICROMETRE)
    if abs(there.cross) > MILLIMETRE and abs(back.along - line.length + there.along) < MILLIMETRE:
        assert back.cross == pytest.approx(-there.cross, abs=MICROMETRE)


@given(bent_lines(), st.floats(-2.0, 2.0))
def test_search_near_the_last_foot_finds_what_the_whole_search_finds(points: FloatArray, side: float) -> None:
    line = Polyline.through(points)
    ideal = shapely.LineString(points)
    near = 0.0
    for along in np.arange(0.0, line.length, 2.0):
        place = ideal.interpolate(along)
        whole = line.foot(place.x + side, place.y)
        if abs(whole.along - along) < 5.0:
            assert line.foot(place.x + side, place.y, near, 15.0).distance <= whole.distance + MICROMETRE
        near = float(along)


@given(st.floats(-3.0, 3.0), st.floats(5.0, 12.0))
def test_round_a_lap_cross_track_and_direction_have_no_step(side: float, radius: float) -> None:
    ring = rounded_ring(60.0, radius)
    line = Polyline.through(ring, closed=True)
    driven = np.vstack([rounded_ring(60.0 + 2 * side, radius + side), rounded_ring(60.0 + 2 * side, radius + side)[:1]])
    feet = [line.foot(pose.east, pose.north) for pose in poses_along(driven, speed=1.0)]
    cross = np.array([foot.cross for foot in feet])
    assert np.ptp(cross) < 0.05
    assert abs(cross.mean() + side) < 0.05
    turned = np.diff(np.unwrap([foot.direction for foot in feet]))
    assert np.abs(turned).max() < 3.0 * INTERVAL_TURN / (radius - 3.0)


INTERVAL_TURN = 0.1
"""Metres driven between two of these poses."""


@given(bent_lines(), places, headings)
def test_cross_track_for_one_pose_agrees_with_the_line(
    points: FloatArray, place: tuple[float, float], heading: float
) -> None:
    cross, error = cross_track(points, *NOT_CLOSED_NOR_ENDLESS, *place, heading)
    foot = Polyline.through(points).foot(*place)
    assert abs(cross) == abs(foot.cross)
    assert abs(error) <= math.pi / 2 + MICROMETRE


# --- families ---------------------------------------------------------------------------------------------------------


@given(places, places.filter(lambda place: math.hypot(*place) > 1.0), st.integers(-50, 50), st.floats(0.5, 40.0))
def test_parallel_lines_count_to_the_right(
    start: tuple[float, float], way: tuple[float, float], number: int, spacing: float
) -> None:
    family = ParallelLines(start, (start[0] + way[0], start[1] + way[1]), spacing)
    line = family.pass_numbered(number)
    assert line is not None
    assert Polyline.through(family.pass_numbered(0).points, endless=True).foot(*line.points[0]).cross == pytest.approx(
        number * spacing, abs=MICROMETRE * (1 + abs(number) * spacing)
    )
    assert family.nearest_number(*line.points[0]) == number


def a_curve() -> FloatArray:
    """Soft bends of at least 40 m radius."""
    north = np.arange(0.0, 400.0, 2.0)
    return np.column_stack([30.0 * np.sin(north / 60.0), north])


@given(st.integers(-6, 6))
def test_offset_curves_keep_their_distance(number: int) -> None:
    family = OffsetCurves(a_curve(), SPACING)
    line = family.pass_numbered(number)
    assert line is not None
    base = Polyline.through(a_curve(), endless=True)
    feet = [base.foot(*point) for point in shapely.get_coordinates(shapely.LineString(line.points).segmentize(1.0))]
    off = np.array([foot.cross - number * SPACING for foot in feet])
    assert np.abs(off).max() < 0.02
    assert {family.nearest_number(*point) for point in line.points} == {number}


def test_offset_curve_of_a_hairpin_has_no_loop() -> None:
    angles = np.linspace(0.0, math.pi, 60)
    bend = np.column_stack([5.0 - 5.0 * np.cos(angles), 50.0 + 5.0 * np.sin(angles)])
    hairpin = np.vstack([[[0.0, 0.0]], bend, [[10.0, 0.0]]])
    for number in (-3, -1, 1):
        line = OffsetCurves(hairpin, SPACING).pass_numbered(number)
        assert line is not None
        assert shapely.LineString(line.points).is_simple
        assert shapely.LineString(line.points).distance(shapely.LineString(hairpin)) == pytest.approx(
            abs(number) * SPACING, abs=0.02
        )


@given(st.integers(-20, 9))
def test_circles_lie_inside_one_another(number: int) -> None:
    family = Circles((10.0, -5.0), 40.0, SPACING)
    circle = family.pass_numbered(number)
    assert circle is not None
    radius = np.hypot(*(circle.points - (10.0, -5.0)).T)
    assert radius == pytest.approx(40.0 - number * SPACING, abs=2 * MILLIMETRE)
    assert family.nearest_number(*circle.points[3]) == number
    clockwise = not shapely.is_ccw(shapely.linearrings(circle.points))
    assert clockwise


@given(st.floats(-30.0, 30.0), st.floats(-3.0, 3.0))
def test_a_shifted_family_is_the_family_elsewhere(first: float, second: float) -> None:
    for family in (ParallelLines((0, 0), (10, 100), SPACING), Circles((0, 0), 80.0, SPACING)):
        moved = family.shifted(first).shifted(second)
        expected = family.shifted(first + second).pass_numbered(0)
        found = moved.pass_numbered(0)
        assert found is not None
        assert expected is not None
        assert found.points == pytest.approx(expected.points, abs=MICROMETRE)


# --- the tracker ------------------------------------------------------------------------------------------------------


def ab_tracker() -> Tracker:
    return Tracker(ParallelLines((0.0, 0.0), (0.0, 100.0), SPACING), SPACING)


@settings(max_examples=40)
@given(st.lists(st.floats(-0.6, 0.6), min_size=20, max_size=120), st.booleans(), st.randoms(use_true_random=False))
def test_while_it_works_on_a_pass_the_target_never_changes(turns: list[float], plan: bool, random: object) -> None:
    """Drifting over several spacings, with jumps of the position, as long as the heading stays along the pass."""
    tracker = Tracker(round_trip(6), SPACING) if plan else ab_tracker()
    drive(tracker, [a_pose(0.0, 0.0, 1.0), a_pose(0.1, 0.0, 1.2), a_pose(0.2, 0.0, 1.4)], working=True)
    east, north = 0.0, 1.4
    for i, turn in enumerate(turns):
        east += 0.3 * math.sin(turn) + random.uniform(-1.0, 1.0)
        north += 0.3
        guidance = tracker.step(a_pose(0.3 + 0.1 * i, east, north, turn), (east, north), working=True)
        assert guidance is not None
        assert guidance.target.number == (1 if plan else 0)


@settings(max_examples=40)
@given(st.floats(-0.5, 0.5), st.integers(0, 2**32 - 1))
def test_between_two_passes_noise_does_not_make_the_target_flutter(heading: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    tracker = ab_tracker()
    numbers = []
    for i in range(200):
        east = 0.5 * SPACING + rng.uniform(-0.09, 0.09) * SPACING
        guidance = tracker.step(a_pose(0.1 * i, east, 0.3 * i, heading), (east, 0.3 * i), working=False)
        assert guidance is not None
        numbers.append(guidance.target.number)
    assert np.count_nonzero(np.diff(numbers)) == 0


anything = st.floats(allow_nan=True, allow_infinity=True)


@given(st.lists(st.tuples(anything, anything, anything, anything, st.booleans()), max_size=8), st.booleans())
def test_guidance_is_finite_for_any_pose(poses: list[tuple[float, float, float, float, bool]], plan: bool) -> None:
    tracker = Tracker(round_trip(3), SPACING) if plan else ab_tracker()
    for t, east, north, heading, working in poses:
        guidance = tracker.step(a_pose(t, east, north, heading), (east, north), working)
        if guidance is None:
            assert not (
                math.isfinite(t) and math.isfinite(heading) and all(abs(one) <= MAX_REACH for one in (east, north))
            )
        else:
            assert _is_finite(guidance)


def _is_finite(guidance: Guidance) -> bool:
    numbers = [guidance.cross_track, guidance.heading_error, guidance.along_track]
    if guidance.remaining is not None:
        numbers.append(guidance.remaining)
    if guidance.turn is not None:
        numbers.append(guidance.turn.distance)
    return all(map(math.isfinite, numbers))


@settings(max_examples=25)
@given(st.integers(0, 400), st.integers(0, 2**32 - 1))
def test_a_fork_goes_on_like_the_tracker_and_leaves_it_alone(cut: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    poses = [
        a_pose(0.1 * i, 0.02 * i + rng.normal(0, 0.2), 20.0 * math.sin(0.02 * i), rng.uniform(-3, 3))
        for i in range(450)
    ]
    work = rng.random(len(poses)) < 0.7
    tracker = Tracker(round_trip(4), SPACING)

    def told(one: Tracker, first: int, behind: int) -> list[tuple[float, float, int, frozenset[int]]]:
        answers = (one.step(poses[i], (poses[i].east, poses[i].north), bool(work[i])) for i in range(first, behind))
        return [(a.cross_track, a.along_track, a.target.number, a.done) for a in answers if a is not None]

    told(tracker, 0, cut)
    fork, other = tracker.fork(), tracker.fork()
    other.shift(0.5)
    other.take(3)
    told(other, 0, cut)
    assert told(fork, cut, 450) == told(tracker, cut, 450)


@given(st.floats(-2.0, 2.0), st.sampled_from(list(OffsetKind)[:3]), st.booleans(), st.booleans())
def test_shifted_lines_shift_the_error_and_come_back(
    metres: float, kind: OffsetKind, plan: bool, southward: bool
) -> None:
    tracker = Tracker(round_trip(4), SPACING) if plan else ab_tracker()
    pose = a_pose(0.0, 4.3 if southward else 0.3, 20.0, math.pi if southward else 0.0)
    if plan and southward:
        tracker.take(2)
    before = drive(tracker, [pose], working=False)[0]
    assert tracker.shift(metres, kind)
    after = drive(tracker, [pose], working=False)[0]
    assert after.cross_track == pytest.approx(before.cross_track - metres, abs=MICROMETRE)
    assert [record.kind for record in tracker.offsets] == [kind]
    assert abs(tracker.offsets[0].metres) == pytest.approx(abs(metres))
    assert tracker.drop(kind)
    assert tracker.offsets == ()
    assert drive(tracker, [pose], working=False)[0].cross_track == pytest.approx(before.cross_track, abs=MICROMETRE)


def test_a_position_offset_is_no_line_offset() -> None:
    with pytest.raises(ValueError, match="line offsets"):
        LineOffsets().plus(OffsetKind.MARK, 1.0, 0.0)


@given(st.floats(-1.9, 1.9), st.booleans())
def test_line_here_brings_the_line_here(east: float, plan: bool) -> None:
    tracker = Tracker(round_trip(4), SPACING) if plan else ab_tracker()
    pose = a_pose(0.0, east, 20.0)
    drive(tracker, [pose], working=False)
    assert tracker.line_here((east, 20.0), arrival=7.0)
    assert drive(tracker, [copy.copy(pose)], working=False)[0].cross_track == pytest.approx(0.0, abs=MICROMETRE)
    assert tracker.offsets[0].kind is OffsetKind.LINE_HERE
    assert tracker.offsets[0].arrival == 7.0
