"""Every control of the panels is pressed: it posts its command, and follows what is without answering itself."""

import pytest
import viser
from support.drives import a_job, path_chunks, up_and_down
from support.snapshots import SetSession, field_job, field_snapshot
from support.stage import Stage, visible
from support.viser_client import ViserClient, viser_client

from guidance_app.documents import Settings, Units
from guidance_app.model import (
    BeginInitialisation,
    BeginRollZero,
    DropOffset,
    LineHere,
    LinkState,
    LinkStatus,
    Nudge,
    OffsetKind,
    OffsetRecord,
    Pause,
    ReverseDirection,
    SetLookAhead,
    SetSection,
    SetWork,
    SetWorkMode,
    SkipPass,
    TakePass,
    WorkMode,
)
from guidance_app.runtime import ReplaySession
from guidance_app.sources.file import FileLog
from guidance_app.view.units import INCH


@pytest.fixture
def stage(server: viser.ViserServer) -> Stage:
    """The field at work."""
    return Stage(server, SetSession(field_snapshot()))


COMMANDS = [
    ("Working · press to lift", SetWork(down=False)),
    ("◀ Line", TakePass(2)),
    ("Line ▶", TakePass(4)),
    ("Skip", SkipPass()),
    ("◀10", Nudge(-0.10)),
    ("◀2", Nudge(-0.02)),
    ("2▶", Nudge(0.02)),
    ("10▶", Nudge(0.10)),
    ("Here", LineHere()),
    ("As planned", DropOffset(OffsetKind.LINE_HERE)),
    ("Other way", ReverseDirection()),
    ("Button", SetWorkMode(WorkMode.BUTTON)),
    ("Speed", SetWorkMode(WorkMode.SPEED)),
    ("Switch", SetWorkMode(WorkMode.SWITCH)),
    ("Auto", SetWorkMode(WorkMode.AUTO)),
    ("Pause", Pause()),
    ("1", SetSection(1, on=False)),
    ("3", SetSection(3, on=False)),
    ("Measure without a known point", BeginInitialisation()),
    ("Begin the first drive", BeginRollZero()),
]

HIDDEN = {"nudge", "shift", "line here", "mark", "initialisation", "Give up", "Keep it for this tractor"}
"""Buttons that are shown only when there is something for them to do; ``test_panel_position`` presses them."""


def test_every_button_posts_its_command(stage: Stage) -> None:
    with stage.client() as client:
        for words, command in COMMANDS:
            client.press(words)
            stage.tick_until(client, lambda wanted=command: wanted in stage.session.commands)
        client.set("Look ahead", 2.5)
        stage.tick_until(client, lambda: SetLookAhead(2.5) in stage.session.commands)


def test_quick_presses_all_count_and_in_order(stage: Stage) -> None:
    with stage.client() as client:
        presses = [("◀2", -0.02), ("2▶", 0.02), ("◀10", -0.10), ("2▶", 0.02), ("2▶", 0.02), ("10▶", 0.10)] * 5
        for words, _ in presses:
            client.press(words)
        stage.tick_until(client, lambda: len(stage.session.commands) == len(presses))
        assert stage.session.commands == [Nudge(metres) for _, metres in presses]


def test_no_button_is_left_without_a_test(stage: Stage) -> None:
    of_rest = {"Take this pass", "Plan the rest again from here"}
    of_position = HIDDEN | {"2", "I stand on this point", "Measure on this point, 10 s"}
    elsewhere = {"Driver", "Heading up", "North up", "Whole field", "Bring back", "Day", "Night", "Look ahead"}
    of_menu = {"Fields, machines, recordings", "End the drive", "No, drive on"}
    of_wheel = {"Ask for the wheel", "Give it", "Keep it"}
    of_receiver = {"Show what it sends", "Look again", "Use this receiver", "No, keep this one"}
    known = {words for words, _ in COMMANDS} | elsewhere | of_menu | of_wheel | of_receiver | of_position | of_rest
    with stage.client() as client:
        stage.tick_until(client, lambda: client.control("Working · press to lift"))
        stage.settle(client)  # some buttons get their words from the first picture
        for control in client.controls.values():
            kind, props = control["type"], control["props"]
            if kind in {"GuiButtonGroupMessage"}:
                assert {word.removeprefix("● ") for word in props["options"]} <= known
            elif kind in {"GuiButtonMessage", "GuiSliderMessage"}:
                assert props["label"] in known


def test_the_widgets_follow_what_is_and_post_nothing_by_themselves(stage: Stage) -> None:
    with stage.client() as client:
        moved = (OffsetRecord(OffsetKind.NUDGE, 1.0, metres=0.04),)
        stage.session.publish(
            field_snapshot(target=7, working=False, work_mode=WorkMode.SPEED, look_ahead_s=2.2, offsets=moved)
        )
        for words in ("Line 7", "Moved 4 cm right", "Lifted · press to work"):
            stage.tick_until(client, lambda wanted=words: wanted in client.words())
        stage.tick_until(client, lambda: (client.control("Look ahead") or {}).get("value") == pytest.approx(2.2))
        stage.tick_until(client, lambda: "● Speed" in (client.control("Speed") or {})["props"]["options"])
        assert stage.session.commands == []


def test_the_head_shows_the_numbers(stage: Stage) -> None:
    with stage.client() as client:
        for words in ("0.52", "1.80", "9.0", "km/h", "RTK fixed", "17 satellites", "HDOP 0.7"):
            stage.tick_until(client, lambda wanted=words: wanted in client.words())


def test_units_follow_the_settings(server: viser.ViserServer) -> None:
    stage = Stage(server, SetSession(field_snapshot(), field_job(Settings(units=Units.IMPERIAL))))
    with stage.client() as client:
        stage.tick_until(client, lambda: "mph" in client.words() and "ac" in client.words())
        client.press("4▶")
        stage.tick_until(client, lambda: Nudge(4 * INCH) in stage.session.commands)


def test_words_from_outside_cannot_become_markup(stage: Stage) -> None:
    down = LinkState(LinkStatus.DOWN, since=90.0, reason="<script>alert(1)</script>")
    stage.session.publish(field_snapshot(link=down, notices=("<b>bold</b>",)))
    with stage.client() as client:
        stage.tick_until(client, lambda: "&lt;script&gt;" in client.words())
        assert "<script>" not in client.words()
        assert "<b>bold" not in client.words()


def test_each_client_has_its_own_view_and_one_button_brings_it_back(stage: Stage) -> None:
    def height(client: ViserClient) -> float:
        homes = client.heard("SetCameraPositionMessage")
        return float(homes[-1]["position"][2]) if homes else 0.0

    with stage.client() as one, stage.client() as other:
        one.until(lambda: height(one) > 0)
        other.until(lambda: height(other) > 0)
        behind = height(other)
        for words in ("Heading up", "North up", "Whole field"):
            before = height(one)
            one.press(words)
            stage.tick_until(one, lambda lower=before: height(one) > lower + 1.0)
        assert height(other) == behind
        homes = len(one.heard("SetCameraPositionMessage"))
        one.camera(820, 674)  # a finger has turned the view: the page tells the camera it has now
        one.press("Bring back")
        stage.tick_until(one, lambda: len(one.heard("SetCameraPositionMessage")) > homes)
        one.press("Driver")
        stage.tick_until(one, lambda: height(one) == pytest.approx(behind))


def test_the_whole_field_fits_again_when_the_window_is_turned(stage: Stage) -> None:
    with stage.client() as client:
        client.press("Whole field")
        stage.tick_until(client, lambda: client.heard("SetCameraPositionMessage")[-1]["position"][2] > 100)
        wide = client.heard("SetCameraPositionMessage")[-1]["position"][2]
        client.camera(390, 674)
        stage.tick_until(client, lambda: client.heard("SetCameraPositionMessage")[-1]["position"][2] > wide + 10)


def test_night_and_day_change_for_all_and_late_clients(stage: Stage) -> None:
    with stage.client() as one, stage.client() as other:
        one.press("Night")
        for client in (one, other):
            stage.tick_until(client, lambda who=client: visible(who, "/backdrop/night"))
            stage.tick_until(client, lambda who=client: not visible(who, "/backdrop/day"))
        with stage.client() as late:
            assert late.heard("ThemeConfigurationMessage")[-1]["dark_mode"]
        other.press("Day")
        stage.tick_until(one, lambda: not visible(one, "/backdrop/night"))


def test_the_replay_panel_steers_a_recording(server: viser.ViserServer) -> None:
    drive = b"".join(chunk.data for chunk in path_chunks(up_and_down()))
    session = ReplaySession(a_job(), FileLog("a drive", drive))
    session.start()
    try:
        stage = Stage(server, session)
        with viser_client(server) as client:
            control = session.replay
            stage.tick_until(client, lambda: client.control("Pause"))
            client.press("Pause")
            stage.tick_until(client, lambda: not control.state.playing)
            stage.tick_until(client, lambda: client.control("Play"))
            client.press("50")
            stage.tick_until(client, lambda: control.state.speed == 50.0)
            for words, speed in (("½", 0.5), ("2", 2.0), ("5", 5.0), ("10", 10.0), ("1", 1.0)):
                client.press(words)
                stage.tick_until(client, lambda wanted=speed: control.state.speed == wanted)
            slider = next(one for one in client.controls.values() if (one["props"].get("max") or 0) > 60)
            client.set(slider["props"]["label"], 60)
            stage.tick_until(client, lambda: control.state.position == pytest.approx(60.0, abs=1.0))
            stage.tick_until(client, lambda: "01:00 of" in client.words())
            client.press("Play")
            stage.tick_until(client, lambda: control.state.playing)
    finally:
        session.close()


def test_a_live_session_has_no_replay_panel(stage: Stage) -> None:
    with stage.client() as client:
        tabs = [one for one in client.controls.values() if "_tab_labels" in one["props"]]
        assert "Replay" not in [label for one in tabs for label in one["props"]["_tab_labels"]]
