import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from guidance_app.decode.framing import MAX_LENGTH, Framer

PIECES = [
    b"$GPGGA,1*00",
    b"$GPRMC,2*00",
    b"#UNIHEADINGA,97;1*00",
    b"# a comment with $GPGGA,3*00 in it",
    b"\r",
    b"\n",
    b"\r\n",
    b"2014-08-01T00:00:00.183Z ",
    b"\xb5b\x01\x07\x5c\x00$\xd3\x00",
    b"$",
    b"#",
    b"{}",
    b"x" * 700,
    b"$GPTXT," + b"y" * MAX_LENGTH,
]


def _lines(chunks: list[bytes]) -> list[str]:
    framer = Framer()
    return [line for chunk in chunks for line in framer.feed(chunk)] + framer.finish()


@given(st.lists(st.sampled_from(PIECES) | st.binary(max_size=30), max_size=20), st.data())
def test_cutting_the_bytes_differently_changes_nothing(pieces: list[bytes], data: st.DataObject) -> None:
    whole = b"".join(pieces)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(whole)), max_size=12)))
    chunks = [whole[start:end] for start, end in itertools.pairwise([0, *cuts, len(whole)])]
    assert _lines(chunks) == _lines([whole])


@given(st.lists(st.sampled_from(PIECES) | st.binary(max_size=30), max_size=12))
def test_one_byte_at_a_time_changes_nothing(pieces: list[bytes]) -> None:
    whole = b"".join(pieces)
    assert _lines([bytes([byte]) for byte in whole]) == _lines([whole])


@pytest.mark.parametrize("filler", [b"x", b"$", b"\x00", b"$x", b"#", b"# $", b"#ABCA,"])
def test_bytes_without_an_end_are_not_kept(filler: bytes) -> None:
    framer = Framer()
    for _ in range(200):
        framer.feed(filler * (1000 // len(filler)))
        assert len(framer._rest) <= MAX_LENGTH + 1


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r", b"\r\n\r\n"])
def test_a_line_may_end_as_it_likes(end: bytes) -> None:
    assert Framer().feed(b"$GPGGA,1*00" + end + b"$GPRMC,2*00" + end) == ["$GPGGA,1*00", "$GPRMC,2*00"]


def test_a_sentence_waits_for_its_end() -> None:
    framer = Framer()
    assert framer.feed(b"$GPGGA,1") == []
    assert framer.feed(b"*00") == []
    assert framer.feed(b"\r") == ["$GPGGA,1*00"]
    assert framer.feed(b"\n") == []


@pytest.mark.parametrize(
    "before",
    [b"2014-08-01T00:00:00.183Z ", b"[12:00:01] ", b"\\s:r1,c:1277036460*15\\", b"\xb5b\x01\x07\x5c\x00\xff", b"*1E"],
)
def test_what_stands_before_a_sentence_on_its_line_is_dropped(before: bytes) -> None:
    assert Framer().feed(before + b"$GPGGA,1*00\n") == ["$GPGGA,1*00"]


def test_sentences_that_were_glued_together_are_parted() -> None:
    assert Framer().feed(b"$GPGSA,A,1*1E$GPRMC,2*45\n") == ["$GPGSA,A,1*1E", "$GPRMC,2*45"]


def test_binary_between_sentences_is_no_sentence() -> None:
    frames = b"\xd3\x00\x13>\xd0$\x01\xff$\x80ab\n\xb5b\x02$"
    assert Framer().feed(b"$GPGGA,1*00\r\n" + frames + b"$GPRMC,2*00\r\n") == ["$GPGGA,1*00", "$GPRMC,2*00"]


def test_a_sentence_that_carries_binary_is_kept_to_be_counted() -> None:
    assert Framer().feed(b"$PASHR,MCA,\x1a\xe0\x02\r\n") == ["$PASHR,MCA,\x1a\xe0\x02"]


def test_a_comment_quotes_in_vain() -> None:
    assert Framer().feed("# Grüße: $GPGSV,3,3,12*72\n$GPGGA,1*00\n".encode()) == ["$GPGGA,1*00"]


def test_a_unicore_log_is_no_comment() -> None:
    assert Framer().feed(b"#UNIHEADINGA,97;1*00\n#BESTNAVA,1*0\n") == ["#UNIHEADINGA,97;1*00", "#BESTNAVA,1*0"]


def test_a_copy_goes_its_own_way() -> None:
    framer = Framer()
    framer.feed(b"$GPGGA")
    copy = framer.fork()
    assert framer.feed(b",1*00\n") == ["$GPGGA,1*00"]
    assert copy.feed(b",2*00\n") == ["$GPGGA,2*00"]
