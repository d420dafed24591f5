"""``guidance-app plan`` at the desk: each option does what it says, and odd fields give a plan or one sentence."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from guidance_app.cli import main
from guidance_app.documents import FieldDocument, Geometry, GuidanceLineDocument, LineGeometry
from guidance_app.geodesy import FieldFrame
from guidance_app.model import FloatArray

FRAME = FieldFrame(47.5, 8.5)
DEGREE = math.radians(1.0)
CORNERS = [(-90.0, -60.0), (90.0, -60.0), (90.0, 70.0), (-60.0, 60.0)]
HOLES = (
    [(-40.0, -5.0), (-20.0, -5.0), (-20.0, 12.0), (-40.0, 12.0)],
    [(30.0, 0.0), (48.0, 0.0), (48.0, 14.0), (30.0, 14.0)],
)
LINE = [(-50.0, -30.0), (50.0, 10.0)]


def degrees(points: Any) -> list[tuple[float, float]]:
    return [(float(lon), float(lat)) for lon, lat in FRAME.lonlat_from_array(np.asarray(points, dtype=float))]


def ring(points: Any) -> list[tuple[float, float]]:
    made = degrees(points)
    return [*made, made[0]]


@pytest.fixture
def field(tmp_path: Path) -> Path:
    """A field document with two exclusions and a guidance line."""
    document = FieldDocument(
        name="Two ponds",
        boundary=Geometry(coordinates=[ring(CORNERS), *(ring(hole) for hole in HOLES)]),
        lines=[GuidanceLineDocument(name="ditch", geometry=LineGeometry(coordinates=degrees(LINE)))],
    )
    path = tmp_path / "field.json"
    path.write_text(document.model_dump_json(), encoding="utf-8")
    return path


def planned(field: Path, capsys: pytest.CaptureFixture[str], *more: str) -> dict[str, Any]:
    assert main(["plan", str(field), "--width", "9", "--radius", "5", "--json", *more]) == 0
    made: dict[str, Any] = json.loads(capsys.readouterr().out)
    return made


def passes(plan: dict[str, Any]) -> list[FloatArray]:
    return [FRAME.array_from_lonlat(each["points_lonlat"]) for each in plan["segments"] if each["kind"] == "pass"]


def heading(line: FloatArray) -> float:
    """Modulo half a turn."""
    east, north = line[-1] - line[0]
    return math.atan2(east, north) % math.pi


def crossed(plan: dict[str, Any]) -> set[int]:
    """The exclusions that a pass goes through, counted from 1."""
    holes = [shapely.Polygon(hole).buffer(-0.5) for hole in HOLES]
    lines = [shapely.LineString(one) for one in passes(plan)]
    return {number for number, hole in enumerate(holes, start=1) if any(hole.intersects(line) for line in lines)}


@pytest.mark.parametrize(("asked", "over"), [(None, set()), ("1", {1}), ("2", {2}), ("1,2", {1, 2}), ("all", {1, 2})])
def test_exclusions_are_passable_by_their_numbers(
    field: Path, capsys: pytest.CaptureFixture[str], asked: str | None, over: set[int]
) -> None:
    more = [] if asked is None else ["--passable", asked]
    assert crossed(planned(field, capsys, *more)) == over


@pytest.mark.parametrize(
    ("asked", "wanted"),
    [
        ("edge", math.atan2(150.0, 10.0)),
        ("line", math.atan2(100.0, 40.0)),
        ("line:ditch", math.atan2(100.0, 40.0)),
        ("30", math.radians(30)),
    ],
)
def test_the_direction_is_an_edge_a_line_or_typed(
    field: Path, capsys: pytest.CaptureFixture[str], asked: str, wanted: float
) -> None:
    if asked == "edge":
        (lon, lat), *_ = degrees([(10.0, 64.0)])
        asked = f"edge:{lon:.7f},{lat:.7f}"
    longest = max(passes(planned(field, capsys, "--direction", asked)), key=lambda one: math.dist(one[0], one[-1]))
    assert abs(math.sin(heading(longest) - wanted)) < DEGREE


def test_the_methods_options_and_the_order(field: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plain = planned(field, capsys, "--method", "transfer", "--passable", "all")
    skipping = planned(field, capsys, "--method", "transfer", "--passable", "all", "--option", "skip=3")
    assert [each["number"] for each in plain["segments"]] != [each["number"] for each in skipping["segments"]]
    first = planned(field, capsys, "--laps-first")
    works = [each["kind"] for each in first["segments"] if each["implement_down"]]
    assert works[0] == "lap"
    assert works[-1] == "pass"


@pytest.mark.parametrize(
    "more",
    [
        ["--anticlockwise"],
        ["--turning-space", "30"],
        ["--start-corner", "last-right"],
        ["--no-reverse"],
        ["--last-pass", "even"],
        ["--overlap", "1"],
        ["--laps", "3"],
        ["--start", "{start}"],
        ["--start-corner", "nearest", "--laps-first", "--exit", "{start}"],
    ],
    ids=" ".join,
)
def test_every_option_changes_the_plan(field: Path, capsys: pytest.CaptureFixture[str], more: list[str]) -> None:
    (lon, lat), *_ = degrees([(85.0, 60.0)])
    filled = [one.format(start=f"{lon:.7f},{lat:.7f}") for one in more]
    base = ["--laps-first"] if "--exit" in more else []
    assert planned(field, capsys, *filled)["segments"] != planned(field, capsys, *base)["segments"]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--passable", "3"], "no exclusion 3"),
        (["--passable", "x"], "names no exclusions"),
        (["--direction", "edge:8.6,47.5"], "no edge of the field"),
        (["--direction", "edge:north"], "--direction is"),
        (["--direction", "line:hedge"], "no guidance line 'hedge'"),
        (["--option", "skip"], "NAME=VALUE"),
        (["--option", "colour=red"], "colour"),
        (["--option", "skip=many", "--method", "transfer"], "skip"),
        (["--start", "8.5"], "is no place"),
        (["--turning-space", "-3"], "turning space"),
        (["--width", "nan"], "width"),
        (["--radius", "0"], "radius"),
        (["--radius", "300"], "radius"),
    ],
)
def test_what_cannot_be_asked_is_one_sentence(
    field: Path, capsys: pytest.CaptureFixture[str], more: list[str], said: str
) -> None:
    try:
        status: object = main(["plan", str(field), "--width", "9", "--radius", "5", *more])
    except SystemExit as stopped:  # argparse's own way out
        status = stopped.code
    assert status == 2
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert said in last


def test_what_is_about_one_field_is_refused_for_a_folder(field: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for more in (["--passable", "1"], ["--start", "8.5,47.5"], ["--direction", "edge:8.5,47.5"]):
        assert main(["plan", str(field.parent), "--width", "9", "--radius", "5", *more]) == 2
        assert "one field" in capsys.readouterr().err
    assert main(["plan", str(field.parent), "--width", "9", "--radius", "5", "--passable", "all"]) == 0


def geojson(tmp_path: Path, *parts: list[list[tuple[float, float]]]) -> Path:
    kind = "Polygon" if len(parts) == 1 else "MultiPolygon"
    coordinates: Any = parts[0] if len(parts) == 1 else list(parts)
    path = tmp_path / "odd.geojson"
    path.write_text(json.dumps({"type": kind, "coordinates": coordinates}), encoding="utf-8")
    return path


def circle(count: int) -> list[tuple[float, float]]:
    turn = np.linspace(0.0, 2 * np.pi, count, endpoint=False)
    return ring(np.column_stack([80.0 * np.cos(turn), 60.0 * np.sin(turn)]))


SQUARE = [(0.0, 0.0), (150.0, 0.0), (150.0, 120.0), (0.0, 120.0)]
ODD: dict[str, list[list[list[tuple[float, float]]]]] = {
    "in two parts": [[ring(SQUARE)], [ring([(e + 400.0, n) for e, n in SQUARE])]],
    "a sliver": [[ring([(0.0, 0.0), (200.0, 0.0), (200.0, 0.4), (0.0, 0.4)])]],
    "a hole touching the border": [[ring(SQUARE), ring([(0.0, 40.0), (20.0, 40.0), (20.0, 60.0), (0.0, 60.0)])]],
    "a hole across the border": [[ring(SQUARE), ring([(-5.0, 40.0), (20.0, 40.0), (20.0, 60.0), (-5.0, 60.0)])]],
    "duplicate points": [[ring([point for point in SQUARE for _ in range(3)])]],
    "10,000 vertices": [[circle(10_000)]],
    "crossing itself": [[ring([(0.0, 0.0), (150.0, 120.0), (150.0, 0.0), (0.0, 120.0)])]],
    "a point": [[ring([(0.0, 0.0), (0.0, 0.0), (0.0, 0.0)])]],
}


@pytest.mark.parametrize("what", ODD)
def test_odd_fields_give_a_plan_or_one_sentence(what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = geojson(tmp_path, *ODD[what])
    status = main(["plan", str(path), "--width", "9", "--radius", "5", "--json"])
    told = capsys.readouterr()
    if status == 0:
        plan = json.loads(told.out)
        assert plan["costs"]["worked_fraction"] > 0.5 or plan["warnings"]
    else:
        assert status == 2
        assert len(told.err.strip().splitlines()) == 1


def test_a_start_outside_is_a_warning_in_words(field: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = planned(field, capsys, "--start", "8.51,47.5")
    assert any("start lies outside" in each for each in plan["warnings"])
