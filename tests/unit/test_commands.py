"""The commands that work without a screen: tables and plans whole or not at all, bad use in one sentence."""

import csv
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from support.drives import a_field, path_chunks, up_and_down

from guidance_app.batch.processing import COLUMNS, longest_sigma
from guidance_app.cli import main
from guidance_app.commands import COMMANDS
from guidance_app.estimation.filter import FilterSettings
from guidance_app.exchange import write_field

DECIMETRE = 0.1


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "drive.nmea"
    path.write_bytes(b"".join(chunk.data for chunk in path_chunks(up_and_down())))
    return path


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("fields") / "square.geojson"
    write_field(a_field(), path)
    return path


def test_whoever_reads_the_output_may_leave_early(log: Path) -> None:
    """As in ``guidance-app inspect LOG | head``: no trace, and the shell's own status for it."""
    reading, writing = os.pipe()
    os.close(reading)
    try:
        command = [sys.executable, "-m", "guidance_app", "inspect", str(log)]
        ended = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, check=False)
    finally:
        os.close(writing)
    assert (ended.returncode, ended.stderr) == (128 + signal.SIGPIPE, b"")


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("how", [[], ["--filter", "off"], ["--smooth"]], ids=["filter", "off", "smoother"])
def test_a_log_becomes_a_table_with_every_column(log: Path, field: Path, tmp_path: Path, how: list[str]) -> None:
    out = tmp_path / "out.csv"
    assert main(["process", str(log), "--field", str(field), "--width", "6", "--out", str(out), *how]) == 0
    rows = rows_of(out)
    assert tuple(rows[0]) == COLUMNS
    assert len(rows) > 500
    assert rows[-1]["pass"]
    assert float(rows[-1]["worked_ha"]) > 0


def test_a_log_scored_against_itself_is_near(log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out.csv"
    assert main(["process", str(log), "--truth", str(log), "--out", str(out), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["rms_m"] < 5 * DECIMETRE
    assert {"percentile_95_m", "relative_rms_m", "heading_rms_deg"} <= said.keys()


def test_tuned_settings_are_taken_and_bad_ones_named(log: Path, tmp_path: Path, capsys) -> None:
    good, bad, out = tmp_path / "good.json", tmp_path / "bad.json", tmp_path / "out.csv"
    settings = FilterSettings().model_dump(mode="json")
    good.write_text(json.dumps(settings), encoding="utf-8")
    assert main(["process", str(log), "--settings", str(good), "--out", str(out)]) == 0
    settings["quantisation_kf"]["process_noise"] = [0.1, -1.0, 0.1, 0.1]
    bad.write_text(json.dumps(settings), encoding="utf-8")
    out.unlink()
    assert main(["process", str(log), "--settings", str(bad), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert "quantisation_kf.process_noise.1" in said
    assert "-1" in said
    assert not out.exists()
    bad.write_bytes(b'\xff{"quantisation_kf": ')
    assert main(["process", str(log), "--settings", str(bad), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert said.endswith("bad.json are no whole JSON document: expected value at line 1 column 1\n")


def test_smoother_and_filter_together_are_refused(log: Path, tmp_path: Path, capsys) -> None:
    out = tmp_path / "out.csv"
    assert main(["process", str(log), "--smooth", "--filter", "off", "--out", str(out)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not out.exists()


def test_the_longest_half_axis_of_an_ellipse() -> None:
    assert longest_sigma((4.0, 0.0, 1.0)) == pytest.approx(2.0)
    assert longest_sigma((1.0, 1.0, 1.0)) == pytest.approx(2.0**0.5)


@pytest.mark.parametrize("suffix", [".json", ".geojson", ".png", ".svg"])
def test_a_plan_is_written_in_each_form(field: Path, tmp_path: Path, suffix: str) -> None:
    out = tmp_path / f"plan{suffix}"
    assert main(["plan", str(field), "--width", "6", "--radius", "5", "--out", str(out)]) == 0
    assert out.stat().st_size > 1000


def test_a_plans_json_tells_segments_costs_and_warnings(field: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", str(field), "--width", "6", "--radius", "5", "--json"]) == 0
    plan = json.loads(capsys.readouterr().out)
    assert {"segments", "costs", "warnings", "cpu_s"} <= plan.keys()
    kinds = {segment["kind"] for segment in plan["segments"]}
    assert {"pass", "lap", "turn"} <= kinds
    for name in ("work_m", "idle_m", "turns", "minutes", "worked_fraction", "overlap_fraction"):
        assert plan["costs"][name] >= 0
    longitude, latitude = plan["segments"][0]["points_lonlat"][0]
    assert (round(longitude, 1), round(latitude, 1)) == (8.5, 47.5)


def test_a_folder_of_fields_is_planned_in_one_go(field: Path, tmp_path: Path, capsys) -> None:
    out = tmp_path / "gallery.png"
    assert main(["plan", str(field.parent), "--width", "6", "--radius", "5", "--out", str(out), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["field"] for row in rows] == ["square.geojson"]
    assert out.stat().st_size > 1000


@pytest.mark.parametrize(
    ("more", "word"),
    [
        (["--width", "0"], "width"),
        (["--width", "6", "--direction", "nan"], "direction"),
        (["--width", "6", "--out", "plan.txt"], "plan.txt"),
    ],
)
def test_a_plan_that_cannot_be_is_one_sentence(field: Path, more: list[str], word: str, capsys) -> None:
    assert main(["plan", str(field), "--radius", "5", *more]) == 2
    said = capsys.readouterr().err
    assert word in said
    assert len(said.splitlines()) == 1


def test_the_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["--help"])
    assert stopped.value.code == 0
    said = capsys.readouterr().out
    assert all(name in said for name in COMMANDS)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_describes_itself(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main([name, "--help"])
    assert stopped.value.code == 0
    assert len(capsys.readouterr().out) > 200
