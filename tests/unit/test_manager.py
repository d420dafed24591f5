"""The session manager: those who hear are carried over, and whatever is asked goes to the session in use."""

import threading

from support.sessions import HandSession, driving

from guidance_app.documents import Settings
from guidance_app.model import LinkStatus, SetWork, Snapshot
from guidance_app.runtime import SessionManager
from guidance_app.view.bar import bar_of


def test_who_hears_is_carried_over_to_the_next_session() -> None:
    first, second = HandSession(), HandSession()
    manager = SessionManager(first)
    heard: list[Snapshot] = []
    stop = manager.subscribe(heard.append)
    manager.take(second)
    first.publish(driving(sequence=7))
    assert [one.sequence for one in heard] == [0]
    second.publish(driving(sequence=9))
    assert [one.sequence for one in heard] == [0, 9]
    assert (first.listeners, second.listeners) == (0, 1)
    stop()
    assert second.listeners == 0


def test_what_the_manager_says_stands_before_the_notices_of_the_session() -> None:
    session = HandSession()
    manager = SessionManager(session)
    plain = manager.snapshot()
    manager.say("Getting ready")
    assert manager.snapshot().notices == ("Getting ready", *plain.notices)
    manager.say(None)
    assert manager.snapshot() is plain


def test_commands_go_to_the_session_in_use() -> None:
    first, second = HandSession(), HandSession()
    manager = SessionManager(first)
    manager.post(SetWork(down=True))
    manager.take(second)
    manager.post(SetWork(down=False))
    assert (first.commands, second.commands) == ([SetWork(down=True)], [SetWork(down=False)])


def test_each_session_is_an_episode_of_its_own() -> None:
    manager = SessionManager(HandSession())
    before = manager.episode
    manager.rest()
    assert manager.idle
    manager.take(HandSession())
    assert not manager.idle
    assert manager.episode == before + 2


def test_a_failing_hearer_does_not_keep_the_next_session_from_coming() -> None:
    manager = SessionManager(HandSession())

    def fail(_: Snapshot) -> None:
        msg = "broken"
        raise RuntimeError(msg)

    heard: list[Snapshot] = []
    manager.subscribe(fail)
    manager.subscribe(heard.append)
    manager.take(HandSession())
    assert len(heard) == 1


def test_without_a_session_it_rests_and_says_so() -> None:
    manager = SessionManager()
    said = threading.Event()

    def hear(snapshot: Snapshot) -> None:
        if snapshot.link.status is LinkStatus.UNUSED:
            said.set()

    assert manager.snapshot().link.status is LinkStatus.UNUSED
    manager.subscribe(hear)
    manager.start()
    assert said.wait(10.0)
    manager.close()
    assert manager.idle
    assert bar_of(manager.snapshot(), manager.now(), Settings()).reason == "no receiver in use: start a drive"
