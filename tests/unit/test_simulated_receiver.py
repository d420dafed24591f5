"""The simulated receiver speaks as a real one: strict sentences, an honest grid, a loss of the fix."""

import math
from datetime import UTC, datetime

import numpy as np
import pynmea2
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from guidance_app.decode.decoder import Decoder
from guidance_app.geodesy import FieldFrame, grid_cell
from guidance_app.model import Chunk, Fix, FixQuality, NoFix, Observation
from guidance_app.simulation.receiver import SENTENCES, Antenna, ReceiverSettings, SimulatedReceiver

START = datetime(2026, 4, 14, 23, 59, 58, tzinfo=UTC)
PERFECT = {"noise": 0.0, "drift": 0.0, "doppler": 0.0, "heading_noise": 0.0}
SLOWEST_KNOT = 0.005 * 1852 / 3600


def receiver_at(latitude: float, longitude: float, settings: ReceiverSettings) -> SimulatedReceiver:
    return SimulatedReceiver(FieldFrame(latitude, longitude), settings, START, np.random.default_rng(1))


def antenna_at(east: float, north: float, speed: float = 0.0, heading: float = 0.0) -> Antenna:
    return Antenna(east, north, speed * math.sin(heading), speed * math.cos(heading), heading, 0.1)


def decoded(chunks: list[bytes], interval: float = 0.2) -> list[Observation]:
    decoder = Decoder()
    found: list[Observation] = []
    for number, data in enumerate(chunks):
        found += decoder.feed(Chunk(number * interval, data))
    found += decoder.finish(len(chunks) * interval)
    assert decoder.rejected == {}
    return found


@settings(max_examples=40, deadline=None)
@given(st.floats(-80, 80), st.floats(-179.9, 179.9), st.integers(3, 8), st.floats(-400, 400), st.floats(-400, 400))
def test_a_perfect_receiver_is_right_to_half_its_grid_anywhere(
    latitude: float, longitude: float, decimals: int, east: float, north: float
) -> None:
    receiver = receiver_at(latitude, longitude, ReceiverSettings(decimals=decimals, **PERFECT))
    (fix,) = decoded([receiver.epoch(0, antenna_at(east, north))])
    assert isinstance(fix, Fix)
    read = receiver.frame.east_north_from_degrees(fix.latitude_deg, fix.longitude_deg)
    cell_north, cell_east = grid_cell(fix.latitude_deg, decimals)
    # A nautical mile is up to half a per cent shorter or longer than a minute of the ellipsoid.
    assert abs(read[0] - east) <= 0.51 * cell_east * 1.01 + 1e-6
    assert abs(read[1] - north) <= 0.51 * cell_north * 1.01 + 1e-6
    assert fix.cell == pytest.approx((cell_north, cell_east), rel=1e-3)


def test_every_sentence_is_strict_nmea() -> None:
    receiver = receiver_at(41.93, -4.87, ReceiverSettings(sentences=SENTENCES))
    for data in (receiver.epoch(0, antenna_at(1, 2, 2.5, 1.0)), receiver.no_fix(1)):
        lines = data.decode("ascii").split("\r\n")
        assert lines.pop() == ""
        kinds = []
        for line in lines:
            assert len(line) <= 80
            kinds.append(pynmea2.parse(line, check=True).sentence_type)
        assert tuple(kinds) == SENTENCES


def test_motion_is_that_of_the_antenna_and_no_course_is_given_at_standstill() -> None:
    receiver = receiver_at(41.93, -4.87, ReceiverSettings(sentences=SENTENCES, **PERFECT))
    moving, standing = decoded([receiver.epoch(0, antenna_at(0, 0, 2.7, 4.0)), receiver.epoch(1, antenna_at(0, 0))])
    assert isinstance(moving, Fix)
    assert isinstance(standing, Fix)
    assert moving.speed == pytest.approx(2.7, abs=SLOWEST_KNOT)
    assert moving.course == pytest.approx(4.0, abs=math.radians(0.05))
    assert moving.heading == pytest.approx(4.0, abs=math.radians(0.005))
    assert moving.yaw_rate == pytest.approx(0.1, abs=math.radians(0.05 / 60))
    assert moving.quality is FixQuality.DGPS
    assert standing.speed == 0.0
    assert standing.course is None


def test_without_a_fix_the_epoch_says_so() -> None:
    receiver = receiver_at(41.93, -4.87, ReceiverSettings())
    chunks = [receiver.epoch(0, antenna_at(0, 0)), receiver.no_fix(1), receiver.epoch(2, antenna_at(0, 0))]
    kinds = [type(observation) for observation in decoded(chunks)]
    assert kinds == [Fix, NoFix, Fix]


def test_time_runs_on_over_midnight() -> None:
    receiver = receiver_at(41.93, -4.87, ReceiverSettings(rate=2))
    fixes = decoded([receiver.epoch(number, antenna_at(0, 0)) for number in range(9)], 0.5)
    times = [fix.t for fix in fixes if isinstance(fix, Fix)]
    assert np.diff(times) == pytest.approx([0.5] * 8)
    utc = [fix.utc for fix in fixes if isinstance(fix, Fix)]
    assert utc[-1] == pytest.approx(START.timestamp() + 4.0)


def test_errors_are_as_large_and_as_slow_as_they_are_said_to_be() -> None:
    chosen = ReceiverSettings(rate=1, decimals=8, noise=0.02, drift=0.3, drift_s=60.0, doppler=0.05)
    receiver = receiver_at(41.93, -4.87, chosen)
    drifts, noises = [], []
    for number in range(6000):
        (line, *_) = receiver.epoch(number, antenna_at(0, 0, 2.0)).decode().split("\r\n")
        message = pynmea2.parse(line)
        east, north = receiver.frame.east_north_from_degrees(message.latitude, message.longitude)
        drifts.append(receiver.drift)
        noises.append((east - receiver.drift[0], north - receiver.drift[1]))
    assert np.std(noises, axis=0) == pytest.approx(0.02, rel=0.05)
    assert np.std(drifts, axis=0) == pytest.approx(0.3, rel=0.35)  # a hundred independent drifts or so
    later = np.corrcoef(np.array(drifts)[:-60, 0], np.array(drifts)[60:, 0])[0, 1]
    assert later == pytest.approx(math.exp(-1), abs=0.2)


def test_the_same_seed_gives_the_same_bytes() -> None:
    def log() -> bytes:
        receiver = receiver_at(41.93, -4.87, ReceiverSettings())
        return b"".join(receiver.epoch(number, antenna_at(number, 0, 1.0)) for number in range(20))

    assert log() == log()


@pytest.mark.parametrize(
    "wrong",
    [{"rate": 3}, {"rate": 0}, {"decimals": 1}, {"decimals": 12}, {"sentences": ("RMC",)}, {"sentences": ("GGA", "X")}],
)
def test_what_no_receiver_does_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"not possible|the sentences are"):
        ReceiverSettings(**wrong)  # type: ignore[arg-type] # each is one wrong value
