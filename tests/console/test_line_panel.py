"""The line panel: there without a plan alone, and every button posts what it says."""

from collections.abc import Callable
from dataclasses import replace

import pytest
import viser
from support.snapshots import SetSession, field_snapshot
from support.stage import Stage
from support.viser_client import ViserClient

from guidance_app.model import BeginLine, Command, DropLine, EndLine, LineBegun, LineKind


@pytest.fixture
def stage(server: viser.ViserServer) -> Stage:
    """A drive without a plan."""
    return Stage(server, SetSession(field_snapshot(plan=None, passes=())))


def posted(stage: Stage, client: ViserClient, press: Callable[[], None]) -> Command:
    before = len(stage.session.commands)
    press()
    stage.tick_until(client, lambda: len(stage.session.commands) > before)
    newest: Command = stage.session.commands[-1]
    return newest


def test_with_a_plan_the_rest_is_there_and_without_one_the_line(server: viser.ViserServer, stage: Stage) -> None:
    with stage.client() as client:
        stage.tick_until(client, lambda: client.control("Begin here (A)"))
        assert not client.control("Plan the rest again from here")
    planned = Stage(server, SetSession(field_snapshot()))
    with planned.client() as client:
        planned.tick_until(client, lambda: client.control("Plan the rest again from here"))
        assert not client.control("Begin here (A)")


def test_a_line_is_begun_ended_and_given_up(server: viser.ViserServer, stage: Stage) -> None:
    with stage.client() as client:
        assert posted(stage, client, lambda: client.press("Begin here (A)")) == BeginLine(LineKind("ab"))
        stage.session.publish(
            replace(stage.session.snapshot(), line_begun=LineBegun(LineKind.AB, (0.0, 0.0), 24.2), sequence=900)
        )
        stage.tick_until(client, lambda: "24 m from A: drive on, press End at B." in client.words())
        assert server.scene.get_handle_by_name("/w/flags/line") is not None
        assert posted(stage, client, lambda: client.press("End here (B)")) == EndLine()
        assert posted(stage, client, lambda: client.press("Give up")) == DropLine()
        stage.session.publish(replace(stage.session.snapshot(), line_begun=None, sequence=901))
        stage.tick_until(client, lambda: server.scene.get_handle_by_name("/w/flags/line") is None)


def test_a_plus_takes_a_typed_heading_or_the_tractors(stage: Stage) -> None:
    with stage.client() as client:
        client.press("A+")
        stage.tick_until(client, lambda: client.control("Guide from here"))
        assert posted(stage, client, lambda: client.press("Guide from here")) == BeginLine(LineKind("a-plus"))
        client.set("Heading (°)", "92,5")
        assert posted(stage, client, lambda: client.press("Guide from here")) == BeginLine(LineKind("a-plus"), 92.5)


def test_a_heading_that_is_none_is_said_and_nothing_is_posted(stage: Stage) -> None:
    with stage.client() as client:
        client.press("A+")
        stage.tick_until(client, lambda: client.control("Guide from here"))
        for typed in ("north", "361", "nan"):
            client.set("Heading (°)", typed)
            client.press("Guide from here")
            stage.tick_until(
                client, lambda said=typed: any(f"'{said}' is no heading" in str(one) for one in client.messages)
            )
        assert stage.session.commands == []
