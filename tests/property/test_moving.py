"""A drive moved elsewhere is the same drive: places by whole degrees, everything else to the bit."""

import math
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.drives import a_job, path_chunks, up_and_down
from support.nmea import observations_of

from guidance_app.boundary import frame_of, polygon_in
from guidance_app.decode.decoder import Decoder
from guidance_app.decode.nmea import SENTENCES, xor_of
from guidance_app.engine import Engine
from guidance_app.model import Chunk, Commanded, Fix, Nudge, OnTheMark, SourceUp
from guidance_app.recording.moving import longitudes_of, moved_events, moved_job, possible_moves
from guidance_app.sources.file import load_log

MILLIMETRE = 1e-3
NANODEGREE = 1e-9


def line(body: str) -> bytes:
    return f"${body}*{xor_of(body):02X}\r\n".encode()


def moved_line(body: str, degrees: int) -> str:
    (event,) = moved_events([Chunk(0.0, line(body))], degrees).events
    assert isinstance(event, Chunk)
    return event.data.decode().strip()


@pytest.mark.parametrize(
    ("place", "degrees", "moved"),
    [
        ("00452.1794,W", 20, "01507.8206,E"),
        ("00452.1794,W", -20, "02452.1794,W"),
        ("12205.6186063,W", 100, "02205.6186063,W"),
        ("17959.9999,E", 1, "17900.0001,W"),
        ("00000.000,E", 40, "04000.000,E"),
        ("00830.,E", 10, "01830.,E"),
    ],
)
def test_a_longitude_moves_and_keeps_its_decimals(place: str, degrees: int, moved: str) -> None:
    body = f"GPGGA,073000.00,4155.8055,N,{place},2,08,1.3,748.00,M,51.8,M,3.0,0120"
    assert moved_line(body, degrees) == line(body.replace(place, moved)).decode().strip()


def test_every_kind_with_a_position_is_moved() -> None:
    with_position = {key for key, reader in SENTENCES.items() if "lon" in reader.index}
    assert with_position == {"GGA", "RMC", "GLL", "GNS", "PANDA", "PAOGI", "KSXT"}
    assert not any("lat" in reader.index and "lon" not in reader.index for reader in SENTENCES.values())
    ksxt = "KSXT,20230913083158.60,116.22309,39.9567,61.3,0.1,0.2,83.4,1.2,,1,3,24,30,,,,0.1,0.2,0.3,1.0,"
    assert ",-163.77691,39.9567," in moved_line(ksxt, 80)
    assert ",76.22309," in moved_line(ksxt, -40)


def test_what_is_not_understood_loses_its_digits_and_stays_as_wrong_as_it_was() -> None:
    unknown = line("PXYZ,4155.8055,N,00452.1794,W")
    damaged = b"$GPGGA,073000.00,4155.8055,N,00452.1794,W,2,08,1.3,748.00,M,51.8,M,3.0,0120*00\r\n"
    binary = b"\xb5b\x01\x07" + bytes(range(1, 9)) + b"\r\n"
    chunks = [Chunk(0.0, one) for one in (unknown, damaged, binary, b"at 41.93 -4.86\r\n")]
    moved = moved_events(chunks, 30)
    assert moved.blanked == 2
    text = b"".join(one.data for one in moved.events)
    assert not any(digit in text.replace(b"*", b"") for digit in (b"4155", b"0452", b"41.93"))
    before, after = Decoder(), Decoder()
    for old, new in zip(chunks, moved.events, strict=True):
        before.feed(old)
        after.feed(new)
    assert after.rejected == before.rejected


@given(st.integers(0, 2**32), st.sampled_from([-160, -37, 12, 95]))
def test_bytes_cut_anywhere_are_moved_alike(seed: int, degrees: int) -> None:
    whole = b"".join(one.data for one in path_chunks([(15.0, 15.0), (15.0, 25.0)]))
    cuts = sorted({(seed * 7919 * (number + 1)) % len(whole) for number in range(6)})
    parts = [whole[low:high] for low, high in zip([0, *cuts], [*cuts, len(whole)], strict=True)]
    (one,) = moved_events([Chunk(0.0, whole)], degrees).events
    many = moved_events([Chunk(float(number), part) for number, part in enumerate(parts)], degrees).events
    assert b"".join(event.data for event in many) == one.data
    assert len(many) == len(parts)


def test_documents_and_commands_move_with_the_bytes() -> None:
    job = a_job()
    assert job.operation is not None
    places = {"edge_at": (8.5, 47.5001), "passable": [(8.5004, 47.5)]}
    job = job.model_copy(update={"operation": job.operation.model_copy(update=places)})
    for degrees in (possible_moves(job)[0], 25, possible_moves(job)[-1]):
        other = moved_job(job, degrees)
        assert job.field is not None
        assert other.field is not None
        for before, after in zip(longitudes_of(job), longitudes_of(other), strict=True):
            assert after == pytest.approx(before + degrees, abs=NANODEGREE)
        here, there = (
            polygon_in(frame_of(one.field.boundary), one.field.boundary) for one in (job, other) if one.field
        )
        assert there.area == pytest.approx(here.area, rel=1e-9)
        for before, after in zip(here.exterior.coords, there.exterior.coords, strict=True):
            assert math.dist(before, after) < MILLIMETRE
        assert other.tractor == job.tractor
        assert other.operation is not None
        assert other.operation.edge_at == (pytest.approx(8.5 + degrees), 47.5001)
        assert other.operation.passable == [(pytest.approx(8.5004 + degrees), 47.5)]
    events = (SourceUp(0.0, "x"), Commanded(1.0, OnTheMark(47.5, 8.5)), Commanded(2.0, Nudge(0.1)))
    moved = moved_events(events, 25).events
    assert moved == (events[0], Commanded(1.0, OnTheMark(47.5, 33.5)), events[2])
    assert moved_job(a_job(field=False), 25) == a_job(field=False)
    assert longitudes_of(a_job(field=False)) == ()


@pytest.mark.real_logs
@pytest.mark.parametrize(
    "name",
    [
        "tractor_9m/impl9m_TLG00001_4dec.nmea",
        "walking_4dec/gps.log",
        "gpsd/ublox-zed-f9r.log",
        "gpsd/ac12_binary.log",
        "gpsd/hemi.log",
    ],
)
def test_a_real_log_elsewhere_has_the_same_fixes(real_data: Path, name: str) -> None:
    chunks = list(load_log(real_data / "nmea" / name).chunks[:600])
    degrees = -50
    moved = moved_events(chunks, degrees).events
    before, after = observations_of(chunks), observations_of(moved)
    assert Counter(type(one).__name__ for one in before) == Counter(type(one).__name__ for one in after)
    fixes = [one for one in before if isinstance(one, Fix)]
    for old, new in zip(fixes, (one for one in after if isinstance(one, Fix)), strict=True):
        assert new.latitude_deg == old.latitude_deg
        wrapped = (new.longitude_deg - old.longitude_deg - degrees + 180) % 360 - 180
        assert wrapped == pytest.approx(0.0, abs=NANODEGREE)
        assert (new.t, new.speed, new.course, new.quality) == (old.t, old.speed, old.course, old.quality)
    assert len(fixes) >= 5


def test_a_moved_drive_drives_the_same_way() -> None:
    job, chunks = a_job(), path_chunks(up_and_down())
    here, there = Engine(job), Engine(moved_job(job, 60))
    for chunk in chunks:
        here.step(chunk)
    for event in moved_events(chunks, 60).events:
        there.step(event)
    assert here.snapshot.pose is not None
    assert there.snapshot.pose is not None
    apart = (here.snapshot.pose.east - there.snapshot.pose.east, here.snapshot.pose.north - there.snapshot.pose.north)
    assert math.hypot(*apart) < MILLIMETRE
    assert there.snapshot.totals.worked == pytest.approx(here.snapshot.totals.worked, rel=1e-3)
