"""How far a fix of each quality may be off: white scatter, and the slow error that no averaging removes.

The numbers are those of the sources' own scatter: RTK by its data sheets, DGPS by Inoue et al. (steps of 25 cm that
stay, drift of 16 cm over minutes), RTK float by a car's drive beside a reference (37 cm an axis for minutes),
autonomous by the daily drift that users see between neighbouring passes.

A wider scatter for DGPS (10 cm, drift of 25 cm over 40 s) would take up those steps better, 4.2 instead of 4.5 cm
within a pass of their test, but with it the estimate leaves a real tractor's log by 2.5 m where it backs up (0.4 m as
it is).
"""

import math
from dataclasses import dataclass

from guidance_app.model import FixQuality, Measurement

__all__ = ["DEFAULT_CELL", "ReceiverNoise", "fix_covariance", "noise_of"]

DEFAULT_CELL = 1e-3
"""Rounding in metres where the sentence's decimals are not known."""


@dataclass(frozen=True, slots=True)
class ReceiverNoise:
    """Standard deviations in metres. ``drift`` is the slow error's, ``drift_time`` its correlation time in seconds."""

    white: float
    drift: float
    drift_time: float


_BY_QUALITY = {
    FixQuality.NONE: ReceiverNoise(1.0, 5.0, 60.0),
    FixQuality.AUTONOMOUS: ReceiverNoise(0.03, 0.7, 1000.0),
    FixQuality.DGPS: ReceiverNoise(0.03, 0.18, 70.0),
    FixQuality.PPS: ReceiverNoise(0.03, 0.18, 70.0),
    FixQuality.RTK_FIXED: ReceiverNoise(0.008, 0.0, 1.0),
    FixQuality.RTK_FLOAT: ReceiverNoise(0.03, 0.38, 2000.0),
    FixQuality.DEAD_RECKONING: ReceiverNoise(0.3, 3.0, 60.0),
    FixQuality.MANUAL: ReceiverNoise(0.01, 0.0, 1.0),
    FixQuality.SIMULATED: ReceiverNoise(0.008, 0.0, 1.0),
}


def noise_of(z: Measurement) -> ReceiverNoise:
    """The scatter to expect of this fix; the receiver's own estimate (GST) wins over the table."""
    noise = _BY_QUALITY[z.quality]
    if z.sigma is None:
        return noise
    said = min(max(math.hypot(*z.sigma) / math.sqrt(2), 0.005), 20.0)
    if noise.drift == 0.0:
        return ReceiverNoise(said, 0.0, noise.drift_time)
    return ReceiverNoise(noise.white, max(said, noise.white), noise.drift_time)


def fix_covariance(z: Measurement, measured: tuple[float, float, float] | None = None) -> tuple[float, float, float]:
    """What one fix alone says: (var east, cov, var north) of rounding, scatter and drift together.

    ``measured`` is the sample covariance found standing at the start point: the scatter then, if it is the larger.
    """
    noise = noise_of(z)
    cell_east, cell_north = z.cell or (DEFAULT_CELL, DEFAULT_CELL)
    spread = noise.white**2
    east, cov, north = cell_east**2 / 12 + spread, 0.0, cell_north**2 / 12 + spread
    if measured is not None and measured[0] + measured[2] > east + north:
        east, cov, north = max(measured[0], spread), measured[1], max(measured[2], spread)
    return east + noise.drift**2, cov, north + noise.drift**2
