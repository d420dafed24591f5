"""Every real log against what is stored of it, and against what gpsd makes of the same bytes (its ``.chk`` files)."""

import itertools
import json
import math
from pathlib import Path

import pytest
from support.nmea import fixes_of, observations_of
from support.real_logs import GOLDEN_FILE, logs_in, summary_of

from guidance_app.decode.decoder import Decoder
from guidance_app.model import Attitude, Fix, Rejected
from guidance_app.sources.file import FileLog, load_log

pytestmark = pytest.mark.real_logs

MILLIMETRE = 1e-3
METRES_PER_DEGREE = 111_120.0
GOLDEN = json.loads(GOLDEN_FILE.read_text(encoding="utf-8"))
COARSE_IN_GPSD = {"gpsd/ac12_binary.log": 0.2}
"""gpsd takes the position of this one from RMC, which has a decimal less than GGA."""
GPSD_LOGS = sorted(name for name in GOLDEN if name.startswith("gpsd/"))
CHANNELS = ("latitude_deg", "longitude_deg")


def _log(real_data: Path, name: str) -> FileLog:
    return load_log(real_data / "nmea" / name)


def _fixes(real_data: Path, name: str) -> list[Fix]:
    return fixes_of(observations_of(_log(real_data, name).chunks))


def test_every_log_is_stored(real_data: Path) -> None:
    assert set(logs_in(real_data / "nmea")) == set(GOLDEN)


@pytest.mark.parametrize("name", sorted(GOLDEN))
def test_a_log_decodes_as_stored(real_data: Path, name: str) -> None:
    found = summary_of(real_data / "nmea" / name)
    stored = GOLDEN[name]
    assert found.keys() == stored.keys()
    for key, value in stored.items():
        assert found[key] == (pytest.approx(value, rel=1e-6) if isinstance(value, float | list) else value), key


@pytest.mark.parametrize("name", sorted(GOLDEN))
def test_every_sentence_decodes_or_is_rejected_with_a_reason(real_data: Path, name: str) -> None:
    decoder, refused = Decoder(), 0
    log = _log(real_data, name)
    for chunk in log.chunks:
        refused += sum(1 for one in decoder.feed(chunk) if isinstance(one, Rejected) and one.line and one.reason)
    refused += sum(1 for one in decoder.finish(log.duration) if isinstance(one, Rejected) and one.line and one.reason)
    assert decoder.sentences == sum(decoder.kinds.values()) + refused
    assert b"".join(chunk.data for chunk in log.chunks) == (real_data / "nmea" / name).read_bytes()


@pytest.mark.parametrize("name", sorted(GOLDEN))
def test_every_fix_is_possible_and_time_goes_on(real_data: Path, name: str) -> None:
    fixes = _fixes(real_data, name)
    assert len(fixes) == GOLDEN[name]["fixes"]
    for before, fix in itertools.pairwise(fixes):
        assert fix.t > before.t
        assert fix.arrival >= before.arrival
    for fix in fixes:
        assert fix.cell is not None
        assert fix.cell[0] > fix.cell[1] > 0.0
        assert fix.course is None or 0.0 <= fix.course < math.tau
        assert fix.heading is None or 0.0 <= fix.heading < math.tau
        assert fix.speed is None or 0.0 <= fix.speed < 50.0


def _positions_of_gpsd(path: Path) -> list[tuple[float, float, str | None]]:
    reports = (json.loads(line) for line in path.read_text(errors="replace").splitlines() if '"class":"TPV"' in line)
    return [(one["lat"], one["lon"], one.get("time")) for one in reports if "lat" in one]


def _apart(a: tuple[float, float], b: tuple[float, float]) -> float:
    north, east = (a[0] - b[0]) * METRES_PER_DEGREE, (a[1] - b[1]) * METRES_PER_DEGREE
    return math.hypot(north, east * math.cos(math.radians(a[0])))


@pytest.mark.parametrize("name", GPSD_LOGS)
def test_every_position_of_gpsd_is_a_fix_of_ours(real_data: Path, name: str) -> None:
    theirs = _positions_of_gpsd(real_data / "nmea" / f"{name}.chk")
    ours = {(fix.latitude_deg, fix.longitude_deg) for fix in _fixes(real_data, name)}
    assert theirs
    for latitude, longitude, _ in theirs:
        nearest = min(_apart((latitude, longitude), one) for one in ours)
        assert nearest < COARSE_IN_GPSD.get(name, MILLIMETRE)


@pytest.mark.parametrize("name", sorted(set(GPSD_LOGS) - set(COARSE_IN_GPSD)))
def test_the_time_of_a_position_is_that_of_gpsd(real_data: Path, name: str) -> None:
    """Only the time of day: gpsd puts old logs after the week rollover into another decade."""
    ours: dict[tuple[float, ...], set[float]] = {}
    for fix in _fixes(real_data, name):
        ours.setdefault(tuple(round(getattr(fix, one), 8) for one in CHANNELS), set()).add(round(fix.t % 86400.0, 3))
    compared = 0
    for latitude, longitude, time in _positions_of_gpsd(real_data / "nmea" / f"{name}.chk"):
        times = ours.get((round(latitude, 8), round(longitude, 8)))
        if time is None or times is None:
            continue
        hours, minutes, seconds = time.partition("T")[2].rstrip("Z").split(":")
        assert int(hours) * 3600 + int(minutes) * 60 + float(seconds) in times
        compared += 1
    assert compared


def test_the_truth_of_the_car_is_heard_although_every_rmc_checksum_is_wrong(real_data: Path) -> None:
    name = "car_rtk_with_truth/MTV.Local1.SPAN.20200206-181434.gga"
    observations = observations_of(_log(real_data, name).chunks)
    refused = [one for one in observations if isinstance(one, Rejected)]
    assert {one.reason for one in refused} == {"checksum wrong"}
    assert {one.line[:6] for one in refused} == {"$GPRMC"}
    assert len(fixes_of(observations)) == len(refused) == 1748


def test_the_car_and_its_truth_go_the_same_way(real_data: Path) -> None:
    """There is a constant offset of about half a metre between the two antennas; the rest is the receiver's error."""
    folder = "car_rtk_with_truth/MTV.Local1"
    truth = {round(fix.t, 2): fix for fix in _fixes(real_data, f"{folder}.SPAN.20200206-181434.gga")}
    gaps = []
    for fix in _fixes(real_data, f"{folder}.ublox-F9K.20200206-181434.nmea"):
        true = truth.get(round(fix.t, 2))
        if true is not None:
            gaps.append(_apart((fix.latitude_deg, fix.longitude_deg), (true.latitude_deg, true.longitude_deg)))
    assert len(gaps) > 1600
    assert sorted(gaps)[len(gaps) // 2] < 0.7


def test_a_gyro_compass_gives_its_five_readings_a_second(real_data: Path) -> None:
    log = _log(real_data, "ship_heading/gyr1_hdt_5hz.log")
    readings = [one for one in observations_of(log.chunks) if isinstance(one, Attitude)]
    assert len(readings) == 1500
    assert len(readings) / log.duration == pytest.approx(5.0, rel=0.01)
    assert math.degrees(readings[0].heading or 0.0) == pytest.approx(218.53)
    assert not log.has_fix


def test_a_seapath_gives_heading_roll_and_pitch_with_each_fix(real_data: Path) -> None:
    fixes = _fixes(real_data, "ship_heading/seap_attitude.log")
    with_attitude = [fix for fix in fixes if fix.heading is not None and fix.roll is not None and fix.pitch is not None]
    assert len(with_attitude) >= len(fixes) - 2
    first = with_attitude[0]
    assert [round(math.degrees(one or 0.0), 2) for one in (first.heading, first.roll, first.pitch)] == [
        218.83,
        0.58,
        -1.09,
    ]
    assert first.speed == pytest.approx(9.4 * 1852 / 3600)
