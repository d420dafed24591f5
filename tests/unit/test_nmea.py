import json
import math
from dataclasses import fields
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.nmea import sentence

from guidance_app.decode.nmea import SENTENCES, read_line
from guidance_app.decode.sentence import DecodeError, Sentence

GOLDEN = json.loads((Path(__file__).parents[1] / "data" / "sentences.json").read_text(encoding="utf-8"))
KINDS_WITH_A_READER_OF_THEIR_OWN = {"UNIHEADINGA"}
NOT_COMPARED = {"kind", "cell", "in_view"}
DIGIT = 1e-6


def _line(body: str) -> str:
    return sentence(body).decode().strip()


def _read(line: str) -> Sentence | str:
    """What the line says, or why it is refused."""
    try:
        return read_line(line)
    except DecodeError as error:
        return str(error)


def _said(golden: dict[str, object]) -> dict[str, object]:
    """What a golden line says, by the names of ``Sentence``, in its units."""
    said: dict[str, object] = {}
    for name, value in golden.items():
        if name.endswith("_deg") and name not in ("latitude_deg", "longitude_deg"):
            said[name.removesuffix("_deg")] = math.radians(value)
        else:
            said[name] = tuple(value) if isinstance(value, list) else value
    return said


def test_every_sentence_of_the_table_has_a_golden_line() -> None:
    assert {line["kind"] for line in GOLDEN} == set(SENTENCES) | KINDS_WITH_A_READER_OF_THEIR_OWN


@pytest.mark.parametrize("golden", GOLDEN, ids=lambda golden: golden["line"][:24])
def test_golden_lines_say_exactly_what_is_written_beside_them(golden: dict[str, object]) -> None:
    read = read_line(golden["line"])
    said = _said(golden["says"])
    assert read.kind == golden["kind"]
    for field in fields(Sentence):
        if field.name not in NOT_COMPARED:
            expected = said.get(field.name)
            assert getattr(read, field.name) == (
                pytest.approx(expected, abs=DIGIT) if isinstance(expected, float) else expected
            ), field.name


@given(st.sampled_from(GOLDEN), st.data())
def test_a_flipped_bit_anywhere_in_a_sentence_is_seen_or_changes_nothing(
    golden: dict[str, object], data: st.DataObject
) -> None:
    line = golden["line"]
    place = data.draw(st.integers(1, len(line) - 1))
    bit = data.draw(st.integers(0, 7))
    flipped = line[:place] + chr(ord(line[place]) ^ (1 << bit)) + line[place + 1 :]
    if "*" not in flipped:
        return  # the decoder judges lines without a checksum by their stream
    read = _read(flipped)
    assert isinstance(read, str) or read == read_line(line)


@given(st.sampled_from(GOLDEN), st.data())
def test_a_field_replaced_by_anything_is_read_or_refused_with_a_reason(
    golden: dict[str, object], data: st.DataObject
) -> None:
    texts = golden["line"][1:].partition("*")[0].split(",")
    place = data.draw(st.integers(1, len(texts) - 1))
    texts[place] = data.draw(st.text(st.characters(min_codepoint=0x20, max_codepoint=0x7E, exclude_characters="*$,")))
    read = _read(_line(",".join(texts)))
    assert read
    if isinstance(read, str):
        return
    for field in fields(Sentence):
        value = getattr(read, field.name)
        assert not isinstance(value, float) or math.isfinite(value)


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("GPGGA,120000,4807.0|8,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,", "bad field in GGA"),
        ("GPGGA,120000,4807.038,X,01131.000,E,1,08,0.9,545.4,M,46.9,M,,", "bad field in GGA"),
        ("GPGGA,120000,4867.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,", "bad field in GGA"),
        ("GPGGA,120000,9107.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,", "bad field in GGA"),
        ("GPGGA,120000,4807.038,N,,,1,08,0.9,545.4,M,46.9,M,,", "bad field in GGA"),
        ("GPGGA,250000,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,", "bad field in GGA"),
        ("GPGGA,120000,4807.038,N,01131.000,E,1,08,1e1,545.4,M,46.9,M,,", "bad field in GGA"),
        ("GPGGA,120000,4807.038,N,01131.000,E,1,08,nan,545.4,M,46.9,M,,", "bad field in GGA"),
        ("GPGGA,120000,4807.038,N,01131.000,E,1,1_0,0.9,545.4,M,46.9,M,,", "bad field in GGA"),
        ("GPGGA,120000,4807.038,N,01131.000,E,Q,08,0.9,545.4,M,46.9,M,,", "bad field in GGA"),
        ("GPGGA,120000,4807.038,N,01131.000,E,1,08,0.9", "too short"),
        ("GPRMC,120000,A,4807.038,N,01131.000,E,5.0,361.0,020120,,,A", "bad field in RMC"),
        ("GPRMC,120000,A,4807.038,N,01131.000,E,-5.0,90.0,020120,,,A", "bad field in RMC"),
        ("GPRMC,120000,A,4807.038,N,01131.000,E,5.0,90.0,310220,,,A", "bad field in RMC"),
        ("GPRMC,120000,B,4807.038,N,01131.000,E,5.0,90.0,020120,,,A", "bad field in RMC"),
        ("GNGNS,112257.00,3844.24011,N,00908.43828,W,AX,14,0.5,104.2,50.3,,", "bad field in GNS"),
        ("GPHDT,274.07x,T", "bad field in HDT"),
        ("GPVTG,90.0,M,,M,5.0,N,,K", "bad field in VTG"),
        ("GPGSA,A,4,17,02,,,,,,,,,,,1.48,0.76,1.27", "bad field in GSA"),
        ("GNTHS,244.28,Q", "bad field in THS"),
        ("KSXT,20211016083433.00,116.3,39.9,49.4,223.57,-11.32,330.19,0.024,,7,3,28,27", "bad field in KSXT"),
        ("KSXT,2021101608,116.3,39.9,49.4,223.57,-11.32,330.19,0.024,,1,3,28,27", "bad field in KSXT"),
        ("KSXT,20211316083433.00,116.3,39.9,49.4,223.57,-11.32,330.19,0.024,,1,3,28,27", "bad field in KSXT"),
        ("KSXT,20211016083433.00,116.3,99.9,49.4,223.57,-11.32,330.19,0.024,,1,3,28,27", "bad field in KSXT"),
        ("KSXT,20211016083433.00,,39.9,49.4,223.57,-11.32,330.19,0.024,,1,3,28,27", "bad field in KSXT"),
        ("GPXYZ,1,2,3", "unknown sentence"),
        ("PTNL,GGK,1,2,3", "unknown sentence"),
        ("PASHR,POS,0,03,183530.00,2037.76012,N,08704.07373,W,058.48", "unknown sentence"),
        ("GP", "malformed"),
        ("", "malformed"),
    ],
)
def test_what_is_not_exactly_right_is_refused_with_its_reason(body: str, reason: str) -> None:
    with pytest.raises(DecodeError, match=f"^{reason}$"):
        read_line(_line(body))


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("$GPHDT,274.07,T*04", "checksum wrong"),
        ("$GPHDT,274.07,T*0", "malformed"),
        ("$GPHDT,274.07,T*03*03", "malformed"),
        ("$GPHDT,274.07,T*03junk", "malformed"),
        ("$GPHDT,27\x004.07,T*03", "unprintable characters"),
        ("$GPHDT,27é.07,T*03", "unprintable characters"),
        ("#UNIHEADINGA,97,GPS;SOL_COMPUTED*00000000", "checksum wrong"),
    ],
)
def test_a_damaged_line_is_refused_with_its_reason(line: str, reason: str) -> None:
    with pytest.raises(DecodeError, match=f"^{reason}$"):
        read_line(line)


def test_a_ksxt_without_position_and_time_says_so() -> None:
    read = read_line(_line("KSXT,,,,,,,,,,0,0,0,0"))
    assert (read.time, read.date, read.latitude_deg, read.valid) == (None, None, None, False)


@pytest.mark.parametrize("status", ["UNKNOWN", "FREEWHEELING"])
def test_a_unicore_clock_that_is_not_set_gives_no_time(status: str) -> None:
    line = f"#UNIHEADINGA,97,GPS,{status},2190,365174000,0,0,18,12;SOL_COMPUTED,NARROW_INT,1.0,90.0,10.0"
    assert read_line(line).time is None


def test_a_unicore_clock_that_is_no_number_is_refused() -> None:
    line = "#UNIHEADINGA,97,GPS,FINE,2190,36517x000,0,0,18,12;SOL_COMPUTED,NARROW_INT,1.0,90.0,10.0"
    with pytest.raises(DecodeError, match="bad field in UNIHEADINGA"):
        read_line(line)
    with pytest.raises(DecodeError, match="too short"):
        read_line("#UNIHEADINGA,97,GPS,FINE")


@given(st.text(max_size=200))
def test_any_text_is_read_or_refused(text: str) -> None:
    for line in ("$" + text, "#" + text):
        assert _read(line)


@pytest.mark.parametrize("talker", ["GP", "GN", "GA", "24", "Q1", "II"])
def test_any_talker_is_heard(talker: str) -> None:
    assert read_line(_line(f"{talker}HDT,10.0,T")).heading == pytest.approx(math.radians(10.0))


@pytest.mark.parametrize(("decimals", "north"), [(4, 0.1852), (5, 0.01852), (7, 0.0001852), (0, 1852.0)])
def test_the_cell_comes_from_the_decimals_of_each_coordinate(decimals: int, north: float) -> None:
    minutes = f"07.{'0' * decimals}".rstrip(".")
    read = read_line(_line(f"GPGGA,120000,60{minutes},N,01131.00,E,1,08,0.9,545.4,M,46.9,M,,"))
    assert read.cell is not None
    assert read.cell[0] == pytest.approx(north)
    assert read.cell[1] == pytest.approx(18.52 * math.cos(math.radians(60.0 + 7.0 / 60.0)))


def test_the_cell_of_degrees_is_that_of_sixty_minutes() -> None:
    degrees = "KSXT,20211016083433.00,116.313,60.0000,49.4,223.57,-11.32,330.19,0.024,,1,3,28,27"
    read = read_line(_line(degrees))
    assert read.cell == pytest.approx((60 * 0.1852, 60 * 1.852 * 0.5))
