"""The adaptive filter's models as arrays, made once: which set serves which sensors, and how often they change."""

import math

import numpy as np

from guidance_app.estimation.filter import AdaptiveSettings
from guidance_app.estimation.motion_models import ModelSet
from guidance_app.model import FloatArray, Measurement

__all__ = ["MotionTables"]

SAME_INTERVAL = 4
"""Intervals equal to so many decimals of a second share a table."""
MOST_INTERVALS = 500
RAREST = 1e-7
"""No change is impossible."""


class MotionTables:
    """Model rows and transition probabilities for each kind of input; remembers those of the intervals it has seen."""

    def __init__(self, settings: AdaptiveSettings) -> None:
        self._sets = {
            (False, False): settings.position,
            (True, False): settings.doppler,
            (False, True): settings.gyro,
            (True, True): settings.doppler_gyro,
        }
        self._rows = {kind: _rows(models) for kind, models in self._sets.items()}
        self._moves: dict[tuple[bool, bool, float], FloatArray] = {}

    def models(self, z: Measurement) -> ModelSet:
        """The set tuned for what this epoch holds."""
        return self._sets[_kind(z)]

    def rows(self, z: Measurement) -> FloatArray:
        """Shape (4, 3): acceleration, curvature and memory of each model."""
        return self._rows[_kind(z)]

    def moves(self, z: Measurement, dt: float) -> FloatArray:
        """Shape (4, 4): probability of changing from one model (row) to another (column) within ``dt``."""
        kind = _kind(z)
        interval = round(dt, SAME_INTERVAL)
        found = self._moves.get((*kind, interval))
        if found is None:
            if len(self._moves) >= MOST_INTERVALS:
                self._moves.clear()
            found = _transitions(self._sets[kind], interval)
            self._moves[*kind, interval] = found
        return found


def _kind(z: Measurement) -> tuple[bool, bool]:
    """Whether there is a speed, and whether there is a gyro."""
    return z.speed is not None, z.yaw_rate is not None


def _rows(models: ModelSet) -> FloatArray:
    rows = np.array([(m.acceleration, m.curvature, m.memory) for m in models.models])
    rows.setflags(write=False)
    return rows


def _transitions(models: ModelSet, dt: float) -> FloatArray:
    """From rates to probabilities. From a turn the driver mostly straightens out over gentle and uneven driving."""
    out, bend, calm, ease, swing, end = (-math.expm1(-rate * dt) for rate in models.rates)
    moves = np.array(
        [
            [1 - out - swing / 2, out, 0.0, swing / 2],
            [calm, 1 - calm - bend - swing, bend, swing],
            [0.0, ease, 1 - ease - swing, swing],
            [0.1 * end, 0.4 * end, 0.5 * end, 1 - end],
        ]
    )
    moves = np.clip(moves, RAREST, 1.0)
    moves = np.asarray(moves / moves.sum(axis=1, keepdims=True))
    moves.setflags(write=False)
    return moves
