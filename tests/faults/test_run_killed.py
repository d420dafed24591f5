"""The whole program killed in the middle of a drive: the next start says so, and goes on where it was."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from guidance_app.cli import main
from guidance_app.model import SourceDown, SourceUp
from guidance_app.runtime.live import INTERRUPTED
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_list import list_recordings, resumable

ROOT = Path(__file__).parent.parent.parent
PATIENCE = 60.0
LONG_ENOUGH = 6.0
RUN = (sys.executable, "-m", "guidance_app", "run", "--source", "sim:?rate=10", "--port", "0")


def until(true: Callable[[], object]) -> None:
    """Looks ten times a second, as another program can only be looked at."""
    never, end = threading.Event(), time.monotonic() + PATIENCE
    while not true():
        assert time.monotonic() < end, "it did not happen"
        never.wait(0.1)


@contextmanager
def running(data: Path, *options: str) -> Iterator[tuple[subprocess.Popen[str], list[str]]]:
    """The program on a simulated receiver, once its page is there, and what it has said."""
    process = subprocess.Popen(
        [*RUN, "--data", str(data), *options],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert process.stdout is not None
    said = []
    try:
        for line in process.stdout:
            said.append(line)
            if line.startswith("Stop it"):
                break
        yield process, said
    finally:
        process.kill()
        process.communicate(timeout=PATIENCE)


def duration(data: Path) -> float:
    found = list_recordings(data)
    return open_recording(found[0].path).duration if found else 0.0


def test_a_killed_program_goes_on_with_its_drive(tmp_path: Path) -> None:
    with running(tmp_path) as (first, _):
        until(lambda: duration(tmp_path) > LONG_ENOUGH)
        first.send_signal(signal.SIGKILL)
        first.wait(PATIENCE)
    found = resumable(tmp_path)
    assert found is not None
    cut_off = duration(tmp_path)
    with running(tmp_path, "--resume") as (second, said):
        assert any("was cut off; taking it again" in line for line in said)
        until(lambda: duration(tmp_path) > cut_off + 1.0)
        second.send_signal(signal.SIGTERM)
        assert second.wait(PATIENCE) == 0
    (listed,) = list_recordings(tmp_path)
    assert listed.path == found.path
    assert listed.summary is not None
    assert not listed.summary.ended
    again = resumable(tmp_path)
    assert again is not None
    assert again.path == found.path
    drive = open_recording(listed.path)
    kinds = [event for event in drive.events if isinstance(event, SourceUp | SourceDown)]
    assert [type(event) for event in kinds[:3]] == [SourceUp, SourceDown, SourceUp]
    assert kinds[1].reason == INTERRUPTED  # type: ignore[union-attr]
    assert drive.duration > cut_off + 1.0


def test_there_must_be_something_to_go_on_with(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--resume", "--data", str(tmp_path)]) == 2
    assert "name its receiver by --source" in capsys.readouterr().err
    assert main(["run", "--resume", "--source", "sim:", "--data", str(tmp_path)]) == 2
    assert "no drive was cut off" in capsys.readouterr().err
