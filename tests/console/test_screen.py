"""The screen without a browser: what every client is sent, what its fingers do, and what it costs."""

import math
from dataclasses import replace

import numpy as np
import pytest
import viser
from support.sessions import HandSession
from support.snapshots import SetSession, field_job, field_snapshot, strip, trail
from support.stage import Stage, visible
from support.viser_client import ViserClient, viser_client

from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.model import LinkState, Pose, Snapshot, TurnGuide, WorkMode
from guidance_app.runtime import SessionManager

CENTIMETRE = 1e-2
TICK_S = 0.04
MOST_BYTES_A_TICK = 300
MOST_BYTES_A_FIX = 6_000
MOST_JOIN_BYTES = 120_000


@pytest.fixture
def stage(server: viser.ViserServer) -> Stage:
    """The field at work."""
    return Stage(server, SetSession(field_snapshot()))


def here(client: ViserClient) -> tuple[float, ...]:
    """Where the client draws the tractor."""
    return client.place_of("/w/here")


# --- the scene -------------------------------------------------------------------------------------------------------


def test_every_part_of_the_scene_is_there(stage: Stage) -> None:
    turn = TurnGuide(distance=30.0, seconds=8.0, points=np.array([[18.0, 160.0], [21.0, 166.0], [24.0, 160.0]]))
    stage.session.publish(field_snapshot(turn=turn, worked=trail([strip(0, np.array([[6.0, 12.0], [6.0, 160.0]]))])))
    with stage.client() as client:
        wanted = {
            *(f"/w/field/{name}" for name in ("soil", "exclusions", "boundary", "exclusion_edges", "mainland")),
            *(f"/w/here/{name}" for name in ("tractor", "implement", "edge", "arc", "ghost", "hollow")),
            *(f"/w/{name}" for name in ("passes", "target", "turn", "numbers", "uncertain", "worked/staged0")),
            "/w/flags/start",
            "/w/flags/entrance",
            "/backdrop/day",
            "/backdrop/night",
        }
        stage.tick_until(client, lambda: wanted <= set(client.nodes))


def test_the_tractor_is_drawn_where_it_is_at_the_redraws_instant(stage: Stage) -> None:
    with stage.client() as client:
        stage.session.instant += 0.4
        stage.tick_until(client, lambda: here(client) and here(client)[1] == pytest.approx(61.0, abs=CENTIMETRE))


def test_a_stale_position_is_hollow_and_stands_still(stage: Stage) -> None:
    with stage.client() as client:
        stage.session.instant += 30.0
        stage.tick_until(client, lambda: visible(client, "/w/here/hollow"))
        stage.tick_until(
            client, lambda: not visible(client, "/w/here/tractor") and not visible(client, "/w/here/ghost")
        )
        assert here(client)[1] == pytest.approx(60.0 + 2.5, abs=CENTIMETRE)


def test_without_a_pose_there_is_no_tractor_and_nothing_breaks(server: viser.ViserServer) -> None:
    stage = Stage(server, SetSession(Snapshot(0, 0.0, LinkState())))
    with viser_client(server) as client:
        stage.tick_until(client, lambda: "/w/worked_open" in client.nodes and not visible(client, "/w/here"))
        assert "/w/field/soil" not in client.nodes


def test_the_world_is_moved_and_the_camera_is_left_alone(stage: Stage) -> None:
    with stage.client() as client:
        client.until(lambda: client.heard("SetCameraPositionMessage"))
        homes = len(client.heard("SetCameraPositionMessage"))
        for step in range(1, 6):
            stage.session.instant += TICK_S
            stage.tick_until(client, lambda want=60.0 + 2.5 * TICK_S * step: abs(here(client)[1] - want) < CENTIMETRE)
        assert len(client.heard("SetCameraPositionMessage")) == homes
        assert len(client.heard("SetPositionMessage", name="/w")) >= 5


def test_a_jump_in_time_takes_away_what_was_drawn(stage: Stage) -> None:
    way = np.array([[6.0, 12.0], [6.0, 160.0]])
    stage.session.publish(field_snapshot(worked=trail([strip(0, way)]), track=trail([way])))
    with stage.client() as client:
        stage.tick_until(client, lambda: "/w/worked/staged0" in client.nodes)
        stage.session.publish(field_snapshot(generation=1, worked=trail([]), track=trail([])))
        stage.tick_until(client, lambda: not any("staged" in name for name in client.nodes))


def test_a_late_client_gets_the_whole_scene(stage: Stage) -> None:
    with stage.client() as early:
        stage.session.publish(replace(field_snapshot(target=5), ground_version=2, sequence=2))
        stage.screen.tick()
        with stage.client() as late:
            stage.tick_until(early, lambda: set(early.nodes) == set(late.nodes))


# --- clients come and go ---------------------------------------------------------------------------------------------


def test_a_client_that_left_is_forgotten_and_the_others_go_on(stage: Stage) -> None:
    with stage.client() as stays:
        for _ in range(3):
            with stage.client() as leaves:
                pass
            leaves.until(lambda: True)
            stage.tick_until(stays, lambda: stage.screen.clients == 1)
        stage.session.instant += 0.2
        stage.tick_until(stays, lambda: here(stays)[1] == pytest.approx(60.5, abs=CENTIMETRE))


def test_the_loop_runs_by_itself_and_ends(server: viser.ViserServer) -> None:
    session = HandSession(first=field_snapshot())
    session.job = field_job()
    screen = Screen(server, House(SessionManager(session)))
    screen.start()
    with viser_client(server) as client:
        client.until(lambda: "/w/numbers" in client.nodes)
    screen.close()
    screen.close()


# --- what it costs ---------------------------------------------------------------------------------------------------


def test_a_redraw_between_two_fixes_costs_a_few_hundred_bytes(stage: Stage) -> None:
    with stage.client() as client:
        stage.settle(client)
        before = client.bytes
        for step in range(1, 26):
            stage.session.instant += 0.02
            stage.screen.tick()
            client.until(lambda want=60.0 + 0.05 * step: abs(here(client)[1] - want) < CENTIMETRE)
        assert (client.bytes - before) / 25 < MOST_BYTES_A_TICK


def test_a_fix_costs_less_than_the_open_arrays_allow(stage: Stage) -> None:
    with stage.client() as client:
        stage.settle(client)
        before = client.bytes
        for step in range(1, 21):
            at = 100.0 + 0.1 * step
            pose = Pose(at, at, 18.1 + 0.01 * math.sin(step), 60.0 + 0.25 * step, 0.01 * math.sin(step), 2.5)
            way = np.column_stack([np.full(step + 1, 18.1), 60.0 + 0.25 * np.arange(step + 1)])
            way[:, 0] += 0.1 * np.sin(np.arange(step + 1))
            worked, track = trail([], strip(0, way, sealed=False)), trail([], way)
            stage.session.publish(field_snapshot(at, pose=pose, worked=worked, track=track, sequence=step + 1))
            stage.session.instant = at
            stage.screen.tick()
            client.until(lambda want=60.0 + 0.25 * step: abs(here(client)[1] - want) < CENTIMETRE)
        assert (client.bytes - before) / 20 < MOST_BYTES_A_FIX


def test_a_redraw_is_one_batch_of_messages(stage: Stage) -> None:
    with stage.client() as client:
        stage.settle(client)
        before = len(client.messages)
        at = 100.1
        pose = Pose(at, at, 24.1, 60.25, 0.3, 2.5, covariance=(0.3, 0.0, 0.3))
        turn = TurnGuide(5.0, 2.0, np.array([[18.0, 160.0], [21.0, 166.0], [24.0, 160.0]]))
        stage.session.publish(field_snapshot(at, pose=pose, target=4, turn=turn, sequence=2, work_mode=WorkMode.SWITCH))
        stage.session.instant = at
        stage.screen.tick()
        client.until(lambda: here(client)[1] == pytest.approx(60.25))
        assert len(client.messages) - before < 128


def test_standing_still_costs_nothing(stage: Stage) -> None:
    with stage.client() as client:
        stage.settle(client)
        stage.session.instant += TICK_S
        stage.screen.tick()
        client.until(lambda: abs(here(client)[1] - 60.1) < CENTIMETRE)
        before = client.bytes
        for _ in range(50):
            stage.screen.tick()
        stage.session.instant += TICK_S
        stage.screen.tick()
        client.until(lambda: abs(here(client)[1] - 60.2) < CENTIMETRE)
        assert client.bytes - before < 2 * MOST_BYTES_A_TICK


def test_joining_costs_little_and_fills_few_nodes(stage: Stage) -> None:
    with stage.client() as client:
        assert client.bytes < MOST_JOIN_BYTES
        assert len(client.nodes) < 60
