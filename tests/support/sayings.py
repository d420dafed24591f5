"""What a receiver says of a tractor that stands or moves, as chunks."""

import math
from datetime import UTC, datetime

import numpy as np

from guidance_app.model import Chunk
from guidance_app.simulation.receiver import Antenna, ReceiverSettings, SimulatedReceiver
from support.drives import FRAME

__all__ = ["stood"]

BEGAN = datetime(2026, 4, 1, 7, 59, tzinfo=UTC)
"""A minute before the drives begin."""


def stood(
    seconds: float, at: tuple[float, float] = (15.0, 15.0), *, begin: float = 0.0, rate: int = 5, speed: float = 0.0
) -> list[Chunk]:
    """A tractor that stands at (east, north) of the frame, or creeps north from there."""
    settings = ReceiverSettings(rate=rate, decimals=7, noise=0.01, drift=0.0, doppler=0.01)
    receiver = SimulatedReceiver(FRAME, settings, BEGAN, np.random.default_rng(4))
    first = round(begin * rate)
    chunks = []
    for number in range(first, first + round(seconds * rate)):
        north = at[1] + speed * (number - first) / rate
        antenna = Antenna(at[0], north, 0.0, speed, math.radians(5.0), 0.0)
        chunks.append(Chunk(number / rate, receiver.epoch(number, antenna)))
    return chunks
