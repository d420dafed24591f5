"""What a filter is, and what may be set of each: the contract between the filters and everybody else.

A filter takes one ``Measurement`` per epoch and gives the pose of the reference point. Its inner state is a frozen
record that is replaced in each step, so that ``fork`` is a copy of one reference. No filter raises on a finite
measurement. What every filter promises about time:

* ``dt`` of zero or less (a repeated or an older epoch) changes nothing; the last pose is given again.
* A gap is predicted over where the filter has a model for it and starts anew where it has not; each says its limit.

``FilterSettings`` is one document for all filters, so that a tuning result or a driver's choice can be kept, compared
and put back. Numbers outside their bounds are refused with field, value and bound.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal, Protocol

from pydantic import Field

from guidance_app.documents import Document, quantity
from guidance_app.estimation.motion_models import (
    DOPPLER,
    DOPPLER_GYRO,
    GYRO,
    POSITION,
    ModelSet,
    MotionModel,
    SettingsPart,
)
from guidance_app.model import Measurement, Pose

__all__ = [
    "AdaptiveSettings",
    "Filter",
    "FilterFactory",
    "FilterSettings",
    "GyroSettings",
    "ModelSet",
    "MotionModel",
    "QuantisationSettings",
    "SmootherSettings",
    "Start",
    "Variances",
]


@dataclass(frozen=True, slots=True)
class Start:
    """What standing at the start point has taught.

    ``east``, ``north`` is the correction to add to every position so that the start point is where it is known to be
    (zero when no start point is known). ``covariance`` is the fixes' sample covariance (var east, cov, var north);
    ``gyro_bias`` and ``gyro_sigma`` the gyro's mean rate and its scatter at rest.
    """

    east: float
    north: float
    covariance: tuple[float, float, float]
    gyro_bias: float | None
    gyro_sigma: float | None
    seconds: float
    samples: int


class Filter(Protocol):
    """Measurements in, poses out."""

    def step(self, z: Measurement) -> Pose | None:
        """The pose at the measurement's time; None while there is nothing to say."""
        ...

    def begin(self, start: Start) -> None:
        """Takes over what standing at the start point has taught: measurement noise and gyro bias."""
        ...

    def fork(self) -> "Filter":
        """An independent copy, cheap enough to keep one every few seconds."""
        ...


Variance = Annotated[float, Field(gt=0, le=1e9, allow_inf_nan=False)]
Variances = tuple[Variance, Variance, Variance, Variance]


class QuantisationSettings(SettingsPart):
    """The filter of Gomez-Gil et al. (2013): diagonals in the order east, north, heading, speed.

    The defaults are eq. 14. Only the ratios of process to measurement noise matter; the paper gives no units.
    """

    process_noise: Variances = Field((0.23, 0.26, 0.01, 1.05), title="Process noise Q")
    measurement_noise: Variances = Field((1.51, 5.58, 1.95, 1.68), title="Measurement noise R")
    start_covariance: Variances = Field((3.7, 6.4, 3.7, 6.7), title="Covariance at the start")

    @property
    def numbers(self) -> tuple[float, ...]:
        """All twelve, as the kernels take them."""
        return (*self.process_noise, *self.measurement_noise, *self.start_covariance)


class GyroSettings(SettingsPart):
    """The filter of Inoue et al.: random walks of the state's four parts and the fix's scatter.

    The walks are variances per second; the paper gives no numbers, these were tuned on other seeds than the reported.
    """

    position_walk: Variance = Field(1e-5, title="Random walk of the position", json_schema_extra={"unit": "m2/s"})
    speed_walk: Variance = Field(1e-5, title="Random walk of the speed's error", json_schema_extra={"unit": "m2/s3"})
    heading_walk: Variance = Field(
        1e-4, title="Random walk of the heading's error", json_schema_extra={"unit": "rad2/s"}
    )
    position_noise: Variance = Field(0.04, title="Variance of a fix", json_schema_extra={"unit": "m2"})
    gate: float = quantity("Outlier gate", "chi-square of 2", 6, 40, 13.8, step=0.1)
    as_printed: bool = Field(
        default=False,
        title="Equations as printed",
        description="With the acceleration's error as a fifth, unobservable state, d without B, + a dt2/2",
    )


class AdaptiveSettings(SettingsPart):
    """The adaptive filter: one set of models per kind of input, and how much each sensor is believed."""

    position: ModelSet = POSITION
    doppler: ModelSet = DOPPLER
    gyro: ModelSet = GYRO
    doppler_gyro: ModelSet = DOPPLER_GYRO
    velocity_noise: float = quantity("Noise of the receiver's velocity", "m/s", 0.005, 2, 0.05)
    gyro_noise: float = quantity("Noise of the gyro", "rad/s", 1e-5, 0.5, 0.003, step=0.0001)
    gyro_walk: float = quantity("Walk of the gyro's bias", "rad/s per square root of s", 0, 0.01, 2e-5, step=1e-6)
    heading_noise_deg: float = quantity("Noise of a heading sensor", "deg", 0.02, 20, 0.5, step=0.1)
    heading_walk: float = quantity("Walk of the heading", "rad per square root of s", 1e-6, 0.1, 0.002, step=0.001)
    gate: float = quantity("Outlier gate", "chi-square of 2", 6, 40, 15, step=0.1)


class SmootherSettings(SettingsPart):
    """The offline smoother's calm motion model, for positions alone and with anything beside them.

    The drive's own liveliness is added to it. Stiffer models are better still on straight lines, but their ellipse no
    longer holds in a fishtail: 67 % at a third of these numbers.
    """

    position: MotionModel = MotionModel(acceleration=0.03, curvature=0.01, memory=25.0)
    sensors: MotionModel = MotionModel(acceleration=0.03, curvature=0.01, memory=25.0)


class FilterSettings(Document):
    """Everything that may be set of the filters, and of the look-ahead."""

    kind: Literal["filter settings"] = "filter settings"
    quantisation_kf: QuantisationSettings = QuantisationSettings()
    gyro_ekf: GyroSettings = GyroSettings()
    adaptive: AdaptiveSettings = AdaptiveSettings()
    smoother: SmootherSettings = SmootherSettings()
    look_ahead: float = quantity("Predict ahead", "s", 0.5, 3.0, 1.5, step=0.1)


FilterFactory = Callable[[FilterSettings], Filter]
