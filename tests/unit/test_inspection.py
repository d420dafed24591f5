import argparse
import csv
import json
from pathlib import Path

import pytest
from support.nmea import epoch, gga, hdt, rmc, sentence

from guidance_app.batch.inspection import FIX_COLUMNS, fix_row, inspect, json_of, time_text
from guidance_app.commands import inspect as command
from guidance_app.model import Fix, FixQuality
from guidance_app.sources.file import FileLog

NOON = 43200.0
CENTIMETRE = 0.01
KEYS = {
    "sentences", "decoded", "rejected", "fixes", "interval_s", "duration_s", "length_m", "grid_m", "quality",
    "without_checksum", "kinds", "no_fixes", "attitudes",
}  # fmt: skip
DRIVE = (
    b"".join(gga(NOON + k, quality="0") + rmc(NOON + k, status="V") for k in range(3))
    + b"".join(epoch(NOON + 3 + k, 2.0 * k) for k in range(50))
    + b"$GPGGA,damaged*00\r\n"
    + sentence("GPTXT,hello")
)


def _run(*words: str) -> int:
    parser = argparse.ArgumentParser()
    command.add_parser(parser.add_subparsers())
    arguments = parser.parse_args(["inspect", *words])
    status: int = arguments.func(arguments)
    return status


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    path = tmp_path / "drive.nmea"
    path.write_bytes(DRIVE)
    return path


def test_the_record_counts_what_is_in_the_log() -> None:
    found = inspect(FileLog("drive", DRIVE))
    assert (found.sentences, found.decoded, found.fixes, found.no_fixes) == (108, 106, 50, 3)
    assert found.rejected == {"checksum wrong": 1, "unknown sentence": 1}
    assert found.kinds == {"GGA": 53, "RMC": 53}
    assert (found.interval, found.duration) == (1.0, 52.0)
    assert found.length == pytest.approx(98.0, rel=0.005)
    assert found.quality == {"rtk_fixed": 50}
    assert found.cell == pytest.approx((1.852e-4, 1.14e-4), rel=1e-3)


def test_a_receiver_that_stands_has_gone_nowhere() -> None:
    wobble = b"".join(gga(NOON + k, 0.3 * (k % 2), decimals=4) for k in range(100))
    assert inspect(FileLog("standing", wobble)).length == 0.0


def test_a_log_without_fixes_has_no_interval_and_no_grid() -> None:
    found = inspect(FileLog("compass", hdt(1.0) + hdt(2.0)))
    said = json_of(found)
    assert (said["fixes"], said["attitudes"]) == (0, 2)
    assert said["interval_s"] is said["grid_m"] is None
    assert said["quality"] == {}


def test_sentences_without_a_checksum_are_told_apart() -> None:
    bare = b"".join(gga(NOON + k).partition(b"*")[0] + b"\n" for k in range(4))
    assert inspect(FileLog("bare", bare)).without_checksum == 4


def test_json_says_what_the_record_says(drive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert _run(str(drive), "--json") == 0
    said = json.loads(capsys.readouterr().out)
    assert set(said) == KEYS
    assert said == json.loads(json.dumps(json_of(inspect(FileLog("drive", DRIVE)))))
    assert said["grid_m"] == [pytest.approx(1.852e-4), pytest.approx(1.14e-4, rel=1e-3)]


def test_the_table_of_fixes_reads_back(drive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "fixes.csv"
    assert _run(str(drive), "--fixes", str(out)) == 0
    assert "50 fixes written" in capsys.readouterr().out
    rows = list(csv.DictReader(out.read_text(encoding="utf-8").splitlines()))
    assert tuple(rows[0]) == FIX_COLUMNS
    assert len(rows) == 50
    assert rows[0]["time_utc"] == "2020-01-02T12:00:03.000Z"
    assert rows[0]["course_deg"] == "90.000"
    assert rows[0]["heading_deg"] == ""
    assert float(rows[1]["latitude_deg"]) == pytest.approx(52.0 + 2.0 / 111_120.0)
    assert [one.name for one in sorted(tmp_path.iterdir())] == ["drive.nmea", "fixes.csv"]


def test_the_report_reads_well(drive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert _run(str(drive)) == 0
    out = capsys.readouterr().out
    for words in (
        "108 seen, 106 decoded",
        "1 checksum wrong",
        "50 rtk fixed",
        "1 s (1 Hz)",
        "rounds to 0.11 x 0.19 mm",
    ):
        assert words in out
    assert max(len(line) for line in out.splitlines()) <= 120


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        ((0.1852, 0.138), "14 x 19 cm"),
        ((0.01852, 0.0147), "15 x 19 mm"),
        ((18.52, 13.1), "13.1 x 18.5 m"),
        ((1.852e-5, 1.4e-5), "less than 0.1 mm"),
    ],
)
def test_the_grid_is_said_in_a_farmers_units(cell: tuple[float, float], words: str) -> None:
    assert command.grid_in_words(cell) == words


def test_unknown_cells_are_empty_and_the_time_of_day_stands_in_for_the_date() -> None:
    fix = Fix(t=86400.0 + 3661.25, arrival=0.0, latitude_deg=-1.5, longitude_deg=0.25, quality=FixQuality.DGPS)
    assert fix_row(fix) == ("01:01:01.250", "-1.500000000", "0.250000000", "2", "", "", "", "", "")
    assert time_text(fix) == "01:01:01.250"


def test_each_fix_is_heard_once_and_in_order() -> None:
    heard: list[Fix] = []
    found = inspect(FileLog("drive", DRIVE + rmc(NOON + 60, 100.0)), heard.append)
    assert len(heard) == found.fixes == 51
    assert [fix.t for fix in heard] == sorted(fix.t for fix in heard)
