"""Drives as columns whose answer is known."""

import numpy as np

from guidance_app.model import DriveLog

__all__ = ["HERTZ", "SPACING", "passes_driven"]

SPACING = 6.0
HERTZ = 5.0
SPEED = 2.0


def passes_driven(*errors: float) -> DriveLog:
    """Passes 0, 1, ... to the north, 200 m each, 6 m apart, each so many metres right of where it belongs."""
    count = int(200 / SPEED * HERTZ)
    rows = len(errors) * count
    north = np.tile(np.arange(count) * SPEED / HERTZ, len(errors))
    number = np.repeat(np.arange(len(errors)), count)
    error = np.repeat(np.array(errors), count)
    plain = {name: np.zeros(rows) for name in DriveLog.columns()}
    plain |= {
        "t": np.arange(rows) / HERTZ,
        "utc": 1_760_000_000.0 + np.arange(rows) / HERTZ,
        "east": number * SPACING + error,
        "north": north,
        "speed": np.full(rows, SPEED),
        "cross_track": error,
        "along": north,
        "implement_east": number * SPACING + error,
        "implement_north": north,
        "pass_number": number.astype(np.int32),
        "quality": np.full(rows, 4, np.int32),
        "satellites": np.full(rows, 12, np.int32),
        "on_pass": np.ones(rows, bool),
        "working": np.ones(rows, bool),
        "standing": np.zeros(rows, bool),
    }
    return DriveLog(**plain)
