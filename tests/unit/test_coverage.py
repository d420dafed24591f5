"""What counts as worked, worked twice, left and headland: one case, one rule."""

import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from support.worked import INTERVAL, Place, straight, union, work

from guidance_app.guidance.coverage import Coverage
from guidance_app.model import Strip

WIDTH = 6.0
EAST = math.pi / 2
THOUSANDTH = 1e-3


def worked_along(*passes: list[Place], width: float = WIDTH) -> Coverage:
    coverage = Coverage(width)
    t = 0.0
    for number, places in enumerate(passes):
        t = work(coverage, places, t, number)
    return coverage


def test_a_pass_works_its_length_times_its_width() -> None:
    totals = worked_along(straight((0.0, 0.0), 0.3, 100.0)).totals
    assert totals.worked == pytest.approx(600.0, rel=THOUSANDTH)
    assert totals.overlap == 0.0
    assert totals.distance == pytest.approx(100.0)
    assert totals.working_s == pytest.approx(200 * INTERVAL)
    assert totals.left is None


def test_neighbouring_passes_overlap_by_what_their_spacing_lacks() -> None:
    coverage = worked_along(straight((0.0, 0.0), 0.0, 100.0), straight((5.5, 100.0), math.pi, 100.0))
    assert coverage.totals.worked == pytest.approx(1150.0, rel=THOUSANDTH)
    assert coverage.totals.overlap == pytest.approx(50.0, abs=THOUSANDTH * 1150.0)
    assert coverage.of_pass(0).overlap == 0.0
    assert coverage.of_pass(1).overlap == coverage.totals.overlap
    assert coverage.of_pass(1).worked == pytest.approx(550.0, rel=2 * THOUSANDTH)
    assert coverage.of_pass(7).worked == 0.0


def test_ground_worked_three_times_counts_once_as_worked_twice() -> None:
    line = straight((0.0, 0.0), 0.0, 50.0)
    coverage = worked_along(line, line[::-1], line)
    assert coverage.totals.worked == pytest.approx(300.0, rel=THOUSANDTH)
    assert coverage.totals.overlap == pytest.approx(300.0, rel=THOUSANDTH)


def test_the_lifted_implement_works_nothing_and_the_state_holds_until_the_next_epoch() -> None:
    coverage = Coverage(WIDTH)
    for i in range(101):
        coverage.step((0.0, 1.0 * i, 0.0), INTERVAL * i, not 30 <= i < 60, 1)
    assert coverage.totals.worked == pytest.approx(70.0 * WIDTH, rel=2 * THOUSANDTH)
    assert coverage.totals.distance == pytest.approx(70.0)
    assert coverage.worked.count == 1


def test_standing_adds_nothing_whatever_the_receiver_trembles_within_5_cm() -> None:
    coverage = worked_along(straight((0.0, 0.0), 0.0, 10.0))
    before = coverage.totals
    rng = np.random.default_rng(1)
    for i in range(3000):
        east, north = rng.uniform(-0.015, 0.015, 2)
        coverage.step((east, 10.0 + north, 0.0), 100.0 + 0.1 * i, down=True, pass_number=1)
    after = coverage.totals
    assert (after.worked, after.distance, after.working_s) == (before.worked, before.distance, before.working_s)


def test_time_spent_standing_on_the_way_is_not_working_time() -> None:
    coverage = Coverage(WIDTH)
    places = [(0.0, 0.5 * i, 0.0) for i in range(41)]
    t = 0.0
    for i, place in enumerate(places):
        coverage.step(place, t, down=True, pass_number=1)
        for _ in range(600 if i == 20 else 0):
            t += 1.0
            coverage.step(place, t, down=True, pass_number=1)
        t += INTERVAL
    assert coverage.totals.distance == pytest.approx(20.0)
    assert coverage.totals.working_s < 40 * INTERVAL + 0.5 / 0.1


@pytest.mark.parametrize(
    ("seconds", "metres", "worked"),
    [(0.2, 4.0, True), (0.2, 6.0, False), (1.0, 8.0, True), (10.0, 3.0, True), (10.0, 12.0, False)],
    ids=["small step", "jump", "1 Hz at 29 km/h", "stood without fix", "drove without fix"],
)
def test_ground_over_which_the_position_jumped_was_not_worked(seconds: float, metres: float, worked: bool) -> None:
    coverage = Coverage(WIDTH)
    t = 0.0
    for i in range(21):
        t = 0.2 * i
        coverage.step((0.0, 0.4 * i, 0.0), t, down=True, pass_number=1)
    for i in range(21):
        coverage.step((0.0, 8.0 + metres + 0.4 * i, 0.0), t + seconds + 0.2 * i, down=True, pass_number=1)
    between = metres if worked else 0.0
    assert coverage.totals.worked == pytest.approx((16.0 + between) * WIDTH, rel=2 * THOUSANDTH)
    assert coverage.worked.count == (0 if worked else 1)


def test_a_receiver_that_speaks_every_five_seconds_is_believed() -> None:
    coverage = Coverage(WIDTH)
    for i in range(40):
        coverage.step((0.0, 10.0 * i, 0.0), 5.0 * i, down=True, pass_number=1)
    assert coverage.totals.distance == pytest.approx(390.0)


def test_left_is_the_field_without_what_was_worked_inside_it() -> None:
    field = shapely.box(0.0, 0.0, 12.0, 50.0)
    coverage = Coverage(WIDTH, field)
    assert coverage.totals.left == 600.0
    t = work(coverage, straight((3.0, -20.0), 0.0, 70.0), 0.0)
    assert coverage.totals.left == pytest.approx(300.0, abs=0.5)
    assert coverage.totals.worked == pytest.approx(420.0, rel=THOUSANDTH)
    work(coverage, straight((9.0, 70.0), math.pi, 90.0), t)
    assert coverage.totals.left == pytest.approx(0.0, abs=0.5)


def test_an_obstacle_in_the_field_is_not_left() -> None:
    field = shapely.box(0.0, 0.0, 6.0, 50.0).difference(shapely.box(2.0, 20.0, 4.0, 30.0))
    coverage = Coverage(WIDTH, field)
    work(coverage, straight((3.0, 0.0), 0.0, 50.0), 0.0)
    assert coverage.totals.left == pytest.approx(0.0, abs=0.3)


def test_headland_is_what_was_worked_outside_the_mainland() -> None:
    mainland = shapely.MultiPolygon([shapely.box(-10, 10, 10, 30), shapely.box(-10, 40, 10, 45)])
    coverage = Coverage(WIDTH, shapely.box(-10, 0, 10, 60), mainland)
    work(coverage, straight((0.0, 0.0), 0.0, 60.0), 0.0)
    assert coverage.totals.headland == pytest.approx(35.0 * WIDTH, rel=2 * THOUSANDTH)


def test_sections_that_are_off_work_nothing() -> None:
    coverage = Coverage(12.0, sections=6)
    places = straight((0.0, 0.0), 0.0, 50.0)
    work(coverage, places, 0.0, sections=0b100011)
    assert coverage.totals.worked == pytest.approx(6.0 * 50.0, rel=2 * THOUSANDTH)
    work(coverage, places, 100.0, sections=0b011100)
    assert coverage.totals.worked == pytest.approx(600.0, rel=2 * THOUSANDTH)
    assert coverage.totals.overlap == 0.0
    work(coverage, places, 200.0, sections=0b000110)
    assert coverage.totals.overlap == pytest.approx(200.0, rel=2 * THOUSANDTH)


def test_section_0_is_the_leftmost() -> None:
    coverage = Coverage(12.0, sections=6)
    for i in range(4):
        coverage.step((0.0, 1.0 * i, 0.0), INTERVAL * i, down=True, pass_number=1, sections_on=0b000001)
    strip = coverage.worked.open_piece
    assert isinstance(strip, Strip)
    assert strip.left[:, 0] == pytest.approx(-6.0)
    assert strip.right[:, 0] == pytest.approx(-4.0)


def test_switching_sections_changes_the_width_from_the_next_epoch_on() -> None:
    coverage = Coverage(12.0, sections=2)
    for i in range(101):
        coverage.step((0.0, 1.0 * i, 0.0), INTERVAL * i, down=True, pass_number=1, sections_on=0b11 if i < 50 else 0b01)
    assert coverage.totals.worked == pytest.approx(50 * 12.0 + 50 * 6.0, rel=2 * THOUSANDTH)
    assert coverage.totals.overlap == 0.0


def test_all_sections_off_is_lifted() -> None:
    coverage = Coverage(12.0, sections=2)
    work(coverage, straight((0.0, 0.0), 0.0, 50.0), 0.0, sections=0)
    assert coverage.totals.worked == 0.0
    assert coverage.worked.count == 0


def test_strips_are_drawn_where_the_ground_was_worked() -> None:
    coverage = worked_along(straight((0.0, 0.0), 0.0, 300.0), straight((6.0, 300.0), math.pi, 300.0))
    trail = coverage.worked
    drawn = [piece for piece in trail.pieces[: trail.count] if isinstance(piece, Strip)]
    assert {strip.pass_number for strip in drawn} == {0, 1}
    outlines = [shapely.Polygon(np.vstack([strip.left, strip.right[::-1]])) for strip in drawn]
    assert union(outlines).area == pytest.approx(coverage.totals.worked, rel=THOUSANDTH)


def test_another_pass_without_lifting_begins_another_strip_but_no_overlap() -> None:
    coverage = Coverage(WIDTH)
    for i in range(101):
        coverage.step((0.0, 0.5 * i, 0.0), INTERVAL * i, down=True, pass_number=1 if i < 50 else 2)
    assert coverage.totals.overlap == 0.0
    assert coverage.worked.count == 1
    assert coverage.of_pass(1).distance + coverage.of_pass(2).distance == pytest.approx(50.0)


def test_six_passes_on_which_a_common_union_loses_a_sixth_of_the_area(real_data: Path) -> None:
    """``shapely.union_all`` answers 5,181.65 m2; the passes are 6 m apart and work 6,256.14 m2."""
    polygons = [
        shapely.from_wkt(line) for line in (real_data / "union_all_case.wkt").read_text().splitlines() if line.strip()
    ]
    exact = union(polygons).area
    assert exact == pytest.approx(6256.14, abs=0.01)
    coverage = Coverage(WIDTH)
    t = 0.0
    for polygon in polygons:
        corners = shapely.get_coordinates(polygon)[:4]
        ends = sorted((0.5 * (corners[i] + corners[(i + 1) % 4]) for i in range(4)), key=lambda end: end[1])
        (start_east, start_north), (end_east, end_north) = ends[0].tolist(), ends[-1].tolist()
        heading = math.atan2(end_east - start_east, end_north - start_north)
        length = math.hypot(end_east - start_east, end_north - start_north)
        t = work(coverage, straight((start_east, start_north), heading, length), t)
    assert coverage.totals.worked == pytest.approx(exact, rel=THOUSANDTH)


def test_the_size_of_the_ground_decides_the_memory_not_the_time() -> None:
    coverage = Coverage(WIDTH)
    line = straight((0.0, 0.0), 0.2, 100.0)
    t = work(coverage, line, 0.0)
    tiles = coverage.tiles
    for _ in range(5):
        t = work(coverage, line, t)
    assert coverage.tiles == tiles <= 24


@pytest.mark.parametrize(("width", "sections"), [(0.0, 1), (-3.0, 1), (math.nan, 1), (math.inf, 1), (3.0, 0)])
def test_an_implement_that_covers_nothing_is_refused(width: float, sections: int) -> None:
    with pytest.raises(ValueError, match="covers nothing"):
        Coverage(width, sections=sections)
