"""A whole drive as columns: what was received, estimated and guided at each fix, for reviews, ledgers and exports.

It is derived, never recorded: the inputs of a recording, taken through the engine again, give it to the bit.
"""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from guidance_app.model.arrays import FloatArray

__all__ = ["NO_PASS", "DriveLog"]

NO_PASS = -(2**31)
"""The number of the pass where there was none."""


@dataclass(frozen=True, slots=True, eq=False)
class DriveLog:
    """One row a fix, each column of shape (N,). What is unknown is NaN in a column of numbers: these are arrays.

    ``arrival`` is the session clock, ``t`` the receiver's second of its first day, ``utc`` POSIX time. ``latitude_deg``
    and ``longitude_deg`` are the antenna's as received. ``east``, ``north``, ``heading``, ``speed`` are the filtered
    reference point's in the frame of ``origin_deg`` (latitude, longitude; None without a fix), ``implement_*`` the
    implement's working point. ``ahead_*`` is the predicted pose. ``cross_track`` is positive right of the pass.
    ``worked``, ``overlap`` are the totals so far in m2. Whole numbers: ``quality`` as in GGA,
    ``pass_number`` with ``NO_PASS``, ``satellites`` with -1 where unknown.
    """

    arrival: FloatArray
    t: FloatArray
    utc: FloatArray
    latitude_deg: FloatArray
    longitude_deg: FloatArray
    east: FloatArray
    north: FloatArray
    heading: FloatArray
    speed: FloatArray
    sigma: FloatArray
    roll: FloatArray
    pitch: FloatArray
    implement_east: FloatArray
    implement_north: FloatArray
    implement_heading: FloatArray
    ahead_east: FloatArray
    ahead_north: FloatArray
    ahead_heading: FloatArray
    ahead_cross_track: FloatArray
    cross_track: FloatArray
    heading_error: FloatArray
    along: FloatArray
    hdop: FloatArray
    worked: FloatArray
    overlap: FloatArray
    quality: NDArray[np.int32]
    satellites: NDArray[np.int32]
    pass_number: NDArray[np.int32]
    on_pass: NDArray[np.bool_]
    working: NDArray[np.bool_]
    standing: NDArray[np.bool_]
    origin_deg: tuple[float, float] | None = None

    def __len__(self) -> int:
        return len(self.t)

    @classmethod
    def columns(cls) -> tuple[str, ...]:
        """The names of the columns, in order."""
        return tuple(one.name for one in fields(cls) if one.name != "origin_deg")

    def part(self, chosen: NDArray[np.bool_] | slice) -> "DriveLog":
        """The chosen rows alone."""
        return DriveLog(**{name: getattr(self, name)[chosen] for name in self.columns()}, origin_deg=self.origin_deg)
