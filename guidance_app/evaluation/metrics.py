"""How far an estimate is from the truth: distance, heading, lag in turns, and whether its own uncertainty is honest.

The one entry for a pair of tracks is :func:`score`. Several runs of one scenario are pooled sample by sample, not
averaged run by run, as equation 13 of Gomez-Gil et al. (2013) does over its eighteen lines.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from guidance_app.evaluation.tracks import BoolArray, Track
from guidance_app.model import FloatArray

__all__ = [
    "Errors",
    "Score",
    "after",
    "errors_of",
    "geometric_mean",
    "heading_spread",
    "pool",
    "score",
    "summarise",
    "wrapped",
]

ELLIPSE_95 = 5.991
"""Chi-square of two degrees of freedom that 95 % stay below."""

MOVING = 0.2
"""Below this speed a true heading is not scored: nothing could observe it."""

TURNING = 0.04
"""Above this yaw rate, in rad/s, a path counts as a turn."""

SETTLING = 3.0
"""Headings are scored after so many seconds."""

MAX_GAP = 2.5
"""A truth sampled more sparsely than this, in seconds, is not interpolated."""


@dataclass(frozen=True, slots=True)
class Score:
    """Errors of an estimate in SI units; None where nothing could be scored.

    ``rms``, ``percentile_95`` and ``worst`` are of the distance. ``offset`` is the constant (east, north) that was
    removed first, zero unless asked for. ``within_ellipse`` is the fraction of true positions inside the estimate's
    own 95 % ellipse. ``turn_bias`` is the mean cross-track error in turns, positive to the inside. ``heading_lag`` is
    the delay in seconds that explains most of the heading error.
    """

    samples: int
    rms: float
    percentile_95: float
    worst: float
    heading_rms: float | None
    offset: tuple[float, float] = (0.0, 0.0)
    within_ellipse: float | None = None
    turn_bias: float | None = None
    heading_lag: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Errors:
    """Sample-wise errors, estimate minus truth; all of shape (N,).

    ``right`` is the error across the true heading, positive right. ``heading`` and ``yaw_rate`` are scored only where
    ``scored`` is True. ``normalised`` is the squared distance in the estimate's own sigmas, None without covariance.
    """

    t: FloatArray
    east: FloatArray
    north: FloatArray
    right: FloatArray
    heading: FloatArray
    yaw_rate: FloatArray
    scored: BoolArray
    normalised: FloatArray | None

    @property
    def distance(self) -> FloatArray:
        """Shape (N,), metres."""
        return np.hypot(self.east, self.north)


def wrapped(angle: FloatArray) -> FloatArray:
    """The same directions in [-pi, pi)."""
    return (angle + math.pi) % math.tau - math.pi


def score(estimate: Track, truth: Track, *, remove_offset: bool = False) -> Score:
    """Errors of ``estimate`` against ``truth``, which may be sampled at other times.

    Samples outside the truth's time, or in a gap of it longer than 2.5 s, are left out; ``ValueError`` when none is
    left. With ``remove_offset`` the mean error is taken off first: what remains is the relative error that matters
    between neighbouring passes, when two receivers do not share a reference.
    """
    return summarise(errors_of(estimate, truth), remove_offset=remove_offset)


def errors_of(estimate: Track, truth: Track) -> Errors:
    """The sample-wise errors behind :func:`score`."""
    kept, reference = _matched(estimate, truth)
    if not len(kept):
        msg = "the estimate and the truth have no common time: nothing to score"
        raise ValueError(msg)
    east = kept.east - reference.east
    north = kept.north - reference.north
    moving = np.abs(reference.speed) > MOVING
    settled = kept.t - kept.t[0] >= SETTLING
    return Errors(
        t=kept.t,
        east=east,
        north=north,
        right=east * np.cos(reference.heading) - north * np.sin(reference.heading),
        heading=wrapped(kept.heading - reference.heading),
        yaw_rate=reference.yaw_rate,
        scored=moving & settled & kept.heading_known & reference.heading_known,
        normalised=None if kept.covariance is None else _normalised(east, north, kept.covariance),
    )


def pool(parts: Sequence[Errors]) -> Errors:
    """The errors of several runs as one long run. Normalised errors are kept when every part has them."""
    normalised = [part.normalised for part in parts if part.normalised is not None]
    return Errors(
        t=np.concatenate([part.t for part in parts]),
        east=np.concatenate([part.east for part in parts]),
        north=np.concatenate([part.north for part in parts]),
        right=np.concatenate([part.right for part in parts]),
        heading=np.concatenate([part.heading for part in parts]),
        yaw_rate=np.concatenate([part.yaw_rate for part in parts]),
        scored=np.concatenate([part.scored for part in parts]),
        normalised=np.concatenate(normalised) if len(normalised) == len(parts) else None,
    )


def summarise(errors: Errors, *, remove_offset: bool = False) -> Score:
    """The score of sample-wise errors."""
    offset = (float(np.mean(errors.east)), float(np.mean(errors.north))) if remove_offset else (0.0, 0.0)
    distance = np.hypot(errors.east - offset[0], errors.north - offset[1])
    heading = errors.heading[errors.scored]
    rate = errors.yaw_rate[errors.scored]
    turning = np.abs(errors.yaw_rate) > TURNING
    swing = float(np.sum(rate * rate))
    honest = None if errors.normalised is None else float(np.mean(errors.normalised <= ELLIPSE_95))
    inside = errors.right[turning] * np.sign(errors.yaw_rate[turning])
    return Score(
        samples=len(distance),
        rms=float(np.sqrt(np.mean(distance**2))),
        percentile_95=float(np.percentile(distance, 95)),
        worst=float(np.max(distance)),
        heading_rms=float(np.sqrt(np.mean(heading**2))) if len(heading) else None,
        offset=offset,
        within_ellipse=honest,
        turn_bias=float(np.mean(inside)) if len(inside) else None,
        heading_lag=-float(np.sum(heading * rate)) / swing if swing > 1e-6 else None,
    )


def after(track: Track, seconds: float) -> Track:
    """The track without its first ``seconds``."""
    return _picked(track, track.t - track.t[0] >= seconds)


def heading_spread(error: FloatArray) -> tuple[float, float]:
    """Standard deviation and 95 % range, in the unit of ``error``, the range centred on the true heading.

    Table 2 of Gomez-Gil et al. (2013): the range is the smallest interval around the truth that holds 95 %.
    """
    return float(np.std(error)), 2 * float(np.percentile(np.abs(error), 95))


def geometric_mean(values: Sequence[float]) -> float:
    """The mean that treats a factor of two alike in an easy and in a hard scenario."""
    return math.exp(sum(math.log(value) for value in values) / len(values))


def _normalised(east: FloatArray, north: FloatArray, covariance: FloatArray) -> FloatArray:
    """Squared Mahalanobis distance; a singular covariance counts as infinitely far."""
    var_east, cov, var_north = covariance.T
    determinant = var_east * var_north - cov * cov
    numerator = var_north * east**2 - 2 * cov * east * north + var_east * north**2
    sound = determinant > 0
    return np.where(sound, numerator / np.where(sound, determinant, 1.0), np.inf)


def _matched(estimate: Track, truth: Track) -> tuple[Track, Track]:
    """The estimate's samples that have a truth, and the truth at those times."""
    if len(estimate) == len(truth) and np.array_equal(estimate.t, truth.t):
        return estimate, truth
    if len(truth) < 2 or not len(estimate):
        return _picked(estimate, np.zeros(len(estimate), dtype=bool)), truth
    after = np.clip(np.searchsorted(truth.t, estimate.t), 1, len(truth) - 1)
    before = after - 1
    inside = (estimate.t >= truth.t[0]) & (estimate.t <= truth.t[-1])
    near = truth.t[after] - truth.t[before] <= MAX_GAP
    kept = inside & (near | (truth.t[after] == estimate.t) | (truth.t[before] == estimate.t))
    before, after = before[kept], after[kept]
    span = truth.t[after] - truth.t[before]
    share = (estimate.t[kept] - truth.t[before]) / np.where(span > 0, span, 1.0)

    def between(values: FloatArray) -> FloatArray:
        value: FloatArray = values[before] + share * (values[after] - values[before])
        return value

    turned = wrapped(truth.heading[after] - truth.heading[before])
    reference = Track(
        t=estimate.t[kept],
        east=between(truth.east),
        north=between(truth.north),
        heading=truth.heading[before] + share * turned,
        speed=between(truth.speed),
        curvature=between(truth.curvature),
        heading_known=truth.heading_known[before] & truth.heading_known[after],
    )
    return _picked(estimate, kept), reference


def _picked(track: Track, kept: BoolArray) -> Track:
    return Track(
        t=track.t[kept],
        east=track.east[kept],
        north=track.north[kept],
        heading=track.heading[kept],
        speed=track.speed[kept],
        curvature=track.curvature[kept],
        heading_known=track.heading_known[kept],
        covariance=None if track.covariance is None else track.covariance[kept],
    )
