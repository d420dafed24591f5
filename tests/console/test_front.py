"""The front: the page, our files and downloads; how a console begins and ends, and what it says."""

import socket
import threading
from collections.abc import Iterator

import pytest
import viser
from support.consoles import (
    PlainScreen,
    StartConsole,
    client_of,
    live_socket,
    running_console,
    viser_socket,
)
from support.sessions import HandSession

from guidance_app.console.address import bind, lan_addresses
from guidance_app.console.files import LARGEST_UPLOAD, Download
from guidance_app.console.front import HEAD, patched_page
from guidance_app.console.server import Console, ConsoleError

PATIENCE_S = 40.0
MEGABYTE = 1_000_000


@pytest.fixture(scope="module")
def console() -> Iterator[Console]:
    """One console for the tests that change nothing."""
    with running_console() as running:
        yield running


# --- the page ------------------------------------------------------------------------------------------------------


def test_the_page_is_visers_with_our_head_in_it(console: Console) -> None:
    with client_of(console) as client:
        page = client.get("/")
    before, _, after = page.text.partition(HEAD)
    assert after.startswith("</head>")
    assert '<div id="root"></div>' in after
    assert page.headers["cache-control"] == "no-cache"
    assert before + after == patched_page().body.decode().replace(HEAD, "")


def test_every_file_of_the_head_is_served(console: Console) -> None:
    names = [part.split('"')[0] for part in HEAD.split('="/static/')[1:]]
    assert len(names) >= 6
    with client_of(console) as client:
        for name in names:
            assert client.get(f"/static/{name}").status_code == 200, name


def test_what_the_browser_has_is_not_sent_again(console: Console) -> None:
    with client_of(console) as client:
        for path in ("/", "/static/lightbar.js"):
            first = client.get(path)
            assert first.headers["content-encoding"] == "gzip"
            again = client.get(path, headers={"If-None-Match": first.headers["etag"]})
            assert (again.status_code, again.content) == (304, b"")


def test_without_compression_the_page_is_the_same(console: Console) -> None:
    with client_of(console) as client:
        plain = client.get("/", headers={"Accept-Encoding": "identity"})
        assert "content-encoding" not in plain.headers
        assert plain.content == client.get("/").content


@pytest.mark.parametrize("query", ["websocket=ws://evil.example", "playbackPath=//evil.example/x.viser", "x"])
def test_a_query_that_would_lead_visers_page_elsewhere_is_dropped(console: Console, query: str) -> None:
    with client_of(console) as client:
        answer = client.get(f"/?{query}")
    assert (answer.status_code, answer.headers["location"]) == (303, "/")


@pytest.mark.parametrize(
    "path",
    ["/static/../pyproject.toml", "/static/%2e%2e/pyproject.toml", "/static/..%2fpyproject.toml", "/static/", "/x"],
)
def test_nothing_beside_our_files_is_served(console: Console, path: str) -> None:
    with client_of(console) as client:
        assert client.get(path).status_code == 404


def test_only_get_is_answered(console: Console) -> None:
    with client_of(console) as client:
        assert client.post("/", content=b"x").status_code == 405


# --- downloads -----------------------------------------------------------------------------------------------------


def test_a_download_is_made_when_it_is_asked_for(start_console: StartConsole) -> None:
    console = start_console()
    made_on: list[str] = []

    def make() -> Download:
        made_on.append(threading.current_thread().name)
        return Download("Große Wiese 2.geojson", "application/geo+json", b"{}")

    with client_of(console) as client:
        assert client.get("/download/field").status_code == 404
        console.house.files.offer(make, "field")
        console.house.files.offer(lambda: None, "nothing")
        answer = client.get("/download/field")
        assert client.get("/download/nothing").status_code == 404
    assert answer.content == b"{}"
    assert answer.headers["content-disposition"] == "attachment; filename*=UTF-8''Gro%C3%9Fe%20Wiese%202.geojson"
    assert made_on != ["console-front"]


# --- beginning and end ---------------------------------------------------------------------------------------------


def test_a_port_in_use_is_one_sentence() -> None:
    with bind("127.0.0.1", 0) as taken:
        port = taken.getsockname()[1]
        console = Console(HandSession(), port=port, screen_factory=PlainScreen)
        with pytest.raises(ConsoleError, match=rf"^Port {port} is in use .*--port\.$"):
            console.start()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"port": 70_000}, "Port 70000 does not exist"),
        ({"port": -1}, "Port -1 does not exist"),
        ({"host": "192.0.2.250", "lan": True, "port": 0}, "192.0.2.250 is not an address of this machine"),
        ({"host": "no such host", "lan": True, "port": 0}, "cannot be opened"),
    ],
)
def test_an_address_that_cannot_be_had_is_one_sentence(options: dict[str, object], sentence: str) -> None:
    with pytest.raises(ConsoleError, match=sentence) as refused:
        Console(HandSession(), screen_factory=PlainScreen, **options).start()  # type: ignore[arg-type]
    assert "\n" not in str(refused.value)


def test_a_closed_console_leaves_nothing_behind() -> None:
    before = set(threading.enumerate())
    session = HandSession()
    for _ in range(3):
        with running_console(session) as console, live_socket(console) as page:
            assert page.recv(timeout=PATIENCE_S)
            with viser_socket(console) as scene:
                assert scene.recv(timeout=PATIENCE_S)
                console.close()
        assert PlainScreen.newest.closed
        assert session.listeners == 0
        with pytest.raises(OSError, match="refused"):
            socket.create_connection(("127.0.0.1", int(console.addresses[0].rpartition(":")[2])), timeout=1)
    for thread in set(threading.enumerate()) - before:
        thread.join(PATIENCE_S)
    assert set(threading.enumerate()) <= before


def test_a_screen_that_fails_closes_what_was_open() -> None:
    class Broken(PlainScreen):
        def start(self) -> None:
            msg = "no picture"
            raise RuntimeError(msg)

    before = set(threading.enumerate())
    with pytest.raises(RuntimeError, match="no picture"):
        Console(HandSession(), port=0, screen_factory=Broken).start()
    for thread in set(threading.enumerate()) - before:
        thread.join(PATIENCE_S)
    assert set(threading.enumerate()) <= before


def test_the_invitation_names_address_and_pin(start_console: StartConsole) -> None:
    alone, network = start_console(), start_console(lan=True, pin="480215")
    assert alone.invitation() == f"Open {alone.addresses[0]} in a browser on this machine."
    words = network.invitation(colour=False)
    assert network.addresses[0] in words
    assert "PIN 480215" in words
    assert "█" in words


def test_on_the_network_the_console_answers_at_its_addresses(start_console: StartConsole) -> None:
    console = start_console(lan=True)
    if not lan_addresses():
        pytest.skip("this machine has no network")
    with client_of(console) as client:
        assert client.get("/").status_code == 401


def test_viser_is_the_version_that_the_page_is_made_for() -> None:
    assert viser.__version__.startswith("1.1.")


# --- uploads -------------------------------------------------------------------------------------------------------


def test_an_awaited_file_comes_in_whole_with_its_name(start_console: StartConsole) -> None:
    console = start_console()
    came: list[tuple[str, bytes]] = []
    token = console.house.files.awaits(lambda name, content: came.append((name, content)))
    with client_of(console) as client:
        answer = client.post(f"/upload/{token}", content=b"\x00ring", headers={"X-File-Name": "Gro%C3%9Fe%20Wiese.kml"})
    assert answer.status_code == 200
    assert came == [("Große Wiese.kml", b"\x00ring")]


def test_a_file_that_nobody_awaits_is_refused(start_console: StartConsole) -> None:
    console = start_console()
    token = console.house.files.awaits(lambda name, content: None)
    console.house.files.forget(token)
    with client_of(console) as client:
        assert client.post(f"/upload/{token}", content=b"ring").status_code == 404


def test_a_file_that_is_too_large_is_refused_and_nothing_is_kept(start_console: StartConsole) -> None:
    console = start_console()
    came: list[str] = []
    token = console.house.files.awaits(lambda name, content: came.append(name))

    def pieces() -> Iterator[bytes]:
        for _ in range(LARGEST_UPLOAD // 2**20 + 2):
            yield bytes(2**20)

    with client_of(console) as client:
        answer = client.post(f"/upload/{token}", content=pieces(), headers={"X-File-Name": "big.zip"})
    assert answer.status_code == 413
    assert "larger than 64 MB" in answer.text
    assert came == []
