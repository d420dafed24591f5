"""``quantisation_kf`` over a whole recording at once: arrays in, arrays out, one compiled loop between them."""

import numpy as np

from guidance_app.estimation.filter import FilterSettings
from guidance_app.estimation.observation_kernels import NO_COURSE
from guidance_app.estimation.quantisation_kernels import (
    ARM_FORWARD,
    ARM_RIGHT,
    EPOCH,
    FIX_EE,
    FIX_NN,
    NO_SPEED,
    P_EAST,
    P_EE,
    P_HEADING,
    P_KNOWN,
    P_NN,
    P_NORTH,
    P_SPEED,
    Z_COMPASS,
    Z_COURSE,
    Z_EAST,
    Z_NORTH,
    Z_SPEED,
    Z_T,
    filtered,
)
from guidance_app.estimation.receiver_noise import fix_covariance
from guidance_app.evaluation.tracks import Recording, Track, course_and_speed, measurements
from guidance_app.model import FloatArray

__all__ = ["quantisation_track"]


def quantisation_track(recording: Recording, settings: FilterSettings) -> Track:
    """The pose at every epoch, as ``quantisation_kf`` gives them one after the other."""
    assert np.all(np.diff(recording.t) > 0), "the times of a recording grow"
    poses = filtered(_epochs(recording), np.array(settings.quantisation_kf.numbers))
    return Track(
        t=recording.t,
        east=poses[:, P_EAST],
        north=poses[:, P_NORTH],
        heading=poses[:, P_HEADING],
        speed=poses[:, P_SPEED],
        curvature=np.zeros(len(poses)),
        heading_known=poses[:, P_KNOWN] == 1.0,
        covariance=poses[:, P_EE : P_NN + 1],
    )


def _epochs(recording: Recording) -> FloatArray:
    """Shape (N, 11), as the kernels take them."""
    epochs = np.zeros((len(recording), EPOCH))
    epochs[:, Z_T] = recording.t
    epochs[:, Z_EAST : Z_NORTH + 1] = recording.position
    epochs[:, Z_SPEED], epochs[:, Z_COURSE], epochs[:, Z_COMPASS] = NO_SPEED, NO_COURSE, NO_COURSE
    if recording.velocity is not None:
        epochs[:, Z_COURSE], epochs[:, Z_SPEED] = course_and_speed(recording.velocity)
    if recording.heading is not None:
        epochs[:, Z_COMPASS] = recording.heading
    if recording.antenna is not None:
        epochs[:, ARM_FORWARD : ARM_RIGHT + 1] = recording.antenna[:, :2]
    first = next(measurements(recording), None)  # cell, quality and sigma are the same for all
    if first is not None:
        epochs[:, FIX_EE : FIX_NN + 1] = fix_covariance(first)
    return epochs
