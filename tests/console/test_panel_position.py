"""The position panel, the pause and the sections: each press posts its command, and what is found is kept."""

from dataclasses import replace
from pathlib import Path

import pytest
import viser
from support.snapshots import ORIGIN_DEG, SetSession, field_job, field_snapshot
from support.stage import Stage, visible

from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.documents import Settings, Tractor
from guidance_app.geodesy import FieldFrame
from guidance_app.model import (
    ApplyRollZero,
    BeginInitialisation,
    CancelRollZero,
    DropOffset,
    FinishRollZero,
    Initialised,
    Initialising,
    NextRollZeroDrive,
    OffsetKind,
    OffsetRecord,
    OnTheMark,
    Resume,
    RollZeroFound,
    RollZeroProgress,
    RollZeroStage,
    SessionState,
    SkipInitialisation,
)
from guidance_app.runtime import SessionManager
from guidance_app.store import Store

NANODEGREE = 1e-9


@pytest.fixture
def stage(server: viser.ViserServer) -> Stage:
    """The field at work."""
    return Stage(server, SetSession(field_snapshot()))


def shown(client, label: str) -> bool:
    """Whether the button with these words is to be seen."""
    control = client.control(label)
    return bool(control) and control["props"]["visible"]


def test_every_offset_in_force_has_its_undo(stage: Stage) -> None:
    offsets = (
        OffsetRecord(OffsetKind.INITIALISATION, 10.0, east=0.3, north=0.4),
        OffsetRecord(OffsetKind.MARK, 40.0, east=0.0, north=0.2),
        OffsetRecord(OffsetKind.NUDGE, 90.0, metres=-0.04),
    )
    stage.session.publish(field_snapshot(offsets=offsets))
    undo = {
        "Undo: initialisation 50 cm, 90 s ago": OffsetKind.INITIALISATION,
        "Undo: mark 20 cm, 60 s ago": OffsetKind.MARK,
        "Undo: nudge 4 cm left, 10 s ago": OffsetKind.NUDGE,
    }
    with stage.client() as client:
        for words, kind in undo.items():
            stage.tick_until(client, lambda wanted=words: shown(client, wanted))
            client.press(words)
            stage.tick_until(client, lambda wanted=kind: DropOffset(wanted) in stage.session.commands)
        assert not shown(client, "shift")
        assert not shown(client, "line here")


def test_the_mark_is_the_nearest_known_point(stage: Stage) -> None:
    with stage.client() as client:
        stage.tick_until(client, lambda: "Entrance" in client.words() and "away" in client.words())
        client.press("I stand on this point")
        stage.tick_until(client, lambda: stage.session.commands)
    (mark,) = stage.session.commands
    assert isinstance(mark, OnTheMark)
    entrance = stage.session.job.field.entrance
    assert (mark.longitude_deg, mark.latitude_deg) == (
        pytest.approx(entrance[0], abs=NANODEGREE),
        pytest.approx(entrance[1], abs=NANODEGREE),
    )


def test_a_point_may_be_chosen_by_name_or_typed(stage: Stage) -> None:
    with stage.client() as client:
        client.set("Known point", "Corner 3")
        stage.tick_until(client, lambda: "Corner 3" in client.words())
        client.press("Measure on this point, 10 s")
        stage.tick_until(client, lambda: stage.session.commands)
        (begun,) = stage.session.commands
        assert isinstance(begun, BeginInitialisation)
        east, north = FieldFrame(*ORIGIN_DEG).east_north_from_degrees(begun.latitude_deg, begun.longitude_deg)
        assert (round(east), round(north)) == (150, 200)
        client.set("Known point", "Typed below")
        stage.tick_until(client, lambda: shown(client, "Latitude, longitude"))
        client.set("Latitude, longitude", "47.5001, 8.5002")
        client.press("I stand on this point")
        stage.tick_until(client, lambda: OnTheMark(47.5001, 8.5002) in stage.session.commands)
        client.set("Latitude, longitude", "north of the barn")
        client.press("I stand on this point")
        stage.tick_until(client, lambda: client.heard("NotificationShowMessage"))
        assert len(stage.session.commands) == 2


def test_measuring_shows_how_far_it_is_and_may_be_skipped(stage: Stage) -> None:
    measuring = field_snapshot(state=SessionState.INITIALISING, initialising=Initialising(0.4, 21))
    stage.session.publish(measuring)
    with stage.client() as client:
        for words in ("40 %, 21 fixes", "width:40%"):
            stage.tick_until(client, lambda wanted=words: wanted in client.words())
        client.press("Skip measuring")
        stage.tick_until(client, lambda: SkipInitialisation() in stage.session.commands)
        again = Initialising(0.0, 0, "the tractor turns: stand still at the start point")
        stage.session.publish(replace(measuring, initialising=again))
        stage.tick_until(client, lambda: "Measuring again: the tractor turns" in client.words())
        found = Initialised(100.0, 52, 10.2, 0.3, 0.4, (0.03, 0.04), 0.002)
        stage.session.publish(field_snapshot(initialised=found))
        for words in ("52 fixes in 10 s", "50 cm", "± 5 cm", "0.11 °/s"):
            stage.tick_until(client, lambda wanted=words: wanted in client.words())


def test_a_pause_is_seen_everywhere_and_left_by_two_buttons(stage: Stage) -> None:
    stage.session.publish(field_snapshot(state=SessionState.PAUSED, working=False))
    with stage.client() as client:
        for count, words in enumerate(("Paused · press to go on", "Go on"), start=1):
            client.press(words)
            stage.tick_until(client, lambda wanted=count: stage.session.commands == [Resume()] * wanted)
        stage.session.publish(field_snapshot(state=SessionState.ENDED, working=False))
        stage.tick_until(
            client, lambda: (one := client.control("The drive has ended")) and one["props"].get("disabled")
        )


def test_how_the_present_pass_is(stage: Stage) -> None:
    with stage.client() as client:
        stage.tick_until(client, lambda: "Pass: 310 m² worked, 12 m² twice, 40 m² missed" in client.words())


def test_a_section_that_is_off_is_marked_and_drawn_apart(stage: Stage) -> None:
    stage.session.publish(field_snapshot(sections=(True, False, True)))
    with stage.client() as client:
        stage.tick_until(client, lambda: client.control("✕ 2"))
        stage.tick_until(client, lambda: visible(client, "/w/here/off"))


def test_the_roll_zero_goes_step_by_step_and_is_kept(server: viser.ViserServer, tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.save(Tractor(name="Tractor", wheelbase=2.7))
    session = SetSession(field_snapshot(), field_job(Settings(), wheelbase=2.7))
    stage = Stage(server, session)
    stage.screen = Screen(server, House(SessionManager(session), store))
    stage.screen.attach()
    found = RollZeroFound(1.52, 1.52, 0.04, 58.0)
    steps = [
        (RollZeroProgress(RollZeroStage.THERE, 34.0), "Now the way back", NextRollZeroDrive()),
        (RollZeroProgress(RollZeroStage.BACK, 60.0, 12.0), "Compare both drives", FinishRollZero()),
        (RollZeroProgress(RollZeroStage.FOUND, 60.0, 60.0, found), "Use it", ApplyRollZero()),
    ]
    with stage.client() as client:
        for progress, words, command in steps:
            session.publish(field_snapshot(roll_zero=progress))
            stage.tick_until(client, lambda wanted=words: shown(client, wanted))
            client.press(words)
            stage.tick_until(client, lambda wanted=command: wanted in session.commands)
        assert "1.52" in client.words()
        client.press("Give up")
        stage.tick_until(client, lambda: CancelRollZero() in session.commands)
        session.publish(field_snapshot(roll_zero_deg=1.52))
        stage.tick_until(client, lambda: shown(client, "Keep it for this tractor"))
        client.press("Keep it for this tractor")
        stage.tick_until(client, lambda: store.load(Tractor, "Tractor").document.roll_zero_deg == 1.52)
        assert store.load(Tractor, "Tractor").document.wheelbase == 2.7
