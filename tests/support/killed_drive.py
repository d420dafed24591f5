"""A program for the power-cut test: drives are killed while they are recorded, and gone on with after each kill.

Usage: python killed_drive.py FOLDER KILLS SLOW_KILLS SEED. A child process drives a recorded session fifty times faster
than real time and says through a pipe what the source gave and what the recorder holds as safe; it is killed with
SIGKILL after a random number of chunks, or with the recorder's own pace after a random time (the slow kills). Then the
recording must open, hold all that was safe and, after a slow kill, all that was given a second before; what it held
before must stand unchanged, and the next start must be able to go on. Prints one line of JSON.
"""

import json
import os
import random
import select
import signal
import struct
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from guidance_app.engine import Engine
from guidance_app.model import Chunk, Commanded, Nudge, SetWork, SourceUp
from guidance_app.runtime import LiveSession, Recorder, new_recording
from guidance_app.runtime.recorder import FLUSH_EVERY
from guidance_app.sources.pacing import Paced
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_list import finish_recording, list_recordings, resumable
from guidance_app.store.recordings_writing import RecordingFolder
from support.drives import a_job, path_chunks, up_and_down

SPEED = 50.0
FAST_FLUSH = 0.01
LAST_SECOND = 1.0
LOOK = 0.02
MOST_CHUNKS = 150
LONG_ENOUGH = 6.0
"""A drive that was cut off sooner is not offered again."""
WORD = struct.Struct("!cd")
DRIVES = 12
"""Kills of one drive before another is begun, so that going on stays quick."""


@dataclass(frozen=True, slots=True)
class Killing:
    """When the child is killed: after so many chunks, and not before so many seconds."""

    chunks: int
    seconds: float = 0.0

    def is_due(self, chunks: int, seconds: float) -> bool:
        return chunks >= self.chunks and seconds >= self.seconds


class Tractor:
    """Goes round for ever; says when each chunk was given."""

    description = "a tractor"
    duration = None
    live = False

    def __init__(self, chunks: list[Chunk], pipe: int, begin: float) -> None:
        self._chunks = chunks
        self._pipe = pipe
        self._begin = begin

    def events(self, stop: threading.Event) -> Iterator[Chunk | SourceUp]:
        yield SourceUp(0.0, self.description)
        for chunk in self._chunks:
            if stop.is_set():
                return
            yield chunk
            os.write(self._pipe, WORD.pack(b"g", round(self._begin + chunk.arrival, 6)))


def drive_on(data: Path, chunks: list[Chunk], pipe: int, flush_every: float) -> None:
    """The child: goes on with what was cut off, or begins a drive, until it is killed."""
    found = resumable(data)
    if found is None:
        begin = 0.0
        first = new_recording(data, a_job(), "a tractor")
        first.close(ended=False)
        folder, past = RecordingFolder.go_on(first.path)
    else:
        folder, past = RecordingFolder.go_on(found.path)
        begin = past.duration
    recorder = Recorder(folder, past, flush_every=flush_every)
    source = Paced(Tractor(chunks, pipe, begin), SPEED)
    if found is None:
        session = LiveSession(past.job, source, past.filter_name, recorder=recorder)
    else:
        session = LiveSession.resumed(past, source, recorder)
    session.start()
    said, never = begin, threading.Event()
    number = 0
    while not never.wait(0.003):
        number += 1
        if number % 20 == 0:
            session.post(Nudge(0.01) if number % 40 else SetWork(down=number % 80 == 0))
        if recorder.flushed_to != said:
            said = recorder.flushed_to
            os.write(pipe, WORD.pack(b"f", said))


def killed_once(data: Path, chunks: list[Chunk], after: Killing, flush_every: float) -> tuple[float, float]:
    """Starts a child and kills it; when it was safe to, and what it was given to a second before."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        try:
            drive_on(data, chunks, writing, flush_every)
        finally:
            os._exit(1)
    os.close(writing)
    given: list[tuple[float, float]] = []
    safe, held, began = 0.0, b"", None
    while began is None or not after.is_due(len(given), time.monotonic() - began):
        if began is not None and not select.select([reading], [], [], LOOK)[0]:
            continue
        new = os.read(reading, 65536)
        assert new, "the child ended by itself"
        now = time.monotonic()
        began = now if began is None else began
        held += new
        whole = len(held) // WORD.size * WORD.size
        for kind, arrival in WORD.iter_unpack(held[:whole]):
            if kind == b"f":
                safe = max(safe, arrival)
            else:
                given.append((now, arrival))
        held = held[whole:]
    killed = time.monotonic()
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    while more := os.read(reading, 65536):
        held += more
    os.close(reading)
    safe = max(
        [safe, *(one for kind, one in WORD.iter_unpack(held[: len(held) // WORD.size * WORD.size]) if kind == b"f")]
    )
    return safe, max((arrival for when, arrival in given if when < killed - LAST_SECOND), default=0.0)


def checked(folder: Path, before: list, safe: float, given: float) -> tuple[list, list[str]]:
    """The events that a killed drive has left, and what is wrong with them."""
    drive = open_recording(folder)
    events = list(drive.events)
    wrong = []
    if events[: len(before)] != before:
        wrong.append(f"{folder.name}: what stood there has changed")
    if drive.duration < safe:
        wrong.append(f"{folder.name}: ends at {drive.duration}, but {safe} was safe")
    if drive.duration < given:
        wrong.append(f"{folder.name}: ends at {drive.duration}, but {given} was given a second before")
    return events, wrong


def main(folder: str, kills: str, slow_kills: str, seed: str) -> None:
    data, dice = Path(folder), random.Random(int(seed))
    chunks = path_chunks(up_and_down(passes=5))
    warm = Engine(a_job())
    for chunk in chunks[:200]:
        warm.step(chunk)
    lost: list[str] = []
    truncated = resumed = commands = longest = 0
    known: dict[Path, list] = {}
    for number in range(int(kills) + int(slow_kills)):
        slow = number >= int(kills)
        if number % DRIVES == 0 and number:
            finish_recording(list_recordings(data)[0].path)
        after = Killing(1, 1.2 + dice.random()) if slow else Killing(dice.randint(1, MOST_CHUNKS))
        safe, given = killed_once(data, chunks, after, FLUSH_EVERY if slow else FAST_FLUSH)
        listed = list_recordings(data)[0]
        before, wrong = checked(listed.path, known.get(listed.path, []), safe, given if slow else 0.0)
        known[listed.path] = before
        lost += wrong
        truncated += open_recording(listed.path).truncated is not None
        if open_recording(listed.path).duration > LONG_ENOUGH:
            found = resumable(data)
            resumed += found is not None
            if found is None:
                lost.append(f"{listed.path.name}: cannot be gone on with")
        commands = max(commands, sum(isinstance(one, Commanded) for one in before))
        longest = max(longest, len(before))
    result = {"kills": int(kills) + int(slow_kills), "lost": lost, "truncated": truncated, "resumable": resumed}
    json.dump(result | {"commands": commands, "longest": longest}, sys.stdout)


if __name__ == "__main__":
    main(*sys.argv[1:])
