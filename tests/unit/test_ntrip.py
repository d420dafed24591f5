"""Corrections from a caster: both versions of the protocol, the position sent back, refusals, and the password."""

import itertools
import logging
import socket
from pathlib import Path
from urllib.parse import quote

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.cables import Cable, reading
from support.caster import FRAMES, MOUNT, PASSWORD, USER, local_caster
from support.nmea import epoch, gga, sentence
from support.servers import server

from guidance_app.model import CORRECTIONS, RECEIVER, SourceDown, SourceUp
from guidance_app.sources import SourceError, open_source
from guidance_app.sources.baud import BaudMemory
from guidance_app.sources.kept import LinkError, Pauses
from guidance_app.sources.merged import Merged
from guidance_app.sources.ntrip import Caster, Corrections, Overheard, _Unchunked, caster_from_uri
from guidance_app.sources.serial_port import SerialSettings, serial_source

NOON = 43200.0
QUICK = Pauses(first=0.01, longest=0.05)
ALL = b"".join(FRAMES)


def caster_at(port: int, mount: str = MOUNT, password: str = PASSWORD) -> Caster:
    return caster_from_uri(f"ntrip://{quote(USER, safe='')}:{quote(password, safe='')}@127.0.0.1:{port}/{mount}")


class Receiver:
    """What corrections are sent to."""

    def __init__(self) -> None:
        self.got = b""

    def take(self, data: bytes) -> bool:
        self.got += data
        return True


def corrections_of(caster: Caster, receiver: Receiver, every_s: float = 10.0) -> Corrections:
    return Corrections(caster, receiver.take, QUICK, every_s)


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("cut", [1, 7, 1000])
def test_what_the_caster_sends_reaches_the_receiver_and_nobody_else(version: int, cut: int) -> None:
    receiver = Receiver()
    with (
        local_caster(version, cut=cut) as caster,
        reading(corrections_of(caster_at(caster.server.port), receiver)) as heard,
    ):
        heard.wait(lambda _: receiver.got == ALL)
        assert heard.told == [f"up: {MOUNT} of 127.0.0.1"]
        assert heard.bytes == 0
        assert all(one.link == CORRECTIONS for one in heard.events)


@pytest.mark.parametrize("version", [1, 2])
def test_the_position_goes_back_once_it_is_known_and_again_and_again(version: int) -> None:
    corrections = None
    with local_caster(version) as caster:
        corrections = corrections_of(caster_at(caster.server.port), Receiver(), 0.05)
        with reading(corrections) as heard:
            heard.wait(lambda one: bool(one.told))
            corrections.hear(epoch(NOON))
            heard.wait(lambda _: b"".join(caster.positions).count(b"\r\n") >= 3)
    first = b"".join(caster.positions).split(b"\r\n")[0]
    assert first.startswith(b"$GPGGA,120000.00,5200.")
    assert first + b"\r\n" == sentence(first.decode().strip("$").partition("*")[0])


def test_a_position_known_before_stands_in_the_request() -> None:
    with local_caster(2) as caster:
        corrections = corrections_of(caster_at(caster.server.port), Receiver())
        corrections.hear(epoch(NOON))
        with reading(corrections) as heard:
            heard.wait(lambda one: bool(one.told))
    assert b"Ntrip-GGA: $GPGGA,120000.00" in caster.requests[0]
    assert b"Ntrip-Version: Ntrip/2.0" in caster.requests[0]


@given(st.lists(st.integers(0, len(epoch(NOON)) * 2), max_size=6))
def test_the_newest_position_is_found_however_the_bytes_were_cut(cuts: list[int]) -> None:
    stream = epoch(NOON) + epoch(NOON + 1)
    corrections = corrections_of(caster_at(1), Receiver())
    places = [0, *sorted(cuts), len(stream)]
    for start, end in itertools.pairwise(places):
        corrections.hear(stream[start:end])
    assert corrections.position.startswith(b"$GPGGA,120001.00")


def test_no_position_is_made_of_damage_or_of_no_fix() -> None:
    corrections = corrections_of(caster_at(1), Receiver())
    corrections.hear(gga(NOON).replace(b"5200", b"5300"))
    corrections.hear(gga(NOON, quality="0"))
    corrections.hear(sentence("GNGGA,120000.00,,,,,0,00,99.99,,,,,,"))
    assert corrections.position == b""


@pytest.mark.parametrize("version", [1, 2])
def test_refusals_are_said_in_words(version: int) -> None:
    with local_caster(version) as caster:
        for asked, words in (
            (caster_at(caster.server.port, password="wrong"), "refuses user and password: check both"),
            (caster_at(caster.server.port, mount="ELSEWHERE"), "has no mount point ELSEWHERE: check its name"),
        ):
            with reading(corrections_of(asked, Receiver())) as heard:
                heard.wait(lambda one: bool(one.told))
                assert heard.told == [f"down: the caster 127.0.0.1 {words}"]


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (b"HTTP/1.1 503 Full\x1b[2J\r\n\r\n", "refuses: HTTP/1.1 503 Full?[2J"),
        (b"HTTP/1.1 404 Not Found\r\n\r\n", "has no mount point"),
        (b"\x00" * 9000, "does not answer as a caster"),
        (b"", "has closed the connection"),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nnothing\r\n", "stream is damaged"),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", "has ended the corrections"),
    ],
)
def test_other_answers_are_said_too(answer: bytes, words: str) -> None:
    with (
        server(lambda connection, _: (connection.recv(4096), connection.sendall(answer))) as other,
        reading(corrections_of(caster_at(other.port), Receiver())) as heard,
    ):
        heard.wait(lambda one: any(words in said for said in one.told))


def test_a_broken_connection_is_made_again() -> None:
    receiver = Receiver()
    with (
        local_caster(1) as caster,
        reading(corrections_of(caster_at(caster.server.port), receiver)) as heard,
    ):
        heard.wait(lambda _: receiver.got == ALL)
        caster.breaks.set()
        heard.wait(lambda _: receiver.got == ALL * 2)
        assert [one.split(":")[0] for one in heard.told] == ["up", "down", "up"]


@given(st.lists(st.binary(min_size=1, max_size=50), min_size=1, max_size=8), st.integers(1, 30))
def test_chunks_are_put_together_however_they_were_cut(pieces: list[bytes], cut: int) -> None:
    stream = b"".join(b"%x;name=1\r\n%s\r\n" % (len(one), one) for one in pieces)
    unchunked = _Unchunked()
    out = b"".join(unchunked.feed(stream[at : at + cut]) for at in range(0, len(stream), cut))
    assert out == b"".join(pieces)
    with pytest.raises(LinkError):
        unchunked.feed(b"-5\r\n")


def test_through_a_real_port_beside_an_attitude_sensor(tmp_path: Path) -> None:
    cable = Cable(tmp_path / "ttyUSB0")
    cable.plug()
    port = serial_source(
        SerialSettings(str(cable.path), 115200, list_ports=tuple, memory=BaudMemory(tmp_path / "rates.json"))
    )
    got = b""

    def drained() -> bytes:
        nonlocal got
        got += cable.sent_back()
        return got

    with local_caster(2) as caster:
        corrections = Corrections(caster_at(caster.server.port), port.write, QUICK)
        merged = Merged({RECEIVER: Overheard(port, corrections.hear), CORRECTIONS: corrections})
        with reading(merged) as heard:
            heard.wait(lambda _: caster.told.is_set(), lambda: cable.send(epoch(NOON)))
            heard.wait(lambda _: drained() != b"" and ALL.endswith(got[-20:]))
            links = {one.link for one in heard.events if isinstance(one, SourceUp)}
            assert links == {RECEIVER, CORRECTIONS}
    cable.unplug()


def test_the_password_is_nowhere_to_be_read(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    with local_caster(2) as caster:
        asked = caster_at(caster.server.port)
        source = open_source("tcp://127.0.0.1:1", caster=asked)
        said = [repr(asked), str(asked), asked.what, source.description, repr(corrections_of(asked, Receiver()))]
        with reading(corrections_of(caster_at(caster.server.port, password="wr0ng"), Receiver())) as heard:
            heard.wait(lambda one: bool(one.told))
            said += [repr(one) for one in heard.events]
    said.append(caplog.text)
    for secret in (PASSWORD, quote(PASSWORD), "wr0ng"):
        assert not any(secret in one for one in said)


@pytest.mark.parametrize(
    "uri",
    [
        "http://farmer:s3cret@host/MOUNT",
        "ntrip://farmer:s3cret@host:99999/MOUNT",
        "ntrip://farmer:s3cret@host",
        "ntrip://farmer:s3cret@host/MOUNT/more",
        "ntrip://farmer:s3cret@/MOUNT",
        "ntrip://farmer:s3cret@[host/MOUNT",
    ],
)
def test_a_wrong_address_is_refused_without_repeating_it(uri: str) -> None:
    with pytest.raises(SourceError, match=r"ntrip://user:password@host:2101/MOUNT") as raised:
        caster_from_uri(uri)
    assert "s3cret" not in str(raised.value)


def test_an_address_in_full_and_in_short() -> None:
    assert caster_from_uri("ntrip://a%40b:p%3Aq@host:2102/M") == Caster("host", 2102, "M", "a@b", "p:q")
    assert caster_from_uri("ntrip://host/M") == Caster("host", 2101, "M")
    assert caster_from_uri("ntrip://user@host/M", "from elsewhere").password == "from elsewhere"


def test_a_receiver_that_takes_none_is_refused() -> None:
    with pytest.raises(SourceError, match="takes no corrections"):
        open_source("udp://:9999", caster=Caster("host", 2101, "M"))
    both = open_source("serial:///dev/ttyUSB0", "serial:///dev/ttyUSB1", Caster("host", 2101, "M"))
    assert both.description == "/dev/ttyUSB0, corrections from M of host, attitude from /dev/ttyUSB1"


def test_a_caster_that_is_not_there_is_said_beside_the_receiver() -> None:
    with socket.socket() as nobody:
        nobody.bind(("127.0.0.1", 0))
        port = nobody.getsockname()[1]
        with reading(corrections_of(caster_at(port), Receiver())) as heard:
            heard.wait(lambda one: bool(one.told))
            down = heard.events[0]
            assert isinstance(down, SourceDown)
            assert down.link == CORRECTIONS
            assert "nothing answers at its port" in down.reason
