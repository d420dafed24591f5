"""The replay's screen: another engine's track is drawn as a ghost, and buttons step from pass to pass."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from support.drives import a_job, path_chunks, up_and_down
from support.stage import Stage, running_viser

from guidance_app.runtime import Comparison, ReplaySession
from guidance_app.sources.file import FileLog


@pytest.fixture(scope="module")
def log() -> FileLog:
    return FileLog("a drive", b"".join(chunk.data for chunk in path_chunks(up_and_down())))


@contextmanager
def playing(log: FileLog, compare: Comparison | None = None) -> Iterator[tuple[Stage, ReplaySession]]:
    session = ReplaySession(a_job(), log, speed=float("inf"), compare=compare)
    session.start()
    with running_viser() as server:
        yield Stage(server, session), session
    session.close()


def test_a_ghost_is_drawn_beside_and_by_night_too(log: FileLog) -> None:
    with playing(log, Comparison(antenna=(0.0, 2.0, 0.0))) as (stage, session), stage.client() as client:
        stage.tick_until(client, lambda: session.replay.state.ended)
        stage.tick_until(client, lambda: "/w/ghost_open" in client.nodes)
        client.press("Night")
        stage.tick_until(client, lambda: client.control("Day"))
        session.replay.seek(20.0)
        stage.tick_until(client, lambda: session.snapshot().generation > 0)


def test_the_panel_steps_from_pass_to_pass(log: FileLog) -> None:
    with playing(log) as (stage, session), stage.client() as client:
        stage.tick_until(client, lambda: session.replay.state.ended)
        session.replay.pause()
        last = session.replay.passes[-1].position - 2.0
        client.press("Before")
        stage.tick_until(client, lambda: session.replay.state.position == pytest.approx(last))
        client.press("Before")
        stage.tick_until(client, lambda: session.replay.state.position < last - 0.5)
        client.press("Next")
        stage.tick_until(client, lambda: session.replay.state.position == pytest.approx(last))


def test_without_another_engine_there_is_no_ghost(log: FileLog) -> None:
    with playing(log) as (stage, session), stage.client() as client:
        stage.tick_until(client, lambda: session.replay.state.ended)
        stage.tick_until(client, lambda: "/w/track_open" in client.nodes)
        assert not any(name.startswith("/w/ghost") for name in client.nodes)


def test_the_panel_says_how_much_of_the_index_is_there(log: FileLog) -> None:
    with playing(log) as (stage, session), stage.client() as client:
        session.replay.indexed = 0.42
        stage.tick_until(client, lambda: "Getting ready for jumps to any second: 42 %" in client.words())
        session.replay.indexed = 1.0
        stage.tick_until(client, lambda: "Getting ready" not in client.words())
