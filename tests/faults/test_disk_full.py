"""A disk that is full does not stop a drive; the driver knows, and when there is room again nothing is missing."""

import os
import resource
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from conftest import missing
from support.drives import a_job, path_chunks, up_and_down
from support.recordings import Fed, Heard

from guidance_app.model import Snapshot
from guidance_app.runtime import LiveSession, Recorder, recorded_session
from guidance_app.runtime.recorder import new_recording
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_list import list_recordings
from guidance_app.store.recordings_writing import RecordingFolder

QUICK = 0.02
NOT_WRITTEN = "This drive is not being written down"


@dataclass
class SmallDisk:
    """A data folder, and what makes room where it lies."""

    data: Path
    fill: Callable[[], None]
    make_room: Callable[[], None]


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[SmallDisk]:
    """A file system of its own."""
    place = tmp_path / "disk"
    place.mkdir()
    if os.geteuid() != 0:
        missing("only root may mount a small file system")
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8m", "tmpfs", str(place)], check=False)
    if mounted.returncode != 0:
        missing("no small file system can be mounted here")
    filler = place / "filler"

    def fill() -> None:
        with filler.open("ab", buffering=0) as file:
            try:
                while True:
                    file.write(b"x" * 4096)
            except OSError:
                pass

    yield SmallDisk(place / "data", fill, filler.unlink)
    subprocess.run(["umount", str(place)], check=True)


@pytest.fixture
def small_files(tmp_path: Path) -> Iterator[SmallDisk]:
    """A limit on the size of any file, which every user may set."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)

    def limit(size: int) -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))

    yield SmallDisk(tmp_path / "data", lambda: limit(20_000), lambda: limit(before[0]))
    limit(before[0])


def noticed(words: str) -> Callable[[Snapshot], bool]:
    return lambda one: any(words in notice for notice in one.notices)


def a_drive(data: Path, source: Fed, **changes: float) -> LiveSession:
    """A session that is recorded quickly."""
    first = new_recording(data, a_job(), source.description)
    first.close(ended=False)
    folder, past = RecordingFolder.go_on(first.path)
    return LiveSession(a_job(), source, recorder=Recorder(folder, past, flush_every=QUICK, **changes))


@pytest.mark.parametrize("kind", ["small_disk", "small_files"])
def test_driving_goes_on_and_nothing_is_missing_when_there_is_room_again(
    kind: str, request: pytest.FixtureRequest
) -> None:
    disk: SmallDisk = request.getfixturevalue(kind)
    source, chunks = Fed(), path_chunks(up_and_down(passes=5))
    session = a_drive(disk.data, source)
    heard = Heard(session)
    session.start()
    source.give(chunks[:50])
    heard.wait(lambda one: one.link.fixes >= 49)
    disk.fill()
    source.give(chunks[50:400])
    heard.wait(noticed(NOT_WRITTEN))
    source.give(chunks[400:500])
    driven = heard.wait(lambda one: one.link.fixes >= 499)
    assert driven.pose is not None
    assert noticed(NOT_WRITTEN)(driven)
    disk.make_room()
    source.give(chunks[500:600])
    heard.wait(lambda one: one.link.fixes >= 599 and not noticed(NOT_WRITTEN)(one))
    session.close()
    drive = open_recording(list_recordings(disk.data)[0].path)
    assert drive.truncated is None
    assert b"".join(one.data for one in drive.chunks) == b"".join(one.data for one in chunks[:600])


def test_what_was_written_before_a_full_disk_stays(small_files: SmallDisk) -> None:
    """Closed while there is no room: the recording opens to where it could be written."""
    source, chunks = Fed(), path_chunks(up_and_down(passes=3))
    session = a_drive(small_files.data, source)
    heard = Heard(session)
    session.start()
    small_files.fill()
    source.give(chunks[:300])
    heard.wait(noticed(NOT_WRITTEN))
    session.close()
    small_files.make_room()
    (listed,) = list_recordings(small_files.data)
    drive = open_recording(listed.path)
    whole = b"".join(one.data for one in chunks)
    held = b"".join(one.data for one in drive.chunks)
    assert len(held) > 5000
    assert whole.startswith(held)


def test_short_room_is_told_early(tmp_path: Path) -> None:
    source = Fed()
    session = a_drive(tmp_path, source, low_space=1 << 60)
    heard = Heard(session)
    session.start()
    source.give(path_chunks(up_and_down(passes=1))[:20])
    heard.wait(noticed("nearly full"))
    session.close()


def test_what_waits_in_memory_is_bounded(small_files: SmallDisk) -> None:
    source, chunks = Fed(), path_chunks(up_and_down(passes=5))
    session = a_drive(small_files.data, source, most_waiting=30_000)
    heard = Heard(session)
    session.start()
    small_files.fill()
    source.give(chunks)
    heard.wait(noticed("The recording ended at"))
    small_files.make_room()
    session.close()
    (listed,) = list_recordings(small_files.data)
    drive = open_recording(listed.path)
    assert drive.truncated is None
    held = b"".join(one.data for one in drive.chunks)
    assert b"".join(one.data for one in chunks).startswith(held)
    assert len(held) > 20_000


def test_a_folder_that_cannot_be_written_is_told_and_driven_without(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("a file stands here", encoding="utf-8")
    source = Fed()
    session = recorded_session(tmp_path / "data", a_job(), source)
    assert session.recorder is None
    heard = Heard(session)
    session.start()
    source.give(path_chunks(up_and_down(passes=1))[:20])
    heard.wait(lambda one: one.link.fixes >= 19 and noticed("This drive is not recorded")(one))
    session.close()
