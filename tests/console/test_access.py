"""Who may come in: PIN, throttle, cookie, Origin and Host, on pages, files, downloads and sockets."""

import re
from collections.abc import Iterator

import pytest
from support.consoles import StartConsole, client_of, live_socket, running_console, viser_socket
from support.sessions import HandSession
from websockets.exceptions import InvalidStatus
from websockets.typing import Origin

from guidance_app.console.access import SESSIONS, Admitted, Door, Names, Refused, Wait, foreign, new_pin
from guidance_app.console.address import ConsoleError
from guidance_app.console.files import Download
from guidance_app.console.server import Console

PIN = "480215"
WRONG = "000000"


class Clock:
    def __init__(self) -> None:
        self.seconds = 0.0

    def __call__(self) -> float:
        return self.seconds


# --- the door ------------------------------------------------------------------------------------------------------


def test_without_a_pin_everybody_is_in() -> None:
    assert Door(None).admits(None)


def test_only_a_token_that_was_handed_out_is_let_in() -> None:
    door = Door(PIN)
    outcome = door.knock("here", PIN)
    assert isinstance(outcome, Admitted)
    assert door.admits(outcome.token)
    for other in (None, "", outcome.token[:-1], outcome.token + "x", "déjà"):
        assert not door.admits(other)


def test_after_five_wrong_pins_even_the_right_one_waits_a_minute() -> None:
    clock = Clock()
    door = Door(PIN, clock)
    outcomes = [door.knock("here", WRONG) for _ in range(5)]
    assert outcomes == [Refused(4, 0.0), Refused(3, 0.0), Refused(2, 0.0), Refused(1, 0.0), Refused(0, 60.0)]
    assert door.knock("here", PIN) == Wait(60.0)
    clock.seconds = 59.0
    assert door.knock("here", PIN) == Wait(1.0)
    clock.seconds = 60.0
    assert isinstance(door.knock("here", PIN), Admitted)


def test_one_address_that_guesses_does_not_lock_out_another() -> None:
    door = Door(PIN, Clock())
    for _ in range(9):
        door.knock("there", WRONG)
    assert isinstance(door.knock("here", PIN), Admitted)


def test_many_addresses_together_wait_too() -> None:
    door = Door(PIN, Clock())
    for k in range(20):
        assert isinstance(door.knock(f"address {k}", WRONG), Refused)
    assert isinstance(door.knock("one more", PIN), Wait)


@pytest.mark.parametrize("pin", ["", "48021", "4802155", "４８０２１５", "480215\n480215", "abcdef", "\udcff"])
def test_what_is_not_the_pin_is_refused(pin: str) -> None:
    assert isinstance(Door(PIN, Clock()).knock("here", pin.encode("utf-8", "replace").decode()), Refused)


def test_the_oldest_of_too_many_browsers_signs_out() -> None:
    door = Door(PIN)
    tokens = []
    for _ in range(SESSIONS + 1):
        outcome = door.knock("here", PIN)
        assert isinstance(outcome, Admitted)
        tokens.append(outcome.token)
    assert [door.admits(token) for token in (tokens[0], tokens[1], tokens[-1])] == [False, True, True]


def test_a_pin_is_six_random_digits() -> None:
    pins = {new_pin() for _ in range(50)}
    assert len(pins) > 45
    assert all(re.fullmatch("[0-9]{6}", pin) for pin in pins)


@pytest.mark.parametrize("pin", ["12345", "1234567", "12345a", "１２３４５６"])
def test_another_kind_of_pin_is_a_mistake(pin: str) -> None:
    with pytest.raises(ValueError, match="6 digits"):
        Door(pin)


# --- where a request comes from ------------------------------------------------------------------------------------

HERE = Names(frozenset({"localhost", "127.0.0.1", "tractor.local"}))


@pytest.mark.parametrize(
    "headers",
    [
        {"host": "localhost:8080"},
        {"host": "LOCALHOST:8080"},
        {"host": "tractor.local"},
        {"host": "127.0.0.1:8080", "origin": "http://127.0.0.1:8080"},
        {"host": "localhost:8080", "origin": "https://localhost:8080"},
        {"host": "localhost:8080", "sec-fetch-site": "same-origin"},
        {"host": "localhost:8080", "sec-fetch-site": "none", "sec-fetch-mode": "navigate"},
        {
            "host": "localhost:8080",
            "sec-fetch-site": "cross-site",
            "sec-fetch-mode": "navigate",
            "sec-fetch-dest": "document",
        },
    ],
)
def test_our_own_page_is_not_foreign(headers: dict[str, str]) -> None:
    assert foreign(headers, HERE, socket=False) is None


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"host": ""},
        {"host": "evil.example:8080"},
        {"host": "127.0.0.1.evil.example"},
        {"host": "192.0.2.7:8080"},
        {"host": "[::"},
        {"host": "localhost:8080", "origin": "http://evil.example"},
        {"host": "localhost:8080", "origin": "http://localhost:9090"},
        {"host": "localhost:8080", "origin": "null"},
        {"host": "localhost:8080", "origin": "http://localhost:8080.evil.example"},
        {"host": "localhost:8080", "sec-fetch-site": "cross-site", "sec-fetch-mode": "no-cors"},
        {"host": "localhost:8080", "sec-fetch-site": "same-site", "sec-fetch-mode": "cors"},
        {
            "host": "localhost:8080",
            "sec-fetch-site": "cross-site",
            "sec-fetch-mode": "navigate",
            "sec-fetch-dest": "iframe",
        },
    ],
)
def test_other_pages_and_other_names_are_foreign(headers: dict[str, str]) -> None:
    assert foreign(headers, HERE, socket=False)


def test_a_socket_says_where_it_comes_from() -> None:
    assert foreign({"host": "localhost:8080"}, HERE, socket=True)
    assert foreign({"host": "localhost:8080", "origin": "http://localhost:8080"}, HERE, socket=True) is None


def test_on_a_network_every_numeric_address_may_be_ours() -> None:
    network = Names(HERE.names, any_number=True)
    assert foreign({"host": "192.0.2.7:8080"}, network, socket=False) is None
    assert foreign({"host": "evil.example:8080"}, network, socket=False)


# --- the same over the wire ----------------------------------------------------------------------------------------

EVERYTHING = [
    "/",
    "/static/lightbar.js",
    "/static/console.css",
    "/static/pin.html",
    "/download/log",
    "/live",
    "/nothing",
]


def with_a_secret(console: Console) -> Console:
    console.house.files.offer(lambda: Download("log.txt", "text/plain", b"secret"), "log")
    return console


@pytest.fixture(scope="module")
def network() -> Iterator[Console]:
    """A console behind a PIN, for tests that try no PIN."""
    with running_console(lan=True, pin=PIN) as console:
        yield with_a_secret(console)


@pytest.fixture(scope="module")
def home() -> Iterator[Console]:
    """A console of this machine alone."""
    with running_console() as console:
        yield console


@pytest.mark.parametrize("path", EVERYTHING)
def test_without_the_pin_nothing_is_served(network: Console, path: str) -> None:
    with client_of(network) as client:
        answer = client.get(path)
    assert answer.status_code == 401
    assert b"secret" not in answer.content
    assert b"__lightbar" not in answer.content
    assert (b"keypad" in answer.content or b'action="/pin"' in answer.content) == (path == "/")


@pytest.mark.parametrize("opened", [live_socket, viser_socket])
def test_without_the_pin_no_socket_opens(network: Console, opened: type) -> None:
    with pytest.raises(InvalidStatus) as refused:
        opened(network)
    assert refused.value.response.status_code == 403


def test_the_pin_pages_own_files_are_open(network: Console) -> None:
    with client_of(network) as client:
        for name in re.findall(r'(?:src|href)="(/static/[^"]+)"', client.get("/").text):
            assert client.get(name).status_code == 200, name


def test_the_right_pin_opens_page_files_downloads_and_sockets(start_console: StartConsole) -> None:
    console = with_a_secret(start_console(lan=True, pin=PIN))
    with client_of(console) as client:
        entered = client.post("/pin", data={"pin": PIN}, headers={"Origin": console.addresses[0]})
        assert entered.status_code == 200
        cookie = entered.headers["set-cookie"]
        assert "HttpOnly" in cookie
        assert "SameSite=strict" in cookie
        assert client.get("/").status_code == 200
        assert client.get("/static/lightbar.js").status_code == 200
        assert client.get("/download/log").content == b"secret"
        cookies = {"Cookie": "; ".join(f"{name}={value}" for name, value in client.cookies.items())}
    for opened in (live_socket, viser_socket):
        with opened(console, additional_headers=cookies) as socket:
            assert socket.recv(timeout=10)


def test_the_link_in_the_qr_code_opens_the_console(start_console: StartConsole) -> None:
    console = with_a_secret(start_console(lan=True, pin=PIN))
    with client_of(console) as client:
        entered = client.get("/", params={"pin": PIN})
        assert entered.status_code == 200
        assert PIN not in entered.text
        assert entered.headers["cache-control"] == "no-store"
        assert "__page" not in entered.text
        assert client.get("/").headers["etag"]


def test_wrong_pins_are_counted_and_then_wait(start_console: StartConsole) -> None:
    with client_of(start_console(lan=True, pin=PIN)) as client:
        pages = [client.post("/pin", data={"pin": WRONG}) for _ in range(6)]
        right = client.get("/", params={"pin": PIN})
    assert "4 tries left" in pages[0].text
    assert "1 try left" in pages[3].text
    assert 'data-wait="60"' in pages[4].text
    assert [page.status_code for page in pages] == [401] * 5 + [429]
    assert right.status_code == 429
    assert int(right.headers["retry-after"]) > 0
    assert "set-cookie" not in right.headers


def test_an_endless_form_is_not_read(start_console: StartConsole) -> None:
    with client_of(start_console(lan=True, pin=PIN)) as client:
        assert client.post("/pin", content=b"pin=" + b"1" * 100_000).status_code == 401


@pytest.mark.parametrize("where", ["home", "network"])
def test_foreign_pages_and_rebound_names_are_refused(where: str, request: pytest.FixtureRequest) -> None:
    console = request.getfixturevalue(where)
    host = console.addresses[0].removeprefix("http://")
    with client_of(console) as client:
        for headers in (
            {"Host": "evil.example"},
            {"Host": f"evil.example:{host.rpartition(':')[2]}"},
            {"Origin": "http://evil.example"},
            {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors"},
        ):
            for path in EVERYTHING:
                assert client.get(path, headers=headers).status_code == 403, (headers, path)
        assert client.post("/pin", data={"pin": PIN}, headers={"Origin": "http://evil.example"}).status_code == 403


@pytest.mark.parametrize("opened", [live_socket, viser_socket])
@pytest.mark.parametrize("origin", [None, "http://evil.example", "http://localhost:1"])
def test_a_socket_of_a_foreign_page_is_refused(home: Console, opened: type, origin: str | None) -> None:
    with pytest.raises(InvalidStatus) as refused:
        opened(home, origin=None if origin is None else Origin(origin))
    assert refused.value.response.status_code == 403


def test_every_answer_forbids_framing_and_foreign_connections(home: Console) -> None:
    with client_of(home) as client:
        for path in EVERYTHING:
            headers = client.get(path).headers
            assert headers["x-frame-options"] == "DENY"
            assert headers["x-content-type-options"] == "nosniff"
            assert headers["content-security-policy"].startswith("default-src 'self' ")


def test_no_interface_but_loopback_without_a_pin() -> None:
    with pytest.raises(ConsoleError, match="--lan"):
        Console(HandSession(), host="0.0.0.0")
    assert Console(HandSession()).pin is None
    assert Console(HandSession(), lan=True).pin is not None
