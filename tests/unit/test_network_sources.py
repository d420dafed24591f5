"""Receivers in the network: TCP, UDP and gpsd, with real sockets of this machine."""

import socket
import threading
import time

import pytest
from support.cables import PATIENCE_S, reading
from support.nmea import epoch
from support.servers import free_port, server

from guidance_app.model import ATTITUDE, RECEIVER, Chunk, SourceDown, SourceUp
from guidance_app.sources import SourceError, addresses, open_source
from guidance_app.sources.kept import Kept, LinkError, Pauses
from guidance_app.sources.merged import Merged

NOON = 43200.0
QUICK = Pauses(first=0.01, longest=0.05)


def quick(uri: str) -> Kept:
    """The source of an address, with pauses that a test can wait for."""
    source = open_source(uri)
    assert isinstance(source, Kept)
    source._pauses = QUICK
    return source


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("serial://", "names no serial port: write it as serial:///dev/ttyUSB0"),
        ("serial:/dev/ttyUSB0", "names no serial port"),
        ("serial://dev/ttyUSB0", "names no serial port"),
        ("serial:///dev/ttyUSB0?baud=fast", "it is a number from 300 to 4000000"),
        ("serial:///dev/ttyUSB0?baud=115200&parity=odd", "parity is no option"),
        ("tcp://host", "needs a host and a port: write it as tcp://192.168.1.20:2000"),
        ("tcp://:2000", "needs a host and a port"),
        ("tcp://host:70000", "needs a host and a port"),
        ("tcp:host:2000", "needs a host and a port"),
        ("udp://", "needs the port to listen at: write it as udp://:9999"),
        ("udp://:9999/path", "needs the port"),
        ("gpsd://", "needs the machine on which gpsd runs"),
        ("gpsd://host/device", "needs the machine"),
    ],
)
def test_a_wrong_address_says_how_it_should_look(uri: str, words: str) -> None:
    with pytest.raises(SourceError) as raised:
        open_source(uri)
    assert uri in str(raised.value)
    assert words in str(raised.value)


@pytest.mark.parametrize(
    ("uri", "description"),
    [
        ("serial:///dev/ttyUSB0", "/dev/ttyUSB0"),
        ("serial://COM3?baud=9600", "COM3"),
        ("serial:///dev/serial/by-id/usb-u%20blox?baud=auto", "/dev/serial/by-id/usb-u blox"),
        ("tcp://192.168.1.20:2000", "192.168.1.20:2000"),
        ("udp://:9999", "UDP port 9999"),
        ("gpsd://localhost", "gpsd on localhost"),
        ("gpsd://localhost:3000", "gpsd on localhost:3000"),
    ],
)
def test_a_right_address_is_called_by_what_it_reads(uri: str, description: str) -> None:
    source = open_source(uri)
    assert (source.description, source.live, source.duration) == (description, True, None)


def test_tcp_reads_and_connects_again_when_the_other_side_closes() -> None:
    def say_and_close(connection: socket.socket, number: int) -> None:
        connection.sendall(epoch(NOON + number))

    with server(say_and_close) as receiver, reading(quick(f"tcp://127.0.0.1:{receiver.port}")) as heard:
        heard.wait(lambda one: one.data.startswith(epoch(NOON + 1) + epoch(NOON + 2)))
        assert heard.told[:2] == [
            f"up: 127.0.0.1:{receiver.port}",
            f"down: 127.0.0.1:{receiver.port} has closed the connection",
        ]
        heard.stop()


def test_tcp_says_once_that_nobody_listens_and_goes_on_trying() -> None:
    port = free_port()
    with reading(quick(f"tcp://127.0.0.1:{port}")) as heard:
        heard.wait(lambda one: bool(one.told))
        assert heard.told == [
            (
                f"down: 127.0.0.1 is there, but nothing answers at its port {port}: is the port right, and its server"
                " running?"
            )
        ]
        with server(lambda connection, _: connection.sendall(epoch(NOON)), port):
            heard.wait(lambda one: one.bytes > 0)
        assert heard.told[1] == f"up: 127.0.0.1:{port}"


def test_an_unknown_host_is_said() -> None:
    with pytest.raises(LinkError, match=r"no-such-host\.invalid is not known in this network"):
        addresses.dial("no-such-host.invalid", 2000, threading.Event())


def test_a_dial_that_nobody_answers_ends_when_it_is_told_to() -> None:
    stop = threading.Event()
    stop.set()
    start = time.monotonic()
    with pytest.raises(LinkError):
        addresses.dial("192.0.2.1", 2000, stop)
    assert time.monotonic() - start < addresses.DIAL_S, "it has waited for the dial to end by itself"


def test_a_silent_connection_is_taken_for_dead(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(addresses, "SILENT_S", 0.0)
    with (
        server(lambda connection, _: connection.recv(1)) as receiver,
        reading(quick(f"tcp://127.0.0.1:{receiver.port}")) as heard,
    ):
        heard.wait(lambda one: sum("has sent nothing for" in words for words in one.told) >= 2)


def test_what_is_written_to_tcp_arrives() -> None:
    came: list[bytes] = []
    said = threading.Event()

    def listen(connection: socket.socket, _number: int) -> None:
        came.append(connection.recv(100))
        said.set()

    with server(listen) as receiver:
        source = quick(f"tcp://127.0.0.1:{receiver.port}")
        with reading(source) as heard:
            heard.wait(lambda one: bool(one.told))
            assert source.write(b"\xd3corrections")
            assert said.wait(PATIENCE_S)
    assert came == [b"\xd3corrections"]


def test_udp_takes_text_and_leaves_binary_frames_out() -> None:
    port = free_port(socket.SOCK_DGRAM)
    source = quick(f"udp://127.0.0.1:{port}")
    with reading(source) as heard, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as board:
        heard.wait(lambda one: bool(one.told))
        assert heard.told == [f"up: UDP port {port}"]
        for datagram in (b"\x80\x81\x7f\xd3\x08steer", epoch(NOON).rstrip(), epoch(NOON + 1)):
            board.sendto(datagram, ("127.0.0.1", port))
        heard.wait(lambda one: len(one.data) == len(epoch(NOON)) * 2)
        assert heard.data == epoch(NOON) + epoch(NOON + 1)
        assert not source.write(b"to whom?")
        heard.stop()


def test_udp_says_who_is_in_the_way() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        port = other.getsockname()[1]
        with reading(quick(f"udp://127.0.0.1:{port}")) as heard:
            heard.wait(lambda one: bool(one.told))
            assert heard.told[0].startswith(f"down: UDP port {port} is in use by another program: close it")
    with reading(quick("udp://192.0.2.1:9999")) as heard:
        heard.wait(lambda one: bool(one.told))
        assert "192.0.2.1 is not an address of this machine" in heard.told[0]


def test_gpsd_is_asked_for_the_raw_stream() -> None:
    asked: list[bytes] = []

    def answer(connection: socket.socket, _number: int) -> None:
        connection.sendall(b'{"class":"VERSION","release":"3.25"}\r\n')
        asked.append(connection.recv(200))
        connection.sendall(b'{"class":"DEVICES","devices":[{"path":"/dev/ttyACM0"}]}\r\n' + epoch(NOON))
        connection.recv(1)

    with server(answer) as daemon, reading(quick(f"gpsd://127.0.0.1:{daemon.port}")) as heard:
        heard.wait(lambda one: epoch(NOON) in one.data)
        heard.stop()
    assert asked == [b'?WATCH={"enable":true,"raw":1,"nmea":true};\n']


def test_a_gpsd_without_a_receiver_is_said() -> None:
    with (
        server(lambda connection, _: connection.sendall(b'{"class":"DEVICES","devices":[]}\r\n')) as daemon,
        reading(quick(f"gpsd://127.0.0.1:{daemon.port}")) as heard,
    ):
        heard.wait(lambda one: any("has no receiver: plug it in" in words for words in one.told))


class Written:
    """A source that gives what it was made of, and then waits or fails."""

    duration = None
    live = True

    def __init__(self, description: str, events: list[Chunk | SourceUp | SourceDown], *, fails: bool = False) -> None:
        self.description = description
        self._events = events
        self._fails = fails

    def events(self, stop: threading.Event):
        yield from self._events
        if self._fails:
            msg = "it broke"
            raise RuntimeError(msg)
        stop.wait()


def test_two_sources_are_one_whose_times_never_step_back() -> None:
    receiver = Written("a receiver", [SourceUp(0.0, "a receiver"), *(Chunk(k / 10, b"fix") for k in range(50))])
    sensor = Written("a sensor", [SourceUp(0.0, "a sensor"), *(Chunk(k / 50, b"roll") for k in range(200))])
    merged = Merged({RECEIVER: receiver, ATTITUDE: sensor})
    assert merged.description == "a receiver, attitude from a sensor"
    threads = threading.active_count()
    with reading(merged) as heard:
        heard.wait(lambda one: len(one.events) == 252)
        arrivals = [one.arrival for one in heard.events]
        assert arrivals == sorted(arrivals)
        of_sensor = [one for one in heard.events if one.link == ATTITUDE]
        assert len(of_sensor) == 201
        assert [one.data for one in of_sensor if isinstance(one, Chunk)] == [b"roll"] * 200
        heard.stop()
    assert threading.active_count() == threads


def test_a_source_that_fails_does_not_take_the_other_with_it() -> None:
    receiver = Written("a receiver", [SourceUp(0.0, "a receiver")])
    sensor = Written("a sensor", [Chunk(3.0, b"roll")], fails=True)
    with reading(Merged({RECEIVER: receiver, ATTITUDE: sensor})) as heard:
        heard.wait(lambda one: len(one.events) == 3)
        down = next(one for one in heard.events if isinstance(one, SourceDown))
        assert (down.link, down.reason, down.arrival) == (ATTITUDE, "a sensor failed: it broke", 3.0)


def test_an_attitude_sensor_is_opened_beside_the_receiver() -> None:
    source = open_source("sim:", "serial:///dev/ttyUSB1")
    assert source.description == "simulated receiver on the sample field, attitude from /dev/ttyUSB1"
    assert open_source("sim:").description == "simulated receiver on the sample field"
