"""What the systems say when a port cannot be opened or used, in the driver's words; the errors are pyserial's."""

import errno
import threading
from pathlib import Path

import pytest
import serial
from support.cables import reading

from guidance_app.sources.baud import BaudMemory
from guidance_app.sources.kept import Pauses
from guidance_app.sources.ports import FoundPort, found_ports
from guidance_app.sources.serial_port import SerialSettings, serial_source

QUICK = Pauses(first=0.01, longest=0.05)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (serial.SerialException(errno.ENOENT, "could not open port"), "is not there: plug the device in"),
        (serial.SerialException(errno.EBUSY, "could not open port"), "is in use by another program: close it"),
        (serial.SerialException(errno.EAGAIN, "Could not exclusively lock port"), "is in use by another program"),
        (serial.SerialException(errno.EACCES, "could not open port"), "add your user to the group dialout"),
        (serial.SerialException(errno.EIO, "could not open port"), "was unplugged: plug the device in again"),
        (serial.SerialException("Could not configure port: (25, 'no tty')"), "is not a serial port"),
        (
            serial.SerialException("could not open port 'COM3': PermissionError(13, 'Access is denied.')"),
            "is in use by",
        ),
        (serial.SerialException("could not open port 'COM9': FileNotFoundError(2, '')"), "is not there"),
        (OSError(errno.ENOTTY, "no tty"), "is not a serial port"),
        (ValueError("Invalid baud rate: 12345"), "cannot be opened: Invalid baud rate: 12345"),
    ],
)
def test_each_error_has_its_words(error: Exception, words: str, tmp_path: Path) -> None:
    def refuse(path: str, baud: int):
        raise error

    memory = BaudMemory(tmp_path / "rates.json")
    source = serial_source(SerialSettings("/dev/no-such-port", 115200, refuse, tuple, memory, QUICK))
    first = next(source.events(threading.Event()))
    assert "/dev/no-such-port" in first.reason
    assert words in first.reason


class Worn:
    """A port that reads, and whose other calls fail as those of a broken one do."""

    baudrate = 115200
    in_waiting = 1

    def read(self, size: int) -> bytes:
        return b"$"[:size]

    def write(self, data: bytes) -> object:
        raise serial.SerialTimeoutException("Write timeout")

    def close(self) -> None:
        raise OSError(errno.EIO, "gone")


def test_a_port_that_takes_nothing_and_does_not_close_is_no_accident(tmp_path: Path) -> None:
    memory = BaudMemory(tmp_path / "rates.json")
    source = serial_source(SerialSettings("/dev/worn", 115200, lambda *_: Worn(), tuple, memory, QUICK))
    with reading(source, keep_chunks=False) as heard:
        heard.wait(lambda one: one.bytes > 0)
        assert not source.write(b"corrections")
    assert heard.failed is None


def test_the_ports_of_this_machine_are_listed_usb_first() -> None:
    ports = found_ports()
    assert all(isinstance(one, FoundPort) and one.path for one in ports)
    assert [one.usb is None for one in ports] == sorted(one.usb is None for one in ports)
