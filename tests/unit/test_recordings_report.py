"""A recording to give away: it opens elsewhere, is the same drive, holds no password, and may lie elsewhere."""

import math
import zipfile
from pathlib import Path

import pytest
from support.drives import a_job, path_chunks, up_and_down
from support.recordings import assert_same, driven_live, taken_again

from guidance_app.cli import main
from guidance_app.model import Fix, Nudge, Snapshot
from guidance_app.recording import RecordedDrive
from guidance_app.store.recordings import open_recording

CENTIMETRE = 1e-2


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    job = a_job()
    secret = job.receiver.model_copy(update={"source": "ntrip://me:hidden@caster.example:2101/MOUNT"})
    steps: list = list(path_chunks(up_and_down()))
    steps.insert(300, Nudge(0.2))
    return driven_live(tmp_path_factory.mktemp("data"), steps, job.model_copy(update={"receiver": secret}))[0]


def last_of(drive: RecordedDrive) -> Snapshot:
    made = taken_again(drive)
    return made[max(made)]


def test_a_report_is_the_same_drive_without_the_password(recording: Path, tmp_path: Path, capsys) -> None:
    out = tmp_path / "report.zip"
    assert main(["report", str(recording), "--out", str(out)]) == 0
    assert "events of" in capsys.readouterr().out
    with zipfile.ZipFile(out) as archive:
        assert b"hidden" not in b"".join(archive.read(name) for name in archive.namelist())
        assert b"replay" in archive.read("README.txt")
    assert open_recording(out).job.receiver.source == "ntrip://caster.example:2101/MOUNT"
    assert_same(last_of(open_recording(out)), last_of(open_recording(recording)))


def test_a_moved_report_is_the_same_drive_elsewhere(recording: Path, tmp_path: Path, capsys) -> None:
    out = tmp_path / "moved.zip"
    assert main(["report", str(recording), "--out", str(out), "--move"]) == 0
    assert "0 sentences were not understood" in capsys.readouterr().out
    here, there = last_of(open_recording(recording)), last_of(open_recording(out))
    assert isinstance(here.fix, Fix)
    assert isinstance(there.fix, Fix)
    degrees = there.fix.longitude_deg - here.fix.longitude_deg
    assert abs(degrees) >= 10
    assert degrees == pytest.approx(round(degrees), abs=1e-9)
    assert here.pose is not None
    assert there.pose is not None
    assert math.dist((here.pose.east, here.pose.north), (there.pose.east, there.pose.north)) < CENTIMETRE
    assert there.totals.worked == pytest.approx(here.totals.worked, rel=1e-3)


def test_what_cannot_be_reported_is_one_sentence(recording: Path, tmp_path: Path, capsys) -> None:
    assert main(["report", str(recording), "--out", str(tmp_path / "report.txt")]) == 2
    assert main(["report", str(tmp_path / "nothing"), "--out", str(tmp_path / "report.zip")]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 2
    assert not list(tmp_path.iterdir())
