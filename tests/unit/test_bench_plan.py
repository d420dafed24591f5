"""The bench of plans: every row of what is asked, a peer that fails is told so, a folder without fields too."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from guidance_app.bench import plan
from guidance_app.bench.errors import BenchError
from guidance_app.bench.plan_cases import case_of, outside, tightest
from guidance_app.bench.plan_counter import counter_row
from guidance_app.bench.plan_peers import peer_case
from guidance_app.bench.rows import Row
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.planning import PlanRequest
from guidance_app.model import FloatArray, Segment, SegmentKind

FIELD = shapely.Polygon([(0, 0), (150, 0), (170, 90), (0, 80)])
ASKED = (
    "plans with a point outside",
    "turns that do not fit",
    "mainland worked",
    "field worked, median",
    "field worked, p10",
    "worked twice, median",
    "worked twice without lengthening",
    "not worked over worked",
    "CPU, median",
    "CPU, p95",
    "100 ha at 6 m",
    "four times as many passes",
    "best direction",
    "fewest middle lines",
    "planning the rest again",
    "odd fields",
    "counter",
)


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> list[Row]:
    folder = tmp_path_factory.mktemp("fields")
    ring = FieldFrame(48.0, 11.0).lonlat_from_array(shapely.get_coordinates(FIELD)).tolist()
    geometry = {"type": "Polygon", "coordinates": [[*ring[:-1], ring[0]]]}
    (folder / "a.geojson").write_text(json.dumps(geometry), encoding="utf-8")
    return plan.measured(folder)


@pytest.mark.parametrize("quantity", ASKED)
def test_every_quantity_that_is_asked_has_its_row(rows: list[Row], quantity: str) -> None:
    assert any(quantity in row.quantity for row in rows)


def test_what_must_hold_on_any_field_holds(rows: list[Row]) -> None:
    for row in rows:
        if "point outside" in row.quantity:
            assert row.value == 0 or "peer" in row.note
        if "mainland worked" in row.quantity:
            assert row.value >= 0.9999
        if "counter" in row.quantity:
            assert row.value <= 1e-3


def test_a_folder_without_fields_is_said(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="no GeoJSON"):
        plan.measured(tmp_path)


def test_a_case_counts_what_lies_outside() -> None:
    case = case_of("a", FIELD, PlanRequest(width=9.0))
    assert case.outside == 0
    assert case.worked > 0.98
    assert 0.9 < case.tightest <= 1.0
    assert outside(shapely.LineString([(10, 10), (10, -1)]), FIELD) == 5  # the one on the boundary too


def test_the_tightest_bend_is_found_wherever_it_is() -> None:
    def way(points: FloatArray, **more: bool) -> Segment:
        closed = more.get("closed", False)
        return Segment(SegmentKind.PASS, 1, points, implement_down=True, length=1.0, closed=closed)

    angles = np.arange(0.0, 2 * np.pi, 0.05)
    circle = 4.0 * np.column_stack([np.cos(angles), np.sin(angles)])
    assert tightest([way(circle)], 5.0) == pytest.approx(1.25, rel=1e-3)
    assert tightest([way(np.array([[0.0, 0.0], [9.0, 9.0]]), closed=True)], 5.0) > 1.0
    corner = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])
    sharp = 5.0 * np.pi / 2 / 10.0
    assert tightest([way(corner)], 5.0) == pytest.approx(sharp)
    assert tightest([way(corner[:2]), way(corner[1:])], 5.0) == pytest.approx(sharp)
    assert tightest([way(corner[:2]), replace(way(corner[1:]), reverse=True)], 5.0) == 0.0
    assert tightest([replace(way(corner), fits=False)], 5.0) == 0.0


def test_a_peer_is_measured_and_a_peer_that_fails_is_told() -> None:
    def straight(polygon: shapely.Polygon, width: float, radius: float, laps: int) -> FloatArray:
        del polygon, width, radius, laps
        return np.array([(10.0, 40.0), (140.0, 40.0)])

    def broken(polygon: shapely.Polygon, width: float, radius: float, laps: int) -> FloatArray:
        del polygon, width, radius, laps
        raise IndexError("a list")

    made = peer_case(straight, FIELD, 6.0, 5.0, 2)
    assert made.worked == pytest.approx(130 * 6 / FIELD.area)
    assert made.outside == 0
    assert "IndexError" in peer_case(broken, FIELD, 6.0, 5.0, 2).failed


def test_the_counter_is_right_on_a_plan() -> None:
    assert counter_row("a", FIELD).value < 1e-3
