"""Files damaged in any way are fields or one sentence: no reader lets another error out."""

import io
import struct
import zipfile

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.field_files import field_with_lines, spreadsheet_of, task_data, zipped

from guidance_app.exchange import WRITERS, ExchangeError, ReadOptions, read_fields, written_as
from guidance_app.exchange.time_log import Instant, LoggedValue, written_log
from guidance_app.exchange.time_log_drive import read_time_log
from guidance_app.geodesy import CoordinateSystem, Projection

LONGEST_SENTENCE = 600
FIELD = field_with_lines("Größe 圃場")
GPX = (
    b'<gpx version="1.1" creator="t" xmlns="http://www.topografix.com/GPX/1/1"><trk><name>R</name><trkseg>'
    + b"".join(
        f'<trkpt lat="{41.93 + north}" lon="{-4.87 + east}"/>'.encode()
        for east, north in ((0, 0), (0.001, 0), (0.001, 0.001), (0, 0.001), (0, 0.0001))
    )
    + b"</trkseg></trk></gpx>"
)
ABOUT = "$FieldDir\nA\n$Offsets\n0,0\nStartFix\n51.1,-0.2\n"
BOUNDARY = "$Boundary\nFalse\n4\n0,0,0\n100.5,0,0\n100.5,50.25,1.5\n0,50.25,3\n"
TRACKS = "$TrackLines\nAB 12\n0.5\n1.5,2.5\n30,40\n0\n2\nTrue\n0\n"
AGOPENGPS = {"Field.txt": ABOUT, "Boundary.txt": BOUNDARY, "TrackLines.txt": TRACKS}
SOUND: dict[str, bytes] = {f"x{ending}": written_as(ending, FIELD) for ending in WRITERS} | {
    "x.gpx": GPX,
    "x.xlsx": spreadsheet_of([["lat", "lon"], *([lat, lon] for lon, lat in FIELD.boundary.coordinates[0])]),
    "x.txt": b"38.5467;140.0262\n38.5477;140.0262\n38\xc2\xb032'52\"N;140.0272\n",
}
OPTIONS = st.builds(
    ReadOptions,
    system=st.sampled_from([None, CoordinateSystem(), CoordinateSystem(Projection.PLANE_RECTANGULAR, zone=9)]),
    order=st.sampled_from([None, "north first", "east first"]),
    encoding=st.sampled_from([None, "cp932", "utf-8", "rot13", "idna"]),
)


def unpacked(content: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def damaged(content: bytes, noise: bytes, place: int) -> bytes:
    cut = place % len(content)
    return content[:cut] + noise + content[cut + len(noise) :]


def assert_fields_or_a_sentence(content: bytes, name: str, options: ReadOptions) -> None:
    try:
        fields = read_fields(content, name, options)
    except ExchangeError as error:
        sentence = str(error)
    else:
        assert all(field.area >= 100 for field in fields)
        return
    assert sentence.startswith(f"{name}: ")
    assert "\n" not in sentence
    assert len(sentence) < LONGEST_SENTENCE


@pytest.mark.parametrize("name", sorted(SOUND))
@given(noise=st.binary(max_size=20), place=st.integers(0, 100_000), options=OPTIONS)
@settings(max_examples=40, suppress_health_check=[HealthCheck.too_slow])
def test_damaged_bytes_are_fields_or_a_sentence(name: str, noise: bytes, place: int, options: ReadOptions) -> None:
    assert_fields_or_a_sentence(damaged(SOUND[name], noise, place), name, options)


@given(
    st.sampled_from(["field.shp", "field.shx", "field.dbf", "field.prj", "field.cpg", "lines.shp", "lines.dbf"]),
    st.binary(max_size=12),
    st.integers(0, 100_000),
    OPTIONS,
)
@settings(max_examples=80, suppress_health_check=[HealthCheck.too_slow])
def test_damaged_parts_of_a_shapefile_are_fields_or_a_sentence(
    part: str, noise: bytes, place: int, options: ReadOptions
) -> None:
    files = unpacked(SOUND["x.zip"])
    files[part] = damaged(files[part], noise, place)
    assert_fields_or_a_sentence(zipped(files), "x.zip", options)


@given(st.sampled_from(sorted(AGOPENGPS)), st.text(max_size=12), st.integers(0, 100_000))
@settings(max_examples=100)
def test_damaged_folders_of_agopengps_are_fields_or_a_sentence(part: str, noise: str, place: int) -> None:
    files = {name: text.encode() for name, text in AGOPENGPS.items()}
    files[part] = damaged(files[part], noise.encode("utf-8", "replace"), place)
    assert_fields_or_a_sentence(zipped(files), "x.zip", ReadOptions())


HEAD, BODY = written_log(
    [LoggedValue(141, "DET-1")],
    [Instant(1.7e9 + n, (41.93, -4.87 + n * 1e-5), 700.0, {"D": 4.0}, {0: n % 2}) for n in range(20)],
)


@given(st.booleans(), st.binary(max_size=12), st.integers(0, 100_000))
@settings(max_examples=100)
def test_damaged_time_logs_are_rows_or_a_sentence(head: bool, noise: bytes, place: int) -> None:
    files = {
        "TASKDATA.XML": task_data('<TSK A="TSK1"><TLG A="TLG00001"/></TSK>'),
        "TLG00001.XML": damaged(HEAD, noise, place) if head else HEAD,
        "TLG00001.BIN": BODY if head else damaged(BODY, noise, place),
    }
    try:
        rows = read_time_log(zipped(files), name="x.zip").rows
    except ExchangeError as error:
        rows, sentence = (), str(error)
    else:
        sentence = ""
    assert rows or sentence.startswith("x.zip: ")


def test_numbers_that_no_shapefile_can_mean_are_one_sentence() -> None:
    files = unpacked(SOUND["x.zip"])
    shape = bytearray(files["field.shp"])
    for value in (float("nan"), float("inf"), 1e300, -1e39):
        shape[-16:] = struct.pack("<2d", value, value)
        assert_fields_or_a_sentence(zipped(files | {"field.shp": bytes(shape)}), "x.zip", ReadOptions())
