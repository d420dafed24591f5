"""Time logs of ISOXML: any layout, cut at any byte, and as a drive that the engine takes."""

import struct
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.field_files import RECTANGLE, task_data, zipped
from support.nmea import fixes_of, observations_of

from guidance_app.batch.exporting import drive_export
from guidance_app.batch.time_logs import job_of, recording_of
from guidance_app.exchange import ExchangeError, read_fields
from guidance_app.exchange.time_log import Instant, LoggedValue, written_log
from guidance_app.exchange.time_log_drive import events_of, nmea_of, read_time_log, time_log_names
from guidance_app.model import Chunk, Commanded, FixQuality, SetWork
from guidance_app.store.recordings import open_recording

START = datetime(2026, 5, 4, 6, 30, tzinfo=UTC).timestamp()
HALF_UNIT_DEG = 0.51e-7
LAYOUT = (LoggedValue(141, "DET-1"), LoggedValue(67, "DET-1"))
TASK = '<TSK A="TSK1" B="Sowing" E="PFD1" G="4"><TLG A="TLG00001" C="1"/></TSK>'
PFD = (
    '<PFD A="PFD1" C="Long acre"><PLN A="1"><LSG A="1">'
    + "".join(f'<PNT A="2" C="{latitude:.9f}" D="{longitude:.9f}"/>' for longitude, latitude in RECTANGLE)
    + "</LSG></PLN></PFD>"
)


def instant(second: float, work: int | None = None, place: tuple[float, float] | None = (41.9301, -4.8699)) -> Instant:
    """One record a second, 1 m to the north each."""
    position = None if place is None else (place[0] + second / 111_100, place[1])
    values = {} if work is None else {0: work, 1: 3000}
    return Instant(START + second, position, 700.0, {"D": 4.0, "G": 12.0}, values)


def archive_of(instants: list[Instant], **more: bytes) -> bytes:
    head, body = written_log(LAYOUT, instants)
    files = {"TASKDATA.XML": task_data(PFD + TASK), "tlg00001.xml": head, "TLG00001.bin": body}
    return zipped(files | {name.replace("__", "."): content for name, content in more.items()})


DRIVEN = [instant(n, int(10 <= n < 30)) for n in range(40)]


def test_a_log_is_a_drive_with_its_work_state_and_width() -> None:
    archive = archive_of(DRIVEN)
    assert time_log_names(archive, "up.zip") == ("TLG00001",)
    log = read_time_log(archive, name="up.zip")
    assert (log.name, log.task, log.field, len(log.rows)) == ("TLG00001", "Sowing", "Long acre", 40)
    assert [row.working for row in log.rows] == [10 <= n < 30 for n in range(40)]
    assert log.widest == 3.0
    row = log.rows[20]
    assert (row.utc, row.quality, row.satellites, row.up) == (START + 20, FixQuality.RTK_FIXED, 12, 700.0)
    assert row.speed == pytest.approx(1.0, abs=0.02)
    assert log.warnings == ("the log's times are taken as UTC",)


def test_its_nmea_is_the_same_track_without_invented_speed() -> None:
    log = read_time_log(archive_of(DRIVEN), name="up.zip")
    fixes = fixes_of(observations_of([Chunk(0.0, nmea_of(log))]))
    assert len(fixes) == 40
    for fix, row in zip(fixes, log.rows, strict=True):
        assert fix.latitude_deg == pytest.approx(row.latitude_deg, abs=HALF_UNIT_DEG)
        assert fix.longitude_deg == pytest.approx(row.longitude_deg, abs=HALF_UNIT_DEG)
        assert (fix.speed, fix.course, fix.utc) == (None, None, row.utc)


def test_its_events_switch_the_implement_where_the_log_says() -> None:
    log = read_time_log(archive_of(DRIVEN), name="up.zip")
    switched = [
        (event.arrival, event.command.down)
        for event in events_of(log)
        if isinstance(event, Commanded) and isinstance(event.command, SetWork)
    ]
    assert switched == [(0.0, False), (10.0, True), (30.0, False)]


def test_its_recording_opens_and_works_the_ground_of_the_log(tmp_path: Path) -> None:
    archive = archive_of(DRIVEN)
    log = read_time_log(archive, name="up.zip")
    (field,) = read_fields(archive, "up.zip")
    job = job_of(log, field.document)
    assert job.implement.working_width == 3.0
    path = tmp_path / "log.zip"
    path.write_bytes(recording_of(log, job))
    assert recording_of(log, job) == path.read_bytes()
    drive = open_recording(path)
    assert drive.truncated is None
    export = drive_export(drive)
    assert export.worked_area == pytest.approx(3.0 * 20, rel=0.1)
    assert [epoch.working for epoch in export.epochs].count(True) in range(18, 23)


def test_condensed_states_of_sections_are_a_work_state_too() -> None:
    layout = [LoggedValue(161, "DET-1")]
    states = [0b0000, 0b0100, 0b0101, -1]
    head, body = written_log(layout, [Instant(START + n, (41.9, -4.8), None, {}, {0: s}) for n, s in enumerate(states)])
    files = {"TASKDATA.XML": task_data(PFD + TASK), "TLG00001.XML": head, "TLG00001.BIN": body}
    log = read_time_log(zipped(files), name="up.zip")
    assert [row.working for row in log.rows] == [False, True, True, None]
    assert log.rows[0].quality is FixQuality.AUTONOMOUS
    assert any("does not tell the fix quality" in warning for warning in log.warnings)


def test_records_without_position_and_steps_back_in_time_are_left_out_and_said() -> None:
    instants = [instant(0), instant(1, place=None), instant(2), instant(1), instant(4)]
    log = read_time_log(archive_of(instants), name="up.zip")
    assert [row.utc - START for row in log.rows] == [0, 2, 4]
    assert any("2 of 5 records" in warning for warning in log.warnings)
    assert "the log tells no work state" in log.warnings


@given(st.integers(0, 10_000))
def test_a_log_that_is_cut_at_any_byte_opens_up_to_the_cut(place: int) -> None:
    head, body = written_log(LAYOUT, DRIVEN)
    cut = body[: place % len(body)]
    files = {"TASKDATA.XML": task_data(TASK), "TLG00001.XML": head, "TLG00001.BIN": cut}
    try:
        log = read_time_log(zipped(files), name="up.zip")
    except ExchangeError as error:
        rows, sentence = 0, str(error)
    else:
        rows, sentence = len(log.rows), ""
        full = read_time_log(archive_of(DRIVEN), name="up.zip")
        assert [row.latitude_deg for row in log.rows] == [row.latitude_deg for row in full.rows[:rows]]
    assert rows or "holds no record" in sentence


def test_constants_of_the_position_stand_in_the_layout() -> None:
    head = b'<TIM A="" D="4"><PTN A="" B="" D="5" F="9"/><DLV A="008D" B="" C="DET-1"/></TIM>'
    body = b"".join(struct.pack("<IHiiB", 1000 * n, 16892, 419300000, -48700000, 0) for n in range(3))
    files = {"TASKDATA.XML": task_data(TASK), "TLG00001.XML": head, "TLG00001.BIN": body}
    log = read_time_log(zipped(files), name="up.zip")
    assert [(row.quality, row.hdop, row.latitude_deg) for row in log.rows] == [(FixQuality.RTK_FLOAT, 0.9, 41.93)] * 3


HEAD, BODY = written_log(LAYOUT, DRIVEN)


@pytest.mark.parametrize(
    ("files", "sentence"),
    [
        ({}, "it has no time log"),
        ({"TLG00001.XML": HEAD}, "it has no time log"),
        ({"TLG00001.XML": b"<PFD/>", "TLG00001.BIN": BODY}, "begins with <PFD>"),
        ({"TLG00001.XML": b'<TIM A="2020-01-01"/>', "TLG00001.BIN": BODY}, "one time for all"),
        ({"TLG00001.XML": b'<TIM A=""><DLV A="zz"/></TIM>', "TLG00001.BIN": BODY}, "identifier 'zz'"),
        ({"TLG00001.XML": b'<TIM A=""><PTN A="x"/></TIM>', "TLG00001.BIN": BODY}, "'x' where a number belongs"),
        ({"TLG00001.XML": b'<TIM A=""/>', "TLG00001.BIN": BODY}, "holds no position|holds no record"),
        ({"TLG00001.XML": HEAD, "TLG00001.BIN": b"\xff"}, "holds no record"),
        ({"TLG00001.XML": b"<TIM", "TLG00001.BIN": BODY}, "not sound XML"),
    ],
)
def test_a_log_that_cannot_be_read_is_one_sentence(files: dict[str, bytes], sentence: str) -> None:
    with pytest.raises(ExchangeError, match=sentence):
        read_time_log(zipped({"TASKDATA.XML": task_data(TASK)} | files), name="up.zip")


def test_a_log_is_named_where_there_are_several(tmp_path: Path) -> None:
    tasks = TASK + '<TSK A="TSK2"><TLG A="TLG00002"/></TSK>'
    files = {"TASKDATA.XML": task_data(tasks), "TLG00001.XML": HEAD, "TLG00001.BIN": BODY}
    files |= {"TLG00002.XML": HEAD, "TLG00002.BIN": BODY}
    with pytest.raises(ExchangeError, match=r"has 2 time logs \(TLG00001, TLG00002\): name one"):
        read_time_log(zipped(files), name="up.zip")
    assert read_time_log(zipped(files), "TLG00002", "up.zip").task == "TSK2"
    with pytest.raises(ExchangeError, match="no task in it has the time log TLG00009"):
        read_time_log(zipped(files), "TLG00009", "up.zip")
    with pytest.raises(ExchangeError, match="cannot be read"):
        time_log_names(tmp_path / "nothing")
    tasks_only = {"TASKDATA.XML": task_data(TASK), "TLG00001.BIN": BODY}
    with pytest.raises(ExchangeError, match=r"TLG00001\.XML is missing"):
        read_time_log(zipped(tasks_only), "TLG00001", "up.zip")
