"""Many logs and recordings at once: on this machine and on a cluster, with bad ones and dying workers among them."""

import csv
import json
import os
import shutil
import signal
import zipfile
from pathlib import Path

import pytest
from support.drives import a_job, path_chunks, up_and_down
from support.recordings import driven_live, taken_again

from guidance_app.batch.many import Outcome, Task, Way, outcome_of
from guidance_app.batch.spreading import clustered, spread
from guidance_app.cli import main
from guidance_app.estimation.filters import FILTERS
from guidance_app.evaluation.cluster import ClusterError
from guidance_app.model import SetWork
from guidance_app.store.recordings import open_recording

WAY = Way(a_job(field=False))


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "drive.nmea"
    path.write_bytes(b"".join(chunk.data for chunk in path_chunks(up_and_down())))
    return path


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    steps: list = list(path_chunks(up_and_down()))
    steps.insert(100, SetWork(down=True))
    return driven_live(tmp_path_factory.mktemp("data"), steps)[0]


def many(log: Path, folder: Path, count: int) -> list[Path]:
    folder.mkdir()
    return [Path(shutil.copy(log, folder / f"log{number:02}.nmea")) for number in range(count)]


def tasks_of(paths: list[Path]) -> list[Task]:
    return [Task(path.stem, path, WAY) for path in paths]


def test_a_recording_gives_the_table_of_the_drive_with_its_own_documents(recording: Path) -> None:
    outcome = outcome_of(Task("drive", recording, WAY))
    rows = list(csv.DictReader(outcome.table.splitlines()))
    snapshots = taken_again(open_recording(recording))
    last = snapshots[max(snapshots)]
    assert outcome.fixes == last.link.fixes == len(rows)
    assert outcome.worked_m2 == pytest.approx(last.totals.worked)
    assert float(rows[-1]["worked_ha"]) == pytest.approx(last.totals.worked / 1e4, abs=1e-5)


@pytest.mark.parametrize("name", sorted(FILTERS))
def test_any_filter_and_the_smoother_run_over_a_recording(recording: Path, name: str) -> None:
    assert outcome_of(Task("drive", recording, Way(a_job(), name))).fixes > 100
    if name == "off":
        assert outcome_of(Task("drive", recording, Way(a_job(), smooth=True))).fixes > 100


def test_what_is_bad_is_said_and_stops_nothing(log: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.nmea"
    bad.write_bytes(b"\x00" * 100)
    outcomes = {one.name: one for one in spread(tasks_of([bad, log, tmp_path / "missing.nmea"]), 1)}
    assert outcomes["drive"].problem is None
    assert "bad.nmea" in (outcomes["bad"].problem or "")
    assert "missing.nmea" in (outcomes["missing"].problem or "")


class Deadly:
    """Ends the process that is given it."""

    def __reduce__(self) -> tuple[object, tuple[int]]:
        return os._exit, (1,)


def test_a_process_that_dies_takes_nothing_with_it(log: Path, tmp_path: Path) -> None:
    tasks = tasks_of(many(log, tmp_path / "logs", 3))
    alone = {one.name: one.table for one in spread(tasks, 1)}
    deadly = Task("deadly", Deadly(), WAY)
    outcomes = {one.name: one for one in spread([tasks[0], deadly, *tasks[1:]], 2)}
    assert "died" in (outcomes.pop("deadly").problem or "")
    assert {one.name: one.table for one in outcomes.values()} == alone


def test_a_cluster_with_a_killed_worker_gives_every_table(log: Path, recording: Path, tmp_path: Path) -> None:
    """Two workers on this machine, one killed in the middle."""
    distributed = pytest.importorskip("distributed")
    paths = many(log, tmp_path / "logs", 7)
    tasks = [*tasks_of(paths), Task("recording", recording, WAY), Task("bad", tmp_path, WAY)]
    alone = {one.name: (one.table, one.problem) for one in spread(tasks, 1)}
    outcomes: list[Outcome] = []
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as cluster:
        killed = False
        for outcome in clustered(tasks, cluster.scheduler_address):
            outcomes.append(outcome)
            if not killed and outcome.problem is None:
                os.kill(cluster.workers[0].pid, signal.SIGKILL)
                killed = True
    assert killed
    assert {one.name: (one.table, one.problem) for one in outcomes} == alone
    assert alone["bad"][1] is not None


def test_a_scheduler_that_does_not_answer_is_named(log: Path) -> None:
    with pytest.raises(ClusterError, match="no Dask scheduler answers at nonsense"):
        list(clustered(tasks_of([log]), "nonsense://nowhere"))


# --- the command -----------------------------------------------------------------------------------------------------


def test_logs_and_recordings_become_a_folder_of_tables(
    log: Path, recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    zipped = tmp_path / "drive.zip"
    with zipfile.ZipFile(zipped, "w") as archive:
        for path in recording.iterdir():
            archive.write(path, path.name)
    out = tmp_path / "out"
    assert main(["process", str(log), str(recording), str(zipped), "--out", str(out), "--processes", "1"]) == 0
    assert sorted(path.name for path in out.iterdir()) == sorted(["drive.csv", f"{recording.name}.csv", "drive-2.csv"])
    assert (out / "drive-2.csv").read_text() == (out / f"{recording.name}.csv").read_text()
    assert "[3/3]" in capsys.readouterr().out


def test_a_bad_input_among_others_is_said_at_the_end(log: Path, tmp_path: Path, capsys) -> None:
    bad = tmp_path / "bad.nmea"
    bad.write_text("nothing", encoding="utf-8")
    out = tmp_path / "out"
    assert main(["process", str(bad), str(log), "--out", str(out), "--processes", "1", "--json"]) == 1
    said = capsys.readouterr()
    assert "1 of 2 inputs were left out" in said.err
    problems = [one["problem"] for one in json.loads(said.out)]
    assert problems.count(None) == 1
    assert (out / "drive.csv").is_file()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--width", "3"], "leave --width out"),
        (["--processes", "0"], "at least one"),
        (["--scheduler", "nonsense://nowhere"], "no Dask scheduler"),
    ],
)
def test_use_that_cannot_be_is_one_sentence(recording: Path, tmp_path: Path, capsys, options, said: str) -> None:
    pytest.importorskip("distributed")
    assert main(["process", str(recording), str(recording), "--out", str(tmp_path / "out"), *options]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert len(err.splitlines()) == 1


def test_one_table_of_two_inputs_is_refused(log: Path, tmp_path: Path, capsys) -> None:
    assert main(["process", str(log), str(log), "--out", str(tmp_path / "out.csv")]) == 2
    assert "name a folder" in capsys.readouterr().err


def test_one_recording_becomes_one_table(recording: Path, tmp_path: Path, capsys) -> None:
    out = tmp_path / "one.csv"
    assert main(["process", str(recording), "--out", str(out)]) == 0
    assert "fixes" in capsys.readouterr().out
    assert len(out.read_text(encoding="utf-8").splitlines()) > 100
