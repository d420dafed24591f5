"""A look at the raw stream: the same however it was cut, and bounded whatever comes."""

import itertools
import sys

from hypothesis import given
from hypothesis import strategies as st
from support.nmea import epoch

from guidance_app.model import ATTITUDE, Chunk, SourceUp
from guidance_app.runtime.tap import LINES_KEPT, LONGEST_LINE, MOST_NAMES, RawStream, Tap

NOON = 43200.0
STREAM = b"".join(epoch(NOON + second) for second in range(8))


@given(st.lists(st.integers(0, len(STREAM)), max_size=20))
def test_cutting_the_bytes_differently_changes_neither_lines_nor_counts(cuts: list[int]) -> None:
    tap, whole = Tap(), Tap()
    whole.hear(Chunk(0.0, STREAM))
    places = [0, *sorted(cuts), len(STREAM)]
    for start, end in itertools.pairwise(places):
        tap.hear(Chunk(0.0, STREAM[start:end]))
    assert tap.look(1.0).lines == whole.look(1.0).lines
    assert tap.look(1.0).kinds == whole.look(1.0).kinds
    assert tap.look(1.0).total == len(STREAM)


def test_it_counts_names_with_their_talkers_and_the_rate() -> None:
    tap = Tap()
    tap.hear(SourceUp(0.0, "a port"))
    for second in range(8):
        tap.hear(Chunk(second + 0.1, epoch(NOON + second)))
    seen = tap.look(8.0)
    assert seen.kinds["GNGGA"] == 8
    assert seen.rate == len(epoch(NOON))
    assert seen.last == 7.1
    assert tap.look(30.0).rate == 0.0


def test_links_are_looked_at_apart() -> None:
    tap = Tap()
    tap.hear(Chunk(0.0, b"$PGATT,\r\n", ATTITUDE))
    assert tap.look(0.0) == RawStream()
    assert tap.look(0.0, ATTITUDE).kinds == {"PGATT": 1}


@given(st.lists(st.binary(min_size=1, max_size=4000), min_size=1, max_size=30))
def test_noise_is_kept_within_bounds(noise: list[bytes]) -> None:
    tap = Tap()
    for number, data in enumerate(noise):
        tap.hear(Chunk(float(number), data * 3))
    seen = tap.look(float(len(noise)))
    assert len(seen.lines) <= LINES_KEPT
    assert all(len(line) <= LONGEST_LINE for line in seen.lines)


def test_invented_names_are_counted_together() -> None:
    tap = Tap()
    for number in range(26 * 26):
        first, second = divmod(number, 26)
        tap.hear(Chunk(0.0, b"$A%c%cX,1\n" % (65 + first, 65 + second)))
    kinds = tap.look(0.0).kinds
    assert len(kinds) == MOST_NAMES + 1
    assert sum(kinds.values()) == 26 * 26
    assert sys.getsizeof(kinds) < 10_000
