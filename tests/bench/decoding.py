"""Time to decode a log, a sentence and an epoch, beside pynmea2's own parsing of the same lines.

Run in ``tests``: ``python -m bench.decoding LOG...``
"""

import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pynmea2

from guidance_app.decode.decoder import Decoder
from guidance_app.decode.framing import Framer
from guidance_app.sources.file import FileLog, load_log

ROUNDS = 3
MICROSECONDS = 1e6


def _decoded(log: FileLog) -> tuple[Decoder, float]:
    decoder = Decoder()
    start = time.process_time()
    for chunk in log.chunks:
        decoder.feed(chunk)
    decoder.finish(log.duration)
    return decoder, time.process_time() - start


def _parsed_by_pynmea2(lines: Sequence[str]) -> float:
    start = time.process_time()
    for line in lines:
        try:
            pynmea2.parse(line)
        except (pynmea2.ParseError, ValueError, IndexError, KeyError):
            continue
    return time.process_time() - start


def measured(path: Path) -> dict[str, object]:
    """Best of a few rounds, in microseconds."""
    start = time.process_time()
    log = load_log(path)
    loading = time.process_time() - start
    decoder, seconds = min((_decoded(log) for _ in range(ROUNDS)), key=lambda one: one[1])
    lines = [line for chunk in log.chunks for line in Framer().feed(chunk.data)]
    peer = min(_parsed_by_pynmea2(lines) for _ in range(ROUNDS))
    return {
        "log": path.name,
        "load_s": round(loading, 4),
        "sentences": decoder.sentences,
        "us_per_sentence": round(seconds / decoder.sentences * MICROSECONDS, 1),
        "us_per_epoch": round(seconds / len(log.chunks) * MICROSECONDS, 1),
        "times_pynmea2_parse": round(seconds / peer, 2),
        "times_real_time": round(log.duration / seconds),
    }


if __name__ == "__main__":
    for place in sys.argv[1:]:
        sys.stdout.write(json.dumps(measured(Path(place))) + "\n")
