"""The roll sensor's zero through the engine: two drives, the offer, its use from then on, and every wrong order."""

import math
from datetime import UTC, datetime
from functools import reduce
from operator import xor

import numpy as np
import pytest
from support.drives import FRAME, a_job

from guidance_app.documents import Tractor
from guidance_app.engine import Engine
from guidance_app.model import (
    ApplyRollZero,
    BeginRollZero,
    CancelRollZero,
    Chunk,
    Command,
    Commanded,
    FinishRollZero,
    NextRollZeroDrive,
    RollZeroStage,
    Snapshot,
)
from guidance_app.simulation.receiver import Antenna, ReceiverSettings, SimulatedReceiver

HEIGHT, WRONG_BY_DEG = 3.0, 1.5
SPEED, RATE = 2.0, 5
TENTH_OF_A_DEGREE = 0.1


def engine_on_a_slope(height: float = HEIGHT) -> Engine:
    tractor = Tractor(name="Tractor", antenna_height=height)
    return Engine(a_job(field=False).model_copy(update={"tractor": tractor}))


def drive(begin: float, south_to_north: bool, length: float = 60.0, *, sensor: bool = True) -> list[Chunk]:
    """A level drive along x = 0 whose roll sensor shows 1.5 degrees too much to the right."""
    settings = ReceiverSettings(rate=RATE, decimals=7, noise=0.0, drift=0.0, doppler=0.0)
    receiver = SimulatedReceiver(FRAME, settings, datetime(2026, 4, 1, 8, tzinfo=UTC), np.random.default_rng(1))
    sign = 1.0 if south_to_north else -1.0
    heading = 0.0 if south_to_north else math.pi
    chunks = []
    for step in range(int(length / SPEED * RATE)):
        number = int(begin * RATE) + step
        north = sign * (step * SPEED / RATE - length / 2)
        said = receiver.epoch(number, Antenna(0.0, north, 0.0, sign * SPEED, heading, 0.0))
        body = f"PGATT,,{WRONG_BY_DEG:.2f},0.00,,,,"
        tilt = f"${body}*{reduce(xor, body.encode(), 0):02X}\r\n".encode() if sensor else b""
        chunks.append(Chunk(number / RATE, tilt + said))
    return chunks


def told(engine: Engine, command: Command) -> Snapshot:
    return engine.step(Commanded(engine.snapshot.arrival, command))


def driven(engine: Engine, chunks: list[Chunk]) -> Snapshot:
    for chunk in chunks:
        engine.step(chunk)
    return engine.snapshot


def calibrated() -> Engine:
    engine = engine_on_a_slope()
    there, back = drive(0.0, south_to_north=True), drive(60.0, south_to_north=False)
    driven(engine, there[:25])
    told(engine, BeginRollZero())
    driven(engine, there[25:])
    driven(engine, back[:10])
    told(engine, NextRollZeroDrive())
    driven(engine, back[10:])
    told(engine, FinishRollZero())
    return engine


def test_a_line_driven_both_ways_finds_the_zero_and_its_use_straightens_the_drive():
    engine = calibrated()
    progress = engine.snapshot.roll_zero
    assert progress is not None
    assert progress.stage is RollZeroStage.FOUND
    assert progress.found is not None
    assert progress.found.roll_zero_deg == pytest.approx(WRONG_BY_DEG, abs=TENTH_OF_A_DEGREE)
    assert progress.found.sigma_deg < TENTH_OF_A_DEGREE
    assert engine.snapshot.roll_zero_deg == 0.0
    applied = told(engine, ApplyRollZero())
    assert applied.roll_zero is None
    assert applied.roll_zero_deg == pytest.approx(WRONG_BY_DEG, abs=TENTH_OF_A_DEGREE)
    assert engine.tractor.roll_zero_deg == applied.roll_zero_deg
    straight = driven(engine, drive(120.0, south_to_north=True)).pose
    assert straight is not None
    assert abs(straight.east) < HEIGHT * math.sin(math.radians(TENTH_OF_A_DEGREE)) + 0.01


def test_progress_is_shown_in_metres():
    engine = engine_on_a_slope()
    there = drive(0.0, south_to_north=True)
    driven(engine, there[:25])
    assert told(engine, BeginRollZero()).roll_zero is not None
    progress = driven(engine, there[25:125]).roll_zero
    assert progress is not None
    assert progress.there == pytest.approx(40.0, abs=2.0)
    assert progress.back == 0.0


def test_every_wrong_order_is_said():
    engine = engine_on_a_slope()
    there = drive(0.0, south_to_north=True)
    driven(engine, there[:25])
    assert "No calibration" in told(engine, NextRollZeroDrive()).notices[0]
    told(engine, BeginRollZero())
    assert "30 m are needed" in told(engine, NextRollZeroDrive()).notices[0]
    assert "back first" in told(engine, FinishRollZero()).notices[0]
    assert "Nothing has been found" in told(engine, ApplyRollZero()).notices[0]
    driven(engine, there[25:])
    told(engine, NextRollZeroDrive())
    assert "already begun" in told(engine, NextRollZeroDrive()).notices[0]
    assert "No roll zero" in told(engine, FinishRollZero()).notices[0]
    assert told(engine, CancelRollZero()).roll_zero is None


def test_without_a_roll_sensor_or_a_high_antenna_there_is_nothing_to_calibrate():
    deaf = engine_on_a_slope()
    driven(deaf, drive(0.0, south_to_north=True, sensor=False)[:25])
    assert "No roll sensor" in told(deaf, BeginRollZero()).notices[0]
    low = engine_on_a_slope(height=0.2)
    driven(low, drive(0.0, south_to_north=True)[:25])
    assert "hardly moves" in told(low, BeginRollZero()).notices[0]


def test_a_fork_calibrates_on_its_own():
    engine = calibrated()
    fork = engine.fork(generation=1)
    told(fork, ApplyRollZero())
    assert engine.snapshot.roll_zero_deg == 0.0
    assert fork.snapshot.roll_zero_deg != 0.0
