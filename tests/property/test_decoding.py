import itertools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.nmea import epoch, fixes_of, gst, hdt, metres_apart, observations_of, vtg, without_arrival

from guidance_app.decode.decoder import Decoder
from guidance_app.model import Chunk, Fix, Observation
from guidance_app.sources.file import FileLog, load_log

MILLIMETRE = 1e-3
FLIPS = 4000
EITHER_SIDE = 3
"""Epochs decoded before and after the one that holds the flipped bit."""
NOON = 43200.0
GOLDEN = [
    line["line"].encode("ascii")
    for line in json.loads((Path(__file__).parents[1] / "data" / "sentences.json").read_text(encoding="utf-8"))
]
DRIVE = b"".join(epoch(NOON + k, 1.5 * k) + vtg() + gst(NOON + k) + hdt(5.0 * k) for k in range(6))
NOISE = [b"\r", b"\n", b"\r\n", b"$", b"*", b",", b"#", b"\xb5b\x01\x07\x5c\x00", b"\xd3\x00\x13$\x80", b"\x00" * 40]


def _decode(chunks: list[Chunk]) -> list[Observation]:
    return observations_of(chunks)


def _cut(data: bytes, cuts: list[int]) -> list[bytes]:
    places = [0, *sorted(cuts), len(data)]
    return [data[start:end] for start, end in itertools.pairwise(places)]


streams = st.lists(
    st.sampled_from([line + b"\r\n" for line in GOLDEN]) | st.sampled_from(NOISE) | st.just(DRIVE), max_size=25
).map(b"".join)


@given(streams, st.data())
def test_any_cut_of_the_bytes_gives_the_same_observations(stream: bytes, data: st.DataObject) -> None:
    cuts = data.draw(st.lists(st.integers(0, len(stream)), max_size=15))
    whole = _decode([Chunk(3.0, stream)])
    assert _decode([Chunk(3.0, piece) for piece in _cut(stream, cuts)]) == whole


@given(st.lists(st.integers(0, len(DRIVE)), max_size=40), st.lists(st.floats(0.0, 0.02), min_size=41, max_size=41))
def test_bytes_that_trickle_in_give_the_same_fixes(cuts: list[int], waits: list[float]) -> None:
    """Each piece comes a little later than the one before, but never so late that an epoch is taken for over."""
    arrivals = itertools.accumulate(waits)
    chunks = [Chunk(arrival, piece) for arrival, piece in zip(arrivals, _cut(DRIVE, cuts), strict=False)]
    assert without_arrival(_decode(chunks)) == without_arrival(_decode([Chunk(0.0, DRIVE)]))


@given(st.lists(st.binary(max_size=60) | st.sampled_from(NOISE) | st.sampled_from(GOLDEN), max_size=30))
def test_no_bytes_make_the_decoder_fail_and_every_sentence_is_accounted_for(pieces: list[bytes]) -> None:
    decoder = Decoder()
    lines = 0
    for k, piece in enumerate(pieces):
        lines += sum(1 for one in decoder.feed(Chunk(0.4 * k, piece)) if getattr(one, "line", ""))
    lines += sum(1 for one in decoder.finish(99.0) if getattr(one, "line", ""))
    assert decoder.sentences == sum(decoder.kinds.values()) + lines


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.integers(0, 5)), max_size=20), st.integers(0, 20))
def test_a_copy_made_anywhere_goes_on_like_the_original(steps: list[tuple[float, int]], place: int) -> None:
    original, arrival = Decoder(), 0.0
    copy, mine, its = original, [], []
    for k, (wait, length) in enumerate(steps):
        if k == place:
            copy = original.fork()
        arrival += wait
        chunk = Chunk(arrival, epoch(NOON + arrival, arrival) * (length > 0) + hdt(arrival) * length)
        mine.append(original.feed(chunk))
        if k >= place:
            its.append(copy.feed(chunk))
    assert its == mine[len(mine) - len(its) :] or place >= len(steps)


LOGS = (
    "tractor_9m/impl9m_TLG00001_7dec.nmea",
    "tractor_9m/impl9m_TLG00008_4dec.nmea",
    "car_rtk_with_truth/MTV.Local1.ublox-F9K.20200206-181434.nmea",
    "gpsd/nmea-rtk.log",
)


def _fixes(chunks: list[Chunk]) -> list[Fix]:
    return fixes_of(_decode(chunks))


@pytest.mark.real_logs
@pytest.mark.parametrize("name", LOGS)
def test_a_flipped_bit_never_moves_a_fix(real_data: Path, name: str) -> None:
    log = load_log(real_data / "nmea" / name)
    random = np.random.default_rng(len(name))
    heard = lost = 0
    for _ in range(FLIPS // len(LOGS)):
        chunks, flipped = _flipped(log, random)
        true = {fix.t: fix for fix in _fixes(chunks)}
        found = _fixes(flipped)
        for fix in found:
            assert fix.t in true, (flipped, fix)
            assert metres_apart(fix, true[fix.t]) < MILLIMETRE, (flipped, fix)
        heard += len(found)
        lost += len(true) - len(found)
    assert heard > 0.9 * (heard + lost)


def _flipped(log: FileLog, random: np.random.Generator) -> tuple[list[Chunk], list[Chunk]]:
    """A few epochs around a random byte of the log, as they are and with one of its bits flipped."""
    middle = int(random.integers(len(log.chunks)))
    first = max(0, middle - EITHER_SIDE)
    chunks = list(log.chunks[first : middle + EITHER_SIDE])
    damaged = bytearray(chunks[middle - first].data)
    damaged[int(random.integers(len(damaged)))] ^= 1 << int(random.integers(8))
    flipped = chunks.copy()
    flipped[middle - first] = replace(chunks[middle - first], data=bytes(damaged))
    return chunks, flipped


@pytest.mark.real_logs
@settings(max_examples=20, deadline=None)
@given(data=st.data())
def test_a_real_log_cut_anywhere_gives_the_same_observations(real_data: Path, data: st.DataObject) -> None:
    log = (real_data / "nmea" / "gpsd" / "nmea-rtk.log").read_bytes()
    cuts = data.draw(st.lists(st.integers(0, len(log)), max_size=200))
    assert _decode([Chunk(0.0, piece) for piece in _cut(log, cuts)]) == _decode([Chunk(0.0, log)])
