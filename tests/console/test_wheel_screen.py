"""Two browsers on one drive: one operates, the other follows, asks, and has the wheel when the first one goes."""

import viser
from support.drives import a_job, path_chunks, up_and_down
from support.snapshots import SetSession, field_snapshot
from support.stage import Stage
from support.viser_client import viser_client

from guidance_app.model import SkipPass
from guidance_app.runtime import ReplaySession
from guidance_app.sources.file import FileLog


def test_one_operates_and_the_other_follows(server: viser.ViserServer) -> None:
    session = SetSession(field_snapshot())
    stage = Stage(server, session)
    with stage.client() as first:
        assert "wheel" not in first.words()
        with stage.client() as second:
            stage.tick_until(first, lambda: "You have the wheel" in first.words())
            stage.tick_until(second, lambda: "Tablet 1 has the wheel" in second.words())
            second.press("Skip")
            stage.tick_until(second, lambda: any("Another tablet" in str(one) for one in second.messages))
            assert session.commands == []
            first.press("Skip")
            stage.tick_until(first, lambda: session.commands == [SkipPass()])
            second.press("Ask for the wheel")
            stage.tick_until(first, lambda: "Tablet 2 wants the wheel" in first.words())
            first.press("Give it")
            stage.tick_until(second, lambda: "You have the wheel" in second.words())
            second.press("Skip")
            stage.tick_until(second, lambda: session.commands == [SkipPass(), SkipPass()])


def test_a_browser_that_vanishes_changes_nothing_and_leaves_the_wheel(server: viser.ViserServer) -> None:
    session = SetSession(field_snapshot())
    stage = Stage(server, session)
    with viser_client(server) as first:
        stage.tick_until(first, lambda: first.control("Skip"))
        with stage.client() as second:
            stage.tick_until(second, lambda: "Tablet 1 has the wheel" in second.words())
            first.close()
            stage.tick_until(second, lambda: stage.screen.clients == 1)
            second.press("Skip")
            stage.tick_until(second, lambda: session.commands == [SkipPass()])


def test_nobody_starts_or_ends_a_drive_from_a_tablet_that_follows(server: viser.ViserServer) -> None:
    session = SetSession(field_snapshot())
    stage = Stage(server, session)
    with stage.client() as first, stage.client() as second:
        stage.tick_until(second, lambda: "Tablet 1 has the wheel" in second.words())
        second.press("End the drive")
        stage.tick_until(second, lambda: second.control("Yes, end the drive now"))
        second.press("Yes, end the drive now")
        stage.tick_until(second, lambda: any("Another tablet" in str(one) for one in second.messages))
        assert stage.screen._house.driving
        assert first.control("Skip")


def test_a_tablet_that_follows_does_not_steer_the_recording(server: viser.ViserServer) -> None:
    drive = b"".join(chunk.data for chunk in path_chunks(up_and_down()))
    session = ReplaySession(a_job(), FileLog("a drive", drive))
    session.start()
    stage = Stage(server, session)
    try:
        with viser_client(server) as first:
            stage.tick_until(first, lambda: first.control("Pause"))
            with viser_client(server) as second:
                stage.tick_until(second, lambda: "Tablet 1 has the wheel" in second.words())
                for words in ("Pause", "50", "Next"):
                    second.press(words)
                stage.tick_until(second, lambda: sum("Another tablet" in str(one) for one in second.messages) >= 3)
                assert session.replay.state.playing
                assert session.replay.state.speed == 1.0
                first.press("Pause")
                stage.tick_until(first, lambda: not session.replay.state.playing)
    finally:
        session.close()
