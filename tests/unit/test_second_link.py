"""Receiver and attitude sensor on separate ports: joined by time, each with a state of its own."""

import math

import pytest
from support.nmea import epoch, sentence
from support.sessions import a_job

from guidance_app.engine import Engine
from guidance_app.engine.attitudes import Attitudes
from guidance_app.model import ATTITUDE, CORRECTIONS, Attitude, Chunk, LinkStatus, SourceDown, SourceUp

NOON = 43200.0
DIGIT = 1e-9


def attitude(at: float, roll_deg: float) -> Chunk:
    return Chunk(at, sentence(f"PGATT,,{roll_deg:.2f},0.50,,,,1.00"), ATTITUDE)


def driven(until: float, *, sensor_until: float) -> Engine:
    """Fixes at 5 Hz, standing, whose bytes take 0.1 s; the sensor at 50 Hz rolls 1 degree in each second."""
    engine = Engine(a_job(), filter_name="off")
    engine.step(SourceUp(0.0, "the receiver"))
    engine.step(SourceUp(0.0, "the sensor", ATTITUDE))
    for step in range(round(until * 50)):
        now = step / 50
        if now < sensor_until:
            engine.step(attitude(now, now))
        if step % 10 == 0:
            engine.step(Chunk(now, epoch(NOON + now)))
    return engine


def test_a_reading_of_the_other_port_is_in_the_pose() -> None:
    engine = driven(4.0, sensor_until=4.0)
    snapshot = engine.snapshot
    assert snapshot.link.status is LinkStatus.FIX
    assert snapshot.links_beside[ATTITUDE].status is LinkStatus.ATTITUDE
    assert snapshot.links_beside[ATTITUDE].what == "the sensor"
    assert snapshot.fix is not None
    assert snapshot.fix.roll is None
    assert snapshot.pose is not None
    assert snapshot.pose.roll == pytest.approx(math.radians(snapshot.fix.arrival), abs=math.radians(0.02))


def test_the_fix_takes_the_reading_nearest_to_it_not_the_newest() -> None:
    readings = Attitudes()
    for step in range(100):
        readings.take(Attitude(step / 50, roll=float(step)))
    near = readings.at(1.0)
    assert near is not None
    assert (near.arrival, near.roll) == (1.0, 50.0)


def test_each_quantity_comes_from_the_nearest_reading_that_has_it() -> None:
    readings = Attitudes()
    readings.take(Attitude(1.00, roll=0.1, pitch=0.2))
    readings.take(Attitude(1.02, heading=2.0))
    readings.take(Attitude(1.04, yaw_rate=0.3))
    near = readings.at(1.05)
    assert near is not None
    assert (near.roll, near.pitch, near.heading, near.yaw_rate) == (0.1, 0.2, 2.0, 0.3)
    assert near.roll_rate is None


def test_readings_far_from_the_fix_say_nothing_and_are_forgotten() -> None:
    readings = Attitudes()
    assert readings.at(0.0) is None
    readings.take(Attitude(0.0, roll=0.1))
    assert readings.at(1.5) is None
    copy = readings.fork()
    readings.take(Attitude(10.0, roll=0.2))
    assert readings.at(0.0) is None
    assert copy.at(0.0) is not None


def test_a_lost_sensor_leaves_the_receiver_as_it_is_and_is_in_the_pose_no_more() -> None:
    engine = driven(4.0, sensor_until=2.0)
    assert engine.snapshot.pose is not None
    assert engine.snapshot.pose.roll is None
    engine.step(SourceDown(4.0, "the sensor is unplugged", ATTITUDE))
    snapshot = engine.snapshot
    assert snapshot.link.status is LinkStatus.FIX
    assert snapshot.links_beside[ATTITUDE].status is LinkStatus.DOWN
    assert snapshot.links_beside[ATTITUDE].reason == "the sensor is unplugged"


def test_a_lost_receiver_does_not_hide_behind_the_sensor() -> None:
    engine = driven(2.0, sensor_until=2.0)
    engine.step(SourceDown(2.0, "the receiver is unplugged"))
    engine.step(attitude(2.1, 1.0))
    assert engine.snapshot.link.status is LinkStatus.DOWN
    assert engine.snapshot.links_beside[ATTITUDE].status is LinkStatus.ATTITUDE


def test_a_sensor_whose_sentences_hold_no_reading_is_told_apart_from_noise() -> None:
    engine = Engine(a_job(), filter_name="off")
    engine.step(SourceUp(0.0, "/dev/ttyUSB1 at 9600 baud", ATTITUDE))
    engine.step(Chunk(0.5, b"\x80\xff$\x03noise", ATTITUDE))
    noise = engine.snapshot.links_beside[ATTITUDE]
    assert noise.status is LinkStatus.NO_SENTENCE
    assert "/dev/ttyUSB1 at 9600 baud" in noise.reason
    engine.step(Chunk(1.0, sentence("PGATT,,,,,,,"), ATTITUDE))
    assert engine.snapshot.links_beside[ATTITUDE].status is LinkStatus.NO_FIX


def test_a_caster_is_connected_or_not() -> None:
    engine = Engine(a_job(), filter_name="off")
    engine.step(SourceUp(0.0, "caster.example MOUNT", CORRECTIONS))
    assert engine.snapshot.links_beside[CORRECTIONS].status is LinkStatus.CORRECTED
    engine.step(SourceDown(1.0, "refused", CORRECTIONS))
    assert engine.snapshot.links_beside[CORRECTIONS].status is LinkStatus.DOWN
    assert engine.snapshot.link.status is LinkStatus.CONNECTING
