"""Finding Q and R: the objective, the searches, the cluster, and the command around them."""

import json
import math
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from support.drives import path_chunks, up_and_down
from support.recordings import driven_live

from guidance_app.cli import main
from guidance_app.estimation.filter import FilterSettings, QuantisationSettings
from guidance_app.estimation.filters import make_filter
from guidance_app.evaluation.cluster import ClusterError, cluster_search
from guidance_app.evaluation.comparisons import Case, recording_of
from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.gomez_gil import Reading, eighteen_lines, rounding_only
from guidance_app.evaluation.kernels import COLUMNS, best_of, squared_error
from guidance_app.evaluation.metrics import errors_of
from guidance_app.evaluation.objectives import (
    Objective,
    TuningError,
    mixed_objective,
    recorded_objective,
    straight_objective,
)
from guidance_app.evaluation.scenarios import Purpose, straight_line
from guidance_app.evaluation.tracks import Recording
from guidance_app.evaluation.tuning import (
    CHUNK,
    best_of_chunk,
    best_so_far,
    chunks_of,
    cma_search,
    cross_validation,
    noise_of,
    random_search,
    settings_from,
)

TENTH_OF_A_MILLIMETRE = 1e-4
CM = 100.0
EQUATION_14 = noise_of(QuantisationSettings())


def last(results: Iterator[object]) -> object:
    *_, result = results
    return result


def drive_of(scenario: str) -> Recording:
    return recording_of(Case("position", scenario, range(1), Purpose.TUNING), 1)[1]


def test_the_compiled_objective_is_the_consoles_filter() -> None:
    lines = eighteen_lines(100)
    ours = [
        errors_of(estimate_recording(rounding_only(line, Reading.TWO_STEP), "quantisation_kf"), line).distance
        for line in lines
    ]
    rms = math.sqrt(float(np.mean(np.concatenate(ours) ** 2)))
    assert straight_objective(100).rms(EQUATION_14) == pytest.approx(rms, abs=TENTH_OF_A_MILLIMETRE)


def test_the_compiled_objective_is_a_textbook_filter() -> None:
    """Equations 8 to 12 with 4 x 4 matrices, on a path that turns."""
    objective = mixed_objective().only("uturn")
    q, r, p0 = (np.diag(part) for part in np.split(EQUATION_14, 3))
    rows = objective.table
    x, p, total = rows[0, 1:5].copy(), p0, 0.0
    for k, row in enumerate(rows):
        if k:
            f = np.eye(4)
            f[0, 3], f[1, 3] = row[0] * math.sin(x[2]), row[0] * math.cos(x[2])
            x, p = f @ x, f @ p @ f.T + q
            new = row[1:5] - x
            new[2] = (new[2] + math.pi) % math.tau - math.pi
            gain = p @ np.linalg.inv(p + r)
            x, p = x + gain @ new, (np.eye(4) - gain) @ p
        total += (x[0] - row[5]) ** 2 + (x[1] - row[6]) ** 2
    assert squared_error(rows, objective.starts, EQUATION_14, math.inf) == pytest.approx(total, rel=1e-9)


def test_only_the_ratios_of_the_matrices_matter() -> None:
    objective = mixed_objective()
    assert objective.rms(7.0 * EQUATION_14) == pytest.approx(objective.rms(EQUATION_14), rel=1e-9)


def test_giving_up_early_does_not_change_the_winner() -> None:
    objective = straight_objective(60)
    draws = np.column_stack([np.random.default_rng(1).uniform(0, 6, (300, 8)), np.tile(EQUATION_14[8:], (300, 1))])
    total, winner = best_of(objective.table, objective.starts, draws, np.inf)
    sums = [squared_error(objective.table, objective.starts, draw, np.inf) for draw in draws]
    assert winner == int(np.argmin(sums))
    assert total == pytest.approx(min(sums))
    assert best_of(objective.table, objective.starts, draws, 0.5 * min(sums)) == (math.inf, -1)


def test_a_tuning_on_straight_lines_alone_does_not_turn() -> None:
    """The reason why it is not the default: more than a metre off an arc of 50 m."""
    tuned = last(cma_search(straight_objective()))
    both = mixed_objective()
    assert both.only("lines").rms(tuned.noise) < both.only("lines").rms(EQUATION_14)
    assert both.only("arc50").rms(tuned.noise) > 1.0


def test_the_default_objective_keeps_lines_and_turns() -> None:
    tuned = last(cma_search(mixed_objective()))
    both = mixed_objective()
    for name in dict.fromkeys(both.names):
        assert both.only(name).rms(tuned.noise) * CM < 6.0, name


def test_the_optimiser_beats_the_monte_carlo() -> None:
    objective = mixed_objective()
    drawn = last(random_search(objective, chunks_of(3000)))
    found = last(cma_search(objective))
    assert found.rms < drawn.rms < objective.rms(EQUATION_14)
    assert found.evaluations < 6000


def test_draws_are_the_same_on_one_process_and_on_two() -> None:
    objective = straight_objective(40)
    chunks = chunks_of(2 * CHUNK + 17)
    one, two = last(random_search(objective, chunks, 1)), last(random_search(objective, chunks, 2))
    assert one.noise.tolist() == two.noise.tolist()
    assert one.evaluations == two.evaluations == 2 * CHUNK + 17


def test_the_order_of_arrival_does_not_change_the_winner() -> None:
    objective = straight_objective(40)
    chunks = chunks_of(3 * CHUNK)
    bests = [best_of_chunk(objective, chunk) for chunk in chunks]
    forwards, backwards = (last(best_so_far(objective, chunks, order)) for order in (bests, bests[::-1]))
    assert forwards.noise.tolist() == backwards.noise.tolist()


def test_the_best_so_far_never_gets_worse() -> None:
    for results in (cma_search(straight_objective(40)), random_search(straight_objective(40), chunks_of(3 * CHUNK))):
        rms = [found.rms for found in results]
        assert len(rms) > 1
        assert rms == sorted(rms, reverse=True)


def test_the_result_is_a_settings_document_that_a_filter_takes() -> None:
    settings = settings_from(np.array([0.1, 0.2, 0.3, 0.4, 1, 2, 3, 4, 5, 6, 7, 8], dtype=float))
    again = FilterSettings.model_validate_json(settings.model_dump_json())
    assert again.quantisation_kf.process_noise == (0.1, 0.2, 0.3, 0.4)
    assert again.quantisation_kf.start_covariance == (5, 6, 7, 8)
    track = estimate_recording(drive_of("straight"), "quantisation_kf", again)
    default = estimate_recording(drive_of("straight"), "quantisation_kf")
    assert not np.allclose(track.east[20:], default.east[20:])
    assert make_filter("adaptive", again) is not None


# --- recordings ----------------------------------------------------------------------------------------------------


def test_recordings_are_judged_a_second_ahead() -> None:
    recording = drive_of("meander")
    objective = recorded_objective([recording, drive_of("uturn")])
    ahead = objective.table[:, COLUMNS.index("ahead")]
    assert np.all(ahead[objective.table[:, COLUMNS.index("weight")] > 0] == pytest.approx(1.0, abs=0.01))


def test_a_tuning_on_recordings_serves_the_truth_as_well() -> None:
    """No truth is used, yet the true error falls: on another drive of another shape."""
    tuned = last(cma_search(recorded_objective([drive_of("meander"), drive_of("uturn"), drive_of("straight")])))
    truth, recording = recording_of(Case("position", "spiral", range(1)), 0)
    settings = settings_from(tuned.noise)
    after = errors_of(estimate_recording(recording, "quantisation_kf", settings), truth).distance
    before = errors_of(estimate_recording(recording, "quantisation_kf"), truth).distance
    assert np.sqrt(np.mean(after**2)) < 0.5 * np.sqrt(np.mean(before**2))


def test_cross_validation_judges_every_piece_by_what_it_was_not_tuned_on() -> None:
    objective = recorded_objective([drive_of("meander"), drive_of("uturn"), drive_of("arc15")])
    seen: list[int] = []

    def search(part: Objective) -> Iterator[object]:
        seen.append(len(part.names))
        return random_search(part, chunks_of(200))

    checks = list(cross_validation(objective, search))
    assert len(checks) == len(seen) == min(5, len(objective.names))
    assert sum(len(objective.names) - count for count in seen) == len(objective.names)
    assert checks[-1].tuned < checks[-1].default


def test_a_recording_that_is_too_short_is_refused_with_the_reason() -> None:
    line = straight_line(0.4, 1.4, 100)
    with pytest.raises(TuningError, match=r"too short: 20 s; at least 60 s"):
        recorded_objective([Recording(line.t, line.positions, None)])


def test_a_recording_that_stands_still_is_refused_with_the_reason() -> None:
    line = straight_line(0.4, 0.05, 1000)
    with pytest.raises(TuningError, match="stands still too much"):
        recorded_objective([Recording(line.t, line.positions, None)])


def test_a_recording_of_one_fix_is_refused_with_the_reason() -> None:
    with pytest.raises(TuningError, match="two fixes"):
        recorded_objective([Recording(np.zeros(1), np.zeros((1, 2)), None)])


def test_a_gap_cuts_a_recording() -> None:
    line = straight_line(0.4, 1.4, 1000)
    holed = np.r_[0:400, 500:1000]
    objective = recorded_objective([Recording(line.t[holed], line.positions[holed], None)])
    assert float(objective.table[:, COLUMNS.index("dt")].max()) < 0.5


# --- a cluster -----------------------------------------------------------------------------------------------------


def test_a_killed_worker_loses_nothing() -> None:
    """Two workers on this machine, one killed in the middle: the same winner after the same number of draws."""
    distributed = pytest.importorskip("distributed")
    objective = straight_objective(20)
    chunks = chunks_of(24 * CHUNK)
    alone = last(random_search(objective, chunks, 1))
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as cluster:
        killed = False
        found = None
        for found in cluster_search(objective, chunks, cluster.scheduler_address):
            if not killed and found.evaluations >= 4 * CHUNK:
                os.kill(cluster.workers[0].pid, signal.SIGKILL)
                killed = True
    assert killed
    assert found is not None
    assert found.evaluations == 24 * CHUNK
    assert found.noise.tolist() == alone.noise.tolist()


def test_a_scheduler_that_does_not_answer_is_named() -> None:
    with pytest.raises(ClusterError, match="no Dask scheduler answers at nonsense"):
        last(cluster_search(straight_objective(20), chunks_of(10), "nonsense://nowhere"))


# --- the command ---------------------------------------------------------------------------------------------------


COMMAND = (sys.executable, "-m", "guidance_app", "tune")


def tune(*arguments: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([*COMMAND, *arguments], capture_output=True, text=True, timeout=250, check=False)


def test_ctrl_c_keeps_the_best_so_far(tmp_path: Path) -> None:
    out = tmp_path / "settings.json"
    arguments = ("--method", "random", "--samples", "50000000", "--processes", "2", "--straight-only")
    with subprocess.Popen(
        [*COMMAND, *arguments, "--out", str(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        assert "best" in process.stderr.readline()
        process.send_signal(signal.SIGINT)
        printed, _ = process.communicate(timeout=250)
    assert process.returncode == 0
    assert "stopped after" in printed
    settings = FilterSettings.model_validate_json(out.read_text())
    assert settings.quantisation_kf.process_noise != QuantisationSettings().process_noise


def test_the_result_is_written_and_said(tmp_path: Path) -> None:
    out = tmp_path / "settings.json"
    result = tune("--straight-only", "--out", str(out))
    assert "Do not drive curves with it" in result.stdout
    assert "cm off on an arc" in result.stdout
    assert "evaluations, best" in result.stderr
    assert json.loads(out.read_text())["kind"] == "filter settings"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--log", "nowhere.nmea"), "There is no file nowhere.nmea"),
        (("--scheduler", "tcp://127.0.0.1:9"), "is for --method random"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(arguments: tuple[str, ...], sentence: str) -> None:
    result = tune(*arguments)
    assert result.returncode == 2
    assert sentence in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


def test_a_recording_of_the_console_serves_as_well_as_its_log(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    chunks = list(path_chunks(up_and_down()))
    log = tmp_path / "drive.nmea"
    log.write_bytes(b"".join(chunk.data for chunk in chunks))
    recording = driven_live(tmp_path / "data", chunks)[0]
    said = []
    for path in (log, recording):
        assert main(["tune", "--log", str(path), "--method", "random", "--samples", "500", "--processes", "1"]) == 0
        said.append(capsys.readouterr().out)
    assert "one second ahead, your recordings" in said[0]
    assert said[0] == said[1]


def test_a_log_that_tells_nothing_is_named_beside_one_that_does(tmp_path: Path, capsys) -> None:
    good, short = tmp_path / "good.nmea", tmp_path / "short.nmea"
    good.write_bytes(b"".join(chunk.data for chunk in path_chunks(up_and_down())))
    short.write_bytes(good.read_bytes()[:4000])
    assert main(["tune", "--log", str(good), str(short)]) == 2
    assert f"{short}: the recording is too short" in capsys.readouterr().err
