"""Other programs' estimators on the same recordings, for a comparison in one run.

* filterpy's Kalman filter and Stone Soup's, both set up as the four-state filter of Gomez-Gil et al. (2013); what
  they estimate is what ours does, so only their time differs.
* filterpy's constant-velocity filter (``kinematic_kf``), the one that its own book recommends for a moving vehicle,
  with its acceleration noise tuned on the tuning seeds of the same eight scenarios.

The packages are a test extra. :class:`PeerMissingError` says which one to install.
"""

import importlib
import math
import warnings
from datetime import datetime, timedelta
from types import ModuleType

import numpy as np

from guidance_app.estimation.filter import QuantisationSettings
from guidance_app.evaluation.tracks import Recording, Track
from guidance_app.model import FloatArray

__all__ = ["PeerMissingError", "constant_velocity", "filterpy_four_state", "four_state_input", "stonesoup_four_state"]

ACCELERATION = 0.35
"""Spectral density in m/s per square root of s of the constant-velocity peer, tuned on the tuning seeds."""

EPOCH = datetime(2013, 11, 8)  # noqa: DTZ001 - Stone Soup wants a date for its stamps; any will do


class PeerMissingError(Exception):
    """A peer's package is not installed."""


def four_state_input(recording: Recording) -> FloatArray:
    """Shape (N, 4): east, north, heading, speed as measured. The recording needs a velocity."""
    if recording.velocity is None:
        msg = "the four-state filter measures course and speed: the recording needs a velocity"
        raise ValueError(msg)
    heading = np.arctan2(recording.velocity[:, 0], recording.velocity[:, 1])
    return np.column_stack([recording.position, heading, np.hypot(recording.velocity[:, 0], recording.velocity[:, 1])])


def filterpy_four_state(z: FloatArray, interval: float) -> FloatArray:
    """Shape (N, 4): the states that filterpy's ``KalmanFilter`` estimates from ``four_state_input``."""
    kalman = _package("filterpy.kalman")
    settings = QuantisationSettings()
    peer = kalman.KalmanFilter(4, 4)
    peer.x = z[0].copy()
    peer.P = np.diag(settings.start_covariance)
    peer.Q = np.diag(settings.process_noise)
    peer.R = np.diag(settings.measurement_noise)
    peer.H = np.eye(4)
    states = [z[0].copy()]
    for row in z[1:]:
        peer.F = _transition(float(peer.x[2]), interval)
        peer.predict()
        peer.update(_unwrapped(row, float(peer.x[2])))
        states.append(np.array(peer.x))
    return np.array(states)


def stonesoup_four_state(z: FloatArray, interval: float) -> FloatArray:
    """Shape (N, 4): the states that Stone Soup's predictor and updater estimate from ``four_state_input``."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its imports use what newer numpy and Python deprecate
        transition = _package("stonesoup.models.transition.linear").LinearGaussianTimeInvariantTransitionModel
        measurement = _package("stonesoup.models.measurement.linear").LinearGaussian
        predictor = _package("stonesoup.predictor.kalman").KalmanPredictor
        updater = _package("stonesoup.updater.kalman").KalmanUpdater
        state_type = _package("stonesoup.types.state").GaussianState
        detection = _package("stonesoup.types.detection").Detection
        hypothesis = _package("stonesoup.types.hypothesis").SingleHypothesis
        vector = _package("stonesoup.types.array").StateVector
    settings = QuantisationSettings()
    process = np.diag(settings.process_noise)
    model = measurement(4, (0, 1, 2, 3), np.diag(settings.measurement_noise))
    update = updater(model)
    state = state_type(z[0][:, None], np.diag(settings.start_covariance), EPOCH)
    states = [z[0].copy()]
    for number, row in enumerate(z[1:], start=1):
        stamp = EPOCH + timedelta(seconds=number * interval)
        heading = float(state.state_vector[2, 0])
        motion = transition(transition_matrix=_transition(heading, interval), covariance_matrix=process)
        predicted = predictor(motion).predict(state, timestamp=stamp)
        seen = vector(_unwrapped(row, float(predicted.state_vector[2, 0])))
        state = update.update(hypothesis(predicted, detection(seen, timestamp=stamp, measurement_model=model)))
        states.append(np.array(state.state_vector, dtype=float).ravel())
    return np.array(states)


def constant_velocity(recording: Recording, acceleration: float = ACCELERATION) -> Track:
    """The track of filterpy's constant-velocity filter over the recording's positions."""
    common = _package("filterpy.common")
    kalman = _package("filterpy.kalman")
    interval = float(recording.t[1] - recording.t[0])
    cell = recording.cell or (0.01, 0.01)
    peer = kalman.KalmanFilter(4, 2)
    peer.F = np.kron(np.eye(2), np.array([[1.0, interval], [0.0, 1.0]]))
    peer.H = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
    peer.R = np.diag([cell[0] ** 2 / 12, cell[1] ** 2 / 12])
    peer.Q = np.kron(np.eye(2), common.Q_continuous_white_noise(2, interval, acceleration**2))
    peer.P = np.diag([peer.R[0, 0], 4.0, peer.R[1, 1], 4.0])
    first = recording.position[0]
    peer.x = np.array([first[0], 0.0, first[1], 0.0])
    states = [peer.x.copy()]
    for row in recording.position[1:]:
        peer.predict()
        peer.update(row)
        states.append(np.array(peer.x))
    table = np.array(states)
    count = len(table)
    return Track(
        t=recording.t,
        east=table[:, 0],
        north=table[:, 2],
        heading=np.arctan2(table[:, 1], table[:, 3]) % math.tau,
        speed=np.hypot(table[:, 1], table[:, 3]),
        curvature=np.zeros(count),
        heading_known=np.ones(count, dtype=bool),
    )


def _package(name: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        package = name.partition(".")[0]
        msg = f"the peer {package} is not installed; pip install {package}"
        raise PeerMissingError(msg) from error


def _transition(heading: float, interval: float) -> FloatArray:
    """F of equation 9, in headings."""
    f = np.eye(4)
    f[0, 3] = interval * math.sin(heading)
    f[1, 3] = interval * math.cos(heading)
    return f


def _unwrapped(row: FloatArray, heading: float) -> FloatArray:
    """The measurement with its heading less than half a turn from ``heading``: neither peer wraps by itself."""
    near = row.copy()
    near[2] = heading + (row[2] - heading + math.pi) % math.tau - math.pi
    return near
