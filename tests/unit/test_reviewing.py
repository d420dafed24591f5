"""Recordings looked back on: the columns are kept, made anew when damaged, and the ledger command writes them out."""

from pathlib import Path

import numpy as np
import pytest
from support.recordings import driven_live

from guidance_app.batch.drive_log import drive_log
from guidance_app.batch.reviewing import additions_of, entry_of, keep_additions, opened_review
from guidance_app.cli import main
from guidance_app.model import DriveLog
from guidance_app.reports.ledger import Additions
from guidance_app.sources.file import load_log
from guidance_app.store import SAMPLE_RECORDING, Store, StoreError, copy_sample, load_job
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_list import list_recordings
from guidance_app.store.reviews import KEPT, kept_columns


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with one recorded drive: the first minutes of the sample."""
    folder = copy_sample(tmp_path_factory.mktemp("data"))
    chunks = load_log(folder / SAMPLE_RECORDING / "receiver.nmea").chunks
    driven_live(folder, chunks[:900], load_job(Store(folder), "Round trip"))
    return folder


def recording(data: Path) -> Path:
    return next(one.path for one in list_recordings(data) if one.summary is not None)


def same(one: DriveLog, other: DriveLog) -> bool:
    return all(
        np.array_equal(getattr(one, name), getattr(other, name), equal_nan=getattr(one, name).dtype == float)
        for name in DriveLog.columns()
    )


def test_what_was_kept_while_driving_is_what_the_recording_gives(data: Path) -> None:
    (place,) = (data / KEPT).iterdir()
    kept = kept_columns(place)
    assert kept is not None
    drive = open_recording(recording(data))
    assert same(kept.log, drive_log(drive))
    assert kept.log.origin_deg == drive_log(drive).origin_deg


def test_the_second_opening_gives_the_same_without_driving_again(data: Path) -> None:
    for kept in (data / KEPT).iterdir():
        kept.unlink()
    told: list[float] = []
    first = opened_review(recording(data), data, told.append)
    again = opened_review(recording(data), data)
    assert same(first.log, again.log)
    assert (first.totals, first.log.origin_deg) == (again.totals, again.log.origin_deg)
    assert told[-1] == 1.0
    assert len(first.log) > 800


def test_a_damaged_kept_file_is_made_anew(data: Path) -> None:
    first = opened_review(recording(data), data)
    for kept in (data / KEPT).iterdir():
        kept.write_bytes(kept.read_bytes()[:500])
    assert same(opened_review(recording(data), data).log, first.log)


def test_the_map_has_the_fields_boundary(data: Path) -> None:
    entry = entry_of(opened_review(recording(data), data))
    assert len(entry.boundary) == 2
    assert np.abs(entry.boundary[0]).max() < 300


def test_what_the_driver_adds_is_kept_beside_the_recording(data: Path) -> None:
    folder = recording(data)
    assert additions_of(folder) == Additions()
    keep_additions(folder, Additions(product="小麦", rate="180 kg/ha"))
    assert additions_of(folder).product == "小麦"
    (folder / "ledger.json").write_text("{")
    with pytest.raises(StoreError, match=r"ledger\.json"):
        additions_of(folder)
    (folder / "ledger.json").unlink()


@pytest.mark.parametrize("ending", ["pdf", "xlsx", "csv"])
def test_the_command_writes_every_kind(
    data: Path, tmp_path: Path, ending: str, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / f"ledger.{ending}"
    assert main(["ledger", "--data", str(data), "--out", str(out), "--field", "Sample field"]) == 0
    assert out.stat().st_size > 300
    assert "1 drives" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--out", "x.doc"], "written as"),
        (["--out", "x.pdf", "--field", "Nowhere"], "no recording fits"),
        (["--out", "x.pdf", "--day", "1999-01-01"], "no recording fits"),
        (["--out", "/nowhere/at/all/x.pdf"], "cannot be written"),
    ],
)
def test_what_cannot_be_written_is_said_in_one_line(
    data: Path, arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["ledger", "--data", str(data), *arguments]) == 2
    assert says in capsys.readouterr().err


def test_a_recording_that_cannot_be_opened_is_left_out_and_said(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    foreign = tmp_path / "foreign"
    foreign.mkdir()
    (foreign / "session.json").write_text("{}")
    out = tmp_path / "ledger.csv"
    assert main(["ledger", str(recording(data)), str(foreign), "--data", str(data), "--out", str(out)]) == 1
    assert "left out" in capsys.readouterr().err
