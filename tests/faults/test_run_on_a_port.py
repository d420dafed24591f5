"""The real command on real ports: it drives, is unplugged, ends in good order, and keeps the caster's password."""

import contextlib
import gzip
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

import httpx
from support.cables import Cable
from support.caster import FRAMES, MOUNT, PASSWORD, USER, local_caster
from support.nmea import epoch, sentence

from guidance_app.commands import run

NOON = 43200.0
START_S = 120.0
END_S = 60.0
CORRECTIONS = b"".join(FRAMES)
PAGE_S = 30.0


@contextlib.contextmanager
def running(*arguments: str, environment: dict[str, str]) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The command, once it has printed its address; ended by Ctrl-C if the test has not done so."""
    process = subprocess.Popen(
        [sys.executable, "-W", "error", "-m", "guidance_app", "run", "--port", "0", *arguments],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, **environment},
    )
    assert process.stdout is not None
    printed = ""
    try:
        for line in process.stdout:
            printed += line
            if "Ctrl-C" in line:
                break
        yield process, printed
    finally:
        if process.poll() is None:
            process.kill()
            process.communicate()


def _content(path: Path) -> bytes:
    data = path.read_bytes()
    return gzip.decompress(data) if path.suffix == ".gz" else data


def test_it_reads_two_ports_sends_corrections_and_ends_in_good_order(tmp_path: Path) -> None:
    receiver, sensor = Cable(tmp_path / "ttyUSB0"), Cable(tmp_path / "ttyUSB1")
    receiver.plug()
    sensor.plug()
    data = tmp_path / "data"
    came = b""
    with local_caster(2, again=True) as caster:
        address = f"ntrip://{quote(USER, safe='')}@127.0.0.1:{caster.server.port}/{MOUNT}"
        options = (
            *("--source", f"serial://{receiver.path}?baud=115200"),
            *("--attitude", f"serial://{sensor.path}?baud=115200"),
            *("--ntrip", address, "--data", str(data)),
        )
        with running(*options, environment={run.PASSWORD: PASSWORD}) as (process, printed):
            assert (
                f"reading {receiver.path}, corrections from {MOUNT} of 127.0.0.1, attitude from {sensor.path}"
                in printed
            )
            page = re.search(r"http://127\.0\.0\.1:\d+", printed)
            assert page is not None
            end = time.monotonic() + START_S
            step = 0
            while not (caster.told.is_set() and CORRECTIONS in came):
                assert time.monotonic() < end, (printed, caster.requests, came[-40:])
                receiver.send(epoch(NOON + step / 10))
                sensor.send(sentence("PGATT,,2.00,0.50,,,,1.00"))
                came += receiver.sent_back()
                threading.Event().wait(0.02)
                step += 1
            shown = httpx.get(page[0], timeout=PAGE_S).text
            process.send_signal(signal.SIGINT)
            rest, _ = process.communicate(timeout=END_S)
            assert process.returncode == 0
    receiver.unplug()
    sensor.unplug()
    kept = b"".join(_content(path) for path in data.rglob("*") if path.is_file())
    assert b"PGATT" in kept
    assert f"{MOUNT} of 127.0.0.1".encode() in kept
    for secret in (PASSWORD, quote(PASSWORD), PASSWORD.encode().hex()):
        assert secret not in printed + rest + shown
        assert secret.encode() not in kept
