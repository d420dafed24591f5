"""A session on real ports: what the driver sees when receiver or sensor is unplugged, silent or set wrongly."""

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from support.cables import Cable
from support.nmea import epoch, sentence
from support.sessions import a_job

from guidance_app.language import ENGLISH
from guidance_app.model import ATTITUDE, RECEIVER, LinkStatus, Snapshot
from guidance_app.runtime import LiveSession
from guidance_app.sources.baud import BaudMemory
from guidance_app.sources.kept import Kept, Pauses
from guidance_app.sources.merged import Merged
from guidance_app.sources.serial_port import SerialSettings, open_port, serial_source
from guidance_app.view.bar import bar_of
from guidance_app.view.links import beside_notices
from guidance_app.view.status import link_words

NOON = 43200.0
PATIENCE_S = 60.0
QUICK = Pauses(first=0.02, longest=0.1)


class Tractor:
    """A receiver at 10 Hz and an attitude sensor at 20 Hz on two cables, and the session that reads them."""

    def __init__(self, folder: Path) -> None:
        self.receiver, self.sensor = Cable(folder / "ttyUSB0"), Cable(folder / "ttyUSB1")
        self.memory = BaudMemory(folder / "rates.json")
        sources = {RECEIVER: self.source(self.receiver), ATTITUDE: self.source(self.sensor)}
        self.session = LiveSession(a_job(), Merged(sources), "off")
        self._ticks = 0

    def source(self, cable: Cable) -> Kept:
        return serial_source(
            SerialSettings(str(cable.path), 115200, list_ports=tuple, memory=self.memory, pauses=QUICK)
        )

    def send(self) -> None:
        """A twentieth of a second of both; what is unplugged gets nothing."""
        self._ticks += 1
        if self.receiver.master >= 0 and self._ticks % 2 == 0:
            self.receiver.send(epoch(NOON + self._ticks / 20))
        if self.sensor.master >= 0:
            self.sensor.send(sentence("PGATT,,2.00,0.50,,,,1.00"))

    def until(self, fulfilled: Callable[[Snapshot], object]) -> Snapshot:
        """Sends on until the snapshot is so."""
        changed = threading.Event()
        unsubscribe = self.session.subscribe(lambda _: changed.set())
        end = time.monotonic() + PATIENCE_S
        try:
            while not fulfilled(self.session.snapshot()):
                assert time.monotonic() < end, self.session.snapshot()
                self.send()
                changed.wait(0.05)
                changed.clear()
        finally:
            unsubscribe()
        return self.session.snapshot()


@pytest.fixture
def tractor(tmp_path: Path) -> Iterator[Tractor]:
    made = Tractor(tmp_path)
    made.receiver.plug()
    made.sensor.plug()
    made.session.start()
    yield made
    made.session.close()
    made.receiver.unplug()
    made.sensor.unplug()


def rolled(snapshot: Snapshot) -> bool:
    return snapshot.pose is not None and snapshot.pose.roll is not None


def notices(tractor: Tractor) -> tuple[str, ...]:
    return beside_notices(tractor.session.snapshot(), tractor.session.now(), ENGLISH)


def test_the_sensors_roll_is_in_the_pose_until_it_is_unplugged_and_again_afterwards(tractor: Tractor) -> None:
    snapshot = tractor.until(rolled)
    assert snapshot.fix is not None
    assert snapshot.fix.roll is None
    tractor.until(lambda _: notices(tractor) == ())  # a busy machine may have let it be silent for a moment
    tractor.sensor.unplug()
    tractor.until(lambda one: one.links_beside[ATTITUDE].status is LinkStatus.DOWN)
    assert tractor.session.snapshot().link.status is LinkStatus.FIX
    assert notices(tractor)[0].startswith("No attitude, so roll is not corrected: ")
    tractor.until(lambda one: not rolled(one))
    tractor.sensor.plug()
    tractor.until(rolled)
    tractor.until(lambda _: notices(tractor) == ())  # a busy machine may have let it be silent for a moment


def test_an_unplugged_receiver_blanks_the_bar_and_comes_back(tractor: Tractor) -> None:
    tractor.until(rolled)
    threads = sorted(one.name for one in threading.enumerate())
    for _ in range(10):
        tractor.receiver.unplug()
        snapshot = tractor.until(lambda one: one.link.status is LinkStatus.DOWN)
        words, level = link_words(snapshot.link, tractor.session.now(), ENGLISH)
        assert (words.startswith("The receiver is gone, for "), level) == (True, "bad")
        assert bar_of(snapshot, tractor.session.now(), tractor.session.job.settings).steering is None
        assert snapshot.links_beside[ATTITUDE].status is LinkStatus.ATTITUDE
        tractor.receiver.plug()
        tractor.until(lambda one: one.link.status is LinkStatus.FIX)
    assert sorted(one.name for one in threading.enumerate()) == threads


class Scrambled:
    """A port that is set to another baud rate than the receiver's."""

    def __init__(self, path: str, baud: int) -> None:
        self._port = open_port(path, baud)
        self.baudrate = baud
        self.close, self.write = self._port.close, self._port.write

    @property
    def in_waiting(self) -> int:
        return self._port.in_waiting

    def read(self, size: int) -> bytes:
        return bytes(byte ^ 0xA5 for byte in self._port.read(size))


def test_a_wrong_baud_rate_is_said_with_the_port_and_the_rate(tmp_path: Path) -> None:
    tractor = Tractor(tmp_path)
    tractor.receiver.plug()
    settings = SerialSettings(str(tractor.receiver.path), 9600, Scrambled, tuple, tractor.memory, QUICK)
    tractor.session = LiveSession(a_job(), serial_source(settings), "off")
    tractor.session.start()
    snapshot = tractor.until(lambda one: one.link.status is LinkStatus.NO_SENTENCE)
    words, _ = link_words(snapshot.link, tractor.session.now(), ENGLISH)
    assert f"bytes arrive from {tractor.receiver.path} at 9600 baud but no sentence is valid" in words
    tractor.session.close()
    tractor.receiver.unplug()
