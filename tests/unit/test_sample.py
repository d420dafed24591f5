"""The embedded sample is what ``guidance-app sample`` makes, says that it is simulated, and holds the whole job."""

import json
from argparse import Namespace
from pathlib import Path

import numpy as np
import pytest
import shapely
from support.sample import observations_of

from guidance_app.boundary import frame_of, polygon_in
from guidance_app.commands import sample
from guidance_app.documents import Job, Tractor
from guidance_app.model import Fix, FixQuality, NoFix
from guidance_app.simulation.job import SimulatedEpoch
from guidance_app.simulation.sample import sample_job
from guidance_app.sources.file import load_log
from guidance_app.sources.simulated import sample_drive
from guidance_app.store import (
    SAMPLE_RECORDING,
    Store,
    StoreError,
    copy_sample,
    data_folder,
    load_job,
    sample_folder,
    simulated_notice,
)

EIGHT_MINUTES, FIFTEEN_MINUTES = 480.0, 900.0
MEGABYTES_1_5 = 1_500_000
LOG = SAMPLE_RECORDING / "receiver.nmea"


@pytest.fixture(scope="module")
def remade(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sample, made again."""
    folder = tmp_path_factory.mktemp("sample")
    assert sample.run(Namespace(out=folder, seed=sample.SEED)) == 0
    return folder


@pytest.fixture(scope="module")
def simulated() -> tuple[Job, list[SimulatedEpoch]]:
    job = sample_job()
    return job, sample.sample_log(job, sample.SEED)[0]


def test_the_embedded_sample_is_byte_for_byte_what_the_command_makes(remade: Path) -> None:
    made = {path.relative_to(remade): path.read_bytes() for path in remade.rglob("*.*") if path.name != ".lock"}
    assert LOG in made
    embedded = {path: (sample_folder() / path).read_bytes() for path in made}
    different = [str(path) for path in made if made[path] != embedded[path]]
    assert different == [], "run: guidance-app sample --out fields"


def test_another_seed_gives_other_errors_on_the_same_field(remade: Path, tmp_path: Path) -> None:
    sample.run(Namespace(out=tmp_path, seed=sample.SEED + 1))
    assert (tmp_path / LOG).read_bytes() != (remade / LOG).read_bytes()
    assert load_job(Store(tmp_path), "Round trip") == load_job(Store(remade), "Round trip")


def test_making_it_again_in_place_changes_nothing(remade: Path) -> None:
    before = (remade / LOG).read_bytes()
    sample.run(Namespace(out=remade, seed=sample.SEED))
    assert (remade / LOG).read_bytes() == before
    assert Store(remade).problems == ()


def test_the_recording_says_that_it_is_simulated() -> None:
    session = json.loads((sample_folder() / SAMPLE_RECORDING / "session.json").read_text())
    assert session["simulated"] is True
    assert (sample_folder() / LOG).read_bytes().startswith(b"# This log is SIMULATED")
    assert simulated_notice(sample_folder() / LOG) == session["notice"]


@pytest.mark.parametrize(
    "content", [None, "", "[]", "{}", '{"simulated": false}', '{"simulated": "true"}', "[" * 99_999]
)
def test_a_recording_that_does_not_say_so_is_not_called_simulated(tmp_path: Path, content: str | None) -> None:
    if content is not None:
        (tmp_path / "session.json").write_text(content)
    assert simulated_notice(tmp_path / "receiver.nmea") is None


def test_the_recording_is_a_small_job_with_start_loss_and_end() -> None:
    path = sample_folder() / LOG
    assert path.stat().st_size < MEGABYTES_1_5
    log = load_log(path)
    assert EIGHT_MINUTES < log.duration < FIFTEEN_MINUTES
    seen = observations_of(log)
    fixes = [one for one in seen if isinstance(one, Fix)]
    lost = [one for one in seen if isinstance(one, NoFix)]
    assert {fix.quality for fix in fixes} == {FixQuality.DGPS}
    steps = np.diff([fix.t for fix in fixes])
    assert np.sort(steps)[-2:] == pytest.approx([0.2, 8.2])
    assert len(lost) == 40
    assert all(fix.speed == 0 for fix in fixes[:50])
    assert fixes[-1].speed == 0
    assert fixes[0].cell is not None
    assert fixes[0].cell[0] == pytest.approx(0.1852)


def test_it_is_eight_passes_driven_in_their_order(simulated: tuple[Job, list[SimulatedEpoch]]) -> None:
    _, epochs = simulated
    numbers = [epoch.number for epoch in epochs if epoch.kind.value == "pass"]
    order = [number for number, before in zip(numbers, [None, *numbers], strict=False) if number != before]
    assert order == [1, 2, 3, 4, 5, 6, 7, 8]


def test_the_tractor_keeps_near_its_passes_and_inside_the_field(simulated: tuple[Job, list[SimulatedEpoch]]) -> None:
    job, epochs = simulated
    assert job.field is not None
    drive = sample_drive(job)
    lines = {segment.number: shapely.LineString(segment.points) for segment in drive.passes if len(segment.points) == 2}
    off = [
        lines[epoch.number].distance(shapely.Point(epoch.truth.east, epoch.truth.north))
        for epoch in epochs
        if epoch.implement_down and epoch.kind.value == "pass"
    ]
    assert 0.03 < float(np.sqrt(np.mean(np.square(off)))) < 0.2
    assert max(off) < 0.6
    ground = polygon_in(frame_of(job.field.boundary), job.field.boundary)
    body = shapely.MultiPoint([(epoch.truth.east, epoch.truth.north) for epoch in epochs]).buffer(1.2)
    assert ground.covers(body)


def test_the_sample_documents_are_those_of_the_data_folder() -> None:
    assert load_job(Store(sample_folder()), "Round trip") == sample_job()
    field = sample_job().field
    assert field is not None
    ground = polygon_in(frame_of(field.boundary), field.boundary)
    assert 20_000 < ground.area < 30_000
    assert len(ground.interiors) == 1
    assert ground.area < ground.convex_hull.area * 0.99  # slightly concave


def test_a_copy_holds_the_sample_and_nothing_that_lies_beside_it(tmp_path: Path) -> None:
    copy = copy_sample(tmp_path / "copy")
    assert load_job(Store(copy), "Round trip") == sample_job()
    assert len([path for path in copy.rglob("*") if path.is_file()]) == 7
    store = Store(copy)
    stored = store.load(Tractor, "Sample tractor")
    store.save(stored.document.model_copy(update={"wheelbase": 2.6}), stored.revision)
    assert load_job(Store(sample_folder()), "Round trip") == sample_job()
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="cannot be copied"):
        copy_sample(tmp_path / "file")


def test_the_data_folder_is_the_first_that_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    named = {"GUIDANCE_DATA": str(tmp_path / "named")}
    assert data_folder(tmp_path / "given", named) == tmp_path / "given"
    assert data_folder(None, named) == tmp_path / "named"
    assert data_folder(None, {"GUIDANCE_DATA": ""}) == Path(__file__).parents[2] / "fields"
    monkeypatch.chdir(tmp_path)
    assert data_folder(Path("here"), {}) == tmp_path / "here"
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="is a file; name a folder"):
        data_folder(tmp_path / "file", {})
