"""A serial port that is unplugged, taken, forbidden, set wrongly or full of noise. The ports are pseudo terminals."""

import os
import pwd
import random
import subprocess
import sys
import threading
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import pytest
import serial
from support.cables import Cable, reading
from support.nmea import epoch

from guidance_app.decode.decoder import Decoder
from guidance_app.model import Chunk, Fix, SourceUp
from guidance_app.sources.baud import BaudMemory
from guidance_app.sources.kept import Kept, Pauses
from guidance_app.sources.ports import FoundPort
from guidance_app.sources.serial_port import Port, SerialSettings, open_port, serial_source

NOON = 43200.0
BACK_WITHIN_S = 2.0
MEGABYTE = 1 << 20
SPEED = 921_600 // 10
"""Bytes a second of the fastest rate."""

QUICK = Pauses(first=0.01, longest=0.05)


@pytest.fixture
def cable(tmp_path: Path) -> Iterator[Cable]:
    made = Cable(tmp_path / "ttyUSB0")
    made.plug()
    yield made
    made.unplug()


def source_at(cable: Cable, tmp_path: Path, **settings: object) -> Kept:
    chosen = {"baud": 115200, "list_ports": tuple, "memory": BaudMemory(tmp_path / "rates.json"), **settings}
    return serial_source(SerialSettings(str(cable.path), **chosen))


def test_bytes_come_as_they_were_sent_and_the_end_is_prompt(cable: Cable, tmp_path: Path) -> None:
    with reading(source_at(cable, tmp_path)) as heard:
        heard.wait(lambda one: bool(one.told))
        sent = b"".join(epoch(NOON + second) for second in range(20))
        at = 0
        while at < len(sent):
            at += cable.send(sent[at : at + 100])
        heard.wait(lambda one: one.bytes == len(sent))
        assert heard.data == sent
        assert heard.told == [f"up: {cable.path} at 115200 baud"]
        arrivals = [one.arrival for one in heard.events]
        assert arrivals == sorted(arrivals)
        heard.stop()


def test_what_is_written_reaches_the_device_while_it_is_there(cable: Cable, tmp_path: Path) -> None:
    source = source_at(cable, tmp_path)
    assert not source.write(b"nobody listens yet")
    with reading(source) as heard:
        heard.wait(lambda one: bool(one.told))
        assert source.write(b"\xd3\x00corrections")
        assert cable.sent_back() == b"\xd3\x00corrections"
        cable.unplug()
        heard.wait(lambda one: len(one.told) == 2)
        assert not source.write(b"nobody listens any more")


def test_a_hundred_times_unplugged_and_plugged_in_again(cable: Cable, tmp_path: Path) -> None:
    threads = threading.active_count()
    with reading(source_at(cable, tmp_path, pauses=QUICK)) as heard:
        for number in range(100):
            before = heard.bytes
            heard.wait(lambda one, before=before: one.bytes > before, lambda: cable.send(epoch(NOON)))
            cable.unplug()
            heard.wait(lambda one, number=number: sum("was unplugged" in words for words in one.told) == number + 1)
            cable.plug()
        assert threading.active_count() == threads + 1
        heard.stop()
    assert threading.active_count() == threads


def test_with_its_own_pauses_it_is_back_within_two_seconds(cable: Cable, tmp_path: Path) -> None:
    """Plugged in again after one try in vain, the next try but one finds it, however slow the machine is."""
    pauses = Pauses()
    assert pauses.first + min(2 * pauses.first, pauses.longest) < BACK_WITHIN_S
    with reading(source_at(cable, tmp_path)) as heard:
        heard.wait(lambda one: one.bytes > 0, lambda: cable.send(epoch(NOON)))
        cable.unplug()
        heard.wait(lambda one: any("is not there" in words for words in one.told))
        before = heard.bytes
        cable.plug()
        heard.wait(lambda one: one.bytes > before, lambda: cable.send(epoch(NOON)))
        assert any("was unplugged: plug the device in again" in words for words in heard.told)


def test_a_usb_device_is_found_again_under_another_name(cable: Cable, tmp_path: Path) -> None:
    other = Cable(tmp_path / "ttyUSB1")
    stranger = Cable(tmp_path / "stranger")
    there = [FoundPort(str(cable.path), usb="0403:6001:A9")]
    source = source_at(cable, tmp_path, list_ports=lambda: tuple(there), pauses=QUICK)
    with reading(source) as heard:
        heard.wait(lambda one: one.bytes > 0, lambda: cable.send(epoch(NOON)))
        there[:] = []
        cable.unplug()
        heard.wait(lambda one: "is unplugged: plug the device in again" in one.told[-1])
        stranger.path = cable.path
        stranger.plug()
        there[:] = [FoundPort(str(cable.path), usb="1A86:7523:")]
        other.plug()
        there.append(FoundPort(str(other.path), usb="0403:6001:A9"))
        before = heard.bytes
        heard.wait(lambda one: one.bytes > before, lambda: other.send(epoch(NOON)))
        assert heard.told[-1] == f"up: {other.path} at 115200 baud"
    stranger.unplug()
    other.unplug()


def test_of_two_alike_without_a_number_the_one_in_the_same_socket_is_taken(cable: Cable, tmp_path: Path) -> None:
    left, right = Cable(tmp_path / "ttyUSB1"), Cable(tmp_path / "ttyUSB2")
    there = [FoundPort(str(cable.path), usb="1A86:7523:", plug="1-1")]
    with reading(source_at(cable, tmp_path, list_ports=lambda: tuple(there), pauses=QUICK)) as heard:
        heard.wait(lambda one: one.bytes > 0, lambda: cable.send(epoch(NOON)))
        there[:] = [
            FoundPort(str(left.path), usb="1A86:7523:", plug="1-2"),
            FoundPort(str(right.path), usb="1A86:7523:", plug="1-1"),
        ]
        left.plug()
        right.plug()
        cable.unplug()
        heard.wait(lambda one: one.told[-1] == f"up: {right.path} at 115200 baud")
    left.unplug()
    right.unplug()


def test_a_port_that_another_program_holds_is_said_and_taken_when_it_is_free(cable: Cable, tmp_path: Path) -> None:
    holder = subprocess.Popen(
        [
            sys.executable,
            "-c",
            (
                "import serial, sys\n"
                f"port = serial.Serial({str(cable.path)!r}, exclusive=True)\n"
                "print('held', flush=True)\nsys.stdin.read()"
            ),
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    assert holder.stdout is not None
    holder.stdout.readline()
    with reading(source_at(cable, tmp_path, pauses=QUICK)) as heard:
        heard.wait(lambda one: bool(one.told))
        assert heard.told == [f"down: {cable.path} is in use by another program: close it"]
        holder.communicate(b"")
        heard.wait(lambda one: one.bytes > 0, lambda: cable.send(epoch(NOON)))
        assert heard.told[1:] == [f"up: {cable.path} at 115200 baud"]


def test_a_port_that_is_not_ours_says_which_group(cable: Cable, tmp_path: Path) -> None:
    """The source runs as a user without rights, in a process of its own, because the tests may run as root."""
    device = os.path.realpath(cable.path)
    Path(device).chmod(0)
    script = (
        "import os, sys, threading\n"
        "from guidance_app.sources.serial_port import SerialSettings, serial_source\n"
        f"os.setuid({pwd.getpwnam('nobody').pw_uid}) if os.getuid() == 0 else None\n"
        f"source = serial_source(SerialSettings({device!r}, 115200, list_ports=tuple))\n"
        "print(next(source.events(threading.Event())).reason)\n"
    )
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=True).stdout
    assert said.startswith(f"no permission for {device}: add your user to the group ")
    assert "usermod -aG" in said


def test_a_port_that_is_not_there_or_is_none_is_said_once(tmp_path: Path) -> None:
    plain = tmp_path / "plain"
    plain.write_text("no port")
    for path, words in ((tmp_path / "nothing", "is not there"), (plain, "is not a serial port")):
        with reading(source_at(Cable(path), tmp_path, pauses=QUICK)) as heard:
            heard.wait(lambda one: bool(one.told))
            assert words in heard.told[0]
            assert len(heard.told) == 1


class SetPort:
    """A port of a pseudo terminal whose bytes are noise unless the right baud rate is set, as a real one's are."""

    def __init__(self, port: Port, right: int) -> None:
        self._port = port
        self._right = right
        self.set: list[int] = [port.baudrate]

    @property
    def baudrate(self) -> int:
        return self.set[-1]

    @baudrate.setter
    def baudrate(self, rate: int) -> None:
        self.set.append(rate)

    @property
    def in_waiting(self) -> int:
        return self._port.in_waiting

    def read(self, size: int) -> bytes:
        data = self._port.read(size)
        return data if self.baudrate == self._right else bytes(byte ^ 0xA5 for byte in data)

    def write(self, data: bytes) -> object:
        return self._port.write(data)

    def close(self) -> None:
        self._port.close()


def test_the_baud_rate_is_found_and_remembered(cable: Cable, tmp_path: Path) -> None:
    opened: list[SetPort] = []
    clock = iter(range(1_000_000))

    def open_set(path: str, baud: int) -> SetPort:
        opened.append(SetPort(open_port(path, baud), right=9600))
        return opened[-1]

    settings = {"baud": None, "open_port": open_set, "pauses": QUICK, "clock": lambda: next(clock) * 0.3}
    with reading(source_at(cable, tmp_path, **settings)) as heard:
        heard.wait(lambda one: len(one.told) == 2, lambda: cable.send(epoch(NOON)))
        assert opened[0].set == [115200, 460800, 38400, 9600]
        assert heard.told == [
            f"up: {cable.path} (looking for its baud rate)",
            f"up: {cable.path} at 9600 baud",
        ]
        decoder = Decoder()
        found = next(
            place for place, one in enumerate(heard.events) if isinstance(one, SourceUp) and "9600" in one.what
        )
        heard.wait(lambda one: len(one.events) > found + 4, lambda: cable.send(epoch(NOON + len(heard.events))))
        after = [one for one in heard.events[found:] if isinstance(one, Chunk)]
        assert any(isinstance(one, Fix) for chunk in after for one in decoder.feed(chunk))
    with reading(source_at(cable, tmp_path, **settings)) as heard:
        heard.wait(lambda one: len(one.told) == 2, lambda: cable.send(epoch(NOON)))
        assert opened[-1].set == [9600]


def test_garbage_at_full_speed_leaves_memory_flat_and_the_next_sentence_is_read(cable: Cable, tmp_path: Path) -> None:
    """Ten seconds of bytes at 921,600 baud, as fast as they go: through the port, the hunt and the decoder."""
    garbage = random.Random(1).randbytes(SPEED)
    decoder = Decoder()
    grown: list[int] = []
    with reading(source_at(cable, tmp_path, baud=None), keep_chunks=False) as heard:
        heard.wait(lambda one: bool(one.told))
        tracemalloc.start()
        for second in range(10):
            at, before = 0, heard.bytes
            while at < len(garbage):
                at += cable.send(garbage[at : at + 4000])
            heard.wait(lambda one, before=before: one.bytes - before >= SPEED)
            decoder.feed(Chunk(float(second), garbage))
            grown.append(tracemalloc.get_traced_memory()[0])
        tracemalloc.stop()
    assert grown[-1] - grown[2] < MEGABYTE
    fixes = [one for second in range(3) for one in decoder.feed(Chunk(20.0 + second, epoch(NOON + second)))]
    assert any(isinstance(one, Fix) for one in fixes)


def test_a_real_pyserial_port_is_exclusive(cable: Cable) -> None:
    port = open_port(str(cable.path), 115200)
    with pytest.raises(serial.SerialException):
        open_port(str(cable.path), 115200)
    port.close()
