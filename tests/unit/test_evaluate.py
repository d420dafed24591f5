"""``evaluate``: rows, goals, JSON, figures and its refusals."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from guidance_app.evaluation.figures import draw_figures
from guidance_app.evaluation.parallel import in_this_process, spread_over
from guidance_app.evaluation.real import fixes_of
from guidance_app.evaluation.rows import Row, as_dicts, as_table, at_least, at_most, between, unmet


def evaluate(*arguments: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-m", "guidance_app", "evaluate", *arguments],
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
    )


def test_goals_are_met_on_their_bounds() -> None:
    assert at_most(3.0).met_by(3.0)
    assert not at_most(3.0).met_by(3.01)
    assert at_least(2.0).met_by(2.0)
    assert not between(3.5, 4.0).met_by(4.2)
    assert between(3.5, 4.0).met_by(3.74)


def test_a_row_that_misses_its_goal_is_marked() -> None:
    rows = [
        Row("p", "good", "cm", 1.0, paper=2.0, goal=at_most(1.5)),
        Row("p", "bad", "cm", 2.0, goal=at_most(1.5)),
        Row("p", "plain", "cm", 7.0),
    ]
    assert [row.quantity for row in unmet(rows)] == ["bad"]
    good, bad, plain = as_table(rows).splitlines()[2:]
    assert "*" not in good
    assert "2.00*" in bad
    assert "*" not in plain


def test_rows_as_json_have_all_that_is_promised() -> None:
    entry = as_dicts([Row("p", "q", "cm", 1.25, paper=2.0, goal=between(1.0, 1.5))])[0]
    assert {"protocol", "quantity", "unit", "paper", "peer", "ours", "goal"} <= set(entry)
    assert (entry["goal"], entry["goal_low"], entry["met"]) == (1.5, 1.0, True)
    assert json.loads(json.dumps(entry)) == entry


def test_spread_work_keeps_its_order() -> None:
    with spread_over(2) as spread:
        assert spread(abs, [-3, 2, -1]) == in_this_process(abs, [-3, 2, -1]) == [3, 2, 1]


def test_the_command_prints_rows_as_json() -> None:
    result = evaluate("inoue", "--seeds", "2", "--processes", "1", "--json")
    assert result.returncode == 0, result.stderr
    rows = json.loads(result.stdout)
    assert len(rows) > 10
    for row in rows:
        assert {"protocol", "quantity", "unit", "paper", "ours", "goal"} <= set(row)
        assert isinstance(row["ours"], float)


def test_a_folder_without_recordings_is_named(tmp_path: Path) -> None:
    result = evaluate("real", "--data-logs", str(tmp_path))
    assert result.returncode == 2
    assert result.stderr.strip().splitlines()[-1].startswith(f"evaluate: {tmp_path} does not hold")


def test_figures_are_drawn_as_png_and_svg(tmp_path: Path, real_data: Path) -> None:
    pytest.importorskip("matplotlib")
    fixes = fixes_of((real_data / "nmea/tractor_9m/impl9m_TLG00001_4dec.nmea").read_bytes())
    paths = draw_figures(tmp_path, fixes[:600])
    assert {path.suffix for path in paths} == {".png", ".svg"}
    assert {path.stem for path in paths} == {
        *(f"gomez_gil_{number}" for number in ("10a", "10b", "11", "12", "13")),
        *(f"inoue_{number}" for number in ("08", "09", "13", "14")),
    }
    assert all(path.stat().st_size > 5000 for path in paths)
