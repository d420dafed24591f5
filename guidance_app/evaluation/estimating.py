"""Any filter on any trajectory: arrays in, estimated poses out, through the very steps that run in the cab."""

import numpy as np
from numpy.typing import ArrayLike

from guidance_app.estimation.filter import FilterSettings
from guidance_app.estimation.filters import make_filter
from guidance_app.evaluation.quantisation import quantisation_track
from guidance_app.evaluation.tracks import Recording, Track, measurements, track_from_poses
from guidance_app.model import FixQuality, FloatArray

__all__ = ["estimate", "estimate_recording"]


def estimate(  # noqa: PLR0913 - one argument a sensor; all but three have defaults
    time: ArrayLike,
    position: ArrayLike,
    cell: tuple[float, float] | None,
    *,
    velocity: ArrayLike | None = None,
    yaw_rate: ArrayLike | None = None,
    heading: ArrayLike | None = None,
    filter_name: str = "adaptive",
    settings: FilterSettings | None = None,
    quality: FixQuality = FixQuality.RTK_FIXED,
) -> Track:
    """The poses that a filter estimates along a recorded path, causally: no sample uses a later one.

    Args:
        time: shape (N,), seconds, growing.
        position: shape (N, 2), metres east and north, as the receiver reported them.
        cell: rounding (east, north) of the positions in metres, None when it is negligible.
        velocity: shape (N, 2), metres per second east and north, from the receiver's Doppler.
        yaw_rate: shape (N,), radians per second, positive clockwise, from a gyro; a constant bias does no harm.
        heading: shape (N,), radians clockwise from north, from a compass or two antennas.
        filter_name: ``off``, ``quantisation_kf``, ``gyro_ekf`` or ``adaptive``.
        settings: what may be set of the filters; None for the defaults.
        quality: what kind of fix the positions are; it tells how far they drift.

    Returns:
        A track with one sample for each epoch at which the filter had a pose. Score it with ``evaluation.score``.

    Raises:
        ValueError: arrays of different length or with numbers that are not finite, time that does not grow, or an
            unknown filter.

    A tractor drives 30 m to the north-east at 1.4 m/s, rounded to a grid of 14 by 18 cm five times a second:

    >>> import numpy as np
    >>> from guidance_app.evaluation import estimate, score
    >>> from guidance_app.evaluation.scenarios import straight_line
    >>> truth = straight_line(heading=np.radians(50), speed=1.4, samples=107)
    >>> grid = np.array([0.14, 0.18])
    >>> fixes = np.round(truth.positions / grid) * grid
    >>> poses = estimate(truth.t, fixes, cell=(0.14, 0.18))
    >>> filtered = score(poses, truth)
    >>> raw = score(estimate(truth.t, fixes, cell=(0.14, 0.18), filter_name="off"), truth)
    >>> filtered.rms < 0.7 * raw.rms
    True
    """
    t = _checked_time(time)
    count = len(t)
    recording = Recording(
        t=t,
        position=_checked(position, (count, 2), "position"),
        cell=cell,
        velocity=None if velocity is None else _checked(velocity, (count, 2), "velocity"),
        yaw_rate=None if yaw_rate is None else _checked(yaw_rate, (count,), "yaw_rate"),
        heading=None if heading is None else _checked(heading, (count,), "heading"),
        quality=quality,
    )
    return estimate_recording(recording, filter_name, settings)


def estimate_recording(recording: Recording, filter_name: str, settings: FilterSettings | None = None) -> Track:
    """The poses that the filter estimates along ``recording``, one for each epoch at which it had one.

    ``quantisation_kf`` runs over the whole recording in one compiled loop around the step that the cab takes fix by
    fix; the poses are the same to the last bit.
    """
    if filter_name == "quantisation_kf":
        return quantisation_track(recording, settings or FilterSettings())
    estimator = make_filter(filter_name, settings)
    poses = [pose for z in measurements(recording) if (pose := estimator.step(z)) is not None]
    return track_from_poses(poses)


def _checked_time(values: ArrayLike) -> FloatArray:
    count = np.size(np.asarray(values, dtype=float))
    t = _checked(values, (count,), "time")
    if np.any(np.diff(t) <= 0):
        msg = f"time must grow; it does not after sample {int(np.argmax(np.diff(t) <= 0))}"
        raise ValueError(msg)
    return t


def _checked(values: ArrayLike, shape: tuple[int, ...], name: str) -> FloatArray:
    array = np.asarray(values, dtype=float)
    if array.shape != shape:
        msg = f"{name} has shape {array.shape}; {shape} is needed to go with time"
        raise ValueError(msg)
    if not np.all(np.isfinite(array)):
        msg = f"{name} holds numbers that are not finite; leave such epochs out"
        raise ValueError(msg)
    return array
