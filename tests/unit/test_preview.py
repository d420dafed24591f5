"""The table of plans: every wish once, the best marked, stopped when nobody asks for more."""

import itertools

import pytest
import shapely

from guidance_app.documents import Direction, Method, Units
from guidance_app.guidance.planning import plan_operation
from guidance_app.guidance.preview import CORNERS, METHODS, PreviewRow, best_of, preview
from guidance_app.guidance.request import PlanRequest
from guidance_app.language import ENGLISH
from guidance_app.view.plan_table import plan_rows

FIELD = shapely.Polygon([(0, 0), (160, 0), (190, 90), (0, 70)])
REQUEST = PlanRequest(width=9.0, method=Method.TRANSFER, options={"skip": 2})


@pytest.fixture(scope="module")
def rows() -> list[PreviewRow]:
    return list(preview(FIELD, REQUEST))


def test_every_method_direction_and_corner_has_its_row(rows: list[PreviewRow]) -> None:
    assert [row.number for row in rows] == list(range(1, len(rows) + 1))
    assert {row.count for row in rows} == {len(rows)}
    wishes = [(row.request.method, row.request.direction, row.request.start_corner) for row in rows]
    assert len(set(wishes)) == len(wishes)
    assert {method for method, _, _ in wishes} == set(METHODS)
    assert sum(method is Method.SURROUNDING for method, _, _ in wishes) == 1
    for method in METHODS[:3]:
        assert {corner for one, _, corner in wishes if one is method} == set(CORNERS)
    options = {row.request.method: dict(row.request.options) for row in rows}
    assert options == {method: {"skip": 2} if method is Method.TRANSFER else {} for method in METHODS}


def test_a_row_is_the_plan_that_its_wish_gives(rows: list[PreviewRow]) -> None:
    for row in (rows[0], rows[-2], rows[-1]):
        assert row.plan is not None
        assert row.plan.costs == plan_operation(FIELD, row.request).costs


def test_the_best_is_the_quickest_that_fits(rows: list[PreviewRow]) -> None:
    best = best_of(rows)
    assert best is not None
    assert best.plan is not None
    for row in rows:
        assert row.plan is not None
        assert (best.unfit, best.plan.costs.minutes) <= (row.unfit, row.plan.costs.minutes)
    shown = plan_rows(rows, Units.METRIC, ENGLISH)
    assert [row.number for row in shown if row.best] == [best.number]
    assert {len(row.cells) for row in shown} == {4}


def test_directions_that_come_to_the_same_are_planned_once() -> None:
    square = shapely.box(0, 0, 100, 60)
    asked = {row.request.direction for row in preview(square, PlanRequest(width=9.0), METHODS[:1], CORNERS[:1])}
    assert asked == {Direction.LONGEST_EDGE}


def test_it_can_be_stopped_after_any_row() -> None:
    table = preview(FIELD, REQUEST)
    assert [row.number for row in itertools.islice(table, 2)] == [1, 2]
    table.close()
    assert next(table, None) is None


def test_where_nothing_can_be_planned_each_row_says_why() -> None:
    rows = list(preview(shapely.box(0, 0, 2, 2), REQUEST))
    assert rows
    assert all(row.plan is None and row.reason for row in rows)
    assert best_of(rows) is None
    assert all(row.reason for row in plan_rows(rows, Units.METRIC, ENGLISH))
