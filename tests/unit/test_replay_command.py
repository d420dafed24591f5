"""What ``guidance-app replay`` makes of its command line, and what is refused; the engine that fails is told of."""

import argparse
from pathlib import Path

import pytest
from support.drives import a_job, path_chunks, up_and_down
from support.recordings import driven_live

from guidance_app.cli import main, parser
from guidance_app.commands import replay
from guidance_app.engine import Engine
from guidance_app.model import Chunk, LinkStatus
from guidance_app.runtime import cache_folder
from guidance_app.runtime.stepping import stepped
from guidance_app.store import StoreError
from guidance_app.store.recordings import EVENTS, open_recording
from guidance_app.store.recordings_writing import RecordingFolder


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return driven_live(tmp_path_factory.mktemp("data"), path_chunks(up_and_down(passes=1)))[0]


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "drive.nmea"
    path.write_bytes(b"".join(chunk.data for chunk in path_chunks(up_and_down(passes=1))))
    return path


def parsed(*given: object) -> argparse.Namespace:
    return parser("replay").parse_args(["replay", *map(str, given)])


def test_a_recording_is_played_with_its_own_documents_and_another_engine_beside(recording: Path) -> None:
    asked = parsed(recording, "--compare-filter", "off", "--compare-look-ahead", "2.5")
    session = replay._of_recording(asked)
    assert session.job == a_job()
    ghost = session.snapshot().ghost
    assert ghost is not None
    assert ghost.filter_name == "off"
    session.close()


def test_a_log_is_played_with_the_documents_of_the_command_line(log: Path) -> None:
    session = replay._of_log(parsed(log, "--width", "4", "--compare-antenna", "1", "0", "2"))
    assert session.job.implement.working_width == 4.0
    assert session.snapshot().ghost is not None
    session.close()
    plain = replay._of_log(parsed(log))
    assert plain.job.implement.working_width == 3.0
    assert plain.snapshot().ghost is None
    plain.close()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--width", "3"), "leave --width out"),
        (("--filter", "off"), "leave --filter out"),
        (("--compare-look-ahead", "9"), "look_ahead is 9.0"),
        (("--compare-antenna", "0", "0", "99"), "antenna_height is 99.0"),
    ],
)
def test_what_a_recording_does_not_take_is_one_sentence(recording: Path, capsys, options, said: str) -> None:
    assert main(["replay", str(recording), *options]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert len(err.splitlines()) == 1


def test_an_empty_recording_is_said(recording: Path, capsys) -> None:
    empty = recording.parent / "empty"
    empty.mkdir()
    (empty / "session.json").write_bytes((recording / "session.json").read_bytes())
    (empty / EVENTS).write_bytes(b"")
    assert main(["replay", str(empty)]) == 2
    assert "holds no event" in capsys.readouterr().err


def test_the_cache_can_be_put_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GUIDANCE_CACHE", str(tmp_path))
    assert cache_folder() == tmp_path
    monkeypatch.delenv("GUIDANCE_CACHE")
    assert cache_folder().name == "indexes"


def test_an_engine_that_fails_says_so_once_and_goes_on(caplog: pytest.LogCaptureFixture) -> None:
    engine = Engine(a_job())
    broken = Chunk(1.0, 7)  # type: ignore[arg-type]  # what no source gives
    for _ in range(3):
        snapshot = stepped(engine, broken)
    assert snapshot.link.status is LinkStatus.DOWN
    assert "internal error" in snapshot.link.reason
    assert len(caplog.records) == 1
    for chunk in path_chunks(up_and_down(passes=1))[:20]:
        snapshot = stepped(engine, chunk)
    assert snapshot.link.status is LinkStatus.FIX


def test_a_recording_that_cannot_be_begun_or_packed_is_said(recording: Path, tmp_path: Path) -> None:
    meta = open_recording(recording).meta
    (tmp_path / "recordings").write_text("a file stands here", encoding="utf-8")
    with pytest.raises(StoreError, match="cannot be made"):
        RecordingFolder.create(tmp_path, meta)
    folder = RecordingFolder.create(tmp_path / "data", meta)
    (folder.path / EVENTS).mkdir()
    with pytest.raises(StoreError, match="cannot be read"):
        folder.pack()
    with pytest.raises(StoreError, match="cannot be taken away"):
        folder.discard()
    folder.close()
