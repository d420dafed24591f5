"""Over a real wire: what came in odd pieces, with a plug pulled in between, replays to the bit."""

from pathlib import Path

from support.cables import Cable
from support.drives import a_job, path_chunks, up_and_down
from support.recordings import Heard, assert_same, taken_again

from guidance_app.model import LinkStatus, Nudge, SetWork
from guidance_app.runtime import recorded_session
from guidance_app.sources import open_source
from guidance_app.store.recordings import open_recording

PIECE = 37
"""Bytes at a time: sentences are cut anywhere."""


def sent(cable: Cable, data: bytes) -> None:
    """All of it, as the wire takes it."""
    for place in range(0, len(data), PIECE):
        piece = data[place : place + PIECE]
        while piece:
            piece = piece[cable.send(piece) :]


def test_a_drive_over_a_wire_replays_to_the_bit(tmp_path: Path) -> None:
    chunks = path_chunks(up_and_down(passes=2))[:160]
    cable = Cable(tmp_path / "ttyUSB0")
    cable.plug()
    source = open_source(f"serial://{cable.path}?baud=115200")
    session = recorded_session(tmp_path / "data", a_job(), source)
    heard = Heard(session)
    session.start()
    heard.wait(lambda one: one.link.status is LinkStatus.NO_DATA)
    sent(cable, b"".join(chunk.data for chunk in chunks[:80]))
    session.post(SetWork(down=True))
    heard.wait(lambda one: one.link.fixes >= 75)
    cable.unplug()
    heard.wait(lambda one: one.link.status is LinkStatus.DOWN)
    session.post(Nudge(0.15))
    cable.plug()
    heard.wait(lambda one: one.link.status is not LinkStatus.DOWN)
    sent(cable, b"".join(chunk.data for chunk in chunks[80:]))
    heard.wait(lambda one: one.link.fixes >= 150)
    assert session.recorder is not None
    session.close()
    cable.unplug()
    drive = open_recording(session.recorder.path)
    assert sum(1 for _ in drive.chunks) >= 2
    replayed = taken_again(drive)
    for snapshot in heard.snapshots:
        assert_same(snapshot, replayed[snapshot.sequence])
