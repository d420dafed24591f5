"""The light bar's feed: at once, to everybody, never late, never ended by one odd snapshot."""

import json
import logging
import threading
from collections.abc import Iterator

import pytest
from support.consoles import (
    StartConsole,
    live_socket,
    running_console,
    until_closed,
)
from support.sessions import HandSession, driving
from websockets.sync.connection import Connection

from guidance_app.console.server import Console

PATIENCE_S = 40.0
MEGABYTE = 1_000_000


@pytest.fixture(scope="module")
def console() -> Iterator[Console]:
    """One console for the tests that change nothing."""
    with running_console() as running:
        yield running


# --- the light bar's feed ------------------------------------------------------------------------------------------


def messages(page: Connection) -> Iterator[dict[str, object]]:
    """The bar's messages, each answered as the page does."""
    while True:
        message = json.loads(page.recv(timeout=PATIENCE_S))
        if "style" not in message:
            page.send(str(message["t"]))
            yield message


def test_a_page_hears_the_style_and_then_the_bar(console: Console) -> None:
    with live_socket(console) as page:
        first, second, third = (json.loads(page.recv(timeout=PATIENCE_S)) for _ in range(3))
    assert first["style"]["start"]
    assert second["style"]["zones"] == "gggyyyrr"
    assert third["s"] == "connecting"


def test_a_new_snapshot_is_pushed_to_every_page(start_console: StartConsole) -> None:
    session = HandSession()
    console = start_console(session)
    with live_socket(console) as one, live_socket(console) as other:
        feeds = [messages(one), messages(other)]
        for sequence in range(1, 6):
            session.publish(driving(0.05 * sequence, at=session.now(), sequence=sequence))
            for feed in feeds:
                heard = next(message for message in feed if message["q"] == sequence)
                assert heard["s"] == "guide"
    assert len(console.hub.round_trips_ms) >= 10


def test_settings_that_change_are_told(start_console: StartConsole) -> None:
    session = HandSession()
    console = start_console(session)
    with live_socket(console) as page:
        before = next(messages(page))
        settings = session.job.settings.model_copy(update={"sounds": not session.job.settings.sounds})
        console.house.manager.show_as(settings)
        for _ in range(200):
            message = json.loads(page.recv(timeout=PATIENCE_S))
            if "style" in message:
                break
            page.send(str(message["t"]))
    assert before is not None
    assert message["style"]["sounds"] is settings.sounds


def test_a_page_that_does_not_answer_misses_messages_and_gets_the_newest(start_console: StartConsole) -> None:
    session = HandSession()
    console = start_console(session)
    with live_socket(console) as slow, live_socket(console) as quick:
        feed = messages(quick)
        for sequence in range(1, 40):
            session.publish(driving(at=session.now(), sequence=sequence))
            assert next(message for message in feed if message["q"] == sequence)
        waiting = [json.loads(slow.recv(timeout=PATIENCE_S)) for _ in range(6)]
        unanswered = [message for message in waiting if "style" not in message]
        assert len(unanswered) == 4
        with pytest.raises(TimeoutError):
            slow.recv(timeout=0.3)
        for message in unanswered:
            slow.send(str(message["t"]))
        assert json.loads(slow.recv(timeout=PATIENCE_S))["q"] == 39


class Complaints(logging.Handler):
    """Tells when something has been logged."""

    def __init__(self) -> None:
        super().__init__()
        self.heard = threading.Event()
        self.words: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.words.append(record.getMessage())
        self.heard.set()


def test_a_snapshot_that_cannot_be_shown_is_logged_once_and_does_not_end_the_feed(
    start_console: StartConsole,
) -> None:
    complaints = Complaints()
    log = logging.getLogger("guidance_app.console.live")
    log.addHandler(complaints)
    session = HandSession()
    console = start_console(session)
    try:
        with live_socket(console) as page:
            feed = messages(page)
            next(feed)
            session.publish(driving(float("nan"), at=session.now(), sequence=1))
            assert complaints.heard.wait(PATIENCE_S)
            session.publish(driving(0.1, at=session.now(), sequence=2))
            assert next(message for message in feed if message["q"] != 0)["q"] == 2
    finally:
        log.removeHandler(complaints)
    assert complaints.words == ["the light bar could not be made"]


@pytest.mark.parametrize("answer", ["x", "nan", "9" * 400, b"1"])
def test_a_page_that_talks_nonsense_is_hung_up_on(console: Console, answer: str | bytes) -> None:
    with live_socket(console) as page:
        page.send(answer)
        until_closed(page)
